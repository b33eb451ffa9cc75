/* Scene files, modules beside them, and recipes: finding, reading, loading. */
#include "script/internal.h"

#include "base/names.h"

#include <ctype.h>
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>

enum {
    FILE_LIMIT = 4 << 20, /* bytes of a Lua file */
    DATA_LIMIT = 1 << 30, /* bytes of a mesh or a table */
    LISTED_NAMES = 128,
    LISTED_SIZE = 64,
    COPY_DEPTH = 8,
    CALLER_FOLDERS = 64,
    ENDING = 4, /* characters of every ending that files here have, the point included */
};

const source_file *find_source(const script *s, const char *display) {
    for (int i = 0; i < s->source_count; i++)
        if (strcmp(s->sources[i].display, display) == 0) return &s->sources[i];
    return NULL;
}

/* ---- reading ----------------------------------------------------------------------------------------------------- */

/* Reads a whole regular file into the script's arena. NULL, or why it could not be read (a constant text). */
static const char *read_whole(script *s, const char *path, off_t limit, const char **text, size_t *size) {
    int file = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    if (file < 0) return strerror(errno);
    struct stat facts;
    const char *trouble = NULL;
    size_t used = 0;
    char *buffer = NULL;
    if (fstat(file, &facts) != 0)
        trouble = strerror(errno);
    else if (S_ISDIR(facts.st_mode))
        trouble = "a folder";
    else if (!S_ISREG(facts.st_mode))
        trouble = "something that is no regular file";
    else if (facts.st_size > limit)
        trouble = limit == FILE_LIMIT ? "a file over 4 MiB" : "a file over 1 GiB";
    else if (!(buffer = arena_allocate(s->memory, (size_t)facts.st_size + 1)))
        trouble = "no memory to read it";
    while (!trouble && used < (size_t)facts.st_size) {
        ssize_t got = read(file, buffer + used, (size_t)facts.st_size - used);
        if (got < 0 && errno != EINTR) trouble = strerror(errno);
        if (got == 0) break;
        if (got > 0) used += (size_t)got;
    }
    close(file);
    *text = buffer, *size = used;
    return trouble;
}

/* Adds a file of at most `limit` bytes to the sources; NULL, or why it could not be read. */
static const char *add_file(lua_State *L, const char *path, const char *name, const char *display, off_t limit,
                            const source_file **out) {
    script *s = script_of(L);
    if (s->source_count == SCRIPT_SOURCES) return "one file more than a scene may have";
    source_file file = {.name = arena_copy_string(s->memory, name), .display = arena_copy_string(s->memory, display)};
    if (!file.name || !file.display) throw_memory(L);
    const char *trouble = read_whole(s, path, limit, &file.text, &file.size);
    if (trouble) return trouble;
    s->sources[s->source_count] = file;
    *out = &s->sources[s->source_count++];
    return NULL;
}

static const char *add_source(lua_State *L, const char *path, const char *name, const char *display,
                              const source_file **out) {
    return add_file(L, path, name, display, FILE_LIMIT, out);
}

/* The text that Lua gets: without a byte-order mark, without a first line that starts with '#'. */
static const char *lua_text(const source_file *file, size_t *size) {
    const char *text = file->text;
    *size = file->size;
    if (*size >= 3 && memcmp(text, "\xef\xbb\xbf", 3) == 0) text += 3, *size -= 3;
    while (*size > 0 && *file->text == '#' && *text != '\n') text++, (*size)--;
    return text;
}

static void load_text(lua_State *L, const source_file *file) {
    size_t size;
    const char *text = lua_text(file, &size);
    report r;
    if (size > 0 && text[0] == LUA_SIGNATURE[0]) {
        report_input(&r, file->display, 1, NULL, "Lua text", "a compiled chunk", NULL);
        throw_report(L, &r);
    }
    lua_pushfstring(L, "@%s", file->display);
    int outcome = luaL_loadbufferx(L, text, size, lua_tostring(L, -1), "t");
    guard_settle(guard_of(L), outcome);
    guard_raise(L);
    if (outcome != LUA_OK) {
        /* "short_src:line: what"; a chunk under the same name tells what short_src is. */
        lua_Debug named;
        if (luaL_loadbufferx(L, "", 0, lua_tostring(L, -2), "t") != LUA_OK) throw_memory(L);
        lua_getinfo(L, ">S", &named);
        const char *message = lua_tostring(L, -1);
        size_t prefix = strlen(named.short_src);
        int line = 0;
        if (message && strncmp(message, named.short_src, prefix) == 0 && message[prefix] == ':') {
            char *end;
            line = (int)strtol(message + prefix + 1, &end, 10);
            message = *end == ':' ? end + 2 : end;
        }
        report_input(&r, file->display, line, NULL, "valid Lua", message, NULL);
        throw_report(L, &r);
    }
    lua_remove(L, -2);
    lua_rawgetp(L, LUA_REGISTRYINDEX, &KEY_ENVIRONMENT);
    if (!lua_setupvalue(L, -2, 1)) lua_pop(L, 1);
}

