#include "tui/frame_reader.h"

#include "base/memory.h"
#include "tui/newest.h"

#include <stdio.h>
#include <string.h>

enum { PAGES = 3 }; /* one is being filled, one is ready, one is shown */

typedef struct question {
    char folder[READER_PATH], field[READER_NAME];
    int64_t frame;
    bool refresh;
} question;

struct frame_reader {
    newest thread; /* its lock guards what follows, up to `ready` */
    question next;
    bool fresh; /* `ready` has not been polled */
    int ready;

    int shown;    /* the screen's own */
    question now; /* the thread's own, as what follows */
    int working;
    frame_player *player;
    char opened[READER_PATH];
    float low[3], high[3];
    size_t cache;
    void (*wake)(void *context);
    void *context;
    frame_page pages[PAGES];
};

/* ---- pages ------------------------------------------------------------------------------------------------------- */

static void clear_page(frame_page *page) {
    memory_free(page->frames, (size_t)page->frame_capacity * sizeof *page->frames);
    memory_free(page->position, (size_t)page->capacity * 3 * sizeof *page->position);
    memory_free(page->value, (size_t)page->capacity * sizeof *page->value);
    *page = (frame_page){0};
}

static status reserve_points(frame_page *page, int64_t count, report *r) {
    if (count <= page->capacity) return STATUS_OK;
    memory_free(page->position, (size_t)page->capacity * 3 * sizeof *page->position);
    memory_free(page->value, (size_t)page->capacity * sizeof *page->value);
    page->position = memory_allocate_array((size_t)count, 3 * sizeof *page->position);
    page->value = memory_allocate_array((size_t)count, sizeof *page->value);
    page->capacity = page->position && page->value ? count : 0;
    if (page->capacity > 0) return STATUS_OK;
    if (page->position) memory_free(page->position, (size_t)count * 3 * sizeof *page->position);
    if (page->value) memory_free(page->value, (size_t)count * sizeof *page->value);
    page->position = page->value = NULL;
    return report_set(r, STATUS_SYSTEM, "out of memory for a frame of %lld particles", (long long)count);
}

static status take_numbers(frame_page *page, const frame_player *player, report *r) {
    int count = frame_player_count(player);
    page->frame_count = 0;
    if (count > page->frame_capacity) {
        int64_t *grown = memory_allocate_array((size_t)count + 64, sizeof *grown);
        if (!grown) return report_set(r, STATUS_SYSTEM, "out of memory for the numbers of %d frames", count);
        memory_free(page->frames, (size_t)page->frame_capacity * sizeof *page->frames);
        page->frames = grown;
        page->frame_capacity = count + 64;
    }
    for (int i = 0; i < count; i++) page->frames[i] = frame_player_number(player, i);
    page->frame_count = count;
    page->field_count = 0;
    for (const char *name; page->field_count < READER_FIELDS && (name = frame_player_field(player, page->field_count));)
        snprintf(page->fields[page->field_count++], READER_NAME, "%.31s", name);
    return STATUS_OK;
}

static status take_view(frame_page *page, const frame_view *view, report *r) {
    status code = reserve_points(page, view->count, r);
    if (code != STATUS_OK) return code;
    memcpy(page->position, view->position, (size_t)view->count * 3 * sizeof *page->position);
    if (view->value) memcpy(page->value, view->value, (size_t)view->count * sizeof *page->value);
    page->view = *view;
    page->view.position = page->position;
    page->view.value = view->value ? page->value : NULL;
    page->view.body = NULL;
    page->has_frame = true;
    return STATUS_OK;
}

int frame_page_index(const frame_page *page, int64_t frame) {
    int index = 0;
    while (index + 1 < page->frame_count && page->frames[index + 1] <= frame) index++;
    return index;
}

bool frame_page_has(const frame_page *page, const char *field) {
    for (int i = 0; i < page->field_count; i++)
        if (strcmp(page->fields[i], field) == 0) return true;
    return false;
}

/* ---- the thread -------------------------------------------------------------------------------------------------- */

