/* A line that is typed: the cursor steps over characters, not bytes, and nothing is written beyond the line's end. */
#include "check.h"
#include "tui/typing.h"

#include <string.h>

static void the_cursor_steps_over_characters(void) {
    const char *text = "aσ€b"; /* 1, 2, 3 and 1 bytes */
    static const size_t places[] = {0, 1, 3, 6, 7};
    size_t cursor = 0;
    for (int i = 1; i < 5; i++) {
        typing_step(text, &cursor, 1);
        CHECK(cursor == places[i]);
    }
    typing_step(text, &cursor, 1);
    CHECK(cursor == 7);
    for (int i = 3; i >= 0; i--) {
        typing_step(text, &cursor, -1);
        CHECK(cursor == places[i]);
    }
    typing_step(text, &cursor, -1);
    CHECK(cursor == 0);
}

static void whole_characters_are_erased(void) {
    char text[] = "aσ€b";
    size_t cursor = 6;
    typing_erase_before(text, &cursor);
    CHECK(strcmp(text, "aσb") == 0 && cursor == 3);
    typing_erase_before(text, &cursor);
    CHECK(strcmp(text, "ab") == 0 && cursor == 1);
    cursor = 0;
    typing_erase_before(text, &cursor);
    CHECK(strcmp(text, "ab") == 0 && cursor == 0);
}

static void what_does_not_fit_is_left_out(void) {
    char text[8] = "ad";
    size_t cursor = 1;
    typing_insert(text, 6, &cursor, "bc");
    CHECK(strcmp(text, "abcd") == 0 && cursor == 3);
    typing_insert(text, 6, &cursor, "€");
    CHECK(strcmp(text, "abcd") == 0 && cursor == 3);
    typing_insert(text, 6, &cursor, "x");
    CHECK(strcmp(text, "abcxd") == 0 && cursor == 4);
    typing_insert(text, 6, &cursor, "y");
    CHECK(strcmp(text, "abcxd") == 0 && cursor == 4);
}

int main(void) {
    RUN(the_cursor_steps_over_characters);
    RUN(whole_characters_are_erased);
    RUN(what_does_not_fit_is_left_out);
    return check_finish();
}
