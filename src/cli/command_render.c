/* sunder render: a frame of a run as a PNG. */
#include "cli/cli.h"

#include "base/memory.h"
#include "base/record.h"
#include "store/frames.h"
#include "store/ledger.h"
#include "view/picture.h"

#include <getopt.h>
#include <math.h>
#include <string.h>

typedef struct render_options {
    const char *run, *database, *out, *colour;
    long frame, width, height, yaw, pitch, zoom;
} render_options;

static const struct option long_options[] = {
    {"frame", required_argument, NULL, 'f'}, {"out", required_argument, NULL, 'o'},    {"db", required_argument, NULL, 'd'},
    {"width", required_argument, NULL, 'w'}, {"height", required_argument, NULL, 'h'}, {"colour", required_argument, NULL, 'c'},
    {"yaw", required_argument, NULL, 'y'},   {"pitch", required_argument, NULL, 'p'},  {"zoom", required_argument, NULL, 'z'},
    {NULL, 0, NULL, 0}};

static int parse(render_options *o, int count, char **arguments) {
    int option, code = 0;
    while ((option = getopt_long(count, arguments, "", long_options, NULL)) != -1) {
        switch (option) {
        case 'f': code = cli_number("render", "--frame", optarg, 0, 1000000000, &o->frame); break;
        case 'o': o->out = optarg; break;
        case 'd': o->database = optarg; break;
        case 'c': o->colour = optarg; break;
        case 'w': code = cli_number("render", "--width", optarg, 16, 8192, &o->width); break;
        case 'h': code = cli_number("render", "--height", optarg, 16, 8192, &o->height); break;
        case 'y': code = cli_number("render", "--yaw", optarg, -360, 360, &o->yaw); break;
        case 'p': code = cli_number("render", "--pitch", optarg, -90, 90, &o->pitch); break;
        case 'z': code = cli_number("render", "--zoom", optarg, 10, 10000, &o->zoom); break;
        default: return cli_usage("render", "wrong option");
        }
        if (code) return code;
    }
    if (optind != count - 1) return cli_usage("render", "expected one run (an id, its beginning or end, or last)");
    o->run = arguments[optind];
    size_t length = strlen(o->out);
    if (length < 4 || strcmp(o->out + length - 4, ".png") != 0) return cli_usage("render", "--out %s: expected a name that ends in .png", o->out);
    return 0;
}

static status find_folder(const render_options *o, char *folder, size_t size, report *r) {
    char path[1024], id[LEDGER_ID];
    ledger *l = NULL;
    status code = ledger_open_past(o->database, path, sizeof path, &l, r);
    if (code == STATUS_OK) code = ledger_resolve(l, o->run, id, folder, size, r);
    if (l) ledger_close(l);
    return code;
}

/* A record's values as floats, [count][components]; NULL when it is absent or memory is out. */
static float *as_floats(const record *item) {
    if (!item || (item->type != RECORD_F32 && item->type != RECORD_F64)) return NULL;
    size_t n = (size_t)item->count * (size_t)item->components;
    float *out = memory_allocate_array(n, sizeof *out);
    for (size_t i = 0; out && i < n; i++)
        out[i] = item->type == RECORD_F32 ? ((const float *)item->data)[i] : (float)((const double *)item->data)[i];
    return out;
}

static void free_floats(float *values, const record *item) {
    if (values) memory_free(values, (size_t)item->count * (size_t)item->components * sizeof *values);
}

enum { SETS = 2 };
static const char *const sets[SETS] = {"solid", "sheet"};

static const record *find_field(const record_list *records, int set, const char *field) {
    char name[RECORD_NAME];
    snprintf(name, sizeof name, "%s/%s", sets[set], field);
    return record_find(records, name);
}

/* What a set's particles show unless one is told: damage, what diffuses, broken bonds. Told, a field of either set. */
static const record *find_colour(const record_list *records, int set, const char *colour) {
    static const char *const names[SETS][2] = {{"damage", "damage"}, {"diffused", "broken"}};
    if (colour) return strncmp(colour, sets[set], strlen(sets[set])) == 0 ? record_find(records, colour) : NULL;
    const record *found = find_field(records, set, names[set][0]);
    return found ? found : find_field(records, set, names[set][1]);
}

/* A quantity without a natural range is shown over its largest value. */
static void scale_colour(float *value, int64_t count) {
    float most = 0;
    for (int64_t i = 0; i < count; i++) most = fmaxf(most, value[i]);
    for (int64_t i = 0; i < count && most > 0; i++) value[i] /= most;
}

/* Widens the box by a frame's particles. */
static void widen(const record_list *records, float low[3], float high[3]) {
    for (int set = 0; set < SETS; set++) {
        const record *position = find_field(records, set, "position");
        float *points = as_floats(position), here_low[3], here_high[3];
        if (points && view_bounds(points, position->count, here_low, here_high) > 0)
            for (int c = 0; c < 3; c++) {
                low[c] = fminf(low[c], here_low[c]);
                high[c] = fmaxf(high[c], here_high[c]);
            }
        free_floats(points, position);
    }
}

