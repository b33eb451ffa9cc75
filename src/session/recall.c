#include "session/recall.h"

#include "base/memory.h"
#include "session/internal.h"

#include <stdio.h>
#include <string.h>

struct session_recall {
    run_request request;
    knob_turn *turns; /* [turn_capacity] */
    int turn_count, turn_capacity;
};

static status take_turn(void *context, const ledger_turn *turn, report *r) {
    session_recall *recall = context;
    if (recall->turn_count == recall->turn_capacity) {
        int wanted = recall->turn_capacity ? 2 * recall->turn_capacity : 16;
        knob_turn *grown = memory_resize(recall->turns, (size_t)recall->turn_capacity * sizeof *grown, (size_t)wanted * sizeof *grown);
        if (!grown) return report_set(r, STATUS_SYSTEM, "out of memory for the turns of knobs");
        recall->turns = grown;
        recall->turn_capacity = wanted;
    }
    knob_turn *to = &recall->turns[recall->turn_count++];
    to->frame = turn->frame;
    snprintf(to->path, sizeof to->path, "%s", turn->path);
    snprintf(to->value, sizeof to->value, "%s", turn->value);
    return STATUS_OK;
}

status session_recall_run(ledger *l, const char *id, const char *folder, session_recall **out, report *r) {
    *out = NULL;
    session_recall *recall = memory_allocate(sizeof *recall);
    if (!recall) return report_set(r, STATUS_SYSTEM, "out of memory for a run's request");
    status code = request_read(&recall->request, folder, r);
    if (code == STATUS_OK) code = ledger_each_turn(l, id, take_turn, recall, r);
    if (code == STATUS_OK) *out = recall;
    else session_recall_free(recall);
    return code;
}

void session_recall_free(session_recall *recall) {
    if (!recall) return;
    memory_free(recall->turns, (size_t)recall->turn_capacity * sizeof *recall->turns);
    memory_free(recall, sizeof *recall);
}

void session_recall_options(const session_recall *recall, session_options *out) {
    *out = session_options_default();
    request_to_options(&recall->request, out);
    out->turns = recall->turns;
    out->turn_count = recall->turn_count;
}
