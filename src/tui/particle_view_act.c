/* What a camera's keys do, for every screen that has a picture. */
#include "tui/particle_view.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const float turn = 0.1309f; /* rad a key press: 7.5° */
static const float pan = 0.125f;   /* of the picture's half-height */

/* What a verb does by one press: angles, a factor, a shift, a share of the box. */
typedef struct motion {
    const char *verb;
    float yaw, pitch, zoom, right, up, cut;
} motion;

static const motion motions[] = {
    {"turn-left", -turn, 0, 1, 0, 0, 0},  {"turn-right", turn, 0, 1, 0, 0, 0}, {"tilt-up", 0, turn, 1, 0, 0, 0},
    {"tilt-down", 0, -turn, 1, 0, 0, 0},  {"zoom-in", 0, 0, 1.25f, 0, 0, 0},   {"zoom-out", 0, 0, 0.8f, 0, 0, 0},
    {"pan-left", 0, 0, 1, -pan, 0, 0},    {"pan-right", 0, 0, 1, pan, 0, 0},   {"pan-up", 0, 0, 1, 0, pan, 0},
    {"pan-down", 0, 0, 1, 0, -pan, 0},    {"cut-in", 0, 0, 1, 0, 0, -0.04f},   {"cut-out", 0, 0, 1, 0, 0, 0.04f},
};

static status look(particle_view *view, const char *from, char text[96], report *r) {
    static const struct {
        const char *name;
        float yaw, pitch;
    } places[] = {{"corner", 0.52f, 0.38f}, {"front", 0, 0}, {"side", 1.5708f, 0}, {"top", 0, 1.5708f}};
    enum { PLACES = sizeof places / sizeof *places };
    int next = 0;
    for (int i = 0; i < PLACES; i++) {
        bool here = fabsf(view->camera.yaw - places[i].yaw) < 1e-3f && fabsf(view->camera.pitch - places[i].pitch) < 1e-3f;
        if (from[0] ? strcmp(from, places[i].name) == 0 : here) next = from[0] ? i + 1 : (i + 1) % PLACES + 1;
    }
    if (next == 0 && from[0]) return report_input(r, NULL, 0, "look", "corner, front, side or top", from, NULL);
    if (next == 0) next = 1;
    view->camera.yaw = places[next - 1].yaw;
    view->camera.pitch = places[next - 1].pitch;
    snprintf(text, 96, "Seen from the %s.", places[next - 1].name);
    return STATUS_OK;
}

static status cut(particle_view *view, const char *axis, char text[96], report *r) {
    int next = axis[0] ? view_cut_find(axis) : ((int)view->camera.cut.axis + 1) % VIEW_CUT_AXES;
    if (next < 0) return report_input(r, NULL, 0, "cut", "x, y, z or off", axis, NULL);
    view_camera_cut(&view->camera, (view_cut_axis)next);
    if (next == VIEW_CUT_NONE) snprintf(text, 96, "Not cut.");
    else snprintf(text, 96, "Cut across %s; ( and ) move the cut, X takes the other side.", view_cut_name((view_cut_axis)next));
    return STATUS_OK;
}

static status scale(particle_view *view, const char *range, char text[96], report *r) {
    double low, high;
    char rest;
    if (!range[0] || strcmp(range, "auto") == 0) {
        view->scale_is_set = false;
        view->scaled[0] = '\0';
        snprintf(text, 96, "Colours run over what is there.");
        return STATUS_OK;
    }
    if (sscanf(range, "%lf %lf %c", &low, &high, &rest) != 2 || !isfinite(low) || !isfinite(high) || !(high > low))
        return report_input(r, NULL, 0, "scale", "two numbers, the lower first, or auto", range, NULL);
    view->scale = (view_scale){low, high};
    view->scale_is_set = true;
    snprintf(text, 96, "Colours run from %.4g to %.4g.", low, high);
    return STATUS_OK;
}

status particle_view_act(particle_view *view, const char *verb, const char *argument, char text[96], report *r) {
    text[0] = '\0';
    if (!argument) argument = "";
    view->old = true;
    for (size_t i = 0; i < sizeof motions / sizeof *motions; i++) {
        const motion *m = &motions[i];
        if (strcmp(verb, m->verb) != 0) continue;
        view_camera_orbit(&view->camera, m->yaw, m->pitch);
        view_camera_zoom(&view->camera, m->zoom);
        view_camera_pan(&view->camera, m->right, m->up);
        if (m->cut != 0 && view->camera.cut.axis == VIEW_CUT_NONE) snprintf(text, 96, "Nothing is cut; x cuts.");
        view_camera_move_cut(&view->camera, m->cut);
        return STATUS_OK;
    }
    if (strcmp(verb, "look") == 0) return look(view, argument, text, r);
    if (strcmp(verb, "cut") == 0) return cut(view, argument, text, r);
    if (strcmp(verb, "scale") == 0) return scale(view, argument, text, r);
    if (strcmp(verb, "cut-flip") == 0) {
        view->camera.cut.flipped = !view->camera.cut.flipped;
        snprintf(text, 96, view->camera.cut.axis == VIEW_CUT_NONE ? "Nothing is cut; x cuts." : "The other side.");
        return STATUS_OK;
    }
    if (strcmp(verb, "reset") == 0) {
        view->camera = view_camera_default();
        if (view->fitted) particle_view_face(view);
        return STATUS_OK;
    }
    return report_input(r, NULL, 0, "view", "something that a camera does", verb, NULL);
}