/* ---- names of files ---------------------------------------------------------------------------------------------- */

typedef struct name_list {
    int count;
    char text[LISTED_NAMES][LISTED_SIZE];
} name_list;

/* Adds the names of a folder's files with a given ending, without it. */
static void list_files(name_list *list, const char *folder, const char *ending) {
    DIR *stream = opendir(folder);
    if (!stream) return;
    for (struct dirent *entry; (entry = readdir(stream)) && list->count < LISTED_NAMES;) {
        size_t length = strlen(entry->d_name);
        if (length <= ENDING || length - ENDING >= LISTED_SIZE) continue;
        if (strcasecmp(entry->d_name + length - ENDING, ending) != 0) continue;
        memcpy(list->text[list->count], entry->d_name, length - ENDING);
        list->text[list->count++][length - ENDING] = '\0';
    }
    closedir(stream);
}

static void list_folder(name_list *list, const char *folder) {
    list_files(list, folder, ".lua");
}

/* The listed name nearest to `name`, in out[LISTED_SIZE]; NULL when none is near. */
static const char *nearest_listed(const name_list *list, const char *name, char *out) {
    const char *names[LISTED_NAMES];
    for (int i = 0; i < list->count; i++) names[i] = list->text[i];
    const char *nearest = name_nearest(name, names, list->count);
    if (!nearest) return NULL;
    snprintf(out, LISTED_SIZE, "%s", nearest);
    return out;
}

/* Relative, without "..", made of letters, digits, '_', '-', '.' and single '/'. */
static bool is_plain_path(const char *path) {
    if (!*path || *path == '/' || strlen(path) > 200) return false;
    for (const char *p = path; *p; p++) {
        if (!isalnum((unsigned char)*p) && !strchr("_-./", *p)) return false;
        bool part_starts = p == path || p[-1] == '/';
        if (part_starts && (*p == '.' || *p == '/')) return false; /* no "..", no hidden files */
    }
    return path[strlen(path) - 1] != '/';
}

/* The folder part of a path, with its slash; empty when there is none. */
static void folder_of(const char *path, char *out, size_t size) {
    const char *slash = strrchr(path, '/');
    snprintf(out, size, "%.*s", slash ? (int)(slash - path) + 1 : 0, path);
}

/* As people would write it: relative to the working folder where it lies below. */
static const char *shown_path(const script *s, const char *path) {
    size_t length = strlen(s->working);
    return length > 1 && strncmp(path, s->working, length) == 0 && path[length] == '/' ? path + length + 1 : path;
}

/* ---- the scene --------------------------------------------------------------------------------------------------- */

static void throw_missing_scene(lua_State *L, const char *path, const char *trouble) {
    char folder[SCRIPT_PATH], nearest[LISTED_SIZE];
    folder_of(path, folder, sizeof folder);
    name_list list = {0};
    list_folder(&list, *folder ? folder : ".");
    char stem[LISTED_SIZE * 2];
    snprintf(stem, sizeof stem, "%s", path + strlen(folder));
    char *ending = strrchr(stem, '.');
    if (ending) *ending = '\0';
    const char *name = nearest_listed(&list, stem, nearest);
    char suggestion[sizeof folder + LISTED_SIZE + 8] = "";
    if (name && strcmp(name, stem) != 0) snprintf(suggestion, sizeof suggestion, "%s%s.lua", folder, name);
    report r;
    report_input(&r, path, 0, NULL, "a scene file", trouble, suggestion);
    throw_report(L, &r);
}

