#include "session/internal.h"

#include <stdio.h>
#include <string.h>

int session_colours(session *s, char (*names)[32], int limit) {
    if (limit > 0) snprintf(names[0], sizeof names[0], "%s", simulation_picture_field(s->simulation));
    return 1;
}

status session_colour(session *s, const char *name, report *r) {
    const char *only = simulation_picture_field(s->simulation);
    if (strcmp(name, only) == 0) return STATUS_OK;
    return report_input(r, NULL, 0, "colour", "a field of this run", name, only);
}
