/* The rows of both tables, as printed in the papers, in the papers' order. */
#include "cli/table1.h"

#include <string.h>

static const table1_row rows[] = {
    /* AnisoMPM (Wolper et al. 2020), Table 1: s/frame, Δt_frame, Δx, Δt_step, N. */
    {.name = "meat", .example = "(Fig. 1) Meat", .scene = "solid/meat.lua", .particles = 500000, .seconds = 19.30, .fps = 24, .dt = 5e-4,
     .dx = 6.88e-3, .warm = 13, .frames = 3, .remark = "the puller starts at frame 12, damage at frame 34"},
    {.name = "tube_pull", .example = "(Fig. 2) Tube Pull", .scene = "solid/tube_pull.lua", .settings = {"variant=full"}, .particles = 50000,
     .seconds = 1.403, .fps = 24, .dt = 1e-3, .dx = 4.38e-2, .warm = 57, .frames = 3, .remark = ""},
    {.name = "tube_compress", .example = "(Fig. 3) Tube Compress", .scene = "solid/tube_compress.lua", .settings = {"variant=full"},
     .particles = 400000, .seconds = 83.36, .fps = 24, .dt = 1e-4, .dx = 1.48e-2, .warm = 8, .frames = 3, .remark = ""},
    {.name = "pork_belly", .example = "(Fig. 4) Pork Belly", .scene = "solid/pork_belly.lua", .settings = {"variant=orthotropic"},
     .particles = 500000, .seconds = 38.78, .fps = 24, .dt = 2.5e-4, .dx = 6.92e-3, .warm = 7, .frames = 3, .remark = ""},
    {.name = "orange", .example = "(Fig. 5) Orange (int./ext.)", .scene = "solid/orange.lua", .particles = 80000, .seconds = 4.890, .fps = 24,
     .dt = 1e-3, .dx = 7.68e-3, .warm = 4, .frames = 3, .remark = "50K + 30K in the paper; ours are shared out by volume"},
    {.name = "fish", .example = "(Fig. 6) Fish", .scene = "solid/fish.lua", .particles = 50000, .seconds = 0.5625, .fps = 48, .dt = 1e-3,
     .dx = 2.40e-2, .warm = 2, .frames = 3, .remark = ""},
    {.name = "cheese", .example = "(Fig. 7) Cheese", .scene = "solid/cheese.lua", .particles = 500000, .seconds = 48.87, .fps = 24, .dt = 2e-4,
     .dx = 3.08e-3, .warm = 3, .frames = 3, .remark = ""},
    {.name = "lance", .example = "(Fig. 9) Lance (Arma./Ropes)", .scene = "solid/lance.lua", .settings = {"variant=full"}, .particles = 650000,
     .seconds = 111.9, .fps = 24, .dt = 1.25e-4, .dx = 7.81e-3, .warm = 6, .frames = 3,
     .remark = "500K + 150K in the paper; ours are shared out by volume"},
    {.name = "lance_inextensible", .example = "(Fig. 9) Lance, inextensible ropes", .scene = "solid/lance.lua", .settings = {"variant=inextensible"},
     .particles = 650000, .seconds = 111.9, .fps = 24, .dt = 1.25e-4, .dx = 7.81e-3, .warm = 0, .frames = 1,
     .remark = "beside the paper's figure of ropes with stiff fibres: it has none of this"},
    {.name = "heart", .example = "(Fig. 14) Heart", .scene = "solid/heart.lua", .settings = {"variant=plastic"}, .particles = 500000,
     .seconds = 23.88, .fps = 24, .dt = 5.1e-4, .dx = 9.09e-3, .warm = 3, .frames = 3, .remark = ""},
    {.name = "bone", .example = "(Fig. 24) Bone (Bend)", .scene = "solid/bone.lua", .settings = {"variant=bend", "E=7e8", "eta=0.1"},
     .particles = 200000, .seconds = 1974, .fps = 48, .dt = 1e-6, .dx = 2.98e-3, .warm = 0, .frames = 3,
     .remark = "E and eta are the paper's: our scene's own E is a thousand times softer"},

    /* Sheet paper (Han, Xue, Aanjaneya), Table 1: seconds per 20 steps, Δt, Δx, particles. Its first column is one for two scenes. */
    {.name = "stretch", .example = "Large stretching", .sheet = true, .scene = "sheet/stretch.lua", .settings = {"variant=dry"},
     .particles = 10000, .seconds = 0.2, .dt = 1e-4, .dx = 0.02, .warm = 3, .frames = 30, .remark = ""},
    {.name = "shear", .example = "(Large stretching and) Shearing", .sheet = true, .scene = "sheet/shear.lua", .settings = {"variant=dry"},
     .particles = 10000, .seconds = 0.2, .dt = 1e-4, .dx = 0.02, .warm = 3, .frames = 30, .remark = ""},
    {.name = "crack_path", .example = "Crack path", .sheet = true, .scene = "sheet/crack_path.lua", .settings = {"variant=wet"},
     .particles = 10000, .seconds = 0.2, .dt = 1e-4, .dx = 0.02, .warm = 10, .frames = 100, .remark = ""},
    {.name = "foil", .example = "Foil", .sheet = true, .scene = "sheet/foil.lua", .settings = {"variant=wet"}, .particles = 2500, .seconds = 0.6,
     .dt = 3e-4, .dx = 0.04, .warm = 10, .frames = 100, .remark = ""},
    {.name = "rubber", .example = "Rubbery Film", .sheet = true, .scene = "sheet/rubber.lua", .settings = {"variant=wet"}, .particles = 2500,
     .seconds = 0.2, .dt = 5e-4, .dx = 0.04, .warm = 10, .frames = 100, .remark = ""},
    {.name = "seaweed", .example = "Seaweed", .sheet = true, .scene = "sheet/seaweed.lua", .settings = {"variant=wet"}, .particles = 2500,
     .seconds = 0.2, .dt = 1e-4, .dx = 0.04, .warm = 10, .frames = 100, .remark = ""},
};

int table1_rows(const table1_row **out) {
    *out = rows;
    return (int)(sizeof rows / sizeof *rows);
}

const table1_row *table1_find(const char *name) {
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++)
        if (strcmp(rows[i].name, name) == 0) return &rows[i];
    return NULL;
}

const char *table1_machine(bool sheet) {
    return sheet ? "Intel i7-8565K, threads not said" : "Intel i7-9700K, 8 threads";
}
