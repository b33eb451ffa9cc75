/* Tetrahedra of triangle meshes, by Gmsh's C API. The library brings a CAD kernel and 90 others along: it is loaded when a scene wants it, and a
 * program that never does starts without. */
#include "base/memory.h"
#include "geom/tetrahedra.h"

#include <stdio.h>
#include <string.h>

#ifndef SUNDER_HAS_GMSH

static status missing(report *r) {
    return report_input(r, NULL, 0, "mesher", "\"lattice\", or a build that found Gmsh (package libgmsh-dev)", "\"gmsh\" in a build without it", NULL);
}

const char *tetrahedra_gmsh_version(report *r) {
    (void)missing(r);
    return NULL;
}

status tetrahedra_fill_gmsh(const shape *s, double edge, tetrahedra *out, report *r) {
    (void)s, (void)edge;
    *out = (tetrahedra){0};
    return missing(r);
}

#else

#include <dlfcn.h>
#include <gmshc.h>

#define FUNCTIONS(X)                                                                                                   \
    X(gmshInitialize) X(gmshFinalize) X(gmshFree) X(gmshClear) X(gmshOptionSetNumber) X(gmshModelAdd)                  \
    X(gmshModelAddDiscreteEntity) X(gmshModelMeshAddNodes) X(gmshModelMeshAddElementsByType)                           \
    X(gmshModelGeoAddSurfaceLoop) X(gmshModelGeoAddVolume) X(gmshModelGeoSynchronize) X(gmshModelMeshGenerate)         \
    X(gmshModelMeshGetNodes) X(gmshModelMeshGetElementsByType) X(gmshLoggerGetLastError)

#define TEXT_(x) #x
#define TEXT(x) TEXT_(x)
#define LIBRARY "libgmsh.so." TEXT(GMSH_API_VERSION_MAJOR) "." TEXT(GMSH_API_VERSION_MINOR)

#define MEMBER(f) __typeof__(f) *f;
typedef struct gmsh_api {
    void *library;
    FUNCTIONS(MEMBER)
} gmsh_api;

enum { TRIANGLE = 2, TETRAHEDRON = 4 }; /* Gmsh's element types */