static status open_folder(frame_reader *p, const question *q, report *r) {
    status code = STATUS_OK;
    if (p->player && strcmp(p->opened, q->folder) == 0) {
        bool beyond = q->frame > frame_player_number(p->player, frame_player_count(p->player) - 1);
        return q->refresh || beyond ? frame_player_refresh(p->player, r) : STATUS_OK;
    }
    frame_player_close(p->player);
    p->player = NULL;
    memcpy(p->opened, q->folder, sizeof p->opened);
    code = frame_player_open(q->folder, p->cache, &p->player, r);
    if (code == STATUS_OK) code = frame_player_bounds(p->player, p->low, p->high, r);
    if (code == STATUS_OK) return code;
    frame_player_close(p->player);
    p->player = NULL;
    return code;
}

static status read_frame(frame_reader *p, const question *q, frame_page *page, report *r) {
    frame_view view;
    status code = open_folder(p, q, r);
    if (code == STATUS_OK) code = take_numbers(page, p->player, r);
    if (code != STATUS_OK) return code;
    const char *field = q->field[0] ? q->field : frame_player_default_field(p->player);
    if (field && !frame_page_has(page, field)) field = NULL;
    snprintf(page->field, sizeof page->field, "%s", field ? field : "");
    memcpy(page->low, p->low, sizeof page->low);
    memcpy(page->high, p->high, sizeof page->high);
    int64_t frame = frame_player_number(p->player, frame_player_index(p->player, q->frame));
    code = frame_player_read(p->player, frame, field, &view, r);
    return code == STATUS_OK ? take_view(page, &view, r) : code;
}

static void take_question(void *owner) {
    frame_reader *p = owner;
    p->now = p->next;
    p->next.refresh = false;
}

static void show_page(frame_reader *p) {
    pthread_mutex_lock(&p->thread.lock);
    int filled = p->working;
    p->working = p->ready;
    p->ready = filled;
    p->fresh = true;
    if (!p->thread.closing) p->wake(p->context);
    pthread_mutex_unlock(&p->thread.lock);
}

static void answer(void *owner) {
    frame_reader *p = owner;
    frame_page *page = &p->pages[p->working];
    report r;
    page->asked = p->now.frame;
    page->has_frame = false;
    page->problem[0] = page->field[0] = '\0';
    page->frame_count = page->field_count = 0;
    page->view = (frame_view){0};
    memcpy(page->folder, p->now.folder, sizeof page->folder);
    if (read_frame(p, &p->now, page, &r) != STATUS_OK) report_format(&r, page->problem, sizeof page->problem);
    show_page(p);
}

/* ---- the screen's side ------------------------------------------------------------------------------------------- */

status frame_reader_open(size_t cache_bytes, void (*wake)(void *context), void *context, frame_reader **out, report *r) {
    frame_reader *p = *out = memory_allocate(sizeof *p);
    if (!p) return report_set(r, STATUS_SYSTEM, "out of memory for a reader of frames");
    p->cache = cache_bytes;
    p->wake = wake;
    p->context = context;
    p->ready = 1;
    p->shown = 2;
    status code = newest_open(&p->thread, take_question, answer, p, "to read frames", r);
    if (code == STATUS_OK) return code;
    memory_free(p, sizeof *p);
    *out = NULL;
    return code;
}

void frame_reader_close(frame_reader *p) {
    if (!p) return;
    newest_close(&p->thread);
    frame_player_close(p->player);
    for (int i = 0; i < PAGES; i++) clear_page(&p->pages[i]);
    memory_free(p, sizeof *p);
}

void frame_reader_ask(frame_reader *p, const char *folder, int64_t frame, const char *field, bool refresh) {
    newest_begin(&p->thread);
    bool same = strcmp(p->next.folder, folder) == 0;
    p->next.refresh = refresh || (same && p->next.refresh); /* of a question that this one takes the place of */
    p->next.frame = frame;
    snprintf(p->next.folder, sizeof p->next.folder, "%s", folder);
    snprintf(p->next.field, sizeof p->next.field, "%s", field);
    newest_ask(&p->thread);
}

bool frame_reader_poll(frame_reader *p) {
    pthread_mutex_lock(&p->thread.lock);
    bool fresh = p->fresh;
    if (fresh) {
        int before = p->shown;
        p->shown = p->ready;
        p->ready = before;
        p->fresh = false;
    }
    pthread_mutex_unlock(&p->thread.lock);
    return fresh;
}

const frame_page *frame_reader_page(const frame_reader *p) {
    return &p->pages[p->shown];
}

bool frame_reader_busy(frame_reader *p) {
    pthread_mutex_lock(&p->thread.lock);
    bool busy = p->thread.busy || p->fresh;
    pthread_mutex_unlock(&p->thread.lock);
    return busy;
}
