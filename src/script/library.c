#include "script/library.h"

#include "base/memory.h"

#include <dirent.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { SOURCE_PATH = 4096, FIRST_PART = 16 * 1024 /* bytes of a file that are looked at */ };

typedef struct scene_list {
    library_scene *items;
    int count, limit;
} scene_list;

/* ---- one file ---------------------------------------------------------------------------------------------------- */

static size_t read_first_part(const char *path, char text[FIRST_PART + 1]) {
    FILE *file = fopen(path, "re");
    size_t size = file ? fread(text, 1, FIRST_PART, file) : 0;
    if (file) fclose(file);
    text[size] = '\0';
    return size;
}

/* "-- Tube pull: a tube …" without its dashes and without the file's name where that stands first. */
static void take_remark(const char *text, char *out) {
    out[0] = '\0';
    if (strncmp(text, "--", 2) != 0) return;
    text += strspn(text, "- ");
    snprintf(out, LIBRARY_REMARK, "%.*s", (int)strcspn(text, "\r\n"), text);
}

static bool same_file(const char *a, const char *b) {
    struct stat first, second;
    return stat(a, &first) == 0 && stat(b, &second) == 0 && first.st_dev == second.st_dev && first.st_ino == second.st_ino;
}

static void add_scene(scene_list *list, const char *path, const char *group, const char *file, bool certain) {
    size_t stem = strlen(file);
    char text[FIRST_PART + 1];
    if (list->count == list->limit || stem <= 4 || strcmp(file + stem - 4, ".lua") != 0 || file[0] == '.') return;
    if (strlen(path) >= LIBRARY_PATH || stem - 4 >= LIBRARY_NAME) return;
    if (read_first_part(path, text) == 0) return;
    if (!certain && !(strstr(text, "\"sunder\"") && strstr(text, "scene"))) return;
    for (int i = 0; i < list->count; i++)
        if (same_file(list->items[i].path, path)) return;
    library_scene *s = &list->items[list->count++];
    snprintf(s->path, sizeof s->path, "%s", path);
    snprintf(s->name, sizeof s->name, "%.*s", (int)(stem - 4), file);
    snprintf(s->group, sizeof s->group, "%s", group);
    take_remark(text, s->remark);
}

/* ---- folders ----------------------------------------------------------------------------------------------------- */

static void add_folder(scene_list *list, const char *folder, const char *group, bool certain, int depth) {
    DIR *stream = opendir(folder);
    if (!stream) return;
    for (struct dirent *entry; (entry = readdir(stream));) {
        char path[SOURCE_PATH];
        struct stat facts;
        if (entry->d_name[0] == '.' || strcmp(entry->d_name, "sweeps") == 0 || strcmp(entry->d_name, "recipes") == 0) continue;
        const char *form = strcmp(folder, ".") == 0 ? "%.0s%s" : "%s/%s";
        if (snprintf(path, sizeof path, form, folder, entry->d_name) >= (int)sizeof path || stat(path, &facts) != 0) continue;
        if (S_ISDIR(facts.st_mode) && depth > 0) add_folder(list, path, entry->d_name, certain, depth - 1);
        else if (S_ISREG(facts.st_mode)) add_scene(list, path, group, entry->d_name, certain);
    }
    closedir(stream);
}

static int compare_scenes(const void *a, const void *b) {
    const library_scene *x = a, *y = b;
    int order = strcmp(x->group, y->group);
    return order ? order : strcmp(x->name, y->name);
}

int library_scenes(library_scene *out, int limit) {
    scene_list list = {out, 0, limit};
    const char *own = getenv("SUNDER_SCENES");
    add_folder(&list, ".", "", false, 0);
    add_folder(&list, "scenes", "scenes", true, 1);
    if (own && *own) add_folder(&list, own, "", true, 1);
    add_folder(&list, SUNDER_SOURCE_DIR "/scenes", "scenes", true, 1);
    add_folder(&list, SUNDER_DATA_DIR "/scenes", "scenes", true, 1);
    qsort(out, (size_t)list.count, sizeof *out, compare_scenes);
    return list.count;
}

bool library_find_scene(const char *name, char path[LIBRARY_PATH]) {
    enum { MOST = 256 };
    snprintf(path, LIBRARY_PATH, "%s", name);
    if (access(name, R_OK) == 0) return true;
    library_scene *list = memory_allocate_array(MOST, sizeof *list);
    int count = list ? library_scenes(list, MOST) : 0;
    bool found = false;
    for (int i = 0; i < count && !found; i++) {
        size_t whole = strlen(list[i].path), part = strlen(name);
        bool ends = part < whole && list[i].path[whole - part - 1] == '/' && strcmp(list[i].path + whole - part, name) == 0;
        found = ends || strcmp(list[i].name, name) == 0;
        if (found) snprintf(path, LIBRARY_PATH, "%s", list[i].path);
    }
    memory_free(list, MOST * sizeof *list);
    return found;
}

void library_name_scene(const char *path, char name[LIBRARY_PATH]) {
    char found[LIBRARY_PATH];
    const char *file = strrchr(path, '/'), *group = file;
    snprintf(name, LIBRARY_PATH, "%s", path);
    while (group && group > path && group[-1] != '/') group--;
    /* In the working folder that name may be another file's, or this one's already. */
    if (!group || group == path || access(group, F_OK) == 0) return;
    if (library_find_scene(group, found) && same_file(found, path)) snprintf(name, LIBRARY_PATH, "%s", group);
}

/* ---- recipes ----------------------------------------------------------------------------------------------------- */

static int add_recipes(const char *folder, char (*out)[LIBRARY_NAME], int count, int limit) {
    DIR *stream = opendir(folder);
    if (!stream) return count;
    for (struct dirent *entry; (entry = readdir(stream)) && count < limit;) {
        size_t size = strlen(entry->d_name);
        if (entry->d_name[0] == '.' || size <= 4 || size - 4 >= LIBRARY_NAME || strcmp(entry->d_name + size - 4, ".lua") != 0) continue;
        entry->d_name[size - 4] = '\0';
        bool known = false;
        for (int i = 0; i < count; i++) known = known || strcmp(out[i], entry->d_name) == 0;
        if (!known) snprintf(out[count++], LIBRARY_NAME, "%s", entry->d_name);
    }
    closedir(stream);
    return count;
}

static int compare_names(const void *a, const void *b) {
    return strcmp(a, b);
}

int library_recipes(const char *scene_path, char (*out)[LIBRARY_NAME], int limit) {
    char folder[PATH_MAX], path[PATH_MAX + 16];
    int count = 0;
    if (!realpath(scene_path, folder)) folder[0] = '\0';
    for (char *slash; (slash = strrchr(folder, '/'));) {
        *slash = '\0';
        snprintf(path, sizeof path, "%s/recipes", folder);
        count = add_recipes(path, out, count, limit);
    }
    const char *own = getenv("SUNDER_RECIPES");
    if (own && *own) count = add_recipes(own, out, count, limit);
    count = add_recipes(SUNDER_SOURCE_DIR "/recipes", out, count, limit);
    count = add_recipes(SUNDER_DATA_DIR "/recipes", out, count, limit);
    qsort(out, (size_t)count, LIBRARY_NAME, compare_names);
    return count;
}
