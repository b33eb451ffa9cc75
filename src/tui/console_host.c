#include "tui/console_host.h"

#include "base/memory.h"
#include "base/names.h"
#include "tui/actions.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const console_function functions[] = {
    {"help", "help()", "this list"},
    {"knobs", "knobs([word])", "the run's parameters: path, value, unit, live, range"},
    {"knob", "knob(path)", "a parameter's value"},
    {"turn", "turn(path, value)", "turn a knob: it acts at the next frame, and is logged"},
    {"turns", "turns()", "the knobs that have been turned: frame, path, value"},
    {"measures", "measures()", "the newest frame: energies, damage, time, state"},
    {"history", "history(name)", "a measure's values over the last frames"},
    {"pause", "pause()", "pause the run after its frame"},
    {"go", "go()", "let it go on"},
    {"step", "step()", "compute one frame"},
    {"run_to", "run_to(frame)", "go on, and pause at a frame"},
    {"wait", "wait()", "wait until the run is paused or has ended; Esc stops waiting"},
    {"checkpoints", "checkpoints()", "frames that a branch can start from at once"},
    {"save_recipe", "save_recipe(path[, n])", "write the n-th material as it now is as a recipe"},
    {"colour", "colour(name)", "what particles are coloured by; colour() lists"},
    {"start", "start(words)", "start a run, in the words of sunder run"},
    {"act", "act(name[, argument])", "do any action of the workbench"},
    {"actions", "actions()", "the names of all actions"},
    {"runs", "runs([condition])", "runs of the ledger, as rows; condition in SQL"},
    {"query", "query(sql[, \"k=v\" ...])", "ask the ledger in SQL, or one of its own queries by name"},
};

const console_function *console_functions(int *count) {
    *count = (int)(sizeof functions / sizeof *functions);
    return functions;
}

bool console_is_query(const char *function) {
    return strcmp(function, "runs") == 0 || strcmp(function, "query") == 0;
}

/* ---- the ledger -------------------------------------------------------------------------------------------------- */

static status write_row(void *context, const ledger_cell *cells, int count, report *r) {
    json_writer *w = context;
    (void)r;
    json_object(w);
    for (int i = 0; i < count; i++) {
        if (cells[i].text) json_member_string(w, cells[i].name, cells[i].text);
        else if (isfinite(cells[i].number)) json_member_number(w, cells[i].name, cells[i].number);
    }
    json_object_end(w);
    return STATUS_OK;
}

status console_query(ledger **open, const char *database, const char *function, const char *const *arguments, int count, json_writer *reply,
                     report *r) {
    char path[TUI_PATH], sql[2048];
    const char *text = count > 0 ? arguments[0] : "", *named;
    report unused;
    if (!*open) {
        status s = ledger_open_given(database[0] ? database : NULL, path, sizeof path, open, r);
        if (s != STATUS_OK) return s;
    }
    if (strcmp(function, "runs") == 0) {
        snprintf(sql, sizeof sql, "SELECT * FROM runs %s%s ORDER BY started DESC LIMIT 50", text[0] ? "WHERE " : "", text);
        text = sql;
        count = 1;
    } else if (count == 0) {
        return report_input(r, NULL, 0, "query", "SQL, or a query's name", "nothing", NULL);
    } else if (!strchr(text, ' ') && ledger_query(text, &named, &unused) == STATUS_OK) {
        text = named;
    }
    json_array(reply);
    status s = ledger_each_row(*open, text, arguments + 1, count - 1, write_row, reply, r);
    json_array_end(reply);
    return s;
}

/* ---- the run ----------------------------------------------------------------------------------------------------- */

static status need_run(const tui_app *app, report *r) {
    return app->run ? STATUS_OK : report_set(r, STATUS_INPUT, "there is no run: start(\"tube_pull\") starts one");
}

