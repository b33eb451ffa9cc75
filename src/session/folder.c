/* What a run's folder keeps of how it came about: the text of every script, the resolved parameters, and the request. */
#include "base/memory.h"
#include "session/internal.h"
#include "session/turns_file.h"

#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#define XXH_INLINE_ALL
#include <xxhash.h>

static void point_settings(run_request *q) {
    for (int i = 0; i < q->setting_count; i++) {
        char *equals = strchr(q->setting_text[i], '=');
        *equals = '\0';
        q->settings[i] = (script_setting){q->setting_text[i], equals + 1};
    }
}

status request_from_options(run_request *q, const session_options *o, report *r) {
    *q = (run_request){.precision = o->precision, .frames = o->frames};
    if (strlen(o->scene_path) >= sizeof q->scene)
        return report_input(r, o->scene_path, 0, NULL, "a path of fewer than 256 characters", "a longer one", NULL);
    snprintf(q->scene, sizeof q->scene, "%s", o->scene_path);
    snprintf(q->recipe, sizeof q->recipe, "%s", o->script.recipe ? o->script.recipe : "");
    snprintf(q->simd, sizeof q->simd, "%s", o->simd ? o->simd : "auto");
    for (int i = 0; i < o->script.setting_count; i++) {
        const script_setting *from = &o->script.settings[i];
        if (i == SESSION_SETTINGS || strlen(from->key) + strlen(from->value) + 2 > sizeof q->setting_text[0])
            return report_input(r, NULL, 0, from->key, "at most 64 settings of under 255 characters", "more", NULL);
        snprintf(q->setting_text[i], sizeof q->setting_text[i], "%.120s=%.120s", from->key, from->value);
        q->setting_count++;
    }
    point_settings(q);
    return STATUS_OK;
}

void request_to_options(const run_request *q, session_options *out) {
    out->scene_path = q->scene;
    out->simd = q->simd;
    out->precision = q->precision;
    out->frames = q->frames;
    out->script.recipe = q->recipe[0] ? q->recipe : NULL;
    out->script.settings = q->settings;
    out->script.setting_count = q->setting_count;
}

status request_write(const session *s, report *r) {
    const run_request *q = &s->request;
    char path[SESSION_PATH + 32], *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    if (!out) return report_set(r, STATUS_SYSTEM, "out of memory for the run's request");
    fprintf(out, "scene %s\nprecision %d\nsimd %s\nframes %" PRId64 "\n", script_source_at(s->script, 0).name, q->precision,
            simulation_get_plan(s->simulation)->simd, s->target);
    if (q->recipe[0]) fprintf(out, "recipe %s\n", q->recipe);
    for (int i = 0; i < q->setting_count; i++) fprintf(out, "set %s=%s\n", q->settings[i].key, q->settings[i].value);
    status code = fclose(out) ? report_set(r, STATUS_SYSTEM, "out of memory for the run's request") : STATUS_OK;
    snprintf(path, sizeof path, "%s/scene/request", s->folder);
    if (code == STATUS_OK) code = file_write_atomic(path, text, size, r);
    free(text);
    return code;
}

static void read_line(run_request *q, char *line, const char *folder) {
    line[strcspn(line, "\n")] = '\0';
    char *value = strchr(line, ' ');
    if (!value) return;
    *value++ = '\0';
    if (strcmp(line, "scene") == 0) snprintf(q->scene, sizeof q->scene, "%.180s/scene/%.60s", folder, value);
    if (strcmp(line, "recipe") == 0) snprintf(q->recipe, sizeof q->recipe, "%s", value);
    if (strcmp(line, "simd") == 0) snprintf(q->simd, sizeof q->simd, "%s", value);
    if (strcmp(line, "precision") == 0) q->precision = atoi(value);
    if (strcmp(line, "frames") == 0) q->frames = atoll(value);
    if (strcmp(line, "set") == 0 && q->setting_count < SESSION_SETTINGS && strchr(value, '='))
        snprintf(q->setting_text[q->setting_count++], sizeof q->setting_text[0], "%s", value);
}

