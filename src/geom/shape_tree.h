/* The nodes of a shape's tree: private to the shape_*.c files. */
#ifndef SUNDER_GEOM_SHAPE_TREE_H
#define SUNDER_GEOM_SHAPE_TREE_H

#include "geom/mesh_solid.h"
#include "geom/shape.h"

typedef enum shape_kind {
    SHAPE_SPHERE,
    SHAPE_BOX,
    SHAPE_TUBE, /* cylinders too: a tube without a hole */
    SHAPE_CAPSULE,
    SHAPE_TORUS,
    SHAPE_HALF_SPACE,
    SHAPE_MESH,
    SHAPE_UNION,
    SHAPE_INTERSECTION,
    SHAPE_DIFFERENCE, /* the base is the first child, the cuts follow */
    SHAPE_TRANSFORM,
} shape_kind;

/* A solid of revolution whose half-plane section is a trapezoid with its parallel sides across the axis. */
typedef struct shape_tube_data {
    double center[3], axis[3];
    double outer, inner, length, taper;
    /* The section's corners (axial, radial), counter-clockwise. Without a hole the section runs through the axis to its
     * mirror image, because the axis is then no surface. */
    double section[4][2];
} shape_tube_data;

struct shape {
    shape_kind kind;
    int depth;              /* 1 for primitives */
    int count;              /* children */
    const shape **children; /* [count] */
    union {
        struct {
            double center[3], radius;
        } sphere;
        struct {
            double center[3], half[3];
        } box;
        shape_tube_data tube;
        struct {
            double from[3], along[3]; /* along = to − from */
            double radius;
        } capsule;
        struct {
            double center[3], axis[3];
            double major, minor;
        } torus;
        struct {
            double point[3], normal[3];
        } half_space;
        struct {
            const mesh_solid *solid;
            const char *name;
        } mesh;
        struct {
            double rotation[9], scale, translation[3];
        } transform;
    };
};

#endif
