/* sunder runs tag, note, rm: what people write about runs, and taking runs away. */
#include "cli/runs.h"

#include "base/json.h"
#include "store/run_folder.h"

#include <inttypes.h>
#include <string.h>
#include <unistd.h>

enum { RUNS = 256 };

/* ---- tags and notes ---------------------------------------------------------------------------------------------- */

static status take_text(void *context, const ledger_cell *cells, int count, report *r) {
    (void)count, (void)r;
    snprintf(context, 1024, "%s", cells[0].text ? cells[0].text : "");
    return STATUS_OK;
}

/* A text of the run's row; "" when there is none. */
static status ask_text(ledger *l, const char *sql, const char *id, char text[1024], report *r) {
    char argument[LEDGER_ID + 4];
    const char *const arguments[] = {argument};
    snprintf(argument, sizeof argument, "id=%s", id);
    text[0] = '\0';
    return ledger_each_row(l, sql, arguments, 1, take_text, text, r);
}

static status tell(const runs_options *o, const char *id, const char *key, const char *text, report *r) {
    if (!o->json) {
        printf("%s  %s\n", id, text[0] ? text : "-");
        return STATUS_OK;
    }
    json_writer w;
    json_begin(&w, 0);
    json_object(&w);
    json_member_string(&w, "run_id", id);
    json_member_array(&w, key);
    for (const char *at = text; *at;) {
        char item[128];
        size_t length = strcspn(at, ",");
        snprintf(item, sizeof item, "%.*s", (int)length, at);
        json_string(&w, item);
        at += length + (at[length] == ',');
    }
    json_array_end(&w);
    json_object_end(&w);
    return cli_print_json(&w, r);
}

/* runs tag RUN [TAG]…: adds them (--remove: takes them away) and says which it has. */
status verb_tag(ledger *l, const runs_options *o, int count, char **names, int *exit, report *r) {
    char id[LEDGER_ID], text[1024];
    (void)exit;
    if (count == 0) return report_input(r, NULL, 0, "runs tag", "a run, and tags", "none", NULL);
    status code = runs_find(l, names[0], id, NULL, r);
    if (code == STATUS_OK) code = ledger_batch_begin(l, r);
    if (code != STATUS_OK) return code;
    for (int i = 1; i < count && code == STATUS_OK; i++) code = ledger_tag(l, id, names[i], !o->remove, r);
    code = ledger_batch_end(l, code, r);
    if (code == STATUS_OK) code = ask_text(l, "SELECT tags FROM runs_view WHERE id = :id", id, text, r);
    return code == STATUS_OK ? tell(o, id, "tags", text, r) : code;
}

/* runs note RUN TEXT…: the words make one remark. */
status verb_note(ledger *l, const runs_options *o, int count, char **names, int *exit, report *r) {
    char id[LEDGER_ID], text[4096] = "";
    size_t used = 0;
    (void)exit;
    if (count < 2) return report_input(r, NULL, 0, "runs note", "a run and a text", count ? "no text" : "neither", NULL);
    for (int i = 1; i < count && used < sizeof text; i++) used += (size_t)snprintf(text + used, sizeof text - used, "%s%s", i > 1 ? " " : "", names[i]);
    if (used >= sizeof text) return report_input(r, NULL, 0, "runs note", "a text of under 4096 bytes", "a longer one", NULL);
    status code = runs_find(l, names[0], id, NULL, r);
    if (code == STATUS_OK) code = ledger_note(l, id, text, r);
    if (code != STATUS_OK || !o->json) return code;
    json_writer w;
    json_begin(&w, 0);
    json_object(&w);
    json_member_string(&w, "run_id", id);
    json_member_string(&w, "note", text);
    json_object_end(&w);
    return cli_print_json(&w, r);
}

/* ---- taking runs away -------------------------------------------------------------------------------------------- */

typedef struct doomed {
    char id[LEDGER_ID], folder[1024], parent[1024];
    run_folder_removal files;
} doomed;

static void print_size(FILE *out, int64_t bytes) {
    if (bytes < 1000000) fprintf(out, "%.1f kB", 1e-3 * (double)bytes);
    else if (bytes < 1000000000) fprintf(out, "%.1f MB", 1e-6 * (double)bytes);
    else fprintf(out, "%.2f GB", 1e-9 * (double)bytes);
}

