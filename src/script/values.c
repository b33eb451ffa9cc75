/* Reading plain values and tables of named fields. */
#include "script/internal.h"

#include "base/names.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- one value --------------------------------------------------------------------------------------------------- */

static void describe_number(lua_State *L, int index, char *text, size_t size) {
    if (lua_isinteger(L, index))
        snprintf(text, size, "%lld", (long long)lua_tointeger(L, index));
    else if (isnan(lua_tonumber(L, index)))
        snprintf(text, size, "a number that is not one (nan)");
    else
        snprintf(text, size, "%.14g", lua_tonumber(L, index));
}

void describe_value(lua_State *L, int index, char *text, size_t size) {
    switch (lua_type(L, index)) {
    case LUA_TNIL:
    case LUA_TNONE: snprintf(text, size, "nothing"); break;
    case LUA_TBOOLEAN: snprintf(text, size, "%s", lua_toboolean(L, index) ? "true" : "false"); break;
    case LUA_TNUMBER: describe_number(L, index, text, size); break;
    case LUA_TSTRING: snprintf(text, size, "'%.60s'", lua_tostring(L, index)); break;
    case LUA_TTABLE: snprintf(text, size, "a table"); break;
    case LUA_TFUNCTION: snprintf(text, size, "a function"); break;
    default:
        if (luaL_testudata(L, index, META_SHAPE))
            snprintf(text, size, "a shape");
        else if (luaL_testudata(L, index, META_FIBRES))
            snprintf(text, size, "fibres");
        else
            snprintf(text, size, "a %s", luaL_typename(L, index));
    }
}

/* Three numbers and nothing else. */
static bool vector_from_table(lua_State *L, int index, double out[3]) {
    int count = 0;
    lua_pushnil(L);
    while (lua_next(L, index)) {
        bool component = lua_isinteger(L, -2) && lua_type(L, -1) == LUA_TNUMBER;
        lua_Integer i = component ? lua_tointeger(L, -2) : 0;
        if (i >= 1 && i <= 3)
            out[i - 1] = lua_tonumber(L, -1), count++;
        else
            count = 4;
        lua_pop(L, 1);
        if (count > 3) {
            lua_pop(L, 1);
            return false;
        }
    }
    return count == 3;
}

plain_value plain_from_lua(lua_State *L, int index) {
    index = lua_absindex(L, index);
    plain_value v = {.kind = PLAIN_OTHER};
    describe_value(L, index, v.found, sizeof v.found);
    switch (lua_type(L, index)) {
    case LUA_TNIL: v.kind = PLAIN_NONE; break;
    case LUA_TBOOLEAN: v.kind = PLAIN_BOOLEAN, v.number[0] = lua_toboolean(L, index); break;
    case LUA_TNUMBER: v.kind = PLAIN_NUMBER, v.number[0] = lua_tonumber(L, index); break;
    case LUA_TSTRING:
        if (lua_rawlen(L, index) >= SCRIPT_TEXT || strlen(lua_tostring(L, index)) != lua_rawlen(L, index)) break;
        v.kind = PLAIN_TEXT;
        snprintf(v.text, sizeof v.text, "%s", lua_tostring(L, index));
        break;
    case LUA_TTABLE:
        if (!vector_from_table(L, index, v.number)) break;
        v.kind = PLAIN_VECTOR;
        snprintf(v.found, sizeof v.found, "{%g, %g, %g}", v.number[0], v.number[1], v.number[2]);
        break;
    default: break;
    }
    return v;
}

plain_value plain_from_text(const char *text) {
    plain_value v = {.kind = PLAIN_TEXT, .raw = true};
    snprintf(v.text, sizeof v.text, "%s", text);
    snprintf(v.found, sizeof v.found, "'%s'", v.text);
    return v;
}

/* Reads `count` numbers separated by commas, with optional braces around; the whole text must be used. */
static bool numbers_from_text(const char *text, double *out, int count) {
    while (isspace((unsigned char)*text)) text++;
    bool braces = *text == '{';
    if (braces) text++;
    for (int i = 0; i < count; i++) {
        char *end;
        out[i] = strtod(text, &end);
        if (end == text) return false;
        for (text = end; isspace((unsigned char)*text); text++) {
        }
        if (i < count - 1 && *text++ != ',') return false;
    }
    if (braces && *text++ != '}') return false;
    while (isspace((unsigned char)*text)) text++;
    return *text == '\0';
}

