/* Table 1 of the two papers: what was timed there, and which of our scenes answers to it. */
#ifndef SUNDER_CLI_TABLE1_H
#define SUNDER_CLI_TABLE1_H

#include <stdbool.h>

enum { TABLE1_SETTINGS = 4, TABLE1_SHEET_STEPS = 20 };

typedef struct table1_row {
    const char *name;    /* what --row takes */
    const char *example; /* as the paper's table says it */
    bool sheet;          /* the membrane paper's: seconds are those of TABLE1_SHEET_STEPS steps, not of a frame */
    const char *scene;   /* below the folder of scenes */
    const char *settings[TABLE1_SETTINGS]; /* KEY=VALUE beside particles, frame rate and spacing; NULL-terminated */
    long particles;      /* over all bodies */
    double seconds;      /* the paper's */
    double fps;          /* the paper's frame is 1/fps; 0 for sheets */
    double dt, dx;       /* the paper's step; its grid spacing, or distance of a sheet's particles */
    int warm;            /* frames passed over before timing: until something is damaged, where that is not long */
    int frames;          /* timed if nothing else is asked for: a sheet's have a few steps only, of a fraction of a millisecond each */
    const char *remark;  /* where our scene is not the paper's; "" */
} table1_row;

/* All rows, solids first. Returns their number. */
int table1_rows(const table1_row **rows);

/* The row of that name, or NULL. */
const table1_row *table1_find(const char *name);

/* Where the papers were timed. */
const char *table1_machine(bool sheet);

#endif
