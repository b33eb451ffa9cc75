/* The plain keys of a scene: one row each, read by the scene's table, s.params and --set alike. */
#include "script/internal.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

typedef enum storage { STORE_DOUBLE, STORE_INT64, STORE_UINT64, STORE_TRANSFER, STORE_KERNEL, STORE_TEXT } storage;

typedef struct scene_key {
    const char *name, *unit, *doc;
    storage storage;
    size_t offset, size; /* in struct scene; size of texts */
    plain_rule rule;
} scene_key;

static const char *const transfers[] = {"apic", "rpic", "pic", "flip", NULL};
static const char *const kernels[] = {"quadratic", "cubic", NULL};
_Static_assert(TRANSFER_APIC == 0 && TRANSFER_RPIC == 1 && TRANSFER_PIC == 2 && TRANSFER_FLIP == 3,
               "order of `transfers`");
_Static_assert(KERNEL_QUADRATIC == 0 && KERNEL_CUBIC == 1, "order of `kernels`");

#define AT(member) offsetof(scene, member), sizeof((scene *)0)->member
#define NUMBER .kind = PLAIN_NUMBER

static const scene_key keys[] = {
    {"cfl",
     "1",
     "fraction of the step limit that is used",
     STORE_DOUBLE,
     AT(cfl),
     {NUMBER, .minimum = 1e-3, .maximum = 1}},
    {"dt", "time", "time step", STORE_DOUBLE, AT(dt), {NUMBER, .maximum = 1e9, .above = true, .automatic = true}},
    {"duration", "time", "simulated time", STORE_DOUBLE, AT(duration), {NUMBER, .maximum = 1e9, .above = true}},
    {"dx", "length", "grid spacing", STORE_DOUBLE, AT(dx), {NUMBER, .maximum = 1e9, .above = true, .automatic = true}},
    {"fps", "1/time", "frames in a unit of time", STORE_DOUBLE, AT(fps), {NUMBER, .minimum = 1e-9, .maximum = 1e9}},
    {"kernel", "1", "B-spline of the momentum", STORE_KERNEL, AT(kernel), {.kind = PLAIN_TEXT, .choices = kernels}},
    {"laplacian", "1", "B-spline of the damage", STORE_KERNEL, AT(laplacian), {.kind = PLAIN_TEXT, .choices = kernels}},
    {"particles",
     "1",
     "about how many, over all solids",
     STORE_INT64,
     AT(particles),
     {NUMBER, .minimum = 1, .maximum = 5e8, .whole = true}},
    {"particles_per_cell",
     "1",
     "how many fill a grid cell",
     STORE_DOUBLE,
     AT(particles_per_cell),
     {NUMBER, .minimum = 0.125, .maximum = 1000}},
    {"seed",
     "1",
     "of everything that is drawn at random",
     STORE_UINT64,
     AT(seed),
     {NUMBER, .minimum = 0, .maximum = 0x1p53, .whole = true}},
    {"title", "", "for people", STORE_TEXT, AT(title), {.kind = PLAIN_TEXT}},
    {"transfer",
     "1",
     "what a particle's velocity carries",
     STORE_TRANSFER,
     AT(transfer),
     {.kind = PLAIN_TEXT, .choices = transfers}},
    {"transfer_ratio",
     "1",
     "rpic: share of the symmetric part that is kept; flip: fraction",
     STORE_DOUBLE,
     AT(transfer_ratio),
     {NUMBER, .maximum = 1}},
    {"units", "", "name of the system of units", STORE_TEXT, AT(units), {.kind = PLAIN_TEXT}},
};

int scene_key_count(void) {
    return (int)(sizeof keys / sizeof *keys);
}

const char *scene_key_name(int key) {
    return keys[key].name;
}

int scene_key_find(const char *name) {
    for (int i = 0; i < scene_key_count(); i++)
        if (strcmp(keys[i].name, name) == 0) return i;
    return -1;
}

bool scene_key_set(scene *s, int key, plain_value *v, char *expected, size_t size, const char **nearest) {
    const scene_key *k = &keys[key];
    if (!plain_fit(v, &k->rule, expected, size, nearest)) return false;
    void *to = (char *)s + k->offset;
    switch (k->storage) {
    case STORE_DOUBLE: *(double *)to = v->number[0]; break;
    case STORE_INT64: *(int64_t *)to = (int64_t)v->number[0]; break;
    case STORE_UINT64: *(uint64_t *)to = (uint64_t)v->number[0]; break;
    case STORE_TRANSFER: *(transfer_kind *)to = (transfer_kind)v->number[0]; break;
    case STORE_KERNEL: *(kernel_kind *)to = (kernel_kind)v->number[0]; break;
    case STORE_TEXT:
        snprintf(expected, size, "text of at most %zu bytes", k->size - 1);
        if (strlen(v->text) >= k->size) return false;
        snprintf(to, k->size, "%s", v->text);
        break;
    }
    return true;
}

void scene_key_show(const scene *s, int key, scene_parameter *out) {
    const scene_key *k = &keys[key];
    const void *from = (const char *)s + k->offset;
    const char *text = NULL;
    snprintf(out->name, sizeof out->name, "%s", k->name);
    snprintf(out->unit, sizeof out->unit, "%s", k->unit);
    snprintf(out->doc, sizeof out->doc, "%s", k->doc);
    switch (k->storage) {
    case STORE_DOUBLE: out->number = *(const double *)from; break;
    case STORE_INT64: out->number = (double)*(const int64_t *)from; break;
    case STORE_UINT64: out->number = (double)*(const uint64_t *)from; break;
    case STORE_TRANSFER: text = transfers[*(const transfer_kind *)from]; break;
    case STORE_KERNEL: text = kernels[*(const kernel_kind *)from]; break;
    case STORE_TEXT: text = from; break;
    }
    if (k->rule.automatic && out->number == 0) text = "auto";
    out->is_text = text != NULL;
    snprintf(out->text, sizeof out->text, "%s", text ? text : "");
}
