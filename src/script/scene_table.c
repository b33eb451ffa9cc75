/* The scene's table: plain keys, effects of the scene, solids, grips, colliders, walls. */
#include "script/internal.h"

#include "base/names.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const char *const contacts[] = {"sticky", "slip", "separate", NULL};
static const char *const discretisations[] = {"particles", "tetrahedra", NULL};
_Static_assert(DISCRETISATION_PARTICLES == 0 && DISCRETISATION_TETRAHEDRA == 1, "order of `discretisations`");
static const char *const meshers[] = {"lattice", "gmsh", NULL};
_Static_assert(MESHER_LATTICE == 0 && MESHER_GMSH == 1, "order of `meshers`");
static const char *const samplings[] = {"lattice", "jittered", "poisson", NULL};
_Static_assert(CONTACT_STICKY == 0 && CONTACT_SLIP == 1 && CONTACT_SEPARATE == 2, "order of `contacts`");
_Static_assert(SAMPLING_LATTICE == 0 && SAMPLING_JITTERED == 1 && SAMPLING_POISSON == 2, "order of `samplings`");

/* Names are kept short: 63 bytes. An absent one becomes "solid 2" and the like. */
void copy_name(script *s, const place *p, const char *given, const char *kind, int number, char out[64]) {
    place at = place_key(p, "name");
    if (strlen(given) > 63) problem_place(s, &at, "a name of at most 63 bytes", given, NULL);
    if (*given)
        snprintf(out, 64, "%.63s", given);
    else
        snprintf(out, 64, "%s %d", kind, number);
}

/* Pushes the value under `key` of the table at `index`; whether there is one. */
bool push_value(lua_State *L, int index, const char *key) {
    lua_pushstring(L, key);
    return lua_rawget(L, index) != LUA_TNIL;
}

const shape *read_shape_field(script *s, int index, const place *p) {
    place at = place_key(p, "shape");
    push_value(s->L, index, "shape");
    const shape *found = read_shape(s, -1, &at);
    lua_pop(s->L, 1);
    return found;
}

void function_field(script *s, int index, const place *p, const char *key, scene_function *out) {
    place at = place_key(p, key);
    if (push_value(s->L, index, key)) read_function(s, -1, &at, out);
    lua_pop(s->L, 1);
}

/* ---- solids ------------------------------------------------------------------------------------------------------ */

static bool is_bounded(const shape *body, double middle[3]) {
    double low[3], high[3];
    bool bounded = true;
    shape_bounds(body, low, high);
    for (int c = 0; c < 3; c++) {
        bounded = bounded && isfinite(low[c]) && isfinite(high[c]);
        middle[c] = 0.5 * (low[c] + high[c]);
    }
    return bounded;
}

int read_body_material(script *s, int index, const place *p, engine_kind engine, const char *body) {
    lua_State *L = s->L;
    int material = -1;
    place at = place_key(p, "material");
    if (s->recipe) {
        place option = {.file = s->sources[0].display, .line = s->scene_line, .call = "--recipe"};
        lua_pushstring(L, s->recipe);
        material = read_material(s, -1, &option, engine, body);
    } else if (push_value(L, index, "material")) {
        material = read_material(s, -1, &at, engine, body);
    } else {
        problem_place(s, &at, "a value: this key is required", "nothing", NULL);
    }
    lua_pop(L, 1);
    return material;
}

/* A list of shapes, as their union. */
static const shape *read_notches(script *s, int index, const place *p) {
    const shape *shapes[SCENE_NOTCHES];
    int count = read_list(s, index, p, SCENE_NOTCHES, "a list of shapes: notches = { s.box { … }, … }");
    bool fine = count > 0;
    for (int i = 1; i <= count; i++) {
        place at = place_index(p, i);
        lua_rawgeti(s->L, index, i);
        shapes[i - 1] = read_shape(s, -1, &at);
        fine = fine && shapes[i - 1];
        lua_pop(s->L, 1);
    }
    if (!fine) return NULL;
    scene_charge(s->L, 1 + count / 8);
    const shape *made = shape_union(s->scene->memory, shapes, count);
    if (!made) throw_memory(s->L);
    return made;
}

/* Jittered particles crack without a preference for the grid's directions. Inextensible fibres are held cell by cell by sums over particles; scattered
 * ones leave modes that such sums do not see and that creep under load (docs/architecture.md). */
static sampling_kind default_sampling(const scene *s, int material) {
    bool inextensible = material >= 0 && s->materials[material].effects[effect_index("inextensible")].on;
    return inextensible ? SAMPLING_LATTICE : SAMPLING_JITTERED;
}