static void convert_raw(plain_value *v, plain_kind kind) {
    if (kind == PLAIN_NUMBER && numbers_from_text(v->text, v->number, 1)) v->kind = kind;
    if (kind == PLAIN_VECTOR && numbers_from_text(v->text, v->number, 3)) v->kind = kind;
    bool is_true = strcmp(v->text, "true") == 0;
    if (kind == PLAIN_BOOLEAN && (is_true || strcmp(v->text, "false") == 0)) v->kind = kind, v->number[0] = is_true;
}

/* ---- rules ------------------------------------------------------------------------------------------------------- */

static void append(char *text, size_t size, const char *more) {
    size_t used = strlen(text);
    if (used < size) snprintf(text + used, size - used, "%s", more);
}

static void describe_range(const plain_rule *rule, char *text, size_t size) {
    char piece[96];
    bool low = rule->minimum > -HUGE_VAL, high = rule->maximum < HUGE_VAL;
    if (rule->above && high)
        snprintf(piece, sizeof piece, " above %g, at most %g", rule->minimum, rule->maximum);
    else if (rule->above)
        snprintf(piece, sizeof piece, " above %g", rule->minimum);
    else if (low && high)
        snprintf(piece, sizeof piece, " from %g to %g", rule->minimum, rule->maximum);
    else if (low)
        snprintf(piece, sizeof piece, " of at least %g", rule->minimum);
    else if (high)
        snprintf(piece, sizeof piece, " of at most %g", rule->maximum);
    else
        piece[0] = '\0';
    append(text, size, piece);
}

static void describe_rule(const plain_rule *rule, char *text, size_t size) {
    text[0] = '\0';
    switch (rule->kind) {
    case PLAIN_NUMBER:
        append(text, size, rule->whole ? "a whole number" : rule->infinite ? "a number" : "a finite number");
        describe_range(rule, text, size);
        if (rule->automatic) append(text, size, ", or \"auto\"");
        break;
    case PLAIN_VECTOR:
        append(text, size, "three finite numbers {x, y, z}");
        if (rule->minimum > -HUGE_VAL || rule->maximum < HUGE_VAL) append(text, size, ", each");
        describe_range(rule, text, size);
        break;
    case PLAIN_BOOLEAN: append(text, size, "true or false"); break;
    case PLAIN_TEXT:
        if (!rule->choices) append(text, size, "text of at most 127 bytes");
        for (int i = 0; rule->choices && rule->choices[i]; i++) {
            append(text, size, i ? ", \"" : "one of \"");
            append(text, size, rule->choices[i]);
            append(text, size, "\"");
        }
        break;
    default: append(text, size, "a value"); break;
    }
}

static bool number_fits(const plain_rule *rule, double x) {
    if (isnan(x) || (isinf(x) && !rule->infinite)) return false;
    if (rule->whole && floor(x) != x) return false;
    return x <= rule->maximum && (rule->above ? x > rule->minimum : x >= rule->minimum);
}

static bool choice_fits(plain_value *v, const plain_rule *rule, const char **nearest) {
    int count = 0;
    for (; rule->choices[count]; count++)
        if (strcmp(rule->choices[count], v->text) == 0) {
            v->number[0] = count;
            return true;
        }
    *nearest = name_nearest(v->text, rule->choices, count);
    return false;
}

bool plain_fit(plain_value *v, const plain_rule *rule, char *expected, size_t size, const char **nearest) {
    *nearest = NULL;
    describe_rule(rule, expected, size);
    if (rule->automatic && v->kind == PLAIN_TEXT && strcmp(v->text, "auto") == 0) {
        v->kind = PLAIN_NUMBER, v->number[0] = 0;
        return true;
    }
    if (v->raw && v->kind == PLAIN_TEXT) convert_raw(v, rule->kind);
    if (v->kind != rule->kind) return false;
    switch (rule->kind) {
    case PLAIN_NUMBER: return number_fits(rule, v->number[0]);
    case PLAIN_VECTOR:
        return number_fits(rule, v->number[0]) && number_fits(rule, v->number[1]) && number_fits(rule, v->number[2]);
    case PLAIN_TEXT: return !rule->choices || choice_fits(v, rule, nearest);
    default: return true;
    }
}

