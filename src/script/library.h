/* The scenes and recipes that are at hand, for lists to choose from. */
#ifndef SUNDER_SCRIPT_LIBRARY_H
#define SUNDER_SCRIPT_LIBRARY_H

#include <stdbool.h>
#include <stddef.h>

enum { LIBRARY_PATH = 512, LIBRARY_NAME = 64, LIBRARY_REMARK = 160 };

typedef struct library_scene {
    char path[LIBRARY_PATH];     /* as it can be opened from the working folder */
    char name[LIBRARY_NAME];     /* "tube_pull" */
    char group[LIBRARY_NAME];    /* the folder it lies in, below scenes/: "solid"; "" in the working folder */
    char remark[LIBRARY_REMARK]; /* the first line of the comment that it begins with */
} library_scene;

/* Scene files in the working folder, in its scenes/ and one folder down, in $SUNDER_SCENES and with the program (its
 * sources' scenes/, or the installed ones): sorted by group and name, each file once. A file of the working folder is
 * one when it has the word "scene" and asks for the module "sunder". Fills at most `limit`; returns how many. */
int library_scenes(library_scene *out, int limit);

/* A scene's path: as given when there is such a file, else that of the scene at hand whose path ends so ("solid/tube_pull.lua")
 * or whose name it is ("tube_pull"). False: as given, and there is none. */
bool library_find_scene(const char *name, char path[LIBRARY_PATH]);

/* The shortest name by which library_find_scene finds this file ("solid/tube_pull.lua"), so that it can be found from another folder or
 * clone too; as given when it is not a scene at hand. */
void library_name_scene(const char *path, char name[LIBRARY_PATH]);

/* Names of the recipes that a scene can ask for, sorted, each once. */
int library_recipes(const char *scene_path, char (*out)[LIBRARY_NAME], int limit);

#endif