const source_file *load_scene_file(lua_State *L, const char *path) {
    script *s = script_of(L);
    const source_file *file = NULL;
    const char *slash = strrchr(path, '/'), *trouble = add_source(L, path, slash ? slash + 1 : path, path, &file);
    if (trouble) throw_missing_scene(L, path, trouble);
    char absolute[SCRIPT_PATH], folder[SCRIPT_PATH];
    if (!realpath(path, absolute)) throw_missing_scene(L, path, strerror(errno));
    folder_of(absolute, folder, sizeof folder);
    s->folder = arena_copy_string(s->memory, folder);
    char working[SCRIPT_PATH];
    s->working = arena_copy_string(s->memory, getcwd(working, sizeof working) ? working : "");
    if (!s->folder || !s->working) throw_memory(L);
    load_text(L, file);
    return file;
}

/* ---- require ----------------------------------------------------------------------------------------------------- */

static void refuse_after_loading(lua_State *L, const char *what) {
    if (script_of(L)->loaded)
        throw_here(L, what, "a pure function of time or place", "a file read after loading", NULL);
}

static void load_module(lua_State *L, const char *name) {
    script *s = script_of(L);
    char path[SCRIPT_PATH + 256], file_name[256], folder[SCRIPT_PATH], display[SCRIPT_PATH + 256], nearest[LISTED_SIZE];
    snprintf(file_name, sizeof file_name, "%s.lua", name);
    snprintf(path, sizeof path, "%s%s", s->folder, file_name);
    folder_of(s->sources[0].display, folder, sizeof folder);
    snprintf(display, sizeof display, "%s%s", folder, file_name);
    const source_file *file;
    const char *trouble = add_source(L, path, file_name, display, &file);
    if (trouble) {
        char found[SCRIPT_PATH];
        name_list list = {0};
        folder_of(path, folder, sizeof folder);
        list_folder(&list, folder);
        snprintf(found, sizeof found, "%.100s: %.100s", file_name, trouble);
        throw_here(L, "require", "\"sunder\" or a Lua file beside the scene", found,
                   nearest_listed(&list, name, nearest));
    }
    load_text(L, file);
    lua_pushstring(L, name);
    lua_call(L, 1, 1);
}

int sandbox_require(lua_State *L) {
    const char *name = luaL_checkstring(L, 1);
    lua_settop(L, 1);
    lua_rawgetp(L, LUA_REGISTRYINDEX, &KEY_MODULES);
    lua_pushvalue(L, 1);
    if (lua_rawget(L, 2) != LUA_TNIL) {
        if (lua_toboolean(L, -1)) return 1;
        throw_here(L, "require", "modules that do not need each other", name, NULL);
    }
    refuse_after_loading(L, "require");
    char found[160];
    describe_value(L, 1, found, sizeof found);
    if (!is_plain_path(name))
        throw_here(L, "require", "\"sunder\" or the name of a Lua file beside the scene (no folders above it)", found,
                   NULL);
    lua_pop(L, 1);
    lua_pushvalue(L, 1);
    lua_pushboolean(L, 0); /* being loaded */
    lua_rawset(L, 2);
    load_module(L, name);
    if (!lua_toboolean(L, -1)) {
        lua_pop(L, 1);
        lua_pushboolean(L, 1);
    }
    lua_pushvalue(L, 1);
    lua_pushvalue(L, -2);
    lua_rawset(L, 2);
    return 1;
}

/* ---- data -------------------------------------------------------------------------------------------------------- */

/* Whether `ending` is one of a list such as ".obj.ply.stl". */
static bool is_listed_ending(const char *ending, const char *endings) {
    for (const char *e = endings; *e; e += ENDING)
        if (strncasecmp(ending, e, ENDING) == 0) return true;
    return false;
}

/* Records that a data file could not be read, and which file beside it has almost its name. */
static void report_missing_data(script *s, const char *path, const char *name, const char *trouble, const place *p) {
    char folder[SCRIPT_PATH], stem[SCRIPT_TEXT + 16], nearest[LISTED_SIZE], found[SCRIPT_TEXT + 128], suggestion[512] = "";
    const char *slash = strrchr(name, '/'), *ending = name + strlen(name) - ENDING;
    name_list list = {0};
    folder_of(path, folder, sizeof folder);
    list_files(&list, folder, ending);
    snprintf(stem, sizeof stem, "%.*s", (int)(ending - (slash ? slash + 1 : name)), slash ? slash + 1 : name);
    const char *other = nearest_listed(&list, stem, nearest);
    if (other) snprintf(suggestion, sizeof suggestion, "%.*s%s%s", slash ? (int)(slash - name) + 1 : 0, name, other, ending);
    snprintf(found, sizeof found, "'%s': %s", name, trouble);
    problem_place(s, p, "a file that can be read, by its path from the scene's folder", found, other ? suggestion : NULL);
}

