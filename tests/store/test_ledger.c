/* The ledger: opening, writing, finding runs again, dead runs, many writers. What is printed: test_ledger_print.c. */
#include "base/clock.h"
#include "base/memory.h"
#include "check.h"
#include "ledger_scratch.h"

#include <grp.h>
#include <math.h>
#include <signal.h>
#include <sys/resource.h>

/* ---- opening ----------------------------------------------------------------------------------------------------- */

static void a_new_ledger_is_made_with_its_folders(void) {
    ledger_close(open_ledger("new/deep/ledger.db"));
    CHECK(sql_is("new/deep/ledger.db", "PRAGMA application_id", "1936614514"));
    CHECK(sql_is("new/deep/ledger.db", "PRAGMA user_version", "4"));
    CHECK(sql_is("new/deep/ledger.db", "PRAGMA journal_mode", "wal"));
    CHECK(sql_is("new/deep/ledger.db", "SELECT group_concat(name) FROM migrations", "001_initial,002_views,003_knob_turns,004_refusals"));
    ledger_close(open_ledger("new/deep/ledger.db"));
    CHECK(sql_is("new/deep/ledger.db", "SELECT count(*) FROM migrations", "4"));
    CHECK(!exists(in_scratch("new/deep/ledger.db-wal"))); /* the last to close has put everything in one file */
}

static status try_open(const char *name, report *r) {
    ledger *l;
    status s = ledger_open(in_scratch("%s", name), &l, r);
    if (!s) ledger_close(l);
    CHECK((l != NULL) == (s == STATUS_OK));
    return s;
}

static void what_is_no_ledger_is_refused(void) {
    report r;
    ledger *l;
    write_text(in_scratch("garbage.db"),
               "this is a text of some length, and no database at all .......................", 76);
    CHECK(try_open("garbage.db", &r) == STATUS_INPUT && strstr(r.found, "no SQLite database") &&
          strstr(r.file, "garbage.db"));
    CHECK(size_of(in_scratch("garbage.db")) == 76);
    sql_do("other.db", "CREATE TABLE t (x)");
    CHECK(try_open("other.db", &r) == STATUS_INPUT && strstr(r.found, "another program's"));
    CHECK(sql_is("other.db", "SELECT count(*) FROM sqlite_schema", "1") &&
          sql_is("other.db", "PRAGMA journal_mode", "delete"));
    ledger_close(open_ledger("future.db"));
    sql_do("future.db", "PRAGMA user_version = 99");
    CHECK(try_open("future.db", &r) == STATUS_INPUT && strstr(r.found, "schema 99") && strstr(r.expected, "schema 4"));
    CHECK(sql_is("future.db", "PRAGMA user_version", "99"));
    CHECK(try_open("", &r) == STATUS_INPUT && strstr(r.found, "folder"));
    CHECK(try_open("garbage.db/ledger.db", &r) != STATUS_OK);
    CHECK(ledger_open("", &l, &r) == STATUS_INPUT);
    write_text(in_scratch("empty.db"), "", 0);
    CHECK(try_open("empty.db", &r) == STATUS_OK); /* as `touch` makes it */
}

static int open_without_right(void *context) {
    (void)context;
    report r;
    if (getuid() == 0 && (setgroups(0, NULL) != 0 || setgid(65534) != 0 || setuid(65534) != 0)) return 77;
    if (try_open("locked/ledger.db", &r) != STATUS_SYSTEM || !strstr(r.file, "locked") ||
        !strstr(r.message, "Permission denied"))
        return 1;
    if (try_open("locked/below/ledger.db", &r) != STATUS_SYSTEM || !strstr(r.message, "Permission denied")) return 2;
    if (try_open("readable.db", &r) != STATUS_SYSTEM || !strstr(r.message, "Permission denied")) return 3;
    return 0;
}

static void what_cannot_be_written_is_told(void) {
    CHECK(mkdir(in_scratch("locked"), 0555) == 0);
    ledger_close(open_ledger("readable.db"));
    chmod(in_scratch("readable.db"), 0444);
    int code = in_child(open_without_right, NULL);
    CHECK(code == 0 || code == 77);
    if (code) printf("  code %d\n", code);
}

