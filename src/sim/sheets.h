/* From a scene's sheets to arrays of particles, notches and sources. */
#ifndef SUNDER_SIM_SHEETS_H
#define SUNDER_SIM_SHEETS_H

#include "sheet/sheet.h"
#include "sim/scene.h"

/* Particles of all sheets, in the order of sheets and of sampling; the index is the particle's id for ever. */
typedef struct sheet_particles {
    int64_t count;
    double spacing;                     /* of the first sheet */
    double *rest, *position, *velocity; // [count][3]
    double *area;                       // [count]
    double *grain;                      // [count][3], NULL when no sheet has one
    uint8_t *protected, *sheet;         // [count]
    int body_count, notch_count, source_count;
    sheet_body bodies[SCENE_SHEETS];
    sheet_notch notches[SHEET_NOTCHES];
    sheet_source sources[SHEET_SOURCES]; /* with arrays of their own */
} sheet_particles;

/* Samples everything. Errors: a sheet without particles, a grain that is zero, too many notches or sources, memory. */
status sheets_sample(const scene *s, sheet_particles *out, report *r);
void sheets_free(sheet_particles *p);

#endif