status request_read(run_request *q, const char *folder, report *r) {
    char path[SESSION_PATH + 32], line[512];
    snprintf(path, sizeof path, "%s/scene/request", folder);
    *q = (run_request){.precision = 32, .frames = -1};
    FILE *in = fopen(path, "r");
    if (!in) return report_input(r, path, 0, "resume", "the folder of a run of sunder", strerror(errno), NULL);
    while (fgets(line, sizeof line, in)) read_line(q, line, folder);
    fclose(in);
    point_settings(q);
    if (!q->scene[0]) return report_input(r, path, 0, "scene", "the name of the run's scene", "nothing", NULL);
    return STATUS_OK;
}

static void log_turns(session *s) {
    const session_knobs_state *k = &s->knobs;
    report r;
    ledger_turn *rows = memory_allocate_array((size_t)k->count + 1, sizeof *rows);
    for (int i = 0; rows && i < k->count; i++) rows[i] = (ledger_turn){k->turns[i].frame, k->turns[i].path, k->turns[i].value};
    pthread_mutex_lock(&s->ledger_lock);
    status code = rows ? ledger_turns(s->ledger, s->id, rows, k->count, &r) : report_set(&r, STATUS_SYSTEM, "out of memory for the turns of knobs");
    pthread_mutex_unlock(&s->ledger_lock);
    session_tolerate(s, code, &r);
    memory_free(rows, ((size_t)k->count + 1) * sizeof *rows);
}

status turns_write(session *s, report *r) {
    char path[SESSION_PATH + 32], *text;
    size_t size;
    status code = turns_format(s->knobs.turns, s->knobs.count, &text, &size, r);
    if (code != STATUS_OK) return code;
    snprintf(path, sizeof path, "%s/turns.json", s->folder);
    code = file_write_atomic(path, text, size, r);
    memory_free(text, size + 1);
    if (code == STATUS_OK) log_turns(s);
    return code;
}

/* Makes the folders of a relative name such as "recipes/tube.lua" under base. */
static status make_parents(const char *base, const char *name, report *r) {
    char path[SESSION_PATH + 300];
    for (const char *slash = strchr(name, '/'); slash; slash = strchr(slash + 1, '/')) {
        snprintf(path, sizeof path, "%s/%.*s", base, (int)(slash - name), name);
        if (mkdir(path, 0777) && errno != EEXIST) return report_set(r, STATUS_SYSTEM, "%s: %s", path, strerror(errno));
    }
    return STATUS_OK;
}

status sources_write(const session *s, report *r) {
    char base[SESSION_PATH + 16], path[SESSION_PATH + 300];
    snprintf(base, sizeof base, "%s/scene", s->folder);
    for (int i = 0; i < script_source_count(s->script); i++) {
        script_source source = script_source_at(s->script, i);
        status code = make_parents(base, source.name, r);
        snprintf(path, sizeof path, "%s/%s", base, source.name);
        if (code == STATUS_OK) code = file_write_atomic(path, source.text, source.size, r);
        if (code != STATUS_OK) return code;
    }
    const char *resolved = script_resolved(s->script);
    snprintf(path, sizeof path, "%s/resolved.lua", base);
    return file_write_atomic(path, resolved, strlen(resolved), r);
}

void sources_hash(const script *from, char hash[32]) {
    uint64_t sum = 0;
    for (int i = 0; i < script_source_count(from); i++) {
        script_source source = script_source_at(from, i);
        sum = XXH3_64bits_withSeed(source.text, source.size, sum);
    }
    const char *resolved = script_resolved((script *)from);
    sum = XXH3_64bits_withSeed(resolved, strlen(resolved), sum);
    snprintf(hash, 32, "%016" PRIx64, sum);
}