static void an_older_schema_is_brought_up(void) {
    size_t size;
    char *schema = read_text(SUNDER_SOURCE "/db/schema/001_initial.sql", &size);
    sql_do("old.db", schema);
    free(schema);
    sql_do(
        "old.db",
        "PRAGMA user_version = 1; INSERT INTO migrations VALUES (1, '001_initial', 'then'); "
        "INSERT INTO runs (id, status, started, scene_path, scene_title, scene_hash, command, output, precision, simd, "
        "version, effects, threads, particles, frames_wanted, seed, host, boot, pid_space, pid, pid_started) VALUES "
        "('20250101-000000-aaaa', 'done', 0, '', 'Old', '', '', '', '', '', '', '', 1, 1, 1, 1, 'h', '', '', 1, 1)");
    ledger_close(open_ledger("old.db"));
    CHECK(sql_is("old.db", "PRAGMA user_version", "4"));
    CHECK(sql_is("old.db", "SELECT title FROM runs_view", "Old"));
}

static void paths_follow_the_environment(void) {
    char path[512];
    report r;
    setenv("HOME", "/home/somebody", 1);
    unsetenv("XDG_DATA_HOME");
    unsetenv("SUNDER_DB");
    CHECK(ledger_default_path(path, sizeof path, &r) == STATUS_OK);
    CHECK(strcmp(path, "/home/somebody/.local/share/sunder/ledger.db") == 0);
    setenv("XDG_DATA_HOME", "/data", 1);
    CHECK(ledger_default_path(path, sizeof path, &r) == STATUS_OK && strcmp(path, "/data/sunder/ledger.db") == 0);
    CHECK(ledger_runs_folder(path, sizeof path, &r) == STATUS_OK && strcmp(path, "/data/sunder/runs") == 0);
    setenv("XDG_DATA_HOME", "relative", 1);
    CHECK(ledger_runs_folder(path, sizeof path, &r) == STATUS_OK &&
          strcmp(path, "/home/somebody/.local/share/sunder/runs") == 0);
    setenv("SUNDER_DB", "here.db", 1);
    CHECK(ledger_default_path(path, sizeof path, &r) == STATUS_OK && strcmp(path, "here.db") == 0);
    CHECK(ledger_default_path(path, 4, &r) == STATUS_INPUT);
    unsetenv("SUNDER_DB");
}

/* ---- writing ----------------------------------------------------------------------------------------------------- */

static void a_run_is_remembered(void) {
    char id[LEDGER_ID];
    report r;
    ledger *l = open_ledger("run.db");
    ledger_run run = sample_run("full");
    run.parent = "20250101-000000-aaaa";
    run.parent_frame = 12;
    CHECK(ledger_begin(l, &run, id, &r) == STATUS_OK);
    CHECK(strlen(id) == 20 && id[8] == '-' && id[15] == '-');
    CHECK(sql_is("run.db", "SELECT status || pid_started > 0 FROM runs", "1"));
    CHECK(ledger_parameter(l, id, "eta", "1", 0.45, NULL, true, &r) == STATUS_OK);
    CHECK(ledger_parameter(l, id, "eta", "1", 0.5, NULL, true, &r) == STATUS_OK); /* the last word counts */
    CHECK(ledger_parameter(l, id, "stop", "s", (double)INFINITY, NULL, false, &r) == STATUS_OK);
    CHECK(ledger_parameter(l, id, "kernel", NULL, 3, "cubic", false, &r) == STATUS_OK);
    const ledger_value values[] = {{"kinetic", 0.1}, {"damage_max", (double)NAN}, {"blow_up", (double)INFINITY}};
    CHECK(ledger_frame(l, id, 0, 0, 0, 0.25, values, 3, &r) == STATUS_OK);
    CHECK(ledger_event(l, id, 0, "first_crack", "particle 17", &r) == STATUS_OK);
    CHECK(ledger_set_output(l, id, "/data/elsewhere", &r) == STATUS_OK);
    CHECK(ledger_finish(l, id, "done", 1, 10, 2.5, "fine", "{\"ok\": 1}", &r) == STATUS_OK);
    ledger_close(l);
    CHECK(sql_is(
        "run.db",
        "SELECT status || '|' || variant || '|' || frames || '|' || steps || '|' || wall_seconds || '|' || message "
        "|| '|' || parent || '|' || parent_frame FROM runs",
        "done|full|1|10|2.5|fine|20250101-000000-aaaa|12"));
    CHECK(sql_is(
        "run.db",
        "SELECT group_concat(name || '=' || coalesce(text, number) || ' ' || unit || from_set) FROM run_parameters",
        "eta=0.5 11,kernel=cubic 0,stop=inf s0"));
    CHECK(sql_is("run.db", "SELECT number FROM run_parameters WHERE name = 'kernel'", ""));
    CHECK(sql_is(
        "run.db",
        "SELECT group_concat(name || '=' || coalesce(value, 'NULL')) FROM (SELECT * FROM final_measures ORDER BY name)",
        "blow_up=NULL,damage_max=NULL,kinetic=0.1"));
    CHECK(sql_is("run.db", "SELECT kind || text FROM events", "first_crackparticle 17"));
    CHECK(sql_is("run.db", "SELECT summary ->> 'ok' || output FROM runs_view", "1/data/elsewhere"));
}

