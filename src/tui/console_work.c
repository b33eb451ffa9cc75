/* The console's thread: it runs a line, and hands what belongs to the screen's thread over to it. */
#include "tui/console.h"

#include "base/memory.h"
#include "tui/console_host.h"

#include <pthread.h>
#include <stdio.h>
#include <string.h>

typedef struct host_call {
    bool waiting, taken, done; /* to be done by the screen's thread; being done, and past stopping; done */
    const char *function;
    const char *const *arguments;
    int count;
    json_writer *reply;
    report *report;
    status outcome;
} host_call;

struct console_worker {
    pthread_t thread;
    pthread_mutex_t lock; /* guards all below but what is said to be a thread's own */
    pthread_cond_t changed;
    tui_app *app; /* for app_wake alone */
    bool closing, asked, busy, answered, stopped;
    char line[ACTION_ARGUMENT];
    char answer[CONSOLE_ANSWER], trouble[1600];
    status outcome;
    host_call call;
    char database[TUI_PATH];

    console *lua; /* the console's thread's own, but for console_interrupt */
    ledger *ledger;
    char text[CONSOLE_ANSWER];
};

/* Hands a call to the screen's thread and waits for it. */
static status hand_over(console_worker *w, const host_call *call) {
    pthread_mutex_lock(&w->lock);
    w->call = *call;
    w->call.waiting = !w->closing && !w->stopped;
    app_wake(w->app);
    while (w->call.waiting && !w->call.done && (w->call.taken || !(w->closing || w->stopped))) pthread_cond_wait(&w->changed, &w->lock);
    status s = w->call.done ? w->call.outcome : report_set(call->report, STATUS_INPUT, "stopped");
    w->call.waiting = w->call.taken = w->call.done = false;
    pthread_mutex_unlock(&w->lock);
    return s;
}

static status host(void *context, const char *function, const char *const *arguments, int count, json_writer *reply, report *r) {
    console_worker *w = context;
    if (console_is_query(function)) return console_query(&w->ledger, w->database, function, arguments, count, reply, r);
    return hand_over(w, &(host_call){.function = function, .arguments = arguments, .count = count, .reply = reply, .report = r});
}

bool console_serve(tui_app *app, console_worker *w) {
    pthread_mutex_lock(&w->lock);
    host_call *c = &w->call;
    bool due = c->waiting && !c->taken && (strcmp(c->function, "wait") != 0 || console_run_rests(app));
    if (due) {
        /* Unlocked meanwhile: what is done may itself ask the console something. */
        c->taken = true;
        pthread_mutex_unlock(&w->lock);
        status outcome = console_do(app, c->function, c->arguments, c->count, c->reply, c->report);
        pthread_mutex_lock(&w->lock);
        c->outcome = outcome;
        c->done = true;
        pthread_cond_broadcast(&w->changed);
    }
    pthread_mutex_unlock(&w->lock);
    return due;
}

static void run_one(console_worker *w) {
    char line[sizeof w->line];
    report r;
    memcpy(line, w->line, sizeof line);
    pthread_mutex_unlock(&w->lock);
    status s = console_run(w->lua, line, w->text, sizeof w->text, &r);
    pthread_mutex_lock(&w->lock);
    memcpy(w->answer, w->text, sizeof w->answer);
    w->trouble[0] = '\0';
    if (s != STATUS_OK) report_format(&r, w->trouble, sizeof w->trouble);
    w->outcome = s;
    w->answered = true;
    w->busy = false;
    app_wake(w->app);
}

static void *work(void *argument) {
    console_worker *w = argument;
    pthread_mutex_lock(&w->lock);
    while (!w->closing) {
        if (!w->asked) {
            pthread_cond_wait(&w->changed, &w->lock);
            continue;
        }
        w->asked = w->stopped = false;
        run_one(w);
    }
    pthread_mutex_unlock(&w->lock);
    return NULL;
}

