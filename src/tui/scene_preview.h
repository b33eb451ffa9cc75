/* What a scene contains, which effects it will use and what it will cost, found out on a thread of its own. */
#ifndef SUNDER_TUI_SCENE_PREVIEW_H
#define SUNDER_TUI_SCENE_PREVIEW_H

#include "base/status.h"
#include "tui/start_words.h"

#include <stdbool.h>
#include <stdint.h>

enum { PREVIEW_PARTS = 24, PREVIEW_PARAMETERS = 24, PREVIEW_CHOICES = 10, PREVIEW_EFFECTS = 40 };

typedef struct preview_parameter {
    char name[64], value[64], unit[48], doc[128];
    char choices[PREVIEW_CHOICES][32];
    int choice_count;
    bool from_set;
} preview_parameter;

typedef struct preview_facts {
    uint64_t version;             /* grows with each publication */
    char words[START_TEXT];       /* what was looked at, as start_print gives it */
    bool loaded, planned, failed; /* the file is understood; the plan is made and timed; `message` tells why not */
    char message[1024];
    char title[128], units[64];
    char parts[PREVIEW_PARTS][160]; /* bodies and sheets */
    int part_count;
    preview_parameter parameters[PREVIEW_PARAMETERS]; /* what its s.params declared */
    int parameter_count;
    char effects[PREVIEW_EFFECTS][32];
    int effect_count;
    int64_t frames, particles; /* particles: wanted, until planned */
    double duration, dx, spacing, dt, bytes_per_particle, seconds_per_step, steps, seconds;
    int threads;
    bool fixed_dt;
} preview_facts;

typedef struct scene_preview scene_preview;

/* Errors: memory, no thread. */
status preview_open(scene_preview **out, report *r);

/* Waits for what is being looked at. */
void preview_close(scene_preview *p);

/* Looks at a scene; what was asked for before and not begun yet is given up. plan: make the plan and time some steps of it, too. */
void preview_ask(scene_preview *p, const char *words, bool plan);

/* Copies what is known by now when its version is another; returns whether it did. */
bool preview_poll(scene_preview *p, preview_facts *out);

/* Whether something is being looked at. */
bool preview_busy(scene_preview *p);

#endif