static status open_library(gmsh_api *g, report *r) {
    g->library = dlopen(LIBRARY, RTLD_NOW | RTLD_LOCAL);
    bool whole = g->library != NULL;
#define LOAD(f)                                                                                                        \
    if (whole) {                                                                                                       \
        void *symbol = dlsym(g->library, #f);                                                                          \
        memcpy(&g->f, &symbol, sizeof symbol);                                                                         \
        whole = symbol != NULL;                                                                                        \
    }
    FUNCTIONS(LOAD)
#undef LOAD
    if (whole) return STATUS_OK;
    if (g->library) dlclose(g->library);
    return report_input(r, NULL, 0, "mesher", "\"lattice\", or " LIBRARY " on this machine (package libgmsh-dev)", "\"gmsh\" without it", NULL);
}

const char *tetrahedra_gmsh_version(report *r) {
    gmsh_api g;
    if (open_library(&g, r) != STATUS_OK) return NULL;
    dlclose(g.library);
    return GMSH_API_VERSION;
}

/* What Gmsh says is wrong, as wrong input: its reasons are the mesh's. */
static status gmsh_error(gmsh_api *g, report *r) {
    char *text = NULL, found[200];
    int error;
    g->gmshLoggerGetLastError(&text, &error);
    snprintf(found, sizeof found, "Gmsh says: %.180s", !error && text && *text ? text : "no more than that it failed");
    if (text) g->gmshFree(text);
    return report_input(r, NULL, 0, "shape", "a mesh that Gmsh can fill with tetrahedra (closed, without self-intersections)", found, NULL);
}

/* The surface as a discrete entity, and a volume within. */
static status give_surface(gmsh_api *g, const mesh *m, double edge, report *r) {
    size_t vertices = (size_t)m->vertex_count, corners = 3 * (size_t)m->triangle_count;
    size_t *tags = memory_allocate_array(vertices, sizeof *tags), *nodes = memory_allocate_array(corners, sizeof *nodes);
    status code = tags && nodes ? STATUS_OK : report_set(r, STATUS_SYSTEM, "out of memory for Gmsh's copy of a mesh");
    if (code == STATUS_OK) {
        for (size_t v = 0; v < vertices; v++) tags[v] = v + 1;
        for (size_t k = 0; k < corners; k++) nodes[k] = (size_t)m->triangle[k] + 1;
        int e[8] = {0}, surface = 1, loop = 1;
        g->gmshModelAdd("body", &e[0]);
        g->gmshModelAddDiscreteEntity(2, surface, NULL, 0, &e[1]);
        g->gmshModelMeshAddNodes(2, surface, tags, vertices, m->vertex, 3 * vertices, NULL, 0, &e[2]);
        g->gmshModelMeshAddElementsByType(surface, TRIANGLE, NULL, 0, nodes, corners, &e[3]);
        g->gmshModelGeoAddSurfaceLoop(&surface, 1, loop, &e[4]);
        g->gmshModelGeoAddVolume(&loop, 1, 1, &e[5]);
        g->gmshModelGeoSynchronize(&e[6]);
        g->gmshOptionSetNumber("Mesh.CharacteristicLengthMax", edge, &e[7]);
        for (int i = 0; i < 8 && code == STATUS_OK; i++)
            if (e[i]) code = gmsh_error(g, r);
    }
    memory_free(tags, tags ? vertices * sizeof *tags : 0);
    memory_free(nodes, nodes ? corners * sizeof *nodes : 0);
    return code;
}

/* Gmsh's arrays. */
typedef struct gmsh_mesh {
    size_t *tag, *element, *node, tags, elements, nodes;
    double *place, *parameter;
    size_t places, parameters;
} gmsh_mesh;

/* Numbers the vertices that tetrahedra use, in Gmsh's order, and turns left-handed tetrahedra. `number` is [highest tag + 1]. */
static void copy_mesh(const gmsh_mesh *from, int32_t *number, tetrahedra *out) {
    for (size_t k = 0; k < from->nodes; k++) number[from->node[k]] = 1;
    for (size_t v = 0; v < from->tags; v++) {
        if (number[from->tag[v]] != 1) continue;
        memcpy(out->vertex + 3 * out->vertex_count, from->place + 3 * v, 3 * sizeof(double));
        number[from->tag[v]] = -(int32_t)out->vertex_count++ - 1; /* below 0: has its number */
    }
    for (size_t i = 0; i < from->nodes / 4; i++) {
        int32_t *corner = out->corner + 4 * out->count;
        for (int k = 0; k < 4; k++) corner[k] = -number[from->node[4 * i + (size_t)k]] - 1;
        double determinant = tetrahedra_determinant(out, out->count);
        if (determinant < 0) {
            int32_t swap = corner[0];
            corner[0] = corner[1], corner[1] = swap;
        }
        out->count += determinant != 0;
    }
}

static status take_mesh(gmsh_api *g, tetrahedra *out, report *r) {
    gmsh_mesh from = {0};
    int e[2] = {0};
    g->gmshModelMeshGetNodes(&from.tag, &from.tags, &from.place, &from.places, &from.parameter, &from.parameters, -1, -1, 0, 0, &e[0]);
    g->gmshModelMeshGetElementsByType(TETRAHEDRON, &from.element, &from.elements, &from.node, &from.nodes, -1, 0, 1, &e[1]);
    status code = e[0] || e[1] || from.nodes == 0 ? gmsh_error(g, r) : STATUS_OK;
    if (code == STATUS_OK && (from.nodes / 4 >= INT32_MAX / 8 || from.tags >= INT32_MAX / 8))
        code = report_input(r, NULL, 0, "dx", "a spacing that gives under 2.6e8 tetrahedra", "a smaller one", NULL);
    size_t highest = 0;
    for (size_t v = 0; v < from.tags; v++) highest = from.tag[v] > highest ? from.tag[v] : highest;
    int32_t *number = code == STATUS_OK ? memory_allocate_array(highest + 1, sizeof *number) : NULL;
    if (code == STATUS_OK) {
        out->vertex = memory_allocate_array(from.tags, 3 * sizeof *out->vertex);
        out->corner = memory_allocate_array(from.nodes / 4, 4 * sizeof *out->corner);
        out->vertex_capacity = out->vertex ? (int64_t)from.tags : 0;
        out->capacity = out->corner ? (int64_t)(from.nodes / 4) : 0;
        if (!number || !out->vertex || !out->corner) code = report_set(r, STATUS_SYSTEM, "out of memory for %zu tetrahedra", from.nodes / 4);
    }
    if (code == STATUS_OK) copy_mesh(&from, number, out);
    memory_free(number, number ? (highest + 1) * sizeof *number : 0);
    g->gmshFree(from.tag), g->gmshFree(from.element), g->gmshFree(from.node), g->gmshFree(from.place), g->gmshFree(from.parameter);
    return code;
}

static status run_gmsh(const mesh *m, double edge, tetrahedra *out, report *r) {
    gmsh_api g;
    status code = open_library(&g, r);
    if (code != STATUS_OK) return code;
    int error, ignored;
    g.gmshInitialize(0, NULL, 0, &error);
    g.gmshOptionSetNumber("General.Terminal", 0, &ignored);
    code = error ? gmsh_error(&g, r) : give_surface(&g, m, edge, r);
    if (code == STATUS_OK) {
        g.gmshModelMeshGenerate(3, &error);
        code = error ? gmsh_error(&g, r) : take_mesh(&g, out, r);
    }
    g.gmshFinalize(&ignored); /* the library stays loaded: what it started with is not to be undone */
    return code;
}

status tetrahedra_fill_gmsh(const shape *s, double edge, tetrahedra *out, report *r) {
    *out = (tetrahedra){0};
    if (!shape_is_mesh(s))
        return report_input(r, NULL, 0, "mesher", "\"lattice\" for a shape that is no mesh of triangles", "\"gmsh\"", NULL);
    if (!(edge > 0)) return report_input(r, NULL, 0, "dx", "a spacing above 0", "none", NULL);
    mesh surface;
    status code = shape_triangles(s, &surface, r);
    if (code != STATUS_OK) return code;
    code = mesh_cut_long_sides(&surface, 1.5 * edge, r);
    if (code == STATUS_OK) code = run_gmsh(&surface, edge, out, r);
    mesh_free(&surface);
    if (code != STATUS_OK) tetrahedra_free(out);
    return code;
}

#endif
