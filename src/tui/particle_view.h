/* A picture of particles in a rectangle of the screen: camera, cut, colours, and the legend below it. The Run screen has one, Compare
 * two; whoever draws says whose particles they are. */
#ifndef SUNDER_TUI_PARTICLE_VIEW_H
#define SUNDER_TUI_PARTICLE_VIEW_H

#include "tui/draw.h"
#include "tui/theme.h"
#include "view/camera.h"
#include "view/raster.h"
#include "view/scale.h"

/* What is to be drawn; all of it is the caller's. */
typedef struct particle_points {
    const float *position; /* [count][3] */
    const float *scalar;   /* [count]; NULL: one colour */
    int64_t count;
    const char *name, *unit; /* of the scalar */
    view_scale natural;      /* the scale that whoever draws wants, such as damage's 0 to 1; empty: as the values are */
} particle_points;

typedef struct particle_view {
    view_camera camera;
    float fit_minimum[3], fit_maximum[3]; /* the box that the camera fits; grows with the material, never shrinks */
    float first_minimum[3], first_maximum[3];
    bool fitted;
    float radius; /* length; drawn size of a particle */
    view_mode mode;
    view_scale scale;   /* what the colours stand for */
    bool scale_is_set;  /* by the user; else it grows with the values */
    char scaled[32];    /* the scalar's name that the scale is for */
    view_canvas canvas;
    view_cell *cells;   /* [cell_capacity], those of the last picture in rows of cells_width */
    size_t cell_capacity;
    int cells_width, cells_height;
    float *value;       /* [value_capacity] scalars on the scale */
    size_t value_capacity;
    bool old;           /* the picture no longer shows the particles or the camera */
} particle_view;

/* The default camera, and the mode given. */
void particle_view_open(particle_view *view, view_mode mode);
void particle_view_close(particle_view *view);

/* New particles: the box grows with them, and the scale. The first call's bounds, of the first frame, are the box's base. */
void particle_view_follow(particle_view *view, const particle_points *points, const float minimum[3], const float maximum[3]);

/* Turns a camera that is as it was at the start to where such a body is best seen from, and fits it. */
void particle_view_face(particle_view *view);

/* Forgets box and scale: the next particles are another run's. */
void particle_view_forget(particle_view *view);

/* Takes camera, mode, box and scale from another view, so that two pictures can be compared. */
void particle_view_match(particle_view *view, const particle_view *with);

/* Draws the particles, a legend and the camera's figures. Two rows at the bottom are for these where there are more than six. */
void particle_view_draw(particle_view *view, tui_theme *theme, tui_area area, const particle_points *points);

/* What a camera action does, by its verb: "turn-left", "turn-right", "tilt-up", "tilt-down", "zoom-in", "zoom-out", "pan-left" …,
 * "reset", "look" (argument: front, side, top, corner), "cut" (x, y, z, off; NULL: the next), "cut-in", "cut-out", "cut-flip", "scale"
 * ("LOW HIGH" or "auto"). What it did is put into text. Errors: STATUS_INPUT for an argument that it does not know. */
status particle_view_act(particle_view *view, const char *verb, const char *argument, char text[96], report *r);

#endif
