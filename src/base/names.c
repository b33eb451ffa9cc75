#include "base/names.h"

#include <ctype.h>
#include <string.h>

enum { NAME_LIMIT = 63 };

static double least(double a, double b) {
    return a < b ? a : b;
}

static double replacement_cost(char a, char b) {
    if (a == b) return 0.0;
    return tolower((unsigned char)a) == tolower((unsigned char)b) ? 0.5 : 1.0;
}

/* Optimal string alignment (Damerau–Levenshtein without repeated swaps), row by row. */
double name_distance(const char *a, const char *b) {
    size_t na = strlen(a), nb = strlen(b);
    if (na > NAME_LIMIT) na = NAME_LIMIT;
    if (nb > NAME_LIMIT) nb = NAME_LIMIT;
    double rows[3][NAME_LIMIT + 1];
    for (size_t j = 0; j <= nb; j++) rows[0][j] = (double)j;
    for (size_t i = 1; i <= na; i++) {
        double *row = rows[i % 3];
        const double *above = rows[(i + 2) % 3], *above2 = rows[(i + 1) % 3];
        row[0] = (double)i;
        for (size_t j = 1; j <= nb; j++) {
            row[j] = least(least(above[j], row[j - 1]) + 1.0, above[j - 1] + replacement_cost(a[i - 1], b[j - 1]));
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) row[j] = least(row[j], above2[j - 2] + 1.0);
        }
    }
    return rows[na % 3][nb];
}

const char *name_nearest(const char *name, const char *const *candidates, int count) {
    const char *best = NULL;
    double best_distance = 1.0 + (double)strlen(name) / 3.0;
    for (int i = 0; i < count; i++) {
        if (!candidates[i]) continue;
        double distance = name_distance(name, candidates[i]);
        if (distance < best_distance) best_distance = distance, best = candidates[i];
    }
    return best;
}
