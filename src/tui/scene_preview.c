#include "tui/scene_preview.h"

#include "base/memory.h"
#include "sim/simulation.h"

#include <pthread.h>
#include <stdio.h>
#include <string.h>

static const double time_limit = 0.3; /* s of steps that are timed */

struct scene_preview {
    pthread_t thread;
    pthread_mutex_t lock; /* guards all that follows, but `working` */
    pthread_cond_t asked;
    bool closing, waiting, busy; /* waiting: `words` has not been begun */
    char words[START_TEXT];
    bool plan;
    preview_facts facts;

    preview_facts working; /* the thread's own */
    start_words start;
    script_reports reports;
};

static void publish(scene_preview *p) {
    pthread_mutex_lock(&p->lock);
    uint64_t version = p->facts.version + 1;
    p->facts = p->working;
    p->facts.version = version;
    pthread_mutex_unlock(&p->lock);
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

static void look(scene_preview *p, const char *words, bool plan) {
    script *loaded = NULL;
    report r;
    memset(&p->working, 0, sizeof p->working);
    snprintf(p->working.words, sizeof p->working.words, "%s", words);
    if (start_parse(words, &p->start, &r) != STATUS_OK) {
        tell(p, &r);
    } else if (script_load(p->start.scene, &p->start.options.script, &loaded, &p->reports) != STATUS_OK) {
        tell(p, &p->reports.items[0]);
    } else {
        take_scene(&p->working, loaded);
        publish(p);
        if (plan && take_plan(&p->working, loaded, &p->start.options, &r) != STATUS_OK) tell(p, &r);
    }
    script_close(loaded);
    publish(p);
}

/* ---- the thread -------------------------------------------------------------------------------------------------- */

static void *work(void *argument) {
    scene_preview *p = argument;
    char words[START_TEXT];
    pthread_mutex_lock(&p->lock);
    while (!p->closing) {
        if (!p->waiting) {
            p->busy = false;
            pthread_cond_wait(&p->asked, &p->lock);
            continue;
        }
        p->waiting = false;
        p->busy = true;
        bool plan = p->plan;
        memcpy(words, p->words, sizeof words);
        pthread_mutex_unlock(&p->lock);
        look(p, words, plan);
        pthread_mutex_lock(&p->lock);
    }
    pthread_mutex_unlock(&p->lock);
    return NULL;
}

status preview_open(scene_preview **out, report *r) {
    scene_preview *p = *out = memory_allocate(sizeof *p);
    if (!p) return report_set(r, STATUS_SYSTEM, "out of memory for the scenes' preview");
    pthread_mutex_init(&p->lock, NULL);
    pthread_cond_init(&p->asked, NULL);
    if (pthread_create(&p->thread, NULL, work, p) == 0) return STATUS_OK;
    memory_free(p, sizeof *p);
    *out = NULL;
    return report_set(r, STATUS_SYSTEM, "no thread for the scenes' preview");
}

void preview_close(scene_preview *p) {
    pthread_mutex_lock(&p->lock);
    p->closing = true;
    pthread_cond_signal(&p->asked);
    pthread_mutex_unlock(&p->lock);
    pthread_join(p->thread, NULL);
    pthread_cond_destroy(&p->asked);
    pthread_mutex_destroy(&p->lock);
    memory_free(p, sizeof *p);
}

void preview_ask(scene_preview *p, const char *words, bool plan) {
    pthread_mutex_lock(&p->lock);
    snprintf(p->words, sizeof p->words, "%s", words);
    p->plan = plan;
    p->waiting = p->busy = true;
    pthread_cond_signal(&p->asked);
    pthread_mutex_unlock(&p->lock);
}

bool preview_poll(scene_preview *p, preview_facts *out) {
    pthread_mutex_lock(&p->lock);
    bool fresh = p->facts.version != out->version;
    if (fresh) *out = p->facts;
    pthread_mutex_unlock(&p->lock);
    return fresh;
}

bool preview_busy(scene_preview *p) {
    pthread_mutex_lock(&p->lock);
    bool busy = p->busy;
    pthread_mutex_unlock(&p->lock);
    return busy;
}