static void read_solid(script *s, int index, const place *p, int number) {
    char name[SCRIPT_TEXT] = "";
    double sampling = 0, discretisation = DISCRETISATION_PARTICLES, mesher = MESHER_LATTICE, middle[3];
    field fields[] = {{.key = "name", .kind = FIELD_TEXT, .text = name},
                      {.key = "shape", .kind = FIELD_OTHER, .required = true},
                      {.key = "material", .kind = FIELD_OTHER},
                      {.key = "fibres", .kind = FIELD_OTHER},
                      {.key = "velocity", .kind = FIELD_OTHER},
                      {.key = "notches", .kind = FIELD_OTHER},
                      {.key = "sampling", .kind = FIELD_CHOICE, .choices = samplings, .number = &sampling},
                      {.key = "discretisation", .kind = FIELD_CHOICE, .choices = discretisations, .number = &discretisation},
                      {.key = "mesher", .kind = FIELD_CHOICE, .choices = meshers, .number = &mesher},
                      {.key = "start", .kind = FIELD_OTHER},
                      {.key = "sources", .kind = FIELD_OTHER}};
    scene_body *b = &s->scene->bodies[s->scene->body_count];
    s->body_places[s->scene->body_count++] = *p;
    *b = (scene_body){.material = -1};
    bool table = read_fields(s, index, p, fields, sizeof fields / sizeof *fields) || lua_istable(s->L, index);
    copy_name(s, p, name, "solid", number, b->name);
    if (!table) return;
    b->discretisation = (discretisation_kind)discretisation;
    b->mesher = (mesher_kind)mesher;
    b->material = read_body_material(s, index, p, ENGINE_SOLID, b->name);
    b->sampling = fields[6].given ? (sampling_kind)sampling : default_sampling(s->scene, b->material);
    if (fields[1].given && (b->shape = read_shape_field(s, index, p)) && !is_bounded(b->shape, middle)) {
        place at = place_key(p, "shape");
        problem_place(s, &at, "a bounded shape for a body", "one that has no end", NULL);
    }
    place at = place_key(p, "fibres");
    if (push_value(s->L, index, "fibres")) read_fibres(s, -1, &at, b->shape, &b->fibres);
    lua_pop(s->L, 1);
    function_field(s, index, p, "velocity", &b->velocity);
    function_field(s, index, p, "start", &b->start);
    read_sources(s, index, p, &b->source_count, b->sources);
    at = place_key(p, "notches");
    if (push_value(s->L, index, "notches")) b->notches = read_notches(s, lua_gettop(s->L), &at);
    lua_pop(s->L, 1);
}

/* ---- grips, colliders, walls ------------------------------------------------------------------------------------- */

/* What grips and colliders have in common. */
typedef struct mover {
    char name[SCRIPT_TEXT];
    const shape *shape;
    scene_function velocity, spin;
    double pivot[3], start, stop;
} mover;

enum { MOVER_FIELDS = 7 };

static void mover_fields(mover *m, field *out) {
    *m = (mover){.stop = HUGE_VAL};
    const field fields[MOVER_FIELDS] = {{.key = "name", .kind = FIELD_TEXT, .text = m->name},
                                        {.key = "shape", .kind = FIELD_OTHER, .required = true},
                                        {.key = "velocity", .kind = FIELD_OTHER},
                                        {.key = "spin", .kind = FIELD_OTHER},
                                        {.key = "pivot", .kind = FIELD_VECTOR, .number = m->pivot},
                                        {.key = "start", .kind = FIELD_REAL, .number = &m->start},
                                        {.key = "stop", .kind = FIELD_REAL, .number = &m->stop, .infinite = true}};
    memcpy(out, fields, sizeof fields);
}

static void read_mover(script *s, int index, const place *p, const field *fields, mover *m) {
    double middle[3];
    if (fields[1].given) m->shape = read_shape_field(s, index, p);
    bool pivot = fields[4].given;
    if (!pivot && m->shape && is_bounded(m->shape, middle)) memcpy(m->pivot, middle, sizeof middle);
    function_field(s, index, p, "velocity", &m->velocity);
    function_field(s, index, p, "spin", &m->spin);
    place at = place_key(p, "stop");
    if (!(m->stop > m->start)) problem_place(s, &at, "a time after start", "an earlier one, or the same", NULL);
}

