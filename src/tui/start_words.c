#include "tui/start_words.h"

#include "base/names.h"
#include "script/library.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const int64_t ring_bytes = (int64_t)2 << 30; /* of checkpoints, for rewinding */

static const char *const options_known[] = {"--recipe", "--set",  "--frames", "--threads",          "--precision",
                                            "--simd",   "--keep", "--paused", "--checkpoint-every", "--turn"};

/* Cuts text into words, in place; quotes are taken off. Returns how many. */
static int cut(char *text, char **words) {
    int count = 0;
    char *to = text;
    for (char *from = text; *from && count < START_WORDS;) {
        from += strspn(from, " ");
        if (!*from) break;
        words[count++] = to;
        bool quoted = false;
        for (; *from && (quoted || *from != ' '); from++) {
            if (*from == '\'') quoted = !quoted;
            else *to++ = *from;
        }
        if (*from) from++;
        *to++ = '\0';
    }
    return count;
}

static status refuse(report *r, const char *option, const char *expected, const char *found) {
    return report_input(r, NULL, 0, option, expected, found ? found : "nothing", NULL);
}

static status take_whole(const char *option, const char *word, int64_t low, int64_t *out, report *r) {
    char *end;
    long long value = word ? strtoll(word, &end, 10) : 0;
    if (!word || end == word || *end || value < low) return refuse(r, option, "a whole number", word);
    *out = value;
    return STATUS_OK;
}

static status take_setting(start_words *out, char *word, report *r) {
    char *equals = word ? strchr(word, '=') : NULL;
    if (!equals || equals == word) return refuse(r, "--set", "KEY=VALUE", word);
    if (out->options.script.setting_count == START_WORDS / 2) return refuse(r, "--set", "fewer settings", word);
    *equals = '\0';
    out->settings[out->options.script.setting_count++] = (script_setting){word, equals + 1};
    return STATUS_OK;
}

static status take_turn(start_words *out, const char *word, report *r) {
    char *end = NULL;
    long long frame = word ? strtoll(word, &end, 10) : 0;
    const char *path = end && end != word && *end == ':' ? end + 1 : "", *equals = strchr(path, '=');
    if (!equals || equals == path || equals - path >= KNOB_PATH || strlen(equals + 1) >= KNOB_TEXT)
        return refuse(r, "--turn", "FRAME:PATH=VALUE", word);
    if (out->options.turn_count == START_TURNS_SAID) return refuse(r, "--turn", "fewer turns", word);
    knob_turn *turn = &out->turns[out->options.turn_count++];
    turn->frame = frame;
    snprintf(turn->path, sizeof turn->path, "%.*s", (int)(equals - path), path);
    snprintf(turn->value, sizeof turn->value, "%s", equals + 1);
    return STATUS_OK;
}

/* One option and its word; NULL when there is none. */
static status take_option(start_words *out, const char *option, char *word, report *r) {
    session_options *o = &out->options;
    int64_t value = 0;
    status s = STATUS_OK;
    if (strcmp(option, "--set") == 0) return take_setting(out, word, r);
    if (strcmp(option, "--turn") == 0) return take_turn(out, word, r);
    if (strcmp(option, "--recipe") == 0) o->script.recipe = word;
    else if (strcmp(option, "--simd") == 0) o->simd = word;
    else if (strcmp(option, "--frames") == 0) s = take_whole(option, word, 0, &o->frames, r);
    else if (strcmp(option, "--threads") == 0 && (s = take_whole(option, word, 1, &value, r)) == STATUS_OK) o->threads = (int)value;
    else if (strcmp(option, "--checkpoint-every") == 0 && (s = take_whole(option, word, 0, &value, r)) == STATUS_OK)
        o->checkpoint_every = (int)value;
    else if (strcmp(option, "--keep") == 0) s = take_whole(option, word, 1, &o->keep_bytes, r);
    else if (strcmp(option, "--precision") == 0) {
        if (!word || (strcmp(word, "f32") != 0 && strcmp(word, "f64") != 0)) return refuse(r, option, "f32 or f64", word);
        o->precision = strcmp(word, "f64") == 0 ? 64 : 32;
    }
    if (s == STATUS_OK && !word) return refuse(r, option, "a word after it", NULL);
    return s;
}