static void unknown_runs_and_states_are_told(void) {
    char id[LEDGER_ID], wrong[LEDGER_ID];
    report r;
    ledger *l = open_ledger("unknown.db");
    write_run(l, "a", 1, 0, "running", id);
    snprintf(wrong, sizeof wrong, "%s", id);
    wrong[19] = wrong[19] == 'x' ? 'y' : 'x';
    CHECK(ledger_parameter(l, wrong, "eta", "1", 1, NULL, false, &r) == STATUS_INPUT && strcmp(r.nearest, id) == 0);
    CHECK(ledger_frame(l, wrong, 0, 0, 0, 0, NULL, 0, &r) == STATUS_INPUT);
    CHECK(ledger_event(l, wrong, 0, "x", NULL, &r) == STATUS_INPUT);
    CHECK(ledger_finish(l, wrong, "done", 0, 0, 0, NULL, NULL, &r) == STATUS_INPUT);
    CHECK(ledger_finish(l, id, "dome", 0, 0, 0, NULL, NULL, &r) == STATUS_INPUT && strcmp(r.nearest, "done") == 0);
    CHECK(ledger_event(l, id, 0, "ok", NULL, &r) == STATUS_OK); /* no transaction is left open behind an error */
    ledger_close(l);
}

static void frames_after_a_rewritten_one_go(void) {
    char id[LEDGER_ID];
    report r;
    ledger *l = open_ledger("rewrite.db");
    write_run(l, "a", 1, 5, "running", id);
    const ledger_value value = {"kinetic", 100};
    CHECK(ledger_frame(l, id, 3, 1, 30, 1, &value, 1, &r) == STATUS_OK);
    CHECK(sql_is("rewrite.db", "SELECT max(frame) FROM frames", "3"));
    CHECK(sql_is("rewrite.db", "SELECT group_concat(name || value) FROM final_measures", "kinetic100.0"));
    CHECK(sql_is("rewrite.db", "SELECT count(*) FROM run_measures", "10"));
    ledger_close(l);
}

static void a_batch_is_all_or_nothing(void) {
    char id[LEDGER_ID];
    report r;
    ledger_run run = sample_run(NULL);
    ledger *l = open_ledger("batch.db");
    CHECK(ledger_batch_begin(l, &r) == STATUS_OK);
    CHECK(ledger_begin(l, &run, id, &r) == STATUS_OK &&
          ledger_parameter(l, id, "eta", "", 1, NULL, false, &r) == STATUS_OK);
    CHECK(sql_is("batch.db", "SELECT count(*) FROM runs", "0"));
    CHECK(ledger_batch_end(l, STATUS_DIVERGED, &r) == STATUS_DIVERGED);
    CHECK(sql_is("batch.db", "SELECT count(*) FROM runs", "0"));
    CHECK(ledger_batch_begin(l, &r) == STATUS_OK && ledger_batch_begin(l, &r) == STATUS_OK);
    CHECK(ledger_begin(l, &run, id, &r) == STATUS_OK &&
          ledger_parameter(l, id, "eta", "", 1, NULL, false, &r) == STATUS_OK);
    CHECK(ledger_batch_end(l, STATUS_OK, &r) == STATUS_OK && sql_is("batch.db", "SELECT count(*) FROM runs", "0"));
    CHECK(ledger_batch_end(l, STATUS_OK, &r) == STATUS_OK &&
          sql_is("batch.db", "SELECT count(*) FROM run_parameters", "1"));
    ledger_close(l);
}