bool read_plain(script *s, int index, const place *p, const plain_rule *rule, plain_value *out) {
    char expected[256];
    const char *nearest;
    *out = plain_from_lua(s->L, index);
    if (plain_fit(out, rule, expected, sizeof expected, &nearest)) return true;
    problem_place(s, p, expected, out->found, nearest);
    return false;
}

/* ---- tables ------------------------------------------------------------------------------------------------------ */

bool read_table(script *s, int index, const place *p, const char *expected) {
    char found[80];
    if (lua_type(s->L, index) != LUA_TTABLE) {
        describe_value(s->L, index, found, sizeof found);
        problem_place(s, p, expected, found, NULL);
        return false;
    }
    if (luaL_getmetafield(s->L, index, "__index") != LUA_TNIL ||
        luaL_getmetafield(s->L, index, "__pairs") != LUA_TNIL) {
        lua_pop(s->L, 1);
        problem_place(s, p, "a plain table", "one with a metatable, whose keys would go unseen", NULL);
        return false;
    }
    return true;
}

int read_list(script *s, int index, const place *p, int limit, const char *expected) {
    lua_State *L = s->L;
    index = lua_absindex(L, index);
    if (!read_table(s, index, p, expected)) return -1;
    lua_Integer largest = 0, count = 0;
    lua_pushnil(L);
    for (; lua_next(L, index); lua_pop(L, 1), count++) {
        guard_spend(L, 10);
        lua_Integer i = lua_isinteger(L, -2) ? lua_tointeger(L, -2) : 0;
        if (i > largest) largest = i;
        if (i >= 1) continue;
        char found[160], key[80];
        describe_value(L, -2, key, sizeof key);
        snprintf(found, sizeof found, "the key %s beside or instead of list items", key);
        lua_pop(L, 2);
        problem_place(s, p, expected, found, NULL);
        return -1;
    }
    char found[128];
    if (largest != count) {
        snprintf(found, sizeof found, "a list with holes (%lld items, the last is number %lld)", (long long)count,
                 (long long)largest);
        problem_place(s, p, expected, found, NULL);
        return -1;
    }
    if (count <= limit) return (int)count;
    char at_most[160];
    snprintf(at_most, sizeof at_most, "%s, at most %d", expected, limit);
    snprintf(found, sizeof found, "%lld", (long long)count);
    problem_place(s, p, at_most, found, NULL);
    return -1;
}

int push_sorted_names(script *s, int index, const place *p) {
    lua_State *L = s->L;
    index = lua_absindex(L, index);
    int count = 0;
    lua_newtable(L);
    lua_pushnil(L);
    while (lua_next(L, index)) {
        lua_pop(L, 1);
        guard_spend(L, 10);
        if (lua_type(L, -1) != LUA_TSTRING) {
            char found[80];
            describe_value(L, -1, found, sizeof found);
            problem_place(s, p, "keys that are names", found, NULL);
            continue;
        }
        /* Insertion into a sorted list: these tables are short, and order must not depend on Lua's hash seed. */
        int at = ++count;
        for (; at > 1; at--) {
            guard_spend(L, 4);
            lua_rawgeti(L, -2, at - 1);
            if (!lua_compare(L, -2, -1, LUA_OPLT)) {
                lua_pop(L, 1);
                break;
            }
            lua_rawseti(L, -3, at);
        }
        lua_pushvalue(L, -1);
        lua_rawseti(L, -3, at);
    }
    return count;
}

