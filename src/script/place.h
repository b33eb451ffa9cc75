/* Where in a Lua file a value was written: for messages that name the right line.
 *
 * Lua tells the line of a call, not of a key in the table that the call was given. A place is the call's line and the
 * path of keys from there; place_find reads the source again, token by token, and follows the path through the table
 * constructors as far as they are written out. Only messages pay for it. */
#ifndef SUNDER_SCRIPT_PLACE_H
#define SUNDER_SCRIPT_PLACE_H

#include <stddef.h>

enum { PLACE_DEPTH = 8 };

typedef struct place_step {
    const char *key; /* NULL: the index counts */
    int index;       /* from 1 */
} place_step;

typedef struct place {
    const char *file;
    int line;         /* of the call; 0: the file's last `return` */
    const char *call; /* the word before the opening brace ("scene", "sphere"), or NULL */
    int depth;
    place_step path[PLACE_DEPTH];
} place;

/* The place one key, or one list index, further down. Keys are kept by pointer. Past PLACE_DEPTH the path stays as it
 * is. */
place place_key(const place *from, const char *key);
place place_index(const place *from, int index);

/* "solids[1].shape"; the call's word when the path is empty. */
void place_text(const place *p, char *text, size_t size);

/* The line of the deepest step of the path that could be found in text[size]; at least the line of the call. */
int place_find(const place *p, const char *text, size_t size);

#endif