static void tags_notes_and_removal(void) {
    char id[LEDGER_ID], other[LEDGER_ID];
    report r;
    ledger *l = open_ledger("tags.db");
    write_run(l, "a", 1, 2, "done", id);
    write_run(l, "b", 2, 2, "done", other);
    CHECK(ledger_tag(l, id, "figure 2", true, &r) == STATUS_OK && ledger_tag(l, id, "figure 2", true, &r) == STATUS_OK);
    CHECK(ledger_tag(l, id, "good", true, &r) == STATUS_OK);
    CHECK(sql_is("tags.db", "SELECT tags FROM runs_view WHERE variant = 'a'", "figure 2,good"));
    CHECK(ledger_tag(l, id, "god", false, &r) == STATUS_INPUT && strcmp(r.nearest, "good") == 0);
    CHECK(ledger_tag(l, id, "good", false, &r) == STATUS_OK);
    CHECK(ledger_tag(l, id, "a,b", true, &r) == STATUS_INPUT && ledger_tag(l, id, "", true, &r) == STATUS_INPUT);
    CHECK(ledger_note(l, id, "tears too late", &r) == STATUS_OK);
    CHECK(sql_is("tags.db", "SELECT notes FROM runs_view WHERE variant = 'a'", "tears too late"));
    CHECK(ledger_event(l, id, 1, "warning", "x", &r) == STATUS_OK);
    CHECK(ledger_remove(l, id, &r) == STATUS_OK && ledger_remove(l, id, &r) == STATUS_INPUT);
    CHECK(sql_is("tags.db",
                 "SELECT (SELECT count(*) FROM runs) || (SELECT count(*) FROM tags) || (SELECT count(*) FROM notes) || "
                 "(SELECT count(*) FROM events) || (SELECT count(DISTINCT run) FROM run_measures) || "
                 "(SELECT count(DISTINCT run) FROM run_parameters)",
                 "100011"));
    ledger_close(l);
}

/* ---- finding ----------------------------------------------------------------------------------------------------- */

static void names_are_resolved(void) {
    char ids[3][LEDGER_ID], id[LEDGER_ID], output[64];
    report r;
    ledger *l = open_ledger("resolve.db");
    CHECK(ledger_resolve(l, "last", id, output, sizeof output, &r) == STATUS_INPUT);
    for (int i = 0; i < 3; i++) write_run(l, "a", i, 0, "done", ids[i]);
    sql_do("resolve.db", "UPDATE runs SET id = '20260101-000000-ab12' WHERE run = 1");
    sql_do("resolve.db", "UPDATE runs SET id = '20260102-000000-cd12' WHERE run = 2");
    sql_do("resolve.db", "UPDATE runs SET id = '20260102-000001-0021', output = '/there' WHERE run = 3");
    CHECK(ledger_resolve(l, "20260102-000000-cd12", id, NULL, 0, &r) == STATUS_OK &&
          strcmp(id, "20260102-000000-cd12") == 0);
    CHECK(ledger_resolve(l, "last", id, output, sizeof output, &r) == STATUS_OK);
    CHECK(strcmp(id, "20260102-000001-0021") == 0 && strcmp(output, "/there") == 0);
    CHECK(ledger_resolve(l, "20260101", id, output, sizeof output, &r) == STATUS_OK &&
          strcmp(id, "20260101-000000-ab12") == 0);
    CHECK(ledger_resolve(l, "cd12", id, output, sizeof output, &r) == STATUS_OK &&
          strcmp(id, "20260102-000000-cd12") == 0);
    CHECK(ledger_resolve(l, "20260102", id, output, sizeof output, &r) == STATUS_INPUT);
    CHECK(strstr(r.found, "fits 2 runs") && strcmp(r.nearest, "20260102-000001-0021") == 0);
    CHECK(ledger_resolve(l, "12", id, output, sizeof output, &r) == STATUS_INPUT && strstr(r.found, "fits 2 runs"));
    CHECK(ledger_resolve(l, "20260101-000000-ab13", id, output, sizeof output, &r) == STATUS_INPUT);
    CHECK(strcmp(r.nearest, "20260101-000000-ab12") == 0);
    CHECK(ledger_resolve(l, "", id, output, sizeof output, &r) == STATUS_INPUT);
    CHECK(ledger_resolve(l, "%", id, output, sizeof output, &r) == STATUS_INPUT);
    CHECK(ledger_resolve(l, "last", id, output, 3, &r) == STATUS_INPUT);
    ledger_close(l);
}

/* ---- dead runs --------------------------------------------------------------------------------------------------- */

