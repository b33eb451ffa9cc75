/* Scenes written to a temporary folder, loaded, and looked into: for the tests of the script floor. */
#ifndef SUNDER_TESTS_SCRIPT_FILES_H
#define SUNDER_TESTS_SCRIPT_FILES_H

#include "script/script.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static char folder[64];
static char scene_path[128];
static script_reports reports;

static inline void files_open(void) {
    snprintf(folder, sizeof folder, "/tmp/sunder-script-XXXXXX");
    if (!mkdtemp(folder)) exit(1);
    snprintf(scene_path, sizeof scene_path, "%s/scene.lua", folder);
}

static inline void files_write(const char *name, const char *text) {
    char path[192];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    char *slash = strrchr(path + strlen(folder) + 1, '/');
    if (slash) {
        *slash = '\0';
        mkdir(path, 0755);
        *slash = '/';
    }
    FILE *f = fopen(path, "w");
    if (!f || fputs(text, f) < 0 || fclose(f) != 0) exit(1);
}

static inline void files_close(void) {
    char command[128];
    snprintf(command, sizeof command, "rm -r %s", folder);
    if (system(command) != 0) exit(1);
}

/* Loads `text` as a scene with settings given as "key=value" pairs, NULL-terminated. NULL on failure, with `reports`.
 */
static inline script *load_with(const char *text, const script_options *base, const char *const *pairs) {
    static char keys[16][128];
    script_setting settings[16];
    script_options o = *base;
    files_write("scene.lua", text);
    for (o.setting_count = 0; pairs && pairs[o.setting_count]; o.setting_count++) {
        snprintf(keys[o.setting_count], sizeof keys[0], "%s", pairs[o.setting_count]);
        char *equals = strchr(keys[o.setting_count], '=');
        *equals = '\0';
        settings[o.setting_count] = (script_setting){keys[o.setting_count], equals + 1};
    }
    o.settings = settings;
    script *s;
    script_load(scene_path, &o, &s, &reports);
    return s;
}

static inline script *load_set(const char *text, const char *const *pairs) {
    script_options o = script_options_default();
    return load_with(text, &o, pairs);
}

static inline script *load(const char *text) {
    return load_set(text, NULL);
}

/* What the first report says, or "". */
static inline const char *complaint(void) {
    static char text[1500];
    text[0] = '\0';
    if (reports.count > 0) report_format(&reports.items[0], text, sizeof text);
    return text;
}

static inline bool complains(const char *words) {
    bool found = strstr(complaint(), words) != NULL;
    if (!found) printf("  said: %s\n", complaint());
    return found;
}

/* A resolved parameter by name, or NULL. */
static inline const scene_parameter *parameter_named(script *s, const char *name) {
    const scene *sc = script_scene(s);
    for (int i = 0; i < sc->parameter_count; i++)
        if (strcmp(sc->parameters[i].name, name) == 0) return &sc->parameters[i];
    return NULL;
}

/* A material's (or, −1, the scene's) value of effect.key. */
static inline double knob_value(script *s, int material, const char *effect_name, const char *key) {
    const scene *sc = script_scene(s);
    int count, e = effect_index(effect_name);
    const effect_values *all = material < 0 ? sc->effects : sc->materials[material].effects;
    return all[e].value[effect_parameter(effect_catalogue(&count)[e], key)][0];
}

static inline bool effect_is_on(script *s, int material, const char *effect_name) {
    return script_scene(s)->materials[material].effects[effect_index(effect_name)].on;
}

#endif