static plain_rule field_rule(const field *f) {
    plain_rule rule = {.minimum = -HUGE_VAL, .maximum = HUGE_VAL, .infinite = f->infinite, .choices = f->choices};
    switch (f->kind) {
    case FIELD_REAL:
        rule.kind = PLAIN_NUMBER;
        if (f->minimum < f->maximum) rule.minimum = f->minimum, rule.maximum = f->maximum;
        break;
    case FIELD_SIZE: rule.kind = PLAIN_NUMBER, rule.minimum = 0, rule.above = true; break;
    case FIELD_FLAG: rule.kind = PLAIN_BOOLEAN; break;
    case FIELD_CHOICE:
    case FIELD_TEXT: rule.kind = PLAIN_TEXT; break;
    default: rule.kind = PLAIN_VECTOR; break;
    }
    return rule;
}

/* An axis is "x", "-y" … or a vector that is not zero; the result has length 1. */
static bool read_axis(script *s, int index, const place *p, double out[3]) {
    static const char *const names[] = {"x", "y", "z", "-x", "-y", "-z", NULL};
    plain_value v = plain_from_lua(s->L, index);
    if (v.kind == PLAIN_TEXT) {
        for (int i = 0; names[i]; i++) {
            if (strcmp(v.text, names[i]) != 0) continue;
            for (int c = 0; c < 3; c++) out[c] = c == i % 3 ? (i < 3 ? 1 : -1) : 0;
            return true;
        }
    } else if (v.kind == PLAIN_VECTOR) {
        /* hypot scales: no component is too large or too small to be squared. */
        double length = hypot(hypot(v.number[0], v.number[1]), v.number[2]);
        if (isfinite(length) && length > 0) {
            for (int c = 0; c < 3; c++) out[c] = v.number[c] / length;
            return true;
        }
    }
    problem_place(s, p, "an axis: \"x\", \"y\", \"z\", \"-x\" …, or a vector that is not zero", v.found, NULL);
    return false;
}

static bool read_field(script *s, int index, const place *p, field *f) {
    if (f->kind == FIELD_OTHER) return true;
    if (f->kind == FIELD_AXIS) return read_axis(s, index, p, f->number);
    plain_rule rule = field_rule(f);
    plain_value v;
    if (!read_plain(s, index, p, &rule, &v)) return false;
    if (f->text) snprintf(f->text, SCRIPT_TEXT, "%s", v.text);
    for (int c = 0; f->number && c < (f->kind == FIELD_VECTOR ? 3 : 1); c++) f->number[c] = v.number[c];
    return true;
}

/* Records every key of the table that is no field's. */
static bool check_keys(script *s, int index, const place *p, const field *fields, int count) {
    lua_State *L = s->L;
    const char *names[32];
    char expected[256] = "one of ";
    for (int i = 0; i < count && i < 32; i++) {
        names[i] = fields[i].key;
        append(expected, sizeof expected, i ? ", " : "");
        append(expected, sizeof expected, fields[i].key);
    }
    int before = s->problem_count, keys = push_sorted_names(s, index, p);
    for (int k = 1; k <= keys; k++) {
        lua_rawgeti(L, -1, k);
        const char *key = lua_tostring(L, -1);
        bool known = false;
        for (int i = 0; i < count; i++) known = known || strcmp(fields[i].key, key) == 0;
        place at = place_key(p, key);
        if (!known) problem_place(s, &at, expected, "a key that does not exist", name_nearest(key, names, count));
        lua_pop(L, 1);
    }
    lua_pop(L, 1);
    return s->problem_count == before;
}

bool read_fields(script *s, int index, const place *p, field *fields, int count) {
    lua_State *L = s->L;
    index = lua_absindex(L, index);
    if (!read_table(s, index, p, "a table with named fields")) return false;
    bool fine = check_keys(s, index, p, fields, count);
    for (int i = 0; i < count; i++) {
        field *f = &fields[i];
        lua_pushstring(L, f->key);
        lua_rawget(L, index);
        place at = place_key(p, f->key);
        f->given = !lua_isnil(L, -1);
        if (f->given) {
            fine = read_field(s, -1, &at, f) && fine;
        } else if (f->required) {
            problem_place(s, &at, "a value: this key is required", "nothing", NULL);
            fine = false;
        }
        lua_pop(L, 1);
    }
    return fine;
}
