/* Frames and meshes as other programs read them. Every file is written whole or not at all.
 *
 *   .ply   points or a mesh with quantities, binary (Greg Turk's format 1.0): Blender, Houdini, MeshLab, CloudCompare
 *   .obj   points or a mesh, text: everything
 *   .stl   a mesh, binary: printing, CAD
 *   .vtp   points with quantities (VTK XML PolyData, appended raw): ParaView, VisIt; with a .pvd that lists a sequence with its times
 *   .usda  a whole sequence in one text file (UsdGeomPoints with time samples): Houdini, Blender, Maya, Omniverse
 *   .csv   points with quantities, or a run's measures, text: tables, pandas, R */
#ifndef SUNDER_STORE_EXPORT_H
#define SUNDER_STORE_EXPORT_H

#include "base/record.h"
#include "base/status.h"

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

/* A frame's particles: the records of one set ("solid" or "sheet") whose rows are particles. */
typedef struct export_points {
    const record_list *records;
    const char *set;
    int64_t frame;
    double time;
} export_points;

/* Which set of a frame holds its particles: "solid" or "sheet"; NULL when there is none. */
const char *export_set(const record_list *records);

/* Writes a frame's particles; the format is the path's suffix (.ply, .obj, .vtp or .csv). STATUS_INPUT for another suffix. */
status export_points_write(const char *path, const export_points *points, report *r);

/* The path of one frame of a sequence: NAME.ply becomes NAME.000012.ply; path [1024]. STATUS_INPUT when it does not fit. */
status export_sequence_path(const char *out, int64_t frame, char path[1024], report *r);

/* A triangle mesh with a quantity at its vertices. */
typedef struct export_mesh {
    int64_t vertex_count, triangle_count;
    const float *vertex;     /* [vertex_count][3] */
    const float *value;      /* [vertex_count], or NULL */
    const char *value_name;  /* "damage" */
    const int32_t *triangle; /* [triangle_count][3] */
} export_mesh;

/* Writes a mesh; the format is the path's suffix (.ply, .obj or .stl). Only .ply carries the quantity. */
status export_mesh_write(const char *path, const export_mesh *mesh, report *r);

/* A sequence as .pvd: names [count] of the files beside it, and their times. */
status export_pvd_write(const char *path, const char *const *names, const double *times, int count, report *r);

/* A sequence as .usda: `read` gives frame `index`'s records (cleared by the callee here), called once for each array and frame.
 * Time codes are frame numbers; `rate` of them are a second. */
typedef status (*export_reader)(void *context, int index, record_list *records, int64_t *frame, report *r);
status export_usda_write(const char *path, int count, double rate, export_reader read, void *context, report *r);

#endif
