/* How `sunder sweep --lines` tells another program what becomes of its runs. */
#include "script/sweep.h"

#include <string.h>

static const char *const words[] = {"waiting", "going", "done", "failed", "skipped"};

void sweep_line_write(const sweep_line *line, FILE *out) {
    char message[SWEEP_MESSAGE];
    snprintf(message, sizeof message, "%s", line->message);
    for (char *c = message; *c; c++)
        if ((unsigned char)*c < ' ') *c = ' ';
    fprintf(out, "%d\t%d\t%s\t%s\t%s\n", line->run, line->count, words[line->state], line->id, message);
    fflush(out);
}

/* The text before the next tab, or the last one; false when it is too long, or when there is none. */
static bool take_part(const char **at, char *part, size_t size) {
    size_t length = strcspn(*at, "\t");
    bool fits = length < size;
    snprintf(part, size, "%.*s", (int)length, *at);
    *at += length + ((*at)[length] == '\t');
    return fits;
}

bool sweep_line_read(const char *text, sweep_line *out) {
    char word[16];
    int after = 0;
    *out = (sweep_line){0};
    if (sscanf(text, "%d\t%d\t%n", &out->run, &out->count, &after) < 2 || after == 0 || out->run < 0 || out->run >= out->count) return false;
    text += after;
    if (!take_part(&text, word, sizeof word) || !take_part(&text, out->id, sizeof out->id) || !take_part(&text, out->message, sizeof out->message)) return false;
    for (int i = 0; i <= SWEEP_SKIPPED; i++) {
        out->state = (sweep_run_state)i;
        if (strcmp(word, words[i]) == 0) return true;
    }
    return false;
}
