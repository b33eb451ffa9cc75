#include "tui/scene_preview.h"

#include "base/memory.h"
#include "sim/simulation.h"
#include "tui/newest.h"

#include <stdio.h>
#include <string.h>

static const double time_limit = 0.3; /* s of steps that are timed */

typedef struct question {
    char words[START_TEXT];
    bool plan;
} question;

struct scene_preview {
    newest thread; /* its lock guards what follows, up to `facts` */
    question next;
    preview_facts facts;

    question now; /* the thread's own, as what follows */
    preview_facts working;
    start_words start;
    script_reports reports;
};

static void publish(scene_preview *p) {
    pthread_mutex_lock(&p->thread.lock);
    uint64_t version = p->facts.version + 1;
    p->facts = p->working;
    p->facts.version = version;
    pthread_mutex_unlock(&p->thread.lock);
}

static void tell(scene_preview *p, const report *r) {
    char text[1600];
    report_format(r, text, sizeof text);
    snprintf(p->working.message, sizeof p->working.message, "%.1000s", text);
    p->working.failed = true;
}

/* ---- what the file says ------------------------------------------------------------------------------------------ */

static void add_part(preview_facts *f, const char *kind, const shape *form, const char *of) {
    char text[120];
    if (f->part_count == PREVIEW_PARTS) return;
    shape_describe(form, text, sizeof text);
    snprintf(f->parts[f->part_count++], sizeof f->parts[0], "%s%s of %s", kind, text, of);
}

static void take_parts(preview_facts *f, const scene *s) {
    for (int i = 0; i < s->body_count; i++)
        add_part(f, s->bodies[i].discretisation == DISCRETISATION_TETRAHEDRA ? "tetrahedra: " : "", s->bodies[i].shape,
                 s->materials[s->bodies[i].material].name);
    for (int i = 0; i < s->sheet_count; i++)
        add_part(f, "sheet: ", s->sheets[i].region.shape, s->materials[s->sheets[i].material].name);
    if (f->part_count < PREVIEW_PARTS && s->grip_count + s->collider_count > 0)
        snprintf(f->parts[f->part_count++], sizeof f->parts[0], "grips: %d, colliders: %d", s->grip_count, s->collider_count);
}

static void take_parameter(preview_parameter *to, const script_declaration *d) {
    snprintf(to->name, sizeof to->name, "%s", d->name);
    snprintf(to->unit, sizeof to->unit, "%s", d->shown->unit);
    snprintf(to->doc, sizeof to->doc, "%.127s", d->shown->doc);
    if (d->shown->is_text) snprintf(to->value, sizeof to->value, "%.63s", d->shown->text);
    else snprintf(to->value, sizeof to->value, "%.6g", d->shown->number);
    to->from_set = d->shown->from_set;
    for (int i = 0; i < d->choice_count && i < PREVIEW_CHOICES; i++)
        snprintf(to->choices[to->choice_count++], sizeof to->choices[0], "%s", d->choices[i]);
}

static void take_parameters(preview_facts *f, const script *s) {
    for (int i = 0; i < script_declaration_count(s) && f->parameter_count < PREVIEW_PARAMETERS; i++) {
        script_declaration d = script_declaration_at(s, i);
        take_parameter(&f->parameters[f->parameter_count++], &d);
    }
}

/* The effects that some material or the scene names: what the plan's mask will be. */
static void take_effects(preview_facts *f, const scene *s) {
    int count;
    const effect *const *all = effect_catalogue(&count);
    for (int e = 0; e < count && f->effect_count < PREVIEW_EFFECTS; e++) {
        bool on = all[e]->scope == SCOPE_SCENE && s->effects[e].on;
        for (int m = 0; m < s->material_count; m++) on = on || (all[e]->scope == SCOPE_MATERIAL && s->materials[m].effects[e].on);
        if (on) snprintf(f->effects[f->effect_count++], sizeof f->effects[0], "%s", all[e]->name);
    }
}

