#include "session/internal.h"

status session_save_recipe(session *s, int material, const char *path, report *r) {
    (void)s, (void)material;
    return report_set(r, STATUS_INPUT, "%s: recipes cannot be saved yet", path);
}