static void write_knob(json_writer *w, const knob *k) {
    char value[KNOB_TEXT];
    knob_print(k, k->value, value);
    json_object(w);
    json_member_string(w, "path", k->path);
    json_key(w, "value");
    if (k->kind == PARAMETER_CHOICE || k->kind == PARAMETER_BOOLEAN || k->components > 1) json_string(w, value);
    else json_number(w, k->value[0]);
    json_member_string(w, "unit", k->unit);
    json_member_boolean(w, "live", k->live);
    if (isfinite(k->minimum)) json_member_number(w, "minimum", k->minimum);
    if (isfinite(k->maximum)) json_member_number(w, "maximum", k->maximum);
    json_object_end(w);
}

static status knobs(tui_app *app, const char *word, bool one, json_writer *w, report *r) {
    size_t bytes = KNOB_LIMIT * sizeof(knob);
    knob *list = memory_allocate(bytes);
    if (!list) return report_set(r, STATUS_SYSTEM, "out of memory for the knobs");
    int count = session_knobs(app->run, list, KNOB_LIMIT), found = one ? knob_find(list, count, word, r) : 0;
    char value[KNOB_TEXT];
    if (one && found >= 0) {
        const knob *k = &list[found];
        knob_print(k, k->value, value);
        if (k->kind == PARAMETER_CHOICE || k->components > 1) json_string(w, value);
        else if (k->kind == PARAMETER_BOOLEAN) json_boolean(w, k->value[0] != 0);
        else json_number(w, k->value[0]);
    } else if (!one) {
        json_array(w);
        for (int i = 0; i < count; i++)
            if (strstr(list[i].path, word)) write_knob(w, &list[i]);
        json_array_end(w);
    }
    memory_free(list, bytes);
    return found < 0 ? STATUS_INPUT : STATUS_OK;
}

static status turns(tui_app *app, json_writer *w, report *r) {
    enum { MOST = 1000 };
    knob_turn *list = memory_allocate_array(MOST, sizeof *list);
    if (!list) return report_set(r, STATUS_SYSTEM, "out of memory for the turns");
    int count = session_turns(app->run, list, MOST);
    json_array(w);
    for (int i = 0; i < count && i < MOST; i++) {
        json_object(w);
        json_member_integer(w, "frame", list[i].frame);
        json_member_string(w, "path", list[i].path);
        json_member_string(w, "value", list[i].value);
        json_object_end(w);
    }
    json_array_end(w);
    memory_free(list, MOST * sizeof *list);
    return STATUS_OK;
}

static const struct {
    const char *name;
    size_t offset;
} measured[] = {{"time", offsetof(session_sample, time)},       {"seconds", offsetof(session_sample, seconds)},
                {"kinetic", offsetof(session_sample, kinetic)}, {"elastic", offsetof(session_sample, elastic)},
                {"fibre", offsetof(session_sample, fibre)},     {"work", offsetof(session_sample, work)},
                {"damage_mean", offsetof(session_sample, damage_mean)}, {"damage_max", offsetof(session_sample, damage_max)},
                {"broken_fraction", offsetof(session_sample, broken_fraction)}, {"dt", offsetof(session_sample, dt)}};
enum { MEASURED = sizeof measured / sizeof *measured };

static double figure(const session_sample *sample, int index) {
    double value;
    memcpy(&value, (const char *)sample + measured[index].offset, sizeof value);
    return value;
}

static status measures(const tui_app *app, json_writer *w) {
    static const char *const states[] = {"starting", "running", "paused", "ended"};
    const session_snapshot *s = app->shot;
    json_object(w);
    json_member_string(w, "run", s->run_id);
    json_member_string(w, "state", states[s->state]);
    json_member_integer(w, "frame", s->frame);
    json_member_integer(w, "frames", s->frames);
    json_member_integer(w, "step", s->step);
    json_member_integer(w, "particles", s->particles);
    for (int i = 0; i < MEASURED; i++) json_member_number(w, measured[i].name, figure(&s->now, i));
    json_object_end(w);
    return STATUS_OK;
}

