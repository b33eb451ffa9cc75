/* How a past run was asked for, from its folder: to run it again. */
#ifndef SUNDER_SESSION_RECALL_H
#define SUNDER_SESSION_RECALL_H

#include "session/session.h"
#include "store/ledger.h"

typedef struct session_recall session_recall;

/* Reads the request in a run's folder and the turns of its row. STATUS_INPUT when the folder is not a run's. Free with
 * session_recall_free. */
status session_recall_run(ledger *l, const char *id, const char *folder, session_recall **out, report *r);
void session_recall_free(session_recall *recall);

/* Options for the same run in a folder of its own: scene and recipes as the folder keeps them, settings, turns, precision, instruction
 * set, frames. Strings and turns are the recall's, which must outlive the session. */
void session_recall_options(const session_recall *recall, session_options *out);

#endif
