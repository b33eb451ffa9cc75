/* A session as screens use it: knobs turned by hand while the run goes on, pausing at frames, colours, recipes, events, where time goes. */
#include "check.h"
#include "session/session.h"

#include "base/memory.h"
#include "store/frames.h"

#include <ftw.h>
#include <sys/stat.h>
#include <unistd.h>

static char folder[64], database[96];

static int remove_one(const char *path, const struct stat *info, int kind, struct FTW *place) {
    (void)info, (void)kind, (void)place;
    return remove(path);
}

static session_options small_run(void) {
    static const script_setting settings[] = {{"particles", "1200"}, {"break_stretch", "0.02"}, {"pull", "0.6"}};
    session_options o = session_options_default();
    o.script.settings = settings;
    o.script.setting_count = 3;
    o.scene_path = SUNDER_SOURCE "/scenes/solid/tube_pull.lua";
    o.database = database;
    o.command = "test";
    o.threads = 1;
    o.frames = 8;
    return o;
}

static session *begin(const session_options *o) {
    static script_reports reports;
    session *s = NULL;
    if (session_start(o, &s, &reports) == STATUS_OK) return s;
    char text[512];
    report_format(&reports.items[0], text, sizeof text);
    printf("  %s\n", text);
    return NULL;
}

static char *hash_of(session *s) {
    static char text[8][24];
    static int next;
    char *out = text[next = (next + 1) % 8];
    const char *found = session_summary(s) ? strstr(session_summary(s), "\"state_hash\": \"") : NULL;
    snprintf(out, sizeof text[0], "%.16s", found ? found + 15 : "none");
    return out;
}

static bool wait_for(session *s, session_snapshot *p, int64_t frame, session_state state) {
    for (int tries = 0; tries < 20000; tries++) {
        session_poll(s, p);
        if (p->state == state && p->frame >= frame) return true;
        if (p->state == SESSION_ENDED) return false;
        usleep(2000);
    }
    return false;
}

static void turns_by_hand_are_turns_known_beforehand(void) {
    report r;
    session_snapshot p = {0};
    session_options o = small_run();
    o.start_paused = true;
    session *s = begin(&o);
    CHECK(s != NULL);
    if (!s) return;
    double eta[3] = {0.01}, third[3] = {1.0 / 3};
    session_run_to(s, 3);
    CHECK(wait_for(s, &p, 3, SESSION_PAUSED) && p.frame == 3);
    int version = p.knob_version;
    CHECK(session_turn(s, "eta", eta, &r) == STATUS_OK && session_turn_text(s, "break_stretch", "0.01", &r) == STATUS_OK);
    CHECK(session_turn(s, "etta", eta, &r) == STATUS_INPUT && strcmp(r.nearest, "eta") == 0);
    eta[0] = -1;
    CHECK(session_turn(s, "eta", eta, &r) == STATUS_INPUT);
    CHECK(session_poll(s, &p) && p.knob_version > version); /* seen though nothing has been computed since */
    knob *list = memory_allocate_array(KNOB_LIMIT, sizeof *list);
    int found = knob_find(list, session_knobs(s, list, KNOB_LIMIT), "eta", &r);
    CHECK(found >= 0 && list[found].value[0] == 0.01 && list[found].start[0] == 0.45);
    session_run_to(s, 5);
    CHECK(wait_for(s, &p, 5, SESSION_PAUSED) && p.frame == 5 && p.turn_count == 2);
    CHECK(session_turn(s, "fibres.gamma", third, &r) == STATUS_OK);
    session_pause(s, false);
    CHECK(session_wait(s, -1));
    knob_turn turns[8];
    CHECK(session_turns(s, turns, 8) == 3 && turns[0].frame == 3 && turns[1].frame == 3 && turns[2].frame == 5);
    CHECK(strcmp(turns[0].path, "tube.damage.eta") == 0 && strcmp(turns[2].value, "0.3333333333333333") == 0);
    CHECK(session_turn(s, "eta", third, &r) == STATUS_INPUT && strstr(r.expected, "goes on"));
    session_poll(s, &p);
    int told = 0;
    for (int i = 0; i < p.event_count; i++) told += strcmp(p.events[i].kind, "knob") == 0;
    CHECK(told == 3);

    session_options again = small_run();
    again.turns = turns;
    again.turn_count = 3;
    again.threads = 2;
    session *t = begin(&again);
    CHECK(t && session_wait(t, -1));
    session_options none = small_run();
    session *u = begin(&none);
    CHECK(u && session_wait(u, -1));
    CHECK(t && u && strcmp(hash_of(s), hash_of(t)) == 0 && strcmp(hash_of(s), hash_of(u)) != 0);
    memory_free(list, KNOB_LIMIT * sizeof *list);
    session_snapshot_free(&p);
    session_destroy(s);
    session_destroy(t);
    session_destroy(u);
}

