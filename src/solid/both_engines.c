/* What the engine of particles and that of tetrahedra do alike. */
#include "solid/state.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>

#define ADDRESS(name) &SOLID_EFFECT(name),
const effect *const solid_effects[SOLID_EFFECTS] = {SOLID_EFFECT_LIST(ADDRESS)};

void solid_define(solid *s, const solid_definition *definition) {
    s->definition = *definition;
    s->effects = solid_effects;
    s->effect_count = SOLID_EFFECTS;
    s->mask = definition->effect_mask;
    s->threads = definition->threads > 0 ? definition->threads : 1;
    s->count = definition->count;
}

void solid_constants_refresh(solid *s) {
    s->implicit_tolerance = s->constraint.tolerance = 1;
    for (int m = 0; m < s->definition.material_count; m++) {
        const solid_material *material = &s->definition.materials[m];
        s->material_mask[m] = 0;
        for (int e = 0; e < s->effect_count; e++) {
            if (!material->effects[e].on || !(s->mask >> e & 1)) continue;
            s->material_mask[m] |= 1u << e;
            if (solid_effects[e]->stages->constants)
                solid_effects[e]->stages->constants(material->effects, &s->definition, material->protects, s->constants[m][e]);
            if (solid_effects[e]->stages->declare) solid_effects[e]->stages->declare(s, m, material->effects);
        }
        s->explicit_on |= s->material_damaged[m] && !s->material_implicit[m];
    }
}

solid_boundary *solid_boundaries(solid *s) {
    return s->definition.boundaries;
}

void solid_limits(const solid *s, double *limit) {
    for (int e = 0; e < s->effect_count; e++) limit[e] = s->limits[e] > 0 ? 1 / s->limits[e] : HUGE_VAL;
}

void solid_surround(solid *s, const double gravity[3], double damping) {
    memcpy(s->definition.gravity, gravity, sizeof s->definition.gravity);
    s->definition.damping = damping;
}

void solid_phases(const solid *s, double seconds[SOLID_PHASES]) {
    memcpy(seconds, s->seconds, sizeof s->seconds);
}

int solid_stage_names(const stage_place *places, int place_count, uint32_t mask, char (*text)[48], int limit) {
    int count = 0;
    for (int i = 0; i < place_count; i++) {
        if (places[i].pass && count < limit) snprintf(text[count++], sizeof text[0], "%s", places[i].pass);
        for (int e = 0; e < SOLID_EFFECTS; e++) {
            void (*stage)(void);
            memcpy(&stage, (const char *)solid_effects[e]->stages + places[i].offset, sizeof stage);
            if ((mask >> e & 1) && stage && count < limit)
                snprintf(text[count++], sizeof text[0], "%s.%s", solid_effects[e]->name, places[i].name);
        }
    }
    return count;
}