/* Begins a run and leaves without a word; the exit code says whether that much went well. */
static int begin_and_vanish(void *context) {
    char id[LEDGER_ID];
    ledger *l = open_ledger(context);
    write_run(l, "vanished", 1, 2, "running", id);
    return 0; /* in_child leaves by _exit: the ledger is not closed */
}

/* Any writer's next ledger_begin. */
static void bury(const char *name) {
    char id[LEDGER_ID];
    ledger *l = open_ledger(name);
    write_run(l, "writer", 1, 0, "done", id);
    ledger_close(l);
}

static void a_vanished_process_leaves_no_running_run(void) {
    char name[] = "dead.db", id[LEDGER_ID];
    report r;
    CHECK(in_child(begin_and_vanish, name) == 0);
    CHECK(sql_is(name, "SELECT status FROM runs", "running"));
    bury(name);
    CHECK(sql_is(name, "SELECT status FROM runs WHERE variant = 'vanished'", "dead"));
    CHECK(sql_is(name,
                 "SELECT frames || (message LIKE 'its process (% on %) ended without a word') FROM runs_view "
                 "WHERE variant = 'vanished'",
                 "21"));
    ledger *l = open_ledger(name);
    snprintf(id, sizeof id, "%s", sql_text(name, "SELECT id FROM runs WHERE variant = 'vanished'"));
    CHECK(ledger_reopen(l, id, &r) == STATUS_OK); /* it may be resumed */
    CHECK(sql_is(
        name,
        "SELECT status || (pid = (SELECT pid FROM runs WHERE variant = 'writer')) FROM runs WHERE variant = 'vanished'",
        "running1"));
    CHECK(ledger_finish(l, id, "done", 4, 40, 1, NULL, NULL, &r) == STATUS_OK);
    ledger_close(l);
    CHECK(sql_is(name, "SELECT status || frames FROM runs WHERE variant = 'vanished'", "done4"));
}

/* Rows as a live process of this machine would have written them, but for what `change` says. */
static bool looks_dead(const char *change) {
    char id[LEDGER_ID], sql[512];
    const char *name = "alive.db";
    ledger *l = open_ledger(name);
    write_run(l, "subject", 1, 0, "running", id);
    ledger_close(l);
    snprintf(sql, sizeof sql, "UPDATE runs SET %s WHERE id = '%s'", change, id);
    sql_do(name, sql);
    bury(name);
    snprintf(sql, sizeof sql, "SELECT status FROM runs WHERE id = '%s'", id);
    return strcmp(sql_text(name, sql), "dead") == 0;
}

static void only_the_certainly_gone_are_dead(void) {
    CHECK(!looks_dead("message = NULL"));
    CHECK(looks_dead("pid = 999999999"));
    CHECK(looks_dead("pid_started = pid_started - 1"));           /* the pid was used again */
    CHECK(looks_dead("boot = 'another boot'"));                   /* the machine was started anew */
    CHECK(!looks_dead("boot = '', pid_started = 0"));             /* unknown: it may live */
    CHECK(!looks_dead("host = 'elsewhere', pid = 999999999"));    /* cannot be seen from here */
    CHECK(!looks_dead("pid_space = 'pid:[1]', pid = 999999999")); /* nor from this container */
    CHECK(looks_dead("host = (SELECT host FROM runs LIMIT 1), pid = 999999999"));
}

static void a_zombie_is_dead(void) {
    char name[] = "zombie.db";
    fflush(stdout);
    pid_t pid = fork();
    if (pid == 0) _exit(begin_and_vanish(name));
    siginfo_t info;
    CHECK(waitid(P_PID, (id_t)pid, &info, WEXITED | WNOWAIT) == 0); /* it stays a zombie */
    bury(name);
    CHECK(sql_is(name, "SELECT status FROM runs WHERE variant = 'vanished'", "dead"));
    waitpid(pid, NULL, 0);
}

static void who_writes_is_alive(void) {
    char id[LEDGER_ID];
    report r;
    ledger *l = open_ledger("revived.db");
    write_run(l, "a", 1, 0, "running", id);
    sql_do("revived.db", "UPDATE runs SET status = 'dead', message = 'wrong'");
    CHECK(ledger_frame(l, id, 1, 1, 1, 1, NULL, 0, &r) == STATUS_OK);
    CHECK(sql_is("revived.db", "SELECT status || coalesce(message, '-') FROM runs", "running-"));
    ledger_close(l);
}