static void colours_are_chosen_while_a_run_is_paused_and_after_it(void) {
    report r;
    session_snapshot p = {0};
    session_options o = small_run();
    o.start_paused = true;
    session *s = begin(&o);
    if (!s) return;
    char names[SESSION_COLOURS][32];
    int count = session_colours(s, names, SESSION_COLOURS);
    session_run_to(s, 6);
    CHECK(wait_for(s, &p, 6, SESSION_PAUSED) && strcmp(p.colour, "damage") == 0 && p.colour_minimum == 0 && p.colour_maximum == 1);
    static const char *const wanted[] = {"damage", "stress", "stretch", "fibre_stretch", "determinant", "speed", "displacement", "body"};
    for (size_t w = 0; w < sizeof wanted / sizeof *wanted; w++) {
        bool listed = false;
        for (int i = 0; i < count; i++) listed = listed || strcmp(names[i], wanted[w]) == 0;
        CHECK(listed);
        CHECK(session_colour(s, wanted[w], &r) == STATUS_OK);
        for (int tries = 0; tries < 20000 && strcmp(p.colour, wanted[w]) != 0; tries++) usleep(2000), session_poll(s, &p);
        CHECK(strcmp(p.colour, wanted[w]) == 0 && p.history_count == 7);
        double low = HUGE_VAL, high = -HUGE_VAL;
        for (int64_t i = 0; i < p.point_count; i++) low = fmin(low, (double)p.scalar[i]), high = fmax(high, (double)p.scalar[i]);
        CHECK(low == (double)p.scalar_minimum && high == (double)p.scalar_maximum && p.colour_minimum <= p.scalar_minimum && p.colour_maximum >= p.scalar_maximum);
        if (strcmp(wanted[w], "stretch") == 0) CHECK(high > 1.02 && high < 3 && low > 0.5);
        if (strcmp(wanted[w], "stress") == 0) CHECK(high > 0);
        if (strcmp(wanted[w], "body") != 0) CHECK(high > low);
    }
    CHECK(session_colour(s, "sped", &r) == STATUS_INPUT && strcmp(r.nearest, "speed") == 0);
    session_pause(s, false);
    session_wait(s, -1);
    CHECK(session_colour(s, "stretch", &r) == STATUS_OK && session_poll(s, &p) && strcmp(p.colour, "stretch") == 0);
    session_snapshot_free(&p);
    session_destroy(s);
}

static void steps_tell_where_their_time_goes(void) {
    session_snapshot p = {0};
    session_options o = small_run();
    session *s = begin(&o);
    if (!s) return;
    session_wait(s, -1);
    session_poll(s, &p);
    double shares = 0, phase = 0, parts = 0;
    bool seen[3] = {false};
    static const char *const names[] = {"damage", "elastic", "fibres"};
    for (int i = 0; i < p.stage_count; i++) {
        const session_stage *t = &p.stages[i];
        CHECK(t->seconds >= 0 && t->share >= 0 && t->share <= 1);
        shares += t->part ? 0 : t->share;
        if (!t->part) phase = t->seconds, parts = 0;
        else parts += t->seconds;
        CHECK(parts <= phase * 1.0001);
        for (int k = 0; k < 3; k++) seen[k] = seen[k] || (t->part && strcmp(t->name, names[k]) == 0);
    }
    CHECK_NEAR(shares, 1, 1e-9);
    CHECK(seen[0] && seen[1] && seen[2]);
    session_snapshot_free(&p);
    session_destroy(s);
}

/* The same values, parameter by parameter. */
static void compare_materials(const scene_material *a, const scene_material *b) {
    int count;
    const effect *const *effects = effect_catalogue(&count);
    CHECK(a->density == b->density);
    for (int e = 0; e < count; e++) {
        CHECK(a->effects[e].on == b->effects[e].on);
        for (int k = 0; k < effects[e]->parameter_count && a->effects[e].on; k++) {
            bool same = memcmp(a->effects[e].value[k], b->effects[e].value[k], sizeof a->effects[e].value[k]) == 0;
            if (!same) printf("  %s.%s: %.17g, %.17g\n", effects[e]->name, effects[e]->parameters[k].key, a->effects[e].value[k][0], b->effects[e].value[k][0]);
            CHECK(same);
        }
    }
}