/* Names the runs, and makes sure that each folder may go, before anything does. */
static status look_up(ledger *l, const runs_options *o, doomed *run, const char *name, report *r) {
    status code = runs_find(l, name, run->id, run->folder, r);
    if (code == STATUS_OK) code = ask_text(l, "SELECT parent FROM runs_view WHERE id = :id", run->id, run->parent, r);
    if (code == STATUS_OK && !o->keep_files)
        code = run_folder_remove(run->folder, run->id, run->parent[0] ? run->parent : NULL, true, &run->files, r);
    if (code != STATUS_INPUT || !run->folder[0]) return code;
    snprintf(r->message, sizeof r->message, "its files are left alone; runs rm --keep-files takes the row alone away");
    return code;
}

static status ask_first(const runs_options *o, const doomed *runs, int count, bool *yes, report *r) {
    char answer[16] = "";
    *yes = o->yes;
    if (o->yes) return STATUS_OK;
    if (!isatty(STDIN_FILENO)) return report_input(r, NULL, 0, "runs rm", "--yes, when nobody can be asked", "none", NULL);
    for (int i = 0; i < count; i++) {
        fprintf(stderr, "%s  %s  %" PRId64 " files, ", runs[i].id, runs[i].files.absent ? "(no folder)" : runs[i].folder, runs[i].files.files);
        print_size(stderr, runs[i].files.bytes);
        fputc('\n', stderr);
    }
    fprintf(stderr, "Take %s away, for good? [y/N] ", count == 1 ? "this run" : "these runs");
    fflush(stderr);
    *yes = fgets(answer, sizeof answer, stdin) && (answer[0] == 'y' || answer[0] == 'Y');
    return STATUS_OK;
}

/* The row goes first: a row without files is told from one whose files are half gone. */
static status take_away(ledger *l, const runs_options *o, doomed *run, report *r) {
    status code = ledger_remove(l, run->id, r);
    if (code == STATUS_OK && !o->keep_files)
        code = run_folder_remove(run->folder, run->id, run->parent[0] ? run->parent : NULL, false, &run->files, r);
    if (code != STATUS_OK || o->json) return code;
    printf("%s: removed", run->id);
    if (!o->keep_files) {
        printf(", %" PRId64 " files, ", run->files.files);
        print_size(stdout, run->files.bytes);
    }
    if (run->files.kept) printf("; %d files that are no run's stay in %s (%s)", run->files.kept, run->folder, run->files.first_kept);
    putchar('\n');
    return STATUS_OK;
}

static status print_removed(const doomed *runs, int count, report *r) {
    json_writer w;
    json_begin(&w, 0);
    json_object(&w);
    json_member_array(&w, "removed");
    for (int i = 0; i < count; i++) {
        json_object(&w);
        json_member_string(&w, "run_id", runs[i].id);
        json_member_string(&w, "folder", runs[i].folder);
        json_member_integer(&w, "files", runs[i].files.files);
        json_member_integer(&w, "bytes", runs[i].files.bytes);
        json_member_integer(&w, "kept", runs[i].files.kept);
        json_object_end(&w);
    }
    json_array_end(&w);
    json_object_end(&w);
    return cli_print_json(&w, r);
}

/* runs rm RUN… [--yes] [--keep-files] */
status verb_rm(ledger *l, const runs_options *o, int count, char **names, int *exit, report *r) {
    static doomed runs[RUNS];
    bool yes;
    if (count == 0 || count > RUNS) return report_input(r, NULL, 0, "runs rm", "from 1 to 256 runs", count ? "more" : "none", NULL);
    status code = STATUS_OK;
    for (int i = 0; i < count && code == STATUS_OK; i++) code = look_up(l, o, &runs[i], names[i], r);
    if (code == STATUS_OK) code = ask_first(o, runs, count, &yes, r);
    if (code != STATUS_OK) return code;
    if (!yes) {
        fprintf(stderr, "nothing was removed\n");
        *exit = 130;
        return STATUS_OK;
    }
    for (int i = 0; i < count && code == STATUS_OK; i++) code = take_away(l, o, &runs[i], r);
    return code == STATUS_OK && o->json ? print_removed(runs, count, r) : code;
}
