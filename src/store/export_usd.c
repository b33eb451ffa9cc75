/* A run as one USD file in text: UsdGeomPoints with time samples. */
#include "store/export_internal.h"

#include <inttypes.h>
#include <string.h>

typedef struct sequence {
    FILE *out;
    int count;
    export_reader read;
    void *context;
} sequence;

/* The array of a name in the frame's set, "position" too; NULL when the frame lacks it. */
static const record *find_array(const record_list *records, const char *name) {
    const char *set = export_set(records);
    char path[RECORD_NAME];
    snprintf(path, sizeof path, "%s/%s", set ? set : "", name);
    return set ? record_find(records, path) : NULL;
}

static void write_values(FILE *out, const record *item) {
    bool vector = item->components == 3;
    fputc('[', out);
    for (int64_t i = 0; i < item->count; i++) {
        const char *comma = i ? ", " : "";
        if (vector)
            fprintf(out, "%s(%.7g, %.7g, %.7g)", comma, record_value(item, 3 * i), record_value(item, 3 * i + 1), record_value(item, 3 * i + 2));
        else
            fprintf(out, "%s%.7g", comma, record_value(item, i));
    }
    fputc(']', out);
}

/* "    TYPE NAME.timeSamples = { frame: [...], … }" */
static status write_samples(const sequence *s, const char *type, const char *usd_name, const char *name, report *r) {
    if (strncmp(usd_name, "primvars:", 9) == 0) fprintf(s->out, "    %s %s (\n        interpolation = \"vertex\"\n    )\n", type, usd_name);
    fprintf(s->out, "    %s %s.timeSamples = {\n", type, usd_name);
    for (int i = 0; i < s->count; i++) {
        record_list records = {0};
        int64_t frame;
        status code = s->read(s->context, i, &records, &frame, r);
        const record *item = code == STATUS_OK ? find_array(&records, name) : NULL;
        if (item) {
            fprintf(s->out, "        %" PRId64 ": ", frame);
            write_values(s->out, item);
            fputs(",\n", s->out);
        }
        record_clear(&records);
        if (code != STATUS_OK) return code;
    }
    fputs("    }\n", s->out);
    return STATUS_OK;
}

/* Quantities become primvars; what a first frame has of one or three components. */
static status write_fields(const sequence *s, const record_list *first, report *r) {
    const char *set = export_set(first);
    const record *item;
    status code = STATUS_OK;
    for (int k = 0; code == STATUS_OK && (item = export_field(first, set, k)); k++) {
        const char *name = export_short_name(item);
        char usd_name[80];
        if ((item->components != 1 && item->components != 3) || strcmp(name, "id") == 0 || strcmp(name, "velocity") == 0) continue;
        snprintf(usd_name, sizeof usd_name, "primvars:%s", name);
        bool whole = item->type != RECORD_F32 && item->type != RECORD_F64;
        code = write_samples(s, item->components == 3 ? "vector3f[]" : whole ? "int[]" : "float[]", usd_name, name, r);
    }
    return code;
}

static status write_stage(const sequence *s, double rate, report *r) {
    record_list first = {0};
    int64_t from = 0, to = 0;
    status code = s->read(s->context, s->count - 1, &first, &to, r);
    record_clear(&first);
    if (code == STATUS_OK) code = s->read(s->context, 0, &first, &from, r);
    if (code == STATUS_OK && !export_set(&first)) code = report_set(r, STATUS_SYSTEM, "frames without particles");
    if (code == STATUS_OK) {
        fprintf(s->out, "#usda 1.0\n(\n    defaultPrim = \"particles\"\n    startTimeCode = %" PRId64 "\n    endTimeCode = %" PRId64
                        "\n    timeCodesPerSecond = %.9g\n    framesPerSecond = %.9g\n    upAxis = \"Y\"\n)\n\ndef Points \"particles\"\n{\n", from, to, rate, rate);
        code = write_samples(s, "point3f[]", "points", "position", r);
    }
    if (code == STATUS_OK) code = write_samples(s, "vector3f[]", "velocities", "velocity", r);
    if (code == STATUS_OK) code = write_samples(s, "int64[]", "ids", "id", r);
    if (code == STATUS_OK) code = write_fields(s, &first, r);
    fputs("}\n", s->out);
    record_clear(&first);
    return code;
}

status export_usda_write(const char *path, int count, double rate, export_reader read, void *context, report *r) {
    export_file f;
    status code = export_begin(&f, path, r);
    if (code != STATUS_OK) return code;
    sequence s = {.out = f.out, .count = count, .read = read, .context = context};
    return export_end(&f, write_stage(&s, rate, r), r);
}
