/* The sandbox's searches against Lua's own string library, over random subjects and patterns: the same results, or an
 * error in both. Alphabets are small, so that most patterns are valid and many match. */
#include "base/random.h"
#include "check.h"
#include "script/internal.h"

#include <lualib.h>
#include <stdlib.h>

enum { ROUNDS = 60000, STREAM = 11 };

static uint64_t draws;

static unsigned draw(unsigned below) {
    return (unsigned)(random_bits(5, STREAM, draws++) % below);
}

static void random_subject(char *out) {
    static const char letters[] = "ab1 (.";
    unsigned length = draw(12);
    for (unsigned i = 0; i < length; i++) out[i] = letters[draw(sizeof letters - 1)];
    out[length] = '\0';
}

static void random_pattern(char *out) {
    static const char *const pieces[] = {"a",  "b",    "1",    ".",      "%a",     "%d",      "%s",    "%w",
                                         "%A", "[ab]", "[^a]", "[a-b1]", "(",      ")",       "()",    "%1",
                                         "%2", "$",    "%b()", "%bab",   "%f[%a]", "%f[^%a]", "[]a]",  "[%d ]",
                                         "%.", "%(",   "^",    "%",      "[a",     "-",       "[%a-]", "%0"};
    static const char *const suffixes[] = {"", "", "", "*", "+", "-", "?"};
    out[0] = '\0';
    if (draw(5) == 0) strcat(out, "^");
    for (unsigned i = draw(6); i < 6; i++) {
        strcat(out, pieces[draw(sizeof pieces / sizeof *pieces)]);
        strcat(out, suffixes[draw(sizeof suffixes / sizeof *suffixes)]);
    }
    if (draw(5) == 0) strcat(out, "$");
}

static const char program[] = "local subject, pattern, replacement, from = ...\n"
                              "local out = {}\n"
                              "local function add(...) for i = 1, select('#', ...) do out[#out + 1] = "
                              "tostring((select(i, ...))) end out[#out + 1] = '|' end\n"
                              "local function try(f, ...) local ok, a, b, c, d, e = pcall(f, ...)\n"
                              "  if ok then add(a, b, c, d, e) else add('error') end end\n"
                              "try(string.find, subject, pattern, from)\n"
                              "try(string.match, subject, pattern, from)\n"
                              "try(string.gsub, subject, pattern, replacement)\n"
                              "try(string.gsub, subject, pattern, function(a, b) return b end, 2)\n"
                              "try(string.gsub, subject, pattern, { a = 'x', b = false })\n"
                              "try(string.find, subject, pattern, from, true)\n"
                              "try(function() for a, b in string.gmatch(subject, pattern) do add(a, b) end end)\n"
                              "try(string.rep, subject, from, pattern)\n"
                              "return table.concat(out, ' ')\n";

/* What a state says to one case; the text stays on the state's stack. */
static const char *answer(lua_State *L, const char *subject, const char *pattern, const char *replacement, int from) {
    lua_settop(L, 1);
    lua_pushvalue(L, 1);
    lua_pushstring(L, subject);
    lua_pushstring(L, pattern);
    lua_pushstring(L, replacement);
    lua_pushinteger(L, from);
    if (lua_pcall(L, 4, 1, 0) != LUA_OK) printf("  %s\n", lua_tostring(L, -1));
    return lua_tostring(L, -1);
}

static void test_against_lua(void) {
    static const char *const replacements[] = {"", "x", "<%0>", "%1", "%2%1", "%%", "%", "%9"};
    guard g = {.time_limit = 1e9, .memory_limit = (size_t)1 << 30};
    lua_State *theirs = luaL_newstate(), *ours = lua_newstate(guard_allocate, &g);
    guard_arm(&g, ours);
    luaL_openlibs(theirs);
    luaL_openlibs(ours);
    lua_getglobal(ours, "string");
    strings_open(ours, 1);
    lua_settop(ours, 0);
    CHECK(luaL_loadstring(theirs, program) == LUA_OK && luaL_loadstring(ours, program) == LUA_OK);
    int different = 0, errors = 0, matches = 0;
    for (int i = 0; i < ROUNDS && different < 5; i++) {
        char subject[16], pattern[128];
        random_subject(subject);
        random_pattern(pattern);
        const char *replacement = replacements[draw(8)];
        int from = (int)draw(9) - 4;
        const char *a = answer(theirs, subject, pattern, replacement, from),
                   *b = answer(ours, subject, pattern, replacement, from);
        errors += strncmp(a, "error", 5) == 0;
        matches += strncmp(a, "error", 5) != 0 && strncmp(a, "nil", 3) != 0;
        if (strcmp(a, b) == 0) continue;
        different++;
        printf("  '%s' '%s' '%s' %d\n    lua    %s\n    sunder %s\n", subject, pattern, replacement, from, a, b);
    }
    CHECK(different == 0);
    CHECK(errors > ROUNDS / 50 && matches > ROUNDS / 50); /* the comparison means something */
    lua_close(theirs);
    lua_close(ours);
}

int main(void) {
    RUN(test_against_lua);
    return check_finish();
}