static bool is_option(const char *word) {
    for (size_t i = 0; i < sizeof options_known / sizeof *options_known; i++)
        if (strcmp(word, options_known[i]) == 0) return true;
    return false;
}

status start_parse(const char *text, start_words *out, report *r) {
    char *words[START_WORDS];
    const char *path = NULL;
    memset(out, 0, sizeof *out);
    out->options = session_options_default();
    out->options.keep_bytes = ring_bytes;
    out->options.script.settings = out->settings;
    out->options.turns = out->turns;
    if (strlen(text) >= START_TEXT) return refuse(r, "start", "fewer than 1024 characters", "more");
    strcpy(out->text, text);
    int count = cut(out->text, words);
    for (int i = 0; i < count; i++) {
        if (strcmp(words[i], "--paused") == 0) {
            out->options.start_paused = true;
        } else if (is_option(words[i])) {
            status s = take_option(out, words[i], i + 1 < count ? words[i + 1] : NULL, r);
            if (s != STATUS_OK) return s;
            i++;
        } else if (words[i][0] == '-' || path) {
            return report_input(r, NULL, 0, "start", "one scene and options of sunder run", words[i],
                                name_nearest(words[i], options_known, (int)(sizeof options_known / sizeof *options_known)));
        } else {
            path = words[i];
        }
    }
    if (!path) return refuse(r, "start", "a scene", NULL);
    (void)library_find_scene(path, out->scene); /* one that is not there is told by whoever loads it */
    out->options.scene_path = out->scene;
    return STATUS_OK;
}

/* Appends a word, quoted where it must be. */
static void add(char *out, size_t *used, const char *format, const char *a, const char *b) {
    char word[START_TEXT];
    int size = snprintf(word, sizeof word, format, a, b);
    const char *quote = strchr(word, ' ') ? "'" : "";
    if (size >= (int)sizeof word || *used >= START_TEXT) *used = START_TEXT;
    else *used += (size_t)snprintf(out + *used, START_TEXT - *used, "%s%s%s%s", *used ? " " : "", quote, word, quote);
}

bool start_print(const session_options *o, char out[START_TEXT]) {
    size_t used = 0;
    char number[32];
    out[0] = '\0';
    add(out, &used, "%s%s", o->scene_path, "");
    if (o->script.recipe) add(out, &used, "%s%s", "--recipe", ""), add(out, &used, "%s%s", o->script.recipe, "");
    for (int i = 0; i < o->script.setting_count; i++) {
        add(out, &used, "%s%s", "--set", "");
        add(out, &used, "%s=%s", o->script.settings[i].key, o->script.settings[i].value);
    }
    if (o->frames >= 0) {
        snprintf(number, sizeof number, "%lld", (long long)o->frames);
        add(out, &used, "%s%s", "--frames", ""), add(out, &used, "%s%s", number, "");
    }
    if (o->precision == 64) add(out, &used, "%s%s", "--precision", ""), add(out, &used, "%s%s", "f64", "");
    if (o->simd && strcmp(o->simd, "auto") != 0) add(out, &used, "%s%s", "--simd", ""), add(out, &used, "%s%s", o->simd, "");
    for (int i = 0; i < o->turn_count; i++) {
        char turn[KNOB_PATH + KNOB_TEXT + 32];
        snprintf(turn, sizeof turn, "%lld:%s", (long long)o->turns[i].frame, o->turns[i].path);
        add(out, &used, "%s%s", "--turn", ""), add(out, &used, "%s=%s", turn, o->turns[i].value);
    }
    if (o->start_paused) add(out, &used, "%s%s", "--paused", "");
    return used < START_TEXT;
}