/* The camera holds the first frame and the one that is drawn: what has not moved stays in its place from picture to picture. */
static status fit_camera(const char *folder, int64_t frame, view_camera *camera, report *r) {
    float low[3] = {HUGE_VALF, HUGE_VALF, HUGE_VALF}, high[3] = {-HUGE_VALF, -HUGE_VALF, -HUGE_VALF};
    const int64_t frames[2] = {0, frame};
    for (int i = 0; i < 2; i++) {
        record_list records = {0};
        double time;
        int64_t step;
        status code = frame_read(folder, frames[i], &records, &time, &step, r);
        if (code == STATUS_OK) widen(&records, low, high);
        record_clear(&records);
        if (code != STATUS_OK) return code;
    }
    view_camera_fit(camera, low, high);
    return STATUS_OK;
}

/* Points and colours of all sets, solids first; particles of a set without the colour are 0. */
typedef struct point_cloud {
    int64_t count;
    float *points; // [count][3]
    float *values; // [count]
    bool coloured;
} point_cloud;

static void free_cloud(point_cloud *cloud) {
    memory_free(cloud->points, (size_t)cloud->count * 3 * sizeof *cloud->points);
    memory_free(cloud->values, (size_t)cloud->count * sizeof *cloud->values);
}

static bool add_set(const record_list *records, int set, const char *colour, int64_t first, point_cloud *cloud) {
    const record *position = find_field(records, set, "position"), *value = find_colour(records, set, colour);
    if (!position) return true;
    float *points = as_floats(position), *values = as_floats(value);
    if (points) memcpy(cloud->points + 3 * first, points, (size_t)position->count * 3 * sizeof *points);
    if (values && strcmp(value->name, "sheet/diffused") == 0) scale_colour(values, value->count);
    if (values) memcpy(cloud->values + first, values, (size_t)value->count * sizeof *values);
    cloud->coloured |= values != NULL;
    bool good = points != NULL;
    free_floats(points, position);
    free_floats(values, value);
    return good;
}

static status gather_cloud(const record_list *records, const char *colour, point_cloud *cloud, report *r) {
    const record *wanted = colour ? record_find(records, colour) : NULL;
    if (colour && (!wanted || wanted->components != 1))
        return report_input(r, NULL, 0, "--colour", "a field of the frame with one component, such as solid/damage or sheet/diffused", colour, NULL);
    int64_t first[SETS];
    for (int set = 0; set < SETS; set++) {
        const record *position = find_field(records, set, "position");
        first[set] = cloud->count;
        cloud->count += position ? position->count : 0;
    }
    cloud->points = memory_allocate_array((size_t)cloud->count, 3 * sizeof *cloud->points);
    cloud->values = memory_allocate_array((size_t)cloud->count, sizeof *cloud->values);
    bool good = cloud->count > 0 && cloud->points && cloud->values;
    for (int set = 0; set < SETS && good; set++) good = add_set(records, set, colour, first[set], cloud);
    return good ? STATUS_OK : report_set(r, STATUS_SYSTEM, "out of memory for the picture, or a frame without particles");
}

static status draw(const render_options *o, const record_list *records, view_render_options *look, report *r) {
    point_cloud cloud = {0};
    size_t bytes = (size_t)look->width * (size_t)look->height * 3;
    uint8_t *rgb = memory_allocate(bytes);
    status code = rgb ? gather_cloud(records, o->colour, &cloud, r) : report_set(r, STATUS_SYSTEM, "out of memory for the picture");
    if (code == STATUS_OK) code = view_render_points(cloud.points, cloud.coloured ? cloud.values : NULL, cloud.count, look, rgb, r);
    if (code == STATUS_OK) code = view_write_png(o->out, rgb, look->width, look->height, r);
    free_cloud(&cloud);
    memory_free(rgb, bytes);
    return code;
}

int command_render(int count, char **arguments) {
    render_options o = {.frame = -1, .out = "sunder.png", .width = 1280, .height = 720, .yaw = 25, .pitch = 20, .zoom = 100};
    int result = parse(&o, count, arguments);
    if (result) return result;
    char folder[1024];
    record_list records = {0};
    double time = 0;
    int64_t step;
    report r;
    view_render_options look = view_render_options_default();
    look.width = (int)o.width;
    look.height = (int)o.height;
    look.camera.yaw = (float)((double)o.yaw * M_PI / 180);
    look.camera.pitch = (float)((double)o.pitch * M_PI / 180);
    look.camera.zoom = (float)o.zoom / 100;
    status code = find_folder(&o, folder, sizeof folder, &r);
    int64_t frame = code == STATUS_OK && o.frame < 0 ? frame_last(folder) : o.frame;
    if (code == STATUS_OK) code = fit_camera(folder, frame, &look.camera, &r);
    if (code == STATUS_OK) code = frame_read(folder, frame, &records, &time, &step, &r);
    if (code == STATUS_OK) code = draw(&o, &records, &look, &r);
    record_clear(&records);
    if (code != STATUS_OK) return cli_fail(&r);
    fprintf(stderr, "%s: frame %lld, t = %.4g\n", o.out, (long long)frame, time);
    return 0;
}
