#include "sim/sources.h"

#include "base/random.h"
#include "geom/vector.h"

#include <math.h>

enum { STREAM_SPOTS = 0x5c11 };

/* Random places are particles of the body: spots lie in it whatever its shape. */
static bool in_spots(const scene *s, const scene_source *from, int stream, const double *place, int64_t count, int64_t i) {
    for (int k = 0; k < from->spots; k++) {
        int64_t pick = (int64_t)(random_unit(s->seed, STREAM_SPOTS + (uint64_t)stream, (uint64_t)k) * (double)count);
        double difference[3];
        vector_subtract(place + 3 * i, place + 3 * pick, difference);
        if (vector_dot(difference, difference) <= from->radius * from->radius) return true;
    }
    return false;
}

status source_evaluate(const scene *s, const scene_source *from, int stream, const char *owner, const double *place, int64_t count, double *value,
                       report *r) {
    int64_t reached = 0;
    for (int64_t i = 0; i < count; i++) {
        value[i] = NAN;
        if (from->shape && shape_distance(from->shape, place + 3 * i) >= 0) continue;
        if (from->spots && !in_spots(s, from, stream, place, count, i)) continue;
        double given;
        status code = scene_function_evaluate(&from->value, place + 3 * i, 3, &given, r);
        if (code != STATUS_OK) return code;
        if (given == 0 && !from->fixed) continue;
        value[i] = given;
        reached++;
    }
    return reached > 0 ? STATUS_OK : report_input(r, s->file, 0, "sources", "a source that reaches a particle of its body", owner, NULL);
}