static void check_recipe(const char *scene_path, const char *variant, const knob_turn *turns, int turn_count) {
    const script_setting settings[] = {{"particles", "1200"}, {"variant", variant}};
    char path[128];
    report r;
    session_options o = small_run();
    static script_reports reports;
    o.scene_path = scene_path;
    o.script.settings = settings;
    o.script.setting_count = variant ? 2 : 1;
    o.frames = 2;
    o.turns = turns;
    o.turn_count = turn_count;
    session *s = begin(&o);
    CHECK(s && session_wait(s, -1));
    snprintf(path, sizeof path, "%s/saved.lua", folder);
    CHECK(s && session_save_recipe(s, 0, path, NULL, &r) == STATUS_OK);
    CHECK(s && session_save_recipe(s, 7, path, NULL, &r) == STATUS_INPUT && session_save_recipe(s, 0, "/nowhere/at/all.lua", NULL, &r) == STATUS_SYSTEM);

    script *plain = NULL, *loaded = NULL;
    script_options options = script_options_default();
    options.settings = o.script.settings;
    options.setting_count = o.script.setting_count;
    CHECK(script_load(scene_path, &options, &plain, &reports) == STATUS_OK);
    options.recipe = "saved"; /* in $SUNDER_RECIPES */
    status code = script_load(scene_path, &options, &loaded, &reports);
    if (code != STATUS_OK) printf("  %s: %s %s %s\n", path, reports.items[0].key, reports.items[0].expected, reports.items[0].found);
    CHECK(code == STATUS_OK);
    if (plain && loaded) {
        for (int i = 0; i < turn_count; i++) CHECK(scene_turn_text(script_scene(plain), turns[i].path, turns[i].value, NULL, &r) == STATUS_OK);
        compare_materials(&script_scene(plain)->materials[0], &script_scene(loaded)->materials[0]);
    }
    if (plain) script_close(plain);
    if (loaded) script_close(loaded);
    session_destroy(s);
}

static void recipes_resolve_to_the_values_that_were_tuned(void) {
    static const knob_turn tube[] = {{0, "sigma_c", "1234.5678901234567"}, {0, "damage.alpha", "-0.25"}, {1, "elastic.E", "33333.333333333336"}, {1, "lame", "paper"}};
    static const knob_turn stretch[] = {{0, "tube.damage.break_stretch", "0.07"}, {1, "eta", "0.3"}};
    static const knob_turn towel[] = {{0, "softening.stiffness", "0.123"}, {1, "diffusion.k", "0.7"}};
    check_recipe(SUNDER_SOURCE "/scenes/solid/tube_pull.lua", NULL, tube, 4);
    check_recipe(SUNDER_SOURCE "/scenes/solid/tube_pull.lua", NULL, stretch, 2);
    check_recipe(SUNDER_SOURCE "/scenes/solid/heart.lua", NULL, NULL, 0);
    check_recipe(SUNDER_SOURCE "/scenes/sheet/paper_towel.lua", "wet", towel, 2);
    check_recipe(SUNDER_SOURCE "/scenes/sheet/foil.lua", "wet", NULL, 0);
}

static void a_run_that_goes_on_is_not_resumed_beside_itself(void) {
    static script_reports reports;
    session_snapshot p = {0};
    session_options o = small_run();
    o.start_paused = true;
    o.checkpoint_every = 1;
    session *s = begin(&o), *other = NULL;
    if (!s) return;
    session_run_to(s, 2);
    CHECK(wait_for(s, &p, 2, SESSION_PAUSED));
    int64_t frames[8];
    CHECK(session_checkpoints(s, frames, 8) == 2 && frames[0] == 1 && frames[1] == 2);
    session_options again = small_run();
    again.resume = p.run_id;
    CHECK(session_start(&again, &other, &reports) == STATUS_INPUT && strstr(reports.items[0].found, "still writing"));
    CHECK(session_checkpoints(s, frames, 8) == 2);
    /* A branch of it may be made meanwhile: it only reads. */
    session_options branch = small_run();
    branch.branch_of = p.run_id;
    branch.branch_frame = 1;
    branch.frames = -1;
    session *b = begin(&branch);
    CHECK(b && session_wait(b, -1));
    session_pause(s, false);
    CHECK(session_wait(s, -1));
    CHECK(b && strcmp(hash_of(s), hash_of(b)) == 0);
    session_destroy(b);
    session_destroy(s);
    session_snapshot_free(&p);
}

