/* The user's own settings of the workbench: a Lua file that returns a table, run in the scenes' sandbox.
 *
 *   return {
 *     theme = "light",              -- dark, light, colour-blind
 *     colours = "true",             -- 0, 8, 16, 256, or "true" for true colour
 *     map = "civic",                -- of values: ember, lagoon, civic, ink
 *     mode = "blocks",              -- particles as braille, blocks or ascii
 *     ascii = false,
 *     mouse = false,
 *     keys = { ["ctrl-p"] = "run.pause", F9 = "theme light", g = false },
 *     styles = { good = 114, bad = "#ff4040" },
 *   } */
#ifndef SUNDER_SCRIPT_USER_CONFIG_H
#define SUNDER_SCRIPT_USER_CONFIG_H

#include "script/script.h"

enum { USER_BINDINGS = 128, USER_STYLES = 32, USER_TEXT = 128 };

typedef struct user_binding {
    char key[32], action[USER_TEXT]; /* "ctrl-p", "theme light"; "" takes the key's meaning away */
    int line;
} user_binding;

typedef struct user_style {
    char name[32];
    int colour; /* 0–255 of the terminal's, or 0x1000000 + rgb */
    int line;
} user_style;

typedef struct user_config {
    char file[512]; /* where it was read, "" when there is none */
    char theme[USER_TEXT], map[USER_TEXT], mode[USER_TEXT]; /* "" when not said */
    int theme_line, map_line, mode_line;
    int colours; /* −1: not said; 1 << 24: true colour */
    int ascii, mouse; /* −1: not said */
    int binding_count, style_count;
    user_binding bindings[USER_BINDINGS];
    user_style styles[USER_STYLES];
} user_config;

/* $XDG_CONFIG_HOME/sunder/config.lua, else ~/.config/sunder/config.lua. False when there is neither variable. */
bool user_config_path(char path[512]);

/* Reads a file. One that is not there is an empty config. Otherwise as script_load; what was right before the first mistake
 * is in `out` all the same. */
status user_config_load(const char *path, user_config *out, script_reports *reports);

#endif