typedef struct holder {
    int ready[2], leave[2];
} holder;

static void hold_a_run(const holder *pipes) {
    char id[LEDGER_ID], byte = 0;
    ledger *l = open_ledger("held.db");
    write_run(l, "held", 1, 1, "running", id);
    if (write(pipes->ready[1], &byte, 1) != 1 || read(pipes->leave[0], &byte, 1) != 1) _exit(1);
    _exit(0);
}

static void a_run_in_other_hands_is_left_alone(void) {
    holder pipes;
    char byte = 0, id[LEDGER_ID];
    report r;
    if (pipe(pipes.ready) != 0 || pipe(pipes.leave) != 0) abort();
    fflush(stdout);
    pid_t pid = fork();
    if (pid == 0) hold_a_run(&pipes);
    CHECK(read(pipes.ready[0], &byte, 1) == 1);
    bury("held.db");
    snprintf(id, sizeof id, "%s",
             sql_text("held.db", "SELECT id FROM runs WHERE variant = 'held' AND status = 'running'"));
    CHECK(id[0] != '\0');
    ledger *l = open_ledger("held.db");
    CHECK(ledger_reopen(l, id, &r) == STATUS_INPUT && strstr(r.found, "still writing"));
    CHECK(ledger_remove(l, id, &r) == STATUS_INPUT);
    CHECK(write(pipes.leave[1], &byte, 1) == 1);
    waitpid(pid, NULL, 0);
    CHECK(ledger_reopen(l, id, &r) == STATUS_OK);
    ledger_close(l);
    for (int i = 0; i < 2; i++) close(pipes.ready[i]), close(pipes.leave[i]);
}

/* ---- many writers ------------------------------------------------------------------------------------------------ */

enum { WRITERS = 4, TRANSACTIONS = 200, OPENERS = 8 };

static int write_many(void *context) {
    char id[LEDGER_ID];
    report r;
    ledger *l;
    ledger_run run = sample_run("many");
    if (ledger_open(context, &l, &r) || ledger_begin(l, &run, id, &r)) return 1;
    for (int frame = 0; frame < TRANSACTIONS; frame++) {
        const ledger_value values[] = {{"kinetic", frame}, {"elastic", 2.0 * frame}};
        if (ledger_frame(l, id, frame, frame, frame, frame, values, 2, &r)) {
            printf("  %s\n", r.message);
            return 2;
        }
    }
    if (ledger_finish(l, id, "done", TRANSACTIONS - 1, 0, 0, NULL, NULL, &r)) return 3;
    ledger_close(l);
    return 0;
}

/* Runs `count` children at once; returns how many did not exit with 0. */
static int at_once(int count, int (*task)(void *context), void *context) {
    pid_t pids[16];
    int failed = 0;
    fflush(stdout);
    for (int i = 0; i < count; i++) {
        pids[i] = fork();
        if (pids[i] == 0) {
            int code = task(context);
            fflush(stdout);
            _exit(code);
        }
    }
    for (int i = 0; i < count; i++) {
        int state;
        if (waitpid(pids[i], &state, 0) != pids[i] || !WIFEXITED(state) || WEXITSTATUS(state) != 0) failed++;
    }
    return failed;
}

static void four_writers_all_succeed(void) {
    char path[SCRATCH_PATH];
    snprintf(path, sizeof path, "%s/many.db", scratch); /* it does not exist yet: they race for its schema too */
    double start = clock_seconds();
    CHECK(at_once(WRITERS, write_many, path) == 0);
    printf("  %d writers × %d transactions: %.2f s\n", (int)WRITERS, (int)TRANSACTIONS, clock_seconds() - start);
    CHECK(sql_is("many.db", "SELECT count(*) || ' ' || count(DISTINCT run) FROM frames", "800 4"));
    CHECK(sql_is("many.db", "SELECT count(*) FROM run_measures", "1600"));
    CHECK(sql_is("many.db", "SELECT count(*) FROM runs WHERE status = 'done'", "4"));
    CHECK(sql_is("many.db", "PRAGMA integrity_check", "ok"));
}

static int open_and_close(void *context) {
    report r;
    ledger *l;
    for (int i = 0; i < 20; i++) {
        if (ledger_open(context, &l, &r)) {
            printf("  %s %s\n", r.message, r.found);
            return 1;
        }
        ledger_close(l); /* often the last: it checkpoints while others open */
    }
    return 0;
}

