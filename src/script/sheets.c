/* `sheets`: regions, lattices, notches; and sources, which solids have too. */
#include "script/internal.h"

#include <math.h>
#include <string.h>

static const char *const lattices[] = {"square", "hexagonal", "scattered", NULL};
_Static_assert(SHEET_SAMPLING_SQUARE == 0 && SHEET_SAMPLING_HEXAGONAL == 1 && SHEET_SAMPLING_POISSON == 2, "order of `lattices`");

/* A line from … to, or a shape. */
static void read_notch(script *s, int index, const place *p, void *owner) {
    scene_sheet *b = owner;
    scene_notch *n = &b->notches[b->notch_count];
    *n = (scene_notch){0};
    field fields[] = {{.key = "from", .kind = FIELD_VECTOR, .number = n->from},
                      {.key = "to", .kind = FIELD_VECTOR, .number = n->to},
                      {.key = "shape", .kind = FIELD_OTHER}};
    if (!read_fields(s, index, p, fields, 3)) return;
    bool line = fields[0].given && fields[1].given && !fields[2].given;
    if (line == fields[2].given || fields[0].given != fields[1].given)
        problem_place(s, p, "from and to, or a shape", "another set of keys", NULL);
    else if (fields[2].given && !(n->shape = read_shape_field(s, index, p)))
        return;
    else
        b->notch_count++;
}

/* Where a body or a sheet keeps its sources. */
typedef struct source_list {
    int *count;
    scene_source *items;
} source_list;

static void read_source(script *s, int index, const place *p, void *owner) {
    const source_list *list = owner;
    scene_source *from = &list->items[*list->count];
    double spots = 0;
    *from = (scene_source){.stop = HUGE_VAL, .strength = 1, .on = 1};
    field fields[] = {{.key = "shape", .kind = FIELD_OTHER},
                      {.key = "rate", .kind = FIELD_OTHER},
                      {.key = "value", .kind = FIELD_OTHER},
                      {.key = "spots", .kind = FIELD_REAL, .number = &spots, .minimum = 0, .maximum = 10000},
                      {.key = "radius", .kind = FIELD_SIZE, .number = &from->radius},
                      {.key = "start", .kind = FIELD_REAL, .number = &from->start},
                      {.key = "stop", .kind = FIELD_REAL, .number = &from->stop, .infinite = true},
                      {.key = "strength", .kind = FIELD_REAL, .number = &from->strength},
                      {.key = "on", .kind = FIELD_FLAG, .number = &from->on}};
    if (!read_fields(s, index, p, fields, 9)) return;
    if (fields[0].given) from->shape = read_shape_field(s, index, p);
    from->spots = (int)spots;
    from->fixed = fields[2].given;
    if (fields[1].given == fields[2].given) {
        problem_place(s, p, "a rate (added a unit of time) or a value (held)", fields[1].given ? "both" : "neither", NULL);
        return;
    }
    if ((from->spots > 0) != fields[4].given) {
        problem_place(s, p, "spots together with their radius", from->spots > 0 ? "no radius" : "no spots", NULL);
        return;
    }
    place at = place_key(p, from->fixed ? "value" : "rate"), end = place_key(p, "stop");
    if (!(from->stop > from->start)) problem_place(s, &end, "a time after start", "an earlier one, or the same", NULL);
    if (push_value(s->L, index, from->fixed ? "value" : "rate")) read_scalar_function(s, -1, &at, &from->value);
    lua_pop(s->L, 1);
    (*list->count)++;
}

typedef void (*part_reader)(script *s, int index, const place *p, void *owner);

static void read_parts(script *s, int index, const place *p, const char *key, int limit, const char *expected, void *owner, part_reader read) {
    place list = place_key(p, key);
    if (push_value(s->L, index, key)) {
        int table = lua_gettop(s->L), count = read_list(s, table, &list, limit, expected);
        for (int i = 1; i <= count; i++) {
            place at = place_index(&list, i);
            lua_rawgeti(s->L, table, i);
            if (read_table(s, lua_gettop(s->L), &at, "a table with named fields")) read(s, lua_gettop(s->L), &at, owner);
            lua_pop(s->L, 1);
        }
    }
    lua_pop(s->L, 1);
}

void read_sources(script *s, int index, const place *p, int *count, scene_source items[BODY_SOURCES]) {
    source_list list = {count, items};
    read_parts(s, index, p, "sources", BODY_SOURCES, "a list of sources: sources = { { shape = …, rate = … }, … }", &list, read_source);
}

void read_sheet(script *s, int index, const place *p, int number) {
    scene_sheet *b = &s->scene->sheets[s->scene->sheet_count];
    s->sheet_places[s->scene->sheet_count++] = *p;
    *b = (scene_sheet){.material = -1, .radius = 1.5, .region.normal = {0, 0, 1}};
    char name[SCRIPT_TEXT] = "";
    double lattice = SHEET_SAMPLING_SQUARE, surface = 0;
    field fields[] = {{.key = "name", .kind = FIELD_TEXT, .text = name},
                      {.key = "shape", .kind = FIELD_OTHER, .required = true},
                      {.key = "material", .kind = FIELD_OTHER},
                      {.key = "thickness", .kind = FIELD_SIZE, .required = true, .number = &b->thickness},
                      {.key = "spacing", .kind = FIELD_SIZE, .number = &b->spacing},
                      {.key = "radius", .kind = FIELD_REAL, .number = &b->radius, .minimum = 1.2, .maximum = 6},
                      {.key = "lattice", .kind = FIELD_CHOICE, .choices = lattices, .number = &lattice},
                      {.key = "surface", .kind = FIELD_FLAG, .number = &surface},
                      {.key = "point", .kind = FIELD_VECTOR, .number = b->region.point},
                      {.key = "normal", .kind = FIELD_AXIS, .number = b->region.normal},
                      {.key = "ripple", .kind = FIELD_REAL, .number = &b->ripple, .minimum = 0, .maximum = 1},
                      {.key = "notches", .kind = FIELD_OTHER},
                      {.key = "sources", .kind = FIELD_OTHER},
                      {.key = "grain", .kind = FIELD_OTHER},
                      {.key = "velocity", .kind = FIELD_OTHER}};
    enum { FIELDS = sizeof fields / sizeof *fields };
    bool table = read_fields(s, index, p, fields, FIELDS) || lua_istable(s->L, index);
    copy_name(s, p, name, "sheet", number, b->name);
    if (!table) return;
    b->lattice = (sheet_sampling)lattice;
    b->region.surface = surface != 0;
    if (b->region.surface && !fields[6].given) b->lattice = SHEET_SAMPLING_POISSON;
    b->material = read_body_material(s, index, p, ENGINE_SHEET, b->name);
    if (fields[1].given) b->region.shape = read_shape_field(s, index, p);
    place grain = place_key(p, "grain");
    if (push_value(s->L, index, "grain")) read_fibres(s, -1, &grain, b->region.shape, &b->grain);
    lua_pop(s->L, 1);
    function_field(s, index, p, "velocity", &b->velocity);
    read_parts(s, index, p, "notches", SHEET_CUTS, "a list of notches: notches = { { from = …, to = … }, … }", b, read_notch);
    read_sources(s, index, p, &b->source_count, b->sources);
}