static void read_grip(script *s, int index, const place *p, int number) {
    mover m;
    double protects = 1;
    field fields[MOVER_FIELDS + 1];
    mover_fields(&m, fields);
    fields[MOVER_FIELDS] = (field){.key = "protects", .kind = FIELD_FLAG, .number = &protects};
    if (!read_fields(s, index, p, fields, MOVER_FIELDS + 1)) return;
    read_mover(s, index, p, fields, &m);
    scene_grip *g = &s->scene->grips[s->scene->grip_count++];
    *g = (scene_grip){.shape = m.shape,
                      .velocity = m.velocity,
                      .spin = m.spin,
                      .start = m.start,
                      .stop = m.stop,
                      .protects = protects != 0};
    memcpy(g->pivot, m.pivot, sizeof g->pivot);
    /* A grip without a velocity holds still: that is a velocity. */
    if (g->velocity.outputs == 0) g->velocity.outputs = 3;
    copy_name(s, p, m.name, "grip", number, g->name);
}

static void check_contact(script *s, const place *p, const field *friction, double contact) {
    place at = place_key(p, "friction");
    if (friction->given && contact == CONTACT_STICKY)
        problem_place(s, &at, "no friction where contact is \"sticky\" (or contact = \"slip\" or \"separate\")", "some",
                      NULL);
}

static scene_collider *add_collider(script *s, const place *p) {
    if (s->scene->collider_count == SCENE_COLLIDERS) {
        problem_place(s, p, "at most 32 colliders and walls together", "more", NULL);
        return NULL;
    }
    scene_collider *c = &s->scene->colliders[s->scene->collider_count++];
    *c = (scene_collider){.stop = HUGE_VAL, .velocity.outputs = 3};
    return c;
}

static void read_collider(script *s, int index, const place *p, int number) {
    mover m;
    double contact = CONTACT_STICKY, friction = 0;
    field fields[MOVER_FIELDS + 2];
    mover_fields(&m, fields);
    fields[MOVER_FIELDS] = (field){.key = "contact", .kind = FIELD_CHOICE, .choices = contacts, .number = &contact};
    fields[MOVER_FIELDS + 1] = (field){.key = "friction", .kind = FIELD_REAL, .maximum = 1e6, .number = &friction};
    if (!read_fields(s, index, p, fields, MOVER_FIELDS + 2)) return;
    read_mover(s, index, p, fields, &m);
    check_contact(s, p, &fields[MOVER_FIELDS + 1], contact);
    scene_collider *c = add_collider(s, p);
    if (!c) return;
    c->shape = m.shape, c->spin = m.spin, c->start = m.start, c->stop = m.stop;
    if (m.velocity.outputs) c->velocity = m.velocity;
    memcpy(c->pivot, m.pivot, sizeof c->pivot);
    c->contact = (contact_kind)contact, c->friction = friction;
    copy_name(s, p, m.name, "collider", number, c->name);
}

/* A wall keeps material where its normal points to: the collider is the half-space behind it. */
static void read_wall(script *s, int index, const place *p, int number) {
    double point[3] = {0}, normal[3], contact = CONTACT_STICKY, friction = 0;
    char name[SCRIPT_TEXT] = "";
    field fields[] = {{.key = "point", .kind = FIELD_VECTOR, .required = true, .number = point},
                      {.key = "normal", .kind = FIELD_AXIS, .required = true, .number = normal},
                      {.key = "contact", .kind = FIELD_CHOICE, .choices = contacts, .number = &contact},
                      {.key = "friction", .kind = FIELD_REAL, .maximum = 1e6, .number = &friction},
                      {.key = "name", .kind = FIELD_TEXT, .text = name}};
    if (!read_fields(s, index, p, fields, 5)) return;
    check_contact(s, p, &fields[3], contact);
    scene_collider *c = add_collider(s, p);
    if (!c) return;
    c->shape = shape_half_space(s->scene->memory, point, normal);
    if (!c->shape) throw_memory(s->L);
    c->contact = (contact_kind)contact, c->friction = friction;
    copy_name(s, p, name, "wall", number, c->name);
}

/* ---- the whole table --------------------------------------------------------------------------------------------- */

typedef struct list_key {
    const char *name, *expected;
    int limit;
    void (*read)(script *s, int index, const place *p, int number);
} list_key;

static const list_key lists[] = {
    {"solids", "a list of solids: solids = { { shape = …, material = … }, … }", SCENE_BODIES, read_solid},
    {"sheets", "a list of sheets: sheets = { { shape = …, material = …, thickness = … }, … }", SCENE_SHEETS, read_sheet},
    {"grips", "a list of grips: grips = { { shape = …, velocity = … }, … }", SCENE_GRIPS, read_grip},
    {"colliders", "a list of colliders: colliders = { { shape = … }, … }", SCENE_COLLIDERS, read_collider},
    {"walls", "a list of walls: walls = { { point = …, normal = … }, … }", SCENE_COLLIDERS, read_wall},
};
enum { LISTS = sizeof lists / sizeof *lists };