static void many_may_open_a_new_ledger_together(void) {
    char path[SCRATCH_PATH];
    for (int round = 0; round < 5; round++) {
        snprintf(path, sizeof path, "%s/race%d.db", scratch, round);
        CHECK(at_once(OPENERS, open_and_close, path) == 0);
    }
    CHECK(sql_is("race0.db", "SELECT count(*) FROM migrations", "4"));
}

/* ---- faults ------------------------------------------------------------------------------------------------------ */

static void kill_leaves_a_sound_ledger(void) {
    char path[SCRATCH_PATH];
    snprintf(path, sizeof path, "%s/killed.db", scratch);
    ledger_close(open_ledger("killed.db"));
    for (int round = 0; round < 10; round++) {
        fflush(stdout);
        pid_t pid = fork();
        if (pid == 0)
            for (;;) write_many(path);
        usleep(4000u + 7000u * (unsigned)round);
        kill(pid, SIGKILL);
        waitpid(pid, NULL, 0);
        CHECK(sql_is("killed.db", "PRAGMA integrity_check", "ok"));
        /* Transactions are whole: every frame has both of its measures. */
        CHECK(sql_is("killed.db",
                     "SELECT count(*) FROM frames WHERE 2 <> (SELECT count(*) FROM run_measures AS m "
                     "WHERE m.run = frames.run AND m.frame = frames.frame)",
                     "0"));
    }
    bury("killed.db");
    CHECK(sql_is("killed.db", "SELECT count(*) FROM runs WHERE status = 'running'", "0"));
}

/* Room for some frames only; exit code 0 when the trouble is told and what was written before is there. */
static int write_past_limit(void *context) {
    char id[LEDGER_ID];
    report r;
    ledger *l = open_ledger(context);
    write_run(l, "full", 1, 3, "running", id);
    const struct rlimit limit = {256 * 1024, 256 * 1024};
    signal(SIGXFSZ, SIG_IGN);
    setrlimit(RLIMIT_FSIZE, &limit);
    status s = STATUS_OK;
    int frame = 4;
    for (; !s && frame < 10000; frame++) {
        const ledger_value value = {"kinetic", frame};
        s = ledger_frame(l, id, frame, frame, frame, frame, &value, 1, &r);
    }
    if (s != STATUS_SYSTEM || !strstr(r.file, context) || !strstr(r.message, "cannot")) return 1;
    char expected[16];
    snprintf(expected, sizeof expected, "%d", frame - 1);
    return sql_is(context, "SELECT count(*) FROM frames", expected) ? 0 : 2;
}

static void a_full_disk_is_told(void) {
    char name[] = "full.db";
    int code = in_child(write_past_limit, name);
    CHECK(code == 0);
    if (code) printf("  code %d\n", code);
    CHECK(sql_is(name, "PRAGMA integrity_check", "ok"));
}

static void memory_may_run_out(void) {
    report r;
    ledger *l = NULL;
    size_t before = memory_live_bytes();
    memory_fail_after(1, 0);
    CHECK(ledger_open(in_scratch("memory.db"), &l, &r) == STATUS_SYSTEM && l == NULL);
    memory_fail_after(0, 0);
    CHECK(memory_live_bytes() == before);
}

int main(void) {
    scratch_make();
    RUN(a_new_ledger_is_made_with_its_folders);
    RUN(what_is_no_ledger_is_refused);
    RUN(what_cannot_be_written_is_told);
    RUN(an_older_schema_is_brought_up);
    RUN(paths_follow_the_environment);
    RUN(a_run_is_remembered);
    RUN(unknown_runs_and_states_are_told);
    RUN(frames_after_a_rewritten_one_go);
    RUN(a_batch_is_all_or_nothing);
    RUN(tags_notes_and_removal);
    RUN(names_are_resolved);
    RUN(a_vanished_process_leaves_no_running_run);
    RUN(only_the_certainly_gone_are_dead);
    RUN(a_zombie_is_dead);
    RUN(who_writes_is_alive);
    RUN(a_run_in_other_hands_is_left_alone);
    RUN(four_writers_all_succeed);
    RUN(many_may_open_a_new_ledger_together);
    RUN(kill_leaves_a_sound_ledger);
    RUN(a_full_disk_is_told);
    RUN(memory_may_run_out);
    CHECK(memory_live_bytes() == 0);
    return check_finish();
}