static status history(const tui_app *app, const char *name, json_writer *w, report *r) {
    const char *names[MEASURED];
    for (int i = 0; i < MEASURED; i++) {
        names[i] = measured[i].name;
        if (strcmp(name, names[i]) != 0) continue;
        json_array(w);
        for (int k = 0; k < app->shot->history_count; k++) json_number(w, figure(&app->shot->history[k], i));
        json_array_end(w);
        return STATUS_OK;
    }
    return report_input(r, NULL, 0, "history", "a measure's name", name[0] ? name : "nothing", name_nearest(name, names, MEASURED));
}

static status checkpoints(tui_app *app, json_writer *w) {
    enum { MOST = 4096 };
    int64_t frames[MOST];
    int count = session_checkpoints(app->run, frames, MOST);
    json_array(w);
    for (int i = 0; i < count && i < MOST; i++) json_integer(w, frames[i]);
    json_array_end(w);
    return STATUS_OK;
}

static status colour(tui_app *app, const char *name, json_writer *w, report *r) {
    char names[SESSION_COLOURS][32];
    if (name[0]) return session_colour(app->run, name, r);
    int count = session_colours(app->run, names, SESSION_COLOURS);
    json_array(w);
    for (int i = 0; i < count; i++) json_string(w, names[i]);
    json_array_end(w);
    return STATUS_OK;
}

static status do_on_run(tui_app *app, const char *f, const char *first, const char *second, json_writer *w, report *r) {
    char text[ACTION_ARGUMENT];
    status s = need_run(app, r);
    if (s != STATUS_OK) return s;
    if (strcmp(f, "knobs") == 0) return knobs(app, first, false, w, r);
    if (strcmp(f, "knob") == 0) return knobs(app, first, true, w, r);
    if (strcmp(f, "turns") == 0) return turns(app, w, r);
    if (strcmp(f, "measures") == 0) return measures(app, w);
    if (strcmp(f, "history") == 0) return history(app, first, w, r);
    if (strcmp(f, "checkpoints") == 0) return checkpoints(app, w);
    if (strcmp(f, "colour") == 0) return colour(app, first, w, r);
    if (strcmp(f, "save_recipe") == 0) return session_save_recipe(app->run, second[0] ? atoi(second) - 1 : 0, first, NULL, r);
    if (strcmp(f, "pause") == 0) return app_do(app, "run.pause", "on", r);
    if (strcmp(f, "go") == 0) return app_do(app, "run.pause", "off", r);
    if (strcmp(f, "step") == 0) return app_do(app, "run.step", "", r);
    if (strcmp(f, "turn") == 0) {
        snprintf(text, sizeof text, "%s=%s", first, second);
        return app_do(app, "run.turn", text, r);
    }
    if (strcmp(f, "run_to") == 0) {
        char *end;
        long long frame = strtoll(first, &end, 10);
        if (end == first || *end) return report_input(r, NULL, 0, "run_to", "a frame", first[0] ? first : "nothing", NULL);
        session_run_to(app->run, frame);
    }
    return STATUS_OK;
}

bool console_run_rests(const tui_app *app) {
    return app->ended || (app->shot->state == SESSION_PAUSED && !app_starting(app));
}

static status list_actions(json_writer *w) {
    action_place place;
    char name[128];
    json_array(w);
    for (int i = 0; actions_at(i, &place); i++) {
        action_name(&place, name, sizeof name);
        json_string(w, name);
    }
    json_array_end(w);
    return STATUS_OK;
}

status console_do(tui_app *app, const char *function, const char *const *arguments, int count, json_writer *reply, report *r) {
    const char *first = count > 0 ? arguments[0] : "", *second = count > 1 ? arguments[1] : "";
    if (strcmp(function, "start") == 0) {
        const tui_screen *here = app->screen;
        status s = app_do(app, "start", first, r);
        app_show(app, here);
        return s;
    }
    if (strcmp(function, "act") == 0) return app_do(app, first, second, r);
    if (strcmp(function, "actions") == 0) return list_actions(reply);
    return do_on_run(app, function, first, second, reply, r);
}
