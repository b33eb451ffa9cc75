#include "script/user_config.h"

#include "script/internal.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

bool user_config_path(char path[512]) {
    const char *base = getenv("XDG_CONFIG_HOME"), *home = getenv("HOME");
    int size = base && base[0] == '/' ? snprintf(path, 512, "%s/sunder/config.lua", base)
               : home && home[0]      ? snprintf(path, 512, "%s/.config/sunder/config.lua", home)
                                      : 512;
    if (size < 512) return true;
    path[0] = '\0';
    return false;
}

static void read_key(script *s, const place *at, user_config *out, const char *name) {
    user_binding *b = &out->bindings[out->binding_count];
    plain_value v = plain_from_lua(s->L, -1);
    bool off = v.kind == PLAIN_BOOLEAN && v.number[0] == 0;
    if (!off && v.kind != PLAIN_TEXT) {
        problem_place(s, at, "an action and its argument (\"run.pause\", \"theme light\"), or false", v.found, NULL);
        return;
    }
    snprintf(b->key, sizeof b->key, "%.31s", name);
    snprintf(b->action, sizeof b->action, "%s", off ? "" : v.text);
    b->line = place_line(s, at);
    out->binding_count++;
}

static void read_style(script *s, const place *at, user_config *out, const char *name) {
    user_style *style = &out->styles[out->style_count];
    plain_value v = plain_from_lua(s->L, -1);
    char *end = NULL;
    if (v.kind == PLAIN_TEXT && v.text[0] == '#' && strlen(v.text) == 7) {
        style->colour = 0x1000000 + (int)strtol(v.text + 1, &end, 16);
    } else if (v.kind == PLAIN_NUMBER && v.number[0] >= 0 && v.number[0] <= 255) {
        style->colour = (int)v.number[0];
    }
    if ((v.kind == PLAIN_TEXT && (!end || *end)) || (v.kind == PLAIN_NUMBER && v.number[0] != style->colour) ||
        (v.kind != PLAIN_TEXT && v.kind != PLAIN_NUMBER)) {
        problem_place(s, at, "a colour: 0 to 255, or \"#rrggbb\"", v.found, NULL);
        return;
    }
    snprintf(style->name, sizeof style->name, "%.31s", name);
    style->line = place_line(s, at);
    out->style_count++;
}

/* Each name of the table under `key`. */
static void read_names(script *s, int index, const place *p, const char *key, int limit, user_config *out,
                       void (*read)(script *, const place *, user_config *, const char *)) {
    lua_State *L = s->L;
    int top = lua_gettop(L);
    place at = place_key(p, key);
    lua_pushstring(L, key);
    lua_rawget(L, index);
    if (!read_table(s, top + 1, &at, "a table of names and what they stand for")) {
        lua_settop(L, top);
        return;
    }
    int count = push_sorted_names(s, top + 1, &at);
    if (count > limit) problem_place(s, &at, "fewer names", "too many", NULL);
    for (int i = 1; i <= count && i <= limit; i++) {
        lua_rawgeti(L, top + 2, i);
        const char *name = lua_tostring(L, -1);
        place item = place_key(&at, name);
        lua_pushvalue(L, -1);
        lua_rawget(L, top + 1);
        read(s, &item, out, name);
        lua_pop(L, 2);
    }
    lua_settop(L, top);
}

static void read_colours(script *s, const place *p, int index, user_config *out) {
    lua_getfield(s->L, index, "colours");
    plain_value v = plain_from_lua(s->L, -1);
    place at = place_key(p, "colours");
    int number = v.kind == PLAIN_NUMBER ? (int)v.number[0] : -1;
    if (v.kind == PLAIN_TEXT && strcmp(v.text, "true") == 0) number = 1 << 24;
    if (number == 0 || number == 8 || number == 16 || number == 256 || number == 1 << 24) out->colours = number;
    else problem_place(s, &at, "0, 8, 16, 256 or \"true\"", v.found, NULL);
    lua_pop(s->L, 1);
}

static void read_config(lua_State *L, const char *path, const char *file, void *to) {
    (void)path;
    script *s = script_of(L);
    user_config *out = to;
    place p = {.file = file};
    double ascii = 0, mouse = 0;
    field fields[] = {{.key = "theme", .kind = FIELD_TEXT, .text = out->theme}, {.key = "map", .kind = FIELD_TEXT, .text = out->map},
                      {.key = "mode", .kind = FIELD_TEXT, .text = out->mode},   {.key = "ascii", .kind = FIELD_FLAG, .number = &ascii},
                      {.key = "mouse", .kind = FIELD_FLAG, .number = &mouse},   {.key = "colours", .kind = FIELD_OTHER},
                      {.key = "keys", .kind = FIELD_OTHER},                     {.key = "styles", .kind = FIELD_OTHER}};
    int table = lua_gettop(L);
    if (!read_table(s, table, &p, "a table: return { theme = \"light\", keys = { … } }")) return;
    (void)read_fields(s, table, &p, fields, (int)(sizeof fields / sizeof *fields));
    place theme = place_key(&p, "theme"), map = place_key(&p, "map"), mode = place_key(&p, "mode");
    out->theme_line = place_line(s, &theme);
    out->map_line = place_line(s, &map);
    out->mode_line = place_line(s, &mode);
    if (fields[3].given) out->ascii = ascii != 0;
    if (fields[4].given) out->mouse = mouse != 0;
    if (fields[5].given) read_colours(s, &p, table, out);
    if (fields[6].given) read_names(s, table, &p, "keys", USER_BINDINGS, out, read_key);
    if (fields[7].given) read_names(s, table, &p, "styles", USER_STYLES, out, read_style);
}

status user_config_load(const char *path, user_config *out, script_reports *reports) {
    reports->count = 0;
    *out = (user_config){.colours = -1, .ascii = -1, .mouse = -1};
    if (access(path, F_OK) != 0) return STATUS_OK;
    snprintf(out->file, sizeof out->file, "%s", path);
    return script_load_file(path, read_config, out, reports);
}
