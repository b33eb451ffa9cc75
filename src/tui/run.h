/* The Run screen's own state. */
#ifndef SUNDER_TUI_RUN_H
#define SUNDER_TUI_RUN_H

#include "tui/app.h"
#include "view/camera.h"
#include "view/raster.h"

typedef struct run_state {
    bool log_histogram;
    bool spinning;    /* the camera turns by itself */
    double last_turn; /* of the spinning camera, s of app_clock */

    view_camera camera;
    float fit_minimum[3], fit_maximum[3]; /* the box that the camera fits; grows with the material, never shrinks */
    bool fitted;                          /* the box is that of a snapshot */
    float radius;                         /* length; drawn size of a particle */
    view_mode mode;
    view_canvas canvas;
    view_cell *cells; /* [cell_capacity], those of the last picture in rows of cells_width */
    size_t cell_capacity;
    int cells_width, cells_height;
    bool picture_old; /* the picture no longer shows the snapshot, the camera or the mode */
} run_state;

#endif
