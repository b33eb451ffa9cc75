/* Lines of `sunder sweep --lines`: what is written is what is read. */
#include "check.h"
#include "script/sweep.h"

#include <stdlib.h>
#include <string.h>

static bool write_and_read(const sweep_line *line, sweep_line *out) {
    char *text;
    size_t size;
    FILE *f = open_memstream(&text, &size);
    sweep_line_write(line, f);
    fclose(f);
    CHECK(size > 0 && text[size - 1] == '\n');
    CHECK(strcspn(text, "\n") == size - 1); /* one line */
    text[size - 1] = '\0';
    bool fine = sweep_line_read(text, out);
    free(text);
    return fine;
}

static void every_state_is_read_again(void) {
    for (sweep_run_state state = SWEEP_WAITING; state <= SWEEP_SKIPPED; state++) {
        sweep_line line = {.run = 2 + (int)state, .count = 9, .state = state, .id = "20261122-120000-abc", .message = "it  went wrong: 3/9  done"}, got;
        CHECK(write_and_read(&line, &got));
        CHECK(got.run == line.run && got.count == 9 && got.state == state);
        CHECK(strcmp(got.id, line.id) == 0 && strcmp(got.message, line.message) == 0);
    }
}

static void nothing_to_say_and_too_much(void) {
    sweep_line line = {.run = 0, .count = 1, .state = SWEEP_FAILED}, got;
    CHECK(write_and_read(&line, &got) && !got.id[0] && !got.message[0]);
    memset(line.message, 'x', sizeof line.message - 1);
    line.message[3] = '\t', line.message[5] = '\n';
    CHECK(write_and_read(&line, &got));
    CHECK(strlen(got.message) == sizeof got.message - 1 && strncmp(got.message, "xxx x xx", 8) == 0);
}

static void other_text_is_refused(void) {
    sweep_line got;
    CHECK(sweep_line_read("0\t1\tdone\tid\tmessage", &got));
    static const char *const wrong[] = {"", "sunder: grid.lua:3: no such key", "3/9  done  20261122-… eta=0.1", "0\t1\tdonee\tid\t", "0\t1\t\tid\t", "1\t1\tdone\tid\t", "-1\t1\tdone\tid\t",
                                        "0\t1\tdone\tan identity of a run that is far longer than any\t"};
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) CHECK(!sweep_line_read(wrong[i], &got));
}

int main(void) {
    RUN(every_state_is_read_again);
    RUN(nothing_to_say_and_too_much);
    RUN(other_text_is_refused);
    return check_finish();
}
