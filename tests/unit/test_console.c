/* The console's Lua and the user's config, without a screen. */
#include "check.h"

#include "base/memory.h"
#include "script/console.h"
#include "script/library.h"
#include "script/user_config.h"
#include "unit/script_files.h"

#include <pthread.h>
#include <stdatomic.h>

/* ---- the console ------------------------------------------------------------------------------------------------- */

static char asked[256]; /* the last call, as "name(a, b)" */

static status host(void *context, const char *function, const char *const *arguments, int count, json_writer *reply, report *r) {
    int used = snprintf(asked, sizeof asked, "%s(", function);
    for (int i = 0; i < count; i++) used += snprintf(asked + used, sizeof asked - (size_t)used, "%s%s", i ? ", " : "", arguments[i]);
    snprintf(asked + used, sizeof asked - (size_t)used, ")");
    (*(int *)context)++;
    if (strcmp(function, "refuse") == 0) return report_input(r, NULL, 0, "refuse", "something else", "this", "that");
    json_object(reply);
    json_member_number(reply, "pi", 3.140625);
    json_member_string(reply, "text", "a \"quoted\"\nline");
    json_key(reply, "list");
    json_array(reply);
    json_integer(reply, 1);
    json_null(reply);
    json_boolean(reply, true);
    json_array_end(reply);
    json_object_end(reply);
    return STATUS_OK;
}

static const console_function functions[] = {{"get", "get()", "a table"}, {"refuse", "refuse()", "no"}, {"help", "help()", "this list"}};
static int calls;

static console *open_console(void) {
    console *c = NULL;
    report r;
    console_host h = {.functions = functions, .function_count = 3, .call = host, .context = &calls};
    CHECK(console_open(&h, &c, &r) == STATUS_OK);
    return c;
}

static bool says(console *c, const char *line, const char *wanted) {
    static char out[8192];
    report r;
    status s = console_run(c, line, out, sizeof out, &r);
    if (s == STATUS_OK && strcmp(out, wanted) == 0) return true;
    printf("  %s: %d '%s'\n", line, (int)s, out);
    return false;
}

static bool fails(console *c, const char *line, const char *part) {
    char out[8192], text[1600] = "";
    report r;
    status s = console_run(c, line, out, sizeof out, &r);
    report_format(&r, text, sizeof text);
    if (s != STATUS_OK && strstr(text, part)) return true;
    printf("  %s: %d '%s' '%s'\n", line, (int)s, out, text);
    return false;
}

static void test_expressions_and_statements(void) {
    console *c = open_console();
    CHECK(says(c, "1 + 2", "3"));
    CHECK(says(c, "0.1", "0.1"));
    CHECK(says(c, "x = 5", ""));
    CHECK(says(c, "x * 2, 'a'", "10\na"));
    CHECK(says(c, "for i = 1, 3 do print(i) end", "1\n2\n3\n"));
    CHECK(says(c, "{b = 2, a = {1, 2}}", "{a = {1, 2}, b = 2}"));
    CHECK(says(c, "nil", "nil"));
    CHECK(says(c, "sunder.box { size = { 1, 2, 3 } } ~= nil", "true"));
    CHECK(says(c, "sunder.sphere { radius = 2 }", "sphere r=2"));
    CHECK(fails(c, "y", "y"));
    CHECK(fails(c, "x x", "syntax"));
    CHECK(fails(c, "error('mine')", "mine"));
    CHECK(fails(c, "os.exit()", "sandbox"));
    CHECK(fails(c, "io.open('/etc/passwd')", "sandbox"));
    CHECK(says(c, "x", "5")); /* errors leave what was there */
    console_close(c);
}

static void test_host(void) {
    console *c = open_console();
    CHECK(says(c, "get('a', 2, 0.1, true).pi", "3.140625"));
    CHECK(strcmp(asked, "get(a, 2, 0.10000000000000001, true)") == 0);
    CHECK(says(c, "get().text", "a \"quoted\"\nline"));
    CHECK(says(c, "get().list[3]", "true"));
    CHECK(says(c, "get().list[2]", "nil"));
    CHECK(fails(c, "refuse()", "that"));
    CHECK(says(c, "pcall(refuse) == false", "true"));
    int before = calls;
    CHECK(fails(c, "get(1,2,3,4,5,6,7,8,9)", "at most"));
    CHECK(calls == before);
    CHECK(says(c, "help()", "get()                      a table\nrefuse()                   no\nhelp()                     this list\n"));
    console_close(c);
}

static atomic_bool stopped;

/* Again and again: an interruption is of what is running, and nobody knows when that begins. */
static void *interrupt_until_stopped(void *argument) {
    while (!atomic_load(&stopped)) {
        usleep(20 * 1000);
        console_interrupt(argument);
    }
    return NULL;
}