static void take_scene(preview_facts *f, script *from) {
    const scene *s = script_scene(from);
    f->loaded = true;
    snprintf(f->title, sizeof f->title, "%s", s->title);
    snprintf(f->units, sizeof f->units, "%s", s->units);
    f->frames = scene_frames(s);
    f->duration = s->duration;
    f->particles = s->particles;
    take_parts(f, s);
    take_parameters(f, from);
    take_effects(f, s);
}

/* ---- what the plan says ------------------------------------------------------------------------------------------ */

static status take_plan(preview_facts *f, script *from, const session_options *o, report *r) {
    simulation_options options = {.threads = o->threads, .precision = o->precision, .simd = o->simd};
    simulation *made = NULL;
    simulation_cost cost;
    const scene *s = script_scene(from);
    status code = simulation_create(s, &options, &made, r);
    if (code != STATUS_OK) return code;
    const simulation_plan *plan = simulation_get_plan(made);
    f->particles = plan->particles;
    f->dx = plan->dx;
    f->spacing = plan->spacing;
    f->dt = plan->dt;
    f->fixed_dt = s->dt > 0;
    f->bytes_per_particle = plan->bytes_per_particle;
    f->threads = plan->threads;
    f->effect_count = 0;
    for (int e = 0; e < plan->effect_count && f->effect_count < PREVIEW_EFFECTS; e++)
        if (plan->mask >> e & 1) snprintf(f->effects[f->effect_count++], sizeof f->effects[0], "%s", plan->effects[e]->name);
    code = simulation_measure_cost(made, s, time_limit, &cost, r);
    if (code == STATUS_OK) {
        f->planned = true;
        f->seconds_per_step = cost.seconds_per_step;
        f->steps = cost.steps;
        f->seconds = cost.seconds;
    }
    simulation_destroy(made);
    return code;
}

static void look(void *owner) {
    scene_preview *p = owner;
    script *loaded = NULL;
    report r;
    memset(&p->working, 0, sizeof p->working);
    snprintf(p->working.words, sizeof p->working.words, "%s", p->now.words);
    if (start_parse(p->now.words, &p->start, &r) != STATUS_OK) {
        tell(p, &r);
    } else if (script_load(p->start.scene, &p->start.options.script, &loaded, &p->reports) != STATUS_OK) {
        tell(p, &p->reports.items[0]);
    } else {
        take_scene(&p->working, loaded);
        publish(p);
        if (p->now.plan && take_plan(&p->working, loaded, &p->start.options, &r) != STATUS_OK) tell(p, &r);
    }
    script_close(loaded);
    publish(p);
}

/* ---- the thread -------------------------------------------------------------------------------------------------- */

static void take_question(void *owner) {
    scene_preview *p = owner;
    p->now = p->next;
}

status preview_open(scene_preview **out, report *r) {
    scene_preview *p = *out = memory_allocate(sizeof *p);
    if (!p) return report_set(r, STATUS_SYSTEM, "out of memory for the scenes' preview");
    status code = newest_open(&p->thread, take_question, look, p, "for the scenes' preview", r);
    if (code == STATUS_OK) return code;
    memory_free(p, sizeof *p);
    *out = NULL;
    return code;
}

void preview_close(scene_preview *p) {
    newest_close(&p->thread);
    memory_free(p, sizeof *p);
}

void preview_ask(scene_preview *p, const char *words, bool plan) {
    newest_begin(&p->thread);
    snprintf(p->next.words, sizeof p->next.words, "%s", words);
    p->next.plan = plan;
    newest_ask(&p->thread);
}

bool preview_poll(scene_preview *p, preview_facts *out) {
    pthread_mutex_lock(&p->thread.lock);
    bool fresh = p->facts.version != out->version;
    if (fresh) *out = p->facts;
    pthread_mutex_unlock(&p->thread.lock);
    return fresh;
}

bool preview_busy(scene_preview *p) {
    pthread_mutex_lock(&p->thread.lock);
    bool busy = p->thread.busy;
    pthread_mutex_unlock(&p->thread.lock);
    return busy;
}
