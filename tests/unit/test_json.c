/* The JSON writer: text, numbers to the last bit, trouble with memory. */
#include "base/json.h"
#include "base/memory.h"
#include "base/random.h"
#include "check.h"

#include <locale.h>
#include <stdlib.h>

/* Writes one string value and compares. */
static bool string_becomes(const char *text, const char *expected) {
    json_writer w;
    report r;
    json_begin(&w, 0);
    json_string(&w, text);
    bool same = json_finish(&w, &r) == STATUS_OK && strcmp(w.text, expected) == 0;
    if (!same) printf("  got %s, expected %s\n", w.text, expected);
    json_free(&w);
    return same;
}

static void strings_are_escaped(void) {
    CHECK(string_becomes("", "\"\""));
    CHECK(string_becomes("plain", "\"plain\""));
    CHECK(string_becomes("say \"a\\b\"", "\"say \\\"a\\\\b\\\"\""));
    CHECK(string_becomes("1\n2\t3\r4\b5\f6", "\"1\\n2\\t3\\r4\\b5\\f6\""));
    CHECK(string_becomes("\x01\x1f\x7f", "\"\\u0001\\u001f\\u007f\""));
    CHECK(string_becomes("/", "\"/\""));
    CHECK(string_becomes("45° – σ 🧵", "\"45° – σ 🧵\""));
    CHECK(string_becomes(NULL, "null"));
}

#define BAD "\xef\xbf\xbd"

static void bad_utf8_is_replaced(void) {
    CHECK(string_becomes("a\xff"
                         "b",
                         "\"a" BAD "b\""));
    CHECK(string_becomes("\xc3", "\"" BAD "\""));                         /* cut off */
    CHECK(string_becomes("\xe2\x82", "\"" BAD BAD "\""));                 /* cut off after two of three */
    CHECK(string_becomes("\xc0\xaf", "\"" BAD BAD "\""));                 /* overlong '/' */
    CHECK(string_becomes("\xe0\x80\xaf", "\"" BAD BAD BAD "\""));         /* overlong */
    CHECK(string_becomes("\xed\xa0\x80", "\"" BAD BAD BAD "\""));         /* surrogate */
    CHECK(string_becomes("\xf4\x90\x80\x80", "\"" BAD BAD BAD BAD "\"")); /* past U+10FFFF */
    CHECK(string_becomes("\xf4\x8f\xbf\xbf", "\"\xf4\x8f\xbf\xbf\""));    /* U+10FFFF itself */
}

static void numbers_are_short(void) {
    char text[JSON_NUMBER];
    const struct {
        double value;
        const char *text;
    } cases[] = {{0.1, "0.1"},
                 {0.1 + 0.2, "0.30000000000000004"},
                 {1.0 / 3.0, "0.3333333333333333"},
                 {3, "3"},
                 {-0.0, "-0"},
                 {1e300, "1e+300"},
                 {-1.5e-7, "-1.5e-07"}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        json_format_number(cases[i].value, text);
        CHECK(strcmp(text, cases[i].text) == 0);
    }
    json_format_number((double)NAN, text);
    CHECK(strcmp(text, "null") == 0);
    json_format_number((double)-INFINITY, text);
    CHECK(strcmp(text, "null") == 0);
}

static void numbers_come_back_to_the_bit(void) {
    int wrong = 0;
    for (uint64_t i = 0; i < 100000; i++) {
        uint64_t bits = random_bits(7, 1, i);
        double value, back;
        char text[JSON_NUMBER];
        memcpy(&value, &bits, sizeof value);
        if (!isfinite(value)) continue;
        json_format_number(value, text);
        back = strtod(text, NULL);
        wrong += memcmp(&value, &back, sizeof value) != 0;
    }
    CHECK(wrong == 0);
}

static void the_locale_does_not_matter(void) {
    static const char *const commas[] = {"de_DE.UTF-8", "fr_FR.UTF-8", "de_DE", "fr_FR"};
    for (size_t i = 0; i < sizeof commas / sizeof commas[0]; i++) {
        if (!setlocale(LC_NUMERIC, commas[i])) continue;
        char text[JSON_NUMBER];
        json_format_number(0.5, text);
        setlocale(LC_NUMERIC, "C");
        CHECK(strcmp(text, "0.5") == 0);
        return;
    }
    printf("  (no locale with a decimal comma here)\n");
}

static void write_sample(json_writer *w) {
    json_object(w);
    json_member_string(w, "name", "a");
    json_key(w, "list");
    json_array(w);
    json_integer(w, -9223372036854775807 - 1);
    json_number(w, 0.25);
    json_boolean(w, true);
    json_null(w);
    json_array_end(w);
    json_key(w, "empty");
    json_object(w);
    json_object_end(w);
    json_key(w, "raw");
    json_raw(w, "[1,2]");
    json_key(w, "none");
    json_raw(w, NULL);
    json_member_integer(w, "i", 7);
    json_member_boolean(w, "b", false);
    json_member_number(w, "n", (double)INFINITY);
    json_object_end(w);
}

static void structure_is_right(void) {
    json_writer w;
    report r;
    json_begin(&w, 0);
    write_sample(&w);
    CHECK(json_finish(&w, &r) == STATUS_OK);
    CHECK(strcmp(w.text,
                 "{\"name\": \"a\", \"list\": [-9223372036854775808, 0.25, true, null], \"empty\": {}, \"raw\": [1,2], "
                 "\"none\": null, \"i\": 7, \"b\": false, \"n\": null}") == 0);
    json_free(&w);

    json_begin(&w, 2);
    json_object(&w);
    json_key(&w, "a");
    json_array(&w);
    json_integer(&w, 1);
    json_integer(&w, 2);
    json_array_end(&w);
    json_object_end(&w);
    CHECK(json_finish(&w, &r) == STATUS_OK);
    CHECK(strcmp(w.text, "{\n  \"a\": [\n    1,\n    2\n  ]\n}") == 0);
    json_free(&w);
}

static void long_texts_grow(void) {
    json_writer w;
    report r;
    json_begin(&w, 0);
    json_array(&w);
    for (int i = 0; i < 20000; i++) json_integer(&w, i);
    json_array_end(&w);
    CHECK(json_finish(&w, &r) == STATUS_OK);
    CHECK(strlen(w.text) == w.size);
    CHECK(strcmp(w.text + w.size - 7, " 19999]") == 0);
    json_free(&w);
}

static void memory_may_run_out(void) {
    size_t before = memory_live_bytes();
    int failures = 0;
    for (int nth = 1;; nth++) {
        json_writer w;
        report r;
        json_begin(&w, 0);
        memory_fail_after(nth, 1);
        json_array(&w);
        for (int i = 0; i < 500; i++) write_sample(&w);
        json_array_end(&w);
        status s = json_finish(&w, &r);
        memory_fail_after(0, 0);
        json_free(&w);
        CHECK(memory_live_bytes() == before);
        if (s == STATUS_OK) break;
        CHECK(s == STATUS_SYSTEM && r.message[0]);
        failures++;
    }
    CHECK(failures > 3);
}

int main(void) {
    RUN(strings_are_escaped);
    RUN(bad_utf8_is_replaced);
    RUN(numbers_are_short);
    RUN(numbers_come_back_to_the_bit);
    RUN(the_locale_does_not_matter);
    RUN(structure_is_right);
    RUN(long_texts_grow);
    RUN(memory_may_run_out);
    return check_finish();
}
