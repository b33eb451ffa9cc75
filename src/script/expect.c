/* `expect`: what a scene that is a hard case expects of its run. */
#include "script/internal.h"

#include "base/names.h"
#include "sim/hard_case.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const char *const words[] = {"known_limit", "same_as", "stop", "turns"};
enum { WORDS = sizeof words / sizeof *words };

static void read_text(script *s, int index, const place *p, char *out, size_t size) {
    size_t length;
    const char *text = lua_type(s->L, index) == LUA_TSTRING ? lua_tolstring(s->L, index, &length) : NULL;
    char expected[64];
    snprintf(expected, sizeof expected, "a text of 1 to %zu bytes", size - 1);
    if (!text || length == 0 || length >= size) {
        char found[80];
        describe_value(s->L, index, found, sizeof found);
        problem_place(s, p, expected, found, NULL);
        return;
    }
    snprintf(out, size, "%s", text);
}

/* A number: the bound that the measure's sense says. { low, high }: both. */
static void read_bound(script *s, int index, const place *p, int measure, hard_expectation *out) {
    static const plain_rule number = {.kind = PLAIN_NUMBER, .minimum = -HUGE_VAL, .maximum = HUGE_VAL, .infinite = true};
    plain_value v;
    *out = (hard_expectation){measure, -HUGE_VAL, HUGE_VAL};
    if (!lua_istable(s->L, index)) {
        if (!read_plain(s, index, p, &number, &v)) return;
        *(hard_measure_at(measure)->sense == HARD_AT_MOST ? &out->high : &out->low) = v.number[0];
        return;
    }
    int table = lua_gettop(s->L), count = read_list(s, table, p, 2, "a number, or a range { low, high }");
    if (count < 0) return;
    for (int i = 1; i <= count; i++) {
        place at = place_index(p, i);
        lua_rawgeti(s->L, table, i);
        if (read_plain(s, -1, &at, &number, &v)) *(i == 1 ? &out->low : &out->high) = v.number[0];
        lua_pop(s->L, 1);
    }
    if (count != 2 || out->low > out->high) problem_place(s, p, "a range { low, high }, low first", "another list", NULL);
}

static void read_turn(script *s, int index, const place *p, hard_turn *out) {
    double frame = 0;
    char path[SCRIPT_TEXT] = "";
    field fields[] = {{.key = "frame", .kind = FIELD_REAL, .required = true, .minimum = 0, .maximum = 1e9, .number = &frame},
                      {.key = "knob", .kind = FIELD_TEXT, .required = true, .text = path},
                      {.key = "value", .kind = FIELD_OTHER, .required = true}};
    if (!read_fields(s, index, p, fields, 3)) return;
    *out = (hard_turn){.frame = (int64_t)frame};
    snprintf(out->path, sizeof out->path, "%.*s", HARD_TEXT - 1, path);
    push_value(s->L, index, "value");
    push_text(s->L, -1);
    snprintf(out->value, sizeof out->value, "%.*s", HARD_TEXT - 1, lua_tostring(s->L, -1));
    lua_pop(s->L, 2);
}

static void read_turns(script *s, int index, const place *p, hard_case *out) {
    int count = read_list(s, index, p, HARD_TURNS, "a list of turns: turns = { { frame = …, knob = …, value = … }, … }");
    for (int i = 1; i <= count; i++) {
        place at = place_index(p, i);
        lua_rawgeti(s->L, index, i);
        int turn = lua_gettop(s->L);
        if (read_table(s, turn, &at, "a table with frame, knob and value")) read_turn(s, turn, &at, &out->turns[out->turn_count++]);
        lua_settop(s->L, turn - 1);
    }
}

static void read_likeness(script *s, int index, const place *p, hard_likeness *out) {
    char variant[SCRIPT_TEXT] = "";
    *out = (hard_likeness){.length = 1};
    field fields[] = {{.key = "variant", .kind = FIELD_TEXT, .required = true, .text = variant},
                      {.key = "tolerance", .kind = FIELD_SIZE, .required = true, .number = &out->tolerance},
                      {.key = "length", .kind = FIELD_SIZE, .number = &out->length},
                      {.key = "shift", .kind = FIELD_VECTOR, .number = out->shift}};
    if (!read_fields(s, index, p, fields, 4)) return;
    snprintf(out->variant, sizeof out->variant, "%.*s", HARD_TEXT - 1, variant);
}

static void report_unknown(script *s, const place *p, const char *name) {
    const char *names[HARD_MEASURE_COUNT + WORDS];
    for (int i = 0; i < HARD_MEASURE_COUNT; i++) names[i] = hard_measure_at(i)->key;
    for (int i = 0; i < WORDS; i++) names[HARD_MEASURE_COUNT + i] = words[i];
    problem_place(s, p, "a measure of a run, stop, known_limit, turns or same_as", "a key that does not exist",
                  name_nearest(name, names, HARD_MEASURE_COUNT + WORDS));
}

static void read_word(script *s, const char *name, const place *p, hard_case *out) {
    int value = lua_gettop(s->L), measure = hard_measure_find(name);
    if (measure >= 0 && out->count == HARD_EXPECTATIONS) problem_place(s, p, "at most 16 measures", "more", NULL);
    else if (measure >= 0) read_bound(s, value, p, measure, &out->items[out->count++]);
    else if (strcmp(name, "stop") == 0) read_text(s, value, p, out->stop, sizeof out->stop);
    else if (strcmp(name, "known_limit") == 0) read_text(s, value, p, out->known_limit, sizeof out->known_limit);
    else if (strcmp(name, "turns") == 0) read_turns(s, value, p, out);
    else if (strcmp(name, "same_as") == 0) {
        if (read_table(s, value, p, "a table with variant and tolerance")) read_likeness(s, value, p, &out->same_as);
    } else report_unknown(s, p, name);
}

void read_expect(script *s, int index, const place *p) {
    hard_case *out = &s->scene->hard;
    *out = (hard_case){.given = true};
    if (!read_table(s, index, p, "a table with the measures of a run and their bounds")) return;
    int count = push_sorted_names(s, index, p), list = lua_gettop(s->L);
    for (int i = 1; i <= count; i++) {
        lua_rawgeti(s->L, list, i);
        const char *name = lua_tostring(s->L, -1);
        place at = place_key(p, name);
        push_value(s->L, index, name);
        read_word(s, name, &at, out);
        lua_settop(s->L, list);
    }
    lua_settop(s->L, list - 1);
}