static void read_items(script *s, int index, const place *p, const list_key *list) {
    int count = read_list(s, index, p, list->limit, list->expected);
    for (int i = 1; i <= count; i++) {
        place at = place_index(p, i);
        lua_rawgeti(s->L, index, i);
        if (read_table(s, lua_gettop(s->L), &at, "a table with named fields")) list->read(s, lua_gettop(s->L), &at, i);
        lua_pop(s->L, 1);
    }
}

static void read_domain(script *s, int index, const place *p) {
    scene *sc = s->scene;
    double low[3], high[3];
    field fields[] = {{.key = "min", .kind = FIELD_VECTOR, .required = true, .infinite = true, .number = low},
                      {.key = "max", .kind = FIELD_VECTOR, .required = true, .infinite = true, .number = high}};
    if (!read_fields(s, index, p, fields, 2)) return;
    for (int c = 0; c < 3; c++) {
        place at = place_key(p, "max");
        if (!(low[c] < high[c])) problem_place(s, &at, "three components above those of min", "others", NULL);
        sc->domain_minimum[c] = low[c], sc->domain_maximum[c] = high[c];
    }
}

static void read_scene_key(script *s, int index, const place *p, int key) {
    plain_value v = plain_from_lua(s->L, index);
    char expected[256];
    const char *nearest;
    if (!scene_key_set(s->scene, key, &v, expected, sizeof expected, &nearest))
        problem_place(s, p, expected, v.found, nearest);
}

static void report_unknown(script *s, const place *p, const char *name) {
    const char *names[2 * EFFECT_LIMIT + LISTS + 64] = {"domain", "expect"};
    int count = 2, effects;
    const effect *const *all = effect_catalogue(&effects);
    for (int i = 0; i < LISTS; i++) names[count++] = lists[i].name;
    for (int i = 0; i < scene_key_count(); i++) names[count++] = scene_key_name(i);
    for (int e = 0; e < effects; e++)
        if (all[e]->scope == SCOPE_SCENE) names[count++] = all[e]->name;
    bool of_material = effect_index(name) >= 0;
    problem_place(s, p, of_material ? "an effect of the scene" : "a key of the scene",
                  of_material ? "an effect that belongs into a material" : "a key that does not exist",
                  name_nearest(name, names, count));
}

static void read_key(script *s, const char *name, const place *p) {
    int value = lua_gettop(s->L), key = scene_key_find(name), e = effect_index(name), count;
    if (key >= 0) {
        read_scene_key(s, value, p, key);
        return;
    }
    if (e >= 0 && effect_catalogue(&count)[e]->scope == SCOPE_SCENE) {
        read_effect(s, value, p, effect_catalogue(&count)[e], &s->scene->effects[e], &s->sites[SCENE_SITE][e]);
        return;
    }
    for (int i = 0; i < LISTS; i++)
        if (strcmp(lists[i].name, name) == 0) {
            read_items(s, value, p, &lists[i]);
            return;
        }
    if (strcmp(name, "domain") == 0)
        read_domain(s, value, p);
    else if (strcmp(name, "expect") == 0)
        read_expect(s, value, p);
    else
        report_unknown(s, p, name);
}

void read_scene(lua_State *L, const char *file) {
    script *s = script_of(L);
    int table = lua_gettop(L);
    char found[80];
    lua_rawgetp(L, LUA_REGISTRYINDEX, &KEY_SCENE);
    lua_pushvalue(L, table);
    place returned = {.file = file};
    describe_value(L, table, found, sizeof found);
    if (lua_isnil(L, table) || lua_rawget(L, -2) == LUA_TNIL)
        throw_place(L, &returned, "a file that returns s.scene { … }", found, NULL);
    place p = {.file = file, .line = (int)lua_tointeger(L, -1), .call = "scene"};
    s->scene_line = p.line;
    lua_settop(L, table);
    if (!read_table(s, table, &p, "a table with the scene's keys")) return;
    int count = push_sorted_names(s, table, &p), list = lua_gettop(L);
    for (int i = 1; i <= count; i++) {
        lua_rawgeti(L, list, i);
        const char *name = lua_tostring(L, -1);
        place at = place_key(&p, name);
        push_value(L, table, name);
        read_key(s, name, &at);
        lua_settop(L, list);
    }
    lua_settop(L, table);
    place solids = place_key(&p, "solids");
    if (s->scene->body_count + s->scene->sheet_count == 0 && s->problem_count == 0)
        problem_place(s, &solids, "at least one body, or sheets", "none", NULL);
}
