/* Where the time of steps goes. */
#include "sim/internal.h"

#include <stdio.h>
#include <string.h>

typedef struct effort_list {
    simulation_effort *items;
    int count, limit;
} effort_list;

static void add(effort_list *list, const char *name, double seconds, bool part) {
    if (list->count < list->limit) {
        simulation_effort *to = &list->items[list->count];
        *to = (simulation_effort){.seconds = seconds, .part = part};
        snprintf(to->name, sizeof to->name, "%s", name);
    }
    list->count++;
}

static void add_solid(const simulation *s, effort_list *list) {
    double phase[SOLID_PHASES], own[SOLID_PHASES][EFFECT_LIMIT] = {{0}};
    s->engine->phases(s->solid, phase);
    if (s->engine->effort) s->engine->effort(s->solid, own);
    for (int p = 0; p < SOLID_PHASES; p++) {
        if (!s->engine->phase_names[p]) continue;
        add(list, s->engine->phase_names[p], phase[p], false);
        for (int e = 0; e < s->engine->effect_count; e++)
            if (own[p][e] > 0) add(list, s->engine->effects[e]->name, own[p][e], true);
    }
}

int simulation_efforts(const simulation *s, simulation_effort *out, int limit) {
    static const char *const of_sheets[SHEET_PHASES] = {
        [SHEET_PHASE_BONDS] = "bonds", [SHEET_PHASE_DIFFUSION] = "diffusion", [SHEET_PHASE_CONTACT] = "bending, contact", [SHEET_PHASE_ADVANCE] = "advance"};
    effort_list list = {out, 0, limit};
    if (s->solid) add_solid(s, &list);
    if (s->sheet) {
        double phase[SHEET_PHASES];
        s->sheets->phases(s->sheet, phase);
        for (int p = 0; p < SHEET_PHASES; p++) add(&list, of_sheets[p], phase[p], false);
    }
    if (s->contact) add(&list, "sheets on solids", s->contact_seconds, false);
    return list.count;
}