status console_work_open(tui_app *app, console_worker **out, report *r) {
    console_worker *w = *out = memory_allocate(sizeof *w);
    if (!w) return report_set(r, STATUS_SYSTEM, "out of memory for the console");
    w->app = app;
    memcpy(w->database, app->database, sizeof w->database);
    console_host functions = {.call = host, .context = w};
    functions.functions = console_functions(&functions.function_count);
    status s = console_open(&functions, &w->lua, r);
    if (s == STATUS_OK) {
        pthread_mutex_init(&w->lock, NULL);
        pthread_cond_init(&w->changed, NULL);
        if (pthread_create(&w->thread, NULL, work, w) == 0) return STATUS_OK;
        s = report_set(r, STATUS_SYSTEM, "no thread for the console");
    }
    console_close(w->lua);
    memory_free(w, sizeof *w);
    *out = NULL;
    return s;
}

void console_work_close(console_worker *w) {
    console_interrupt(w->lua);
    pthread_mutex_lock(&w->lock);
    w->closing = true;
    pthread_cond_broadcast(&w->changed);
    pthread_mutex_unlock(&w->lock);
    pthread_join(w->thread, NULL);
    console_close(w->lua);
    if (w->ledger) ledger_close(w->ledger);
    pthread_cond_destroy(&w->changed);
    pthread_mutex_destroy(&w->lock);
    memory_free(w, sizeof *w);
}

void console_ask(console_worker *w, const char *text) {
    pthread_mutex_lock(&w->lock);
    snprintf(w->line, sizeof w->line, "%s", text);
    w->asked = w->busy = true;
    w->stopped = false;
    pthread_cond_broadcast(&w->changed);
    pthread_mutex_unlock(&w->lock);
}

bool console_busy(console_worker *w) {
    pthread_mutex_lock(&w->lock);
    bool busy = w->busy;
    pthread_mutex_unlock(&w->lock);
    return busy;
}

void console_stop(console_worker *w) {
    console_interrupt(w->lua);
    pthread_mutex_lock(&w->lock);
    w->stopped = true;
    pthread_cond_broadcast(&w->changed);
    pthread_mutex_unlock(&w->lock);
}

bool console_take(console_worker *w, char *answer, size_t size, status *outcome, char *trouble, size_t trouble_size) {
    pthread_mutex_lock(&w->lock);
    bool fresh = w->answered;
    if (fresh) {
        snprintf(answer, size, "%s", w->answer);
        snprintf(trouble, trouble_size, "%s", w->trouble);
        *outcome = w->outcome;
        w->answered = false;
    }
    pthread_mutex_unlock(&w->lock);
    return fresh;
}

/* ---- completion -------------------------------------------------------------------------------------------------- */

static bool is_word(char c) {
    return c == '_' || c == '.' || (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}

/* Offers one name: the first is kept, of further ones what they have in common. */
static void offer(const char *name, const char *stem, char *common, size_t size, int *count) {
    if (strncmp(name, stem, strlen(stem)) != 0) return;
    if (++*count == 1) {
        snprintf(common, size, "%s", name);
        return;
    }
    size_t same = 0;
    while (common[same] && common[same] == name[same]) same++;
    common[same] = '\0';
}

void console_complete(tui_app *app, console_state *c) {
    size_t start = c->cursor;
    char stem[128], common[128] = "";
    int count = 0, all;
    while (start > 0 && is_word(c->text[start - 1])) start--;
    if (c->cursor - start >= sizeof stem) return;
    snprintf(stem, sizeof stem, "%.*s", (int)(c->cursor - start), c->text + start);
    bool quoted = start > 0 && (c->text[start - 1] == '"' || c->text[start - 1] == '\'');
    if (!quoted) {
        const console_function *list = console_functions(&all);
        for (int i = 0; i < all; i++) offer(list[i].name, stem, common, sizeof common, &count);
    } else if (app->run) {
        size_t bytes = KNOB_LIMIT * sizeof(knob);
        knob *list = memory_allocate(bytes);
        all = list ? session_knobs(app->run, list, KNOB_LIMIT) : 0;
        for (int i = 0; i < all && i < KNOB_LIMIT; i++) offer(list[i].path, stem, common, sizeof common, &count);
        if (list) memory_free(list, bytes);
    }
    if (count == 0 || strlen(common) < strlen(stem)) return;
    console_insert(c, common + strlen(stem));
    if (count == 1 && !quoted) console_insert(c, "(");
}