/* Files are written on a thread of their own while the next frame is made; every frame is looked at as soon as it is shown. */
static void a_frame_that_is_shown_is_on_the_disk(void) {
    session_snapshot p = {0};
    session_options o = small_run();
    o.keep = 0;
    o.frames = 20;
    o.start_paused = true;
    int missing = 0;
    session *s = begin(&o);
    CHECK(s != NULL);
    if (!s) return;
    for (int64_t frame = 0; frame <= 20; frame++) {
        if (frame > 0) session_run_to(s, frame);
        do session_poll(s, &p);
        while ((p.history_count == 0 || p.frame < frame) && p.state != SESSION_ENDED);
        missing += !frame_exists(p.output, frame) || !checkpoint_exists(p.output, frame);
    }
    CHECK(session_wait(s, -1) && p.frame == 20 && missing == 0);
    session_destroy(s);
    session_snapshot_free(&p);
}

static void a_run_stopped_between_checkpoints_leaves_one(void) {
    session_snapshot p = {0};
    session_options o = small_run();
    o.start_paused = true;
    o.checkpoint_every = 100;
    session *s = begin(&o);
    CHECK(s != NULL);
    if (!s) return;
    session_run_to(s, 3);
    CHECK(wait_for(s, &p, 3, SESSION_PAUSED) && !checkpoint_exists(p.output, 3));
    session_stop(s);
    CHECK(session_wait(s, -1) && checkpoint_exists(p.output, 3));
    session_destroy(s);
    session_options again = small_run();
    again.resume = p.run_id;
    again.frames = -1;
    session *rest = begin(&again);
    CHECK(rest && session_wait(rest, -1));
    session *whole = begin((const session_options[]){small_run()});
    CHECK(whole && session_wait(whole, -1) && rest && strcmp(hash_of(rest), hash_of(whole)) == 0);
    session_destroy(rest);
    session_destroy(whole);
    session_snapshot_free(&p);
}

/* Where checkpoints serve a resume alone, one comes as soon as 100 steps have been made since the last, and none sooner but at the end. */
static void checkpoints_come_by_steps(void) {
    session_snapshot p = {0};
    session_options o = small_run();
    o.keep = 1000;
    o.frames = 30;
    session *s = begin(&o);
    CHECK(s && session_wait(s, -1));
    if (!s) return;
    session_poll(s, &p);
    int64_t frames[32], count = session_checkpoints(s, frames, 32), found = 0, since = 0;
    for (int i = 0; i < p.history_count; i++) {
        const session_sample *now = &p.history[i];
        bool due = i == 0 || i == 30 || now->step - since >= SESSION_CHECKPOINT_STEPS;
        if (due) since = now->step;
        if (due) CHECK(found < count && frames[found] == now->frame);
        found += due;
    }
    CHECK(p.history_count == 31 && found == count && count > 3 && count < 20);
    session_destroy(s);
    session_snapshot_free(&p);
}

int main(void) {
    snprintf(folder, sizeof folder, "/tmp/sunder-session-XXXXXX");
    if (!mkdtemp(folder)) return 1;
    snprintf(database, sizeof database, "%s/ledger.db", folder);
    setenv("XDG_DATA_HOME", folder, 1);
    setenv("SUNDER_RECIPES", folder, 1);
    RUN(turns_by_hand_are_turns_known_beforehand);
    RUN(colours_are_chosen_while_a_run_is_paused_and_after_it);
    RUN(steps_tell_where_their_time_goes);
    RUN(recipes_resolve_to_the_values_that_were_tuned);
    RUN(a_run_that_goes_on_is_not_resumed_beside_itself);
    RUN(a_frame_that_is_shown_is_on_the_disk);
    RUN(a_run_stopped_between_checkpoints_leaves_one);
    RUN(checkpoints_come_by_steps);
    nftw(folder, remove_one, 16, FTW_DEPTH | FTW_PHYS);
    return check_finish();
}