static void test_interrupt_and_limits(void) {
    console *c = open_console();
    pthread_t thread;
    CHECK(pthread_create(&thread, NULL, interrupt_until_stopped, c) == 0);
    CHECK(fails(c, "while true do pcall(function() while true do end end) end", "stopped"));
    atomic_store(&stopped, true);
    pthread_join(thread, NULL);
    CHECK(says(c, "6 * 7", "42")); /* and goes on */
    CHECK(fails(c, "t, s = {}, ('x'):rep(1000) for i = 1, 1e9 do t[i] = s:rep(1000) end", "mem"));
    CHECK(says(c, "6 * 7", "42"));
    console_close(c);
}

/* ---- the user's config ------------------------------------------------------------------------------------------- */

static user_config config;

static status load_config(const char *text) {
    char path[192];
    files_write("config.lua", text);
    snprintf(path, sizeof path, "%s/config.lua", folder);
    return user_config_load(path, &config, &reports);
}

static void test_config(void) {
    CHECK(load_config("return { theme = 'light', colours = 16, ascii = true,\n keys = { ['ctrl-p'] = 'run.pause', F9 = 'theme light',\n g = false },\n"
               " styles = { good = 114, bad = '#ff4000' } }\n") == STATUS_OK);
    CHECK(strcmp(config.theme, "light") == 0 && config.colours == 16 && config.ascii == 1 && config.mouse == -1);
    CHECK(config.binding_count == 3 && config.style_count == 2);
    for (int i = 0; i < config.binding_count; i++) {
        const user_binding *b = &config.bindings[i];
        if (strcmp(b->key, "F9") == 0) CHECK(strcmp(b->action, "theme light") == 0 && b->line == 2);
        if (strcmp(b->key, "g") == 0) CHECK(b->action[0] == '\0' && b->line == 3);
    }
    for (int i = 0; i < 2; i++) CHECK(config.styles[i].colour == (strcmp(config.styles[i].name, "bad") == 0 ? 0x1ff4000 : 114));
    CHECK(load_config("return { colours = 'true' }") == STATUS_OK && config.colours == 1 << 24);
    CHECK(user_config_load("/nowhere/config.lua", &config, &reports) == STATUS_OK && config.file[0] == '\0' && config.binding_count == 0);
}

static void test_wrong_configs(void) {
    static const struct {
        const char *text, *part;
        int line;
    } wrong[] = {{"return {\n  themee = 'light' }", "theme", 2}, {"return {\n keys = {\n  a = 3 } }", "action", 3}, {"return 7", "table", 1},
                 {"return {\n colours = 17 }", "256", 2},        {"return {\n styles = { dim = 256 } }", "255", 2},      {"return {", "valid Lua", 1},
                 {"return {\n\n styles = { dim = '#12345g' } }", "rrggbb", 3}};
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        char text[1600] = "";
        CHECK(load_config(wrong[i].text) == STATUS_INPUT);
        report_format(&reports.items[0], text, sizeof text);
        bool fine = strstr(text, wrong[i].part) && reports.items[0].line == wrong[i].line;
        if (!fine) printf("  %s\n", text);
        CHECK(fine);
    }
}

/* ---- what is at hand --------------------------------------------------------------------------------------------- */

static void test_library(void) {
    enum { MOST = 256 };
    library_scene *list = memory_allocate_array(MOST, sizeof *list);
    char found[LIBRARY_PATH], recipes[96][LIBRARY_NAME];
    int count = library_scenes(list, MOST), tubes = 0;
    for (int i = 0; i < count; i++) tubes += strcmp(list[i].name, "tube_pull") == 0 && strcmp(list[i].group, "solid") == 0;
    CHECK(tubes == 1);
    for (int i = 1; i < count; i++) CHECK(strcmp(list[i - 1].group, list[i].group) <= 0);
    CHECK(library_find_scene("tube_pull", found) && access(found, R_OK) == 0 && strstr(found, "solid/tube_pull.lua"));
    CHECK(library_find_scene("solid/tube_pull.lua", found) && strstr(found, "solid/tube_pull.lua"));
    CHECK(!library_find_scene("tube_pul", found) && strcmp(found, "tube_pul") == 0);
    int recipe_count = library_recipes(list[0].path, recipes, 96), seen = 0;
    for (int i = 0; i < recipe_count; i++) seen += strcmp(recipes[i], "rubber_film") == 0;
    CHECK(seen == 1);
    memory_free(list, MOST * sizeof *list);
}

int main(void) {
    files_open();
    RUN(test_expressions_and_statements);
    RUN(test_host);
    RUN(test_interrupt_and_limits);
    RUN(test_config);
    RUN(test_wrong_configs);
    RUN(test_library);
    CHECK(memory_live_bytes() == 0);
    return check_finish();
}
