/* What Lua in the console can call. Runs and screens belong to the screen's thread, so nearly all is done there; the
 * ledger is asked on the console's own. */
#ifndef SUNDER_TUI_CONSOLE_HOST_H
#define SUNDER_TUI_CONSOLE_HOST_H

#include "base/json.h"
#include "script/console.h"
#include "store/ledger.h"
#include "tui/app.h"

const console_function *console_functions(int *count);

/* Whether a function asks only the ledger. */
bool console_is_query(const char *function);

/* Does a query on the console's thread. *open: the connection, opened when first needed. */
status console_query(ledger **open, const char *database, const char *function, const char *const *arguments, int count, json_writer *reply,
                     report *r);

/* Does any other on the screen's thread. */
status console_do(tui_app *app, const char *function, const char *const *arguments, int count, json_writer *reply, report *r);

/* Whether what wait() waits for is there: the run is paused or has ended. */
bool console_run_rests(const tui_app *app);

#endif