const source_file *read_data_file(script *s, const char *name, const char *endings, const place *p) {
    char path[SCRIPT_PATH + SCRIPT_TEXT], expected[160], found[SCRIPT_TEXT + 8];
    size_t length = strlen(name);
    snprintf(found, sizeof found, "'%s'", name);
    if (!is_plain_path(name)) {
        problem_place(s, p, "a path below the scene's folder, of letters, digits, '_', '-', '.' and '/'", found, NULL);
        return NULL;
    }
    if (length <= ENDING || !is_listed_ending(name + length - ENDING, endings)) {
        size_t used = (size_t)snprintf(expected, sizeof expected, "a file that ends in");
        for (const char *e = endings; *e; e += ENDING)
            used += (size_t)snprintf(expected + used, sizeof expected - used, "%s %.4s", e == endings ? "" : " or", e);
        problem_place(s, p, expected, found, NULL);
        return NULL;
    }
    snprintf(path, sizeof path, "%s%s", s->folder, name);
    const char *shown = shown_path(s, path);
    const source_file *file = find_source(s, shown);
    const char *trouble = file ? NULL : add_file(s->L, path, name, shown, DATA_LIMIT, &file);
    if (trouble) report_missing_data(s, path, name, trouble, p);
    return trouble ? NULL : file;
}

/* ---- recipes ----------------------------------------------------------------------------------------------------- */

/* The folders that recipes are looked for in, one after the other; false when there are no more. `step` starts at 0. */
static bool recipe_folder(const script *s, int step, char *out, size_t size) {
    char folder[SCRIPT_PATH];
    snprintf(folder, sizeof folder, "%s", s->folder);
    for (int up = 0; up < step && up < CALLER_FOLDERS; up++) {
        folder[strlen(folder) - 1] = '\0';
        char *slash = strrchr(folder, '/');
        if (slash) {
            slash[1] = '\0';
            continue;
        }
        /* Above the root: the places that do not depend on the scene. */
        const char *environment = getenv("SUNDER_RECIPES");
        const char *const fixed[] = {environment && *environment ? environment : SUNDER_SOURCE_DIR "/recipes",
                                     SUNDER_SOURCE_DIR "/recipes", SUNDER_DATA_DIR "/recipes"};
        int which = step - up - 1;
        if (which >= 3) return false;
        snprintf(out, size, "%s/", fixed[which]);
        return true;
    }
    snprintf(out, size, "%srecipes/", folder);
    return step < CALLER_FOLDERS;
}

static void throw_missing_recipe(lua_State *L, const char *name, const place *p) {
    script *s = script_of(L);
    name_list list = {0};
    char folder[SCRIPT_PATH + 16], found[160], nearest[LISTED_SIZE];
    for (int step = 0; recipe_folder(s, step, folder, sizeof folder); step++) list_folder(&list, folder);
    snprintf(found, sizeof found, "'%.100s'", name);
    throw_place(L, p,
                "the name of a recipe (recipes/NAME.lua beside the scene or in a folder above it, or $SUNDER_RECIPES)",
                found, nearest_listed(&list, name, nearest));
}

/* Finds and reads recipes/NAME.lua, or a .lua file by its path from the scene. */
static const source_file *find_recipe(lua_State *L, const char *name, const place *p) {
    script *s = script_of(L);
    char path[SCRIPT_PATH + 512], folder[SCRIPT_PATH + 16], source_name[256];
    const source_file *file = NULL;
    size_t length = strlen(name);
    if (!is_plain_path(name)) throw_missing_recipe(L, name, p);
    if (length > 4 && strcmp(name + length - 4, ".lua") == 0) {
        snprintf(path, sizeof path, "%s%s", s->folder, name);
        file = find_source(s, shown_path(s, path));
        if (file) return file;
        if (add_source(L, path, name, shown_path(s, path), &file) != NULL) throw_missing_recipe(L, name, p);
        return file;
    }
    snprintf(source_name, sizeof source_name, "recipes/%s.lua", name);
    for (int step = 0; recipe_folder(s, step, folder, sizeof folder); step++) {
        snprintf(path, sizeof path, "%s%s.lua", folder, name);
        file = find_source(s, shown_path(s, path));
        if (file) return file;
        if (access(path, R_OK) == 0 && add_source(L, path, source_name, shown_path(s, path), &file) == NULL)
            return file;
    }
    throw_missing_recipe(L, name, p);
    return NULL;
}

/* Pushes a copy of the plain table at `index`. */
static void push_copy(lua_State *L, int index, int depth, const char *file) {
    place p = {.file = file};
    if (depth > COPY_DEPTH)
        throw_place(L, &p, "a recipe of tables not nested this deep", "a table within itself?", NULL);
    luaL_checkstack(L, 8, "nested too deep");
    index = lua_absindex(L, index);
    lua_newtable(L);
    lua_pushnil(L);
    while (lua_next(L, index)) {
        guard_spend(L, 10);
        lua_pushvalue(L, -2);
        if (lua_type(L, -2) == LUA_TTABLE)
            push_copy(L, -2, depth + 1, file);
        else
            lua_pushvalue(L, -2);
        lua_rawset(L, -5);
        lua_pop(L, 1);
    }
}

/* Pushes the table that a recipe file returned: run once. */
static void push_recipe_table(lua_State *L, const source_file *file, const place *p) {
    lua_rawgetp(L, LUA_REGISTRYINDEX, &KEY_RECIPES);
    int kind = lua_getfield(L, -1, file->display);
    if (kind == LUA_TBOOLEAN) throw_place(L, p, "recipes that do not need each other", file->display, NULL);
    if (kind == LUA_TNIL) {
        lua_pop(L, 1);
        lua_pushboolean(L, 0); /* being loaded */
        lua_setfield(L, -2, file->display);
        load_text(L, file);
        lua_call(L, 0, 1);
        place result = {.file = file->display};
        char found[80];
        describe_value(L, -1, found, sizeof found);
        if (lua_type(L, -1) != LUA_TTABLE) throw_place(L, &result, "a recipe that returns a table", found, NULL);
        lua_pushvalue(L, -1);
        lua_setfield(L, -3, file->display);
    }
    lua_remove(L, -2);
}

void push_recipe(lua_State *L, const char *name, const place *p) {
    refuse_after_loading(L, "s.recipe");
    luaL_checkstack(L, API_STACK, "recipes nested too deep");
    const source_file *file = find_recipe(L, name, p);
    push_recipe_table(L, file, p);
    push_copy(L, -1, 0, file->display);
    lua_remove(L, -2);
    const char *slash = strrchr(name, '/'), *stem = slash ? slash + 1 : name;
    const char *ending = strrchr(stem, '.');
    lua_rawgetp(L, LUA_REGISTRYINDEX, &KEY_ORIGINS);
    lua_pushvalue(L, -2);
    lua_createtable(L, 0, 5);
    lua_pushlstring(L, stem, ending ? (size_t)(ending - stem) : strlen(stem));
    lua_setfield(L, -2, "name");
    lua_pushstring(L, file->display);
    lua_setfield(L, -2, "file");
    lua_rawset(L, -3);
    lua_pop(L, 1);
}

/* core.recipe(name, overrides): a fresh copy of the recipe's table, its origin noted; the Lua side merges the
 * overrides. */
int api_recipe(lua_State *L) {
    script *s = script_of(L);
    luaL_checkstack(L, API_STACK, "recipes");
    place here = s->here;
    char found[80];
    lua_settop(L, 2);
    describe_value(L, 1, found, sizeof found);
    if (lua_type(L, 1) != LUA_TSTRING) throw_place(L, &here, "the name of a recipe", found, NULL);
    describe_value(L, 2, found, sizeof found);
    if (!lua_isnil(L, 2) && !lua_istable(L, 2)) throw_place(L, &here, "a table of overrides, or nothing", found, NULL);
    push_recipe(L, lua_tostring(L, 1), &here);
    lua_rawgetp(L, LUA_REGISTRYINDEX, &KEY_ORIGINS);
    lua_pushvalue(L, -2);
    lua_rawget(L, -2);
    lua_pushvalue(L, 2);
    lua_setfield(L, -2, "overrides");
    lua_pushstring(L, here.file);
    lua_setfield(L, -2, "caller");
    lua_pushinteger(L, here.line);
    lua_setfield(L, -2, "line");
    lua_pop(L, 2);
    return 1;
}
