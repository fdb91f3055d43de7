/* SPDX-License-Identifier: Apache-2.0 */
/* Obstacles of a scene: meshes from files or made in code, then placed. */
#include "app/base/app.h"
#include "app/base/file.h"
#include "app/scene/bodies.h"
#include "app/scene/shapes.h"

#include <stdlib.h>
#include <string.h>

/* A deforming obstacle: numbered files of the same mesh. */
struct series {
    char *files; /* with one %d, as frames/wave_%04d.ply */
    int first, count;
    double dt;
};
struct obstacle {
    drape_obstacle out;
    char *name, *file;
    char *clip; /* of `animation`: its name, empty for none; NULL: the first */
    struct look look;
    struct shape shape;
    struct placement placement;
    struct series series;
};

static int read_series(struct json *json, json_t *node, void *out)
{
    static const struct json_key keys[] = {
        TEXT_KEY("files", offsetof(struct series, files)),
        INTEGER_KEY("first", offsetof(struct series, first), 0, 1e9),
        INTEGER_KEY("count", offsetof(struct series, count), 1, 1e6),
        NUMBER_KEY("dt", offsetof(struct series, dt), 1e-6, 1e6),
        {0}};
    struct series *series = out;
    series->dt = 1.0 / 60;
    int status = json_fields(json, node, keys, series);
    if (status != APP_OK)
        return status;
    const char *percent = series->files ? strchr(series->files, '%') : NULL;
    const char *d =
        percent ? percent + 1 + strspn(percent + 1, "0123456789") : NULL;
    if (!d || d - percent > 4 || *d != 'd' || strchr(d, '%') || !series->count)
        return json_refuse(json, "expected files with one %%d or %%04d in "
                                 "the name, and count");
    return APP_OK;
}

/* The name of an animation, or false for none. */
static int read_clip(struct json *json, json_t *node, void *out)
{
    static const struct json_key name = TEXT_KEY("animation", 0);
    char **clip = out;
    if (json_is_string(node))
        return json_value(json, node, &name, clip);
    if (!json_is_false(node))
        return json_refuse(json, "expected the name of an animation, or false");
    *clip = pool_text(json->pool, "");
    return *clip ? APP_OK : complain(APP_FAILED, "out of memory");
}

/* Looks for a mesh in the folders of a list with colons, such as $DRAPE_MODELS;
 * an empty one is the current folder, as in PATH. */
static bool find_in_list(const char *list, const char *name,
                         char path[FILE_PATH])
{
    while (list) {
        char folder[FILE_PATH];
        size_t length = strcspn(list, ":");
        const char *next = list[length] ? list + length + 1 : NULL;
        if (length < sizeof folder) {
            memcpy(folder, list, length);
            folder[length] = 0;
            if (file_join(path, length ? folder : ".", name) &&
                file_exists(path))
                return true;
        }
        list = next;
    }
    return false;
}

/* Where a mesh is looked for: as named from the scene's folder, then in the
 * folders of $DRAPE_MODELS, in models/ of $DRAPE_DATA, or of build/data without
 * it, and in build/models. */
static int find_mesh(const struct json *json, const char *name,
                     char path[FILE_PATH])
{
    const struct scene *scene = json->user;
    char folder[FILE_PATH];
    strcpy(folder, scene->file);
    char *slash = strrchr(folder, '/');
    strcpy(slash ? slash : folder, slash ? "" : ".");
    if (name[0] == '/') {
        if (snprintf(path, FILE_PATH, "%s", name) < FILE_PATH &&
            file_exists(path))
            return APP_OK;
        return json_refuse(json, "%s: no such mesh file", name);
    }
    const char *own = getenv("DRAPE_MODELS"), *data = getenv("DRAPE_DATA");
    char models[FILE_PATH];
    if (!file_join(models, data && *data ? data : "build/data", "models"))
        return APP_USAGE;
    const char *folders[] = {*folder ? folder : "/", models, "build/models"};
    for (int k = 0; k < 3; k++) {
        if (k == 1 && find_in_list(own ? own : "", name, path))
            return APP_OK;
        if (file_join(path, folders[k], name) && file_exists(path))
            return APP_OK;
    }
    return json_refuse(json,
                       "mesh %s: found neither in %s, $DRAPE_MODELS, %s nor "
                       "build/models (drape fetch-models DIR fetches the "
                       "statues of drape's own scenes)",
                       name, folders[0], models);
}

static int load(struct json *json, const char *name, struct clip *clip,
                struct mesh *mesh)
{
    char path[FILE_PATH];
    int status = find_mesh(json, name, path);
    if (status == APP_OK)
        status = mesh_load_clip(json->pool, path, clip, mesh);
    if (status == APP_OK && clip && *clip->others)
        complain(APP_OK,
                 "%s: has several animations, of which the first is taken: %s; "
                 "the key animation names another, or false for none",
                 path, clip->others);
    return status;
}

/* Loads the mesh of a file, with its animation as frames. */
static int load_file(struct json *json, struct obstacle *o, struct mesh *mesh)
{
    struct clip clip = {.name = o->clip};
    int status = load(json, o->file, &clip, mesh);
    if (status != APP_OK || !clip.frames)
        return status;
    if (o->out.motion >= 0)
        return json_refuse(json,
                           "%s is animated, and a body has a motion or an "
                           "animation; \"animation\": false lets the mesh be "
                           "as it is at rest",
                           o->file);
    mesh_place_frames(clip.x, mesh->nv, clip.frames, &o->placement);
    o->out.frames = clip.frames;
    o->out.frame_dt = clip.dt;
    o->out.frame = (const double(*)[3])clip.x;
    return APP_OK;
}

/* Loads the frames of a deforming obstacle; the first is also its mesh. */
static int load_series(struct json *json, struct obstacle *o, struct mesh *mesh)
{
    drape_obstacle *out = &o->out;
    const struct series *s = &o->series;
    double(*frame)[3] = NULL;
    for (int k = 0; k < s->count; k++) {
        char name[FILE_PATH];
        const char *percent = strchr(s->files, '%');
        int width = atoi(percent + 1);
        snprintf(name, sizeof name, "%.*s%0*d%s", (int)(percent - s->files),
                 s->files, width, s->first + k, strchr(percent, 'd') + 1);
        struct mesh here;
        int status = load(json, name, NULL, &here);
        if (status != APP_OK)
            return status;
        if (k == 0) {
            *mesh = here;
            frame = pool_take(json->pool, (size_t)s->count * (size_t)here.nv,
                              sizeof *frame);
            if (!frame)
                return complain(APP_FAILED, "out of memory");
        }
        if (here.nv != mesh->nv || here.nt != mesh->nt)
            return json_refuse(json,
                               "%s: another number of vertices or "
                               "triangles than the first",
                               name);
        if (memcmp(here.tri, mesh->tri, (size_t)mesh->nt * sizeof *mesh->tri) !=
            0)
            return json_refuse(json, "%s: other triangles than the first",
                               name);
        memcpy(frame + (size_t)k * (size_t)mesh->nv, here.x,
               (size_t)mesh->nv * sizeof *frame);
    }
    mesh_place_frames(frame, mesh->nv, s->count, &o->placement);
    out->frames = s->count;
    out->frame_dt = s->dt;
    out->frame = (const double(*)[3])frame;
    return APP_OK;
}

/* The largest side of a box. */
static double across(const struct mesh *mesh)
{
    double lo[3], hi[3], most = 0;
    mesh_box(mesh, lo, hi);
    for (int i = 0; i < 3; i++)
        most = hi[i] - lo[i] > most ? hi[i] - lo[i] : most;
    return most;
}

/* Says where the mesh of a file is so much larger or smaller than all cloths
 * that it probably has another unit than metres. */
static void compare(const struct json *json, const struct obstacle *o,
                    const struct mesh *mesh)
{
    enum { TIMES = 100 };
    const struct scene *scene = json->user;
    double cloth = 0, size = across(mesh);
    for (int k = 0; k < scene->def.n_cloths; k++) {
        const drape_cloth *c = &scene->def.cloths[k];
        cloth = c->width > cloth ? c->width : cloth;
        cloth = c->height > cloth ? c->height : cloth;
    }
    if (o->placement.size > 0 || !(cloth > 0) || !(size > 0) ||
        (size <= TIMES * cloth && size * TIMES >= cloth))
        return;
    complain(
        APP_OK,
        "%s: %s: note: the mesh is %.3g m across, the largest cloth %.3g m; "
        "if the file is not in metres, scale or size say so",
        json->file, json->where, size, cloth);
}

/* Says which keys are of another shape than this one, or of no obstacle. */
static void say_idle(struct json *json, json_t *node, const struct obstacle *o)
{
    static const struct {
        const char *name[2];
        int shapes; /* bits: of which it is */
    } keys[] = {{{"extent"}, 1 << SHAPE_PLANE | 1 << SHAPE_BOX},
                {{"radius"},
                 1 << SHAPE_SPHERE | 1 << SHAPE_CAPSULE | 1 << SHAPE_FUNNEL},
                {{"length"}, 1 << SHAPE_CAPSULE | 1 << SHAPE_FUNNEL},
                {{"throat"}, 1 << SHAPE_FUNNEL},
                {{"height"}, 1 << SHAPE_FUNNEL | 1 << SHAPE_STATUE},
                {{"detail"},
                 1 << SHAPE_SPHERE | 1 << SHAPE_CAPSULE | 1 << SHAPE_FUNNEL |
                     1 << SHAPE_STATUE}};
    static const char *const axis[] = {"axis", NULL};
    static const char *const check[] = {"check", NULL};
    for (size_t k = 0; k < sizeof keys / sizeof *keys; k++)
        if (!(keys[k].shapes >> o->shape.kind & 1))
            json_idle(json, node, keys[k].name, "it is of other shapes");
    if (o->placement.angle == 0)
        json_idle(json, node, axis, "there is no angle");
    size_t length = json_enter(json, ".look");
    json_idle(json, json_object_get(node, "look"), check, "it is of cloths");
    json_leave(json, length);
}

/* Makes the obstacle's mesh; exactly one of mesh, shape and frames is given. */
static int make(struct json *json, struct obstacle *o)
{
    struct mesh mesh = {0};
    bool shape = o->shape.kind != SHAPE_NONE, series = o->series.files;
    if (shape + series + (o->file != NULL) != 1)
        return json_refuse(json, "expected one of mesh, shape and frames");
    int status = series  ? load_series(json, o, &mesh)
                 : shape ? shape_make(json->pool, &o->shape, &mesh)
                         : load_file(json, o, &mesh);
    if (status != APP_OK)
        return status;
    if (o->clip && !o->file)
        return json_refuse(json, "animation: expected a mesh beside it");
    mesh_place(&mesh, &o->placement);
    if (!shape)
        compare(json, o, &mesh);
    ((struct scene *)json->user)->degenerate += mesh_degenerate(&mesh);
    o->out.n_vertices = mesh.nv;
    o->out.n_triangles = mesh.nt;
    o->out.x = (const double(*)[3])mesh.x;
    o->out.tri = (const int32_t(*)[3])mesh.tri;
    return APP_OK;
}

static const char *const shape_names[] = {
    "plane", "box", "sphere", "capsule", "funnel", "statue", NULL};

static int read_obstacle(struct json *json, json_t *node, void *out)
{
#define O(name) offsetof(struct obstacle, name)
    static const struct json_key keys[] = {
        TEXT_KEY("name", O(name)),
        TEXT_KEY("mesh", O(file)),
        CHOICE_KEY("shape", O(shape.kind), shape_names),
        NESTED_KEY("frames", O(series), read_series),
        NESTED_KEY("animation", O(clip), read_clip),
        VECTOR_KEY("extent", O(shape.extent), 1e-6, 1e6, 3),
        NUMBER_KEY("radius", O(shape.radius), 1e-6, 1e6),
        NUMBER_KEY("length", O(shape.length), 1e-6, 1e6),
        NUMBER_KEY("throat", O(shape.throat), 1e-6, 1e6),
        NUMBER_KEY("height", O(shape.height), 1e-6, 1e6),
        INTEGER_KEY("detail", O(shape.detail), 8, 4096),
        VECTOR_KEY("up", O(placement.up), -1e6, 1e6, 3),
        NUMBER_KEY("size", O(placement.size), 1e-6, 1e6),
        NUMBER_KEY("scale", O(placement.scale), 1e-9, 1e9),
        BOOLEAN_KEY("stand", O(placement.stand)),
        VECTOR_KEY("axis", O(placement.axis), -1e6, 1e6, 3),
        NUMBER_KEY("angle", O(placement.angle), -36000, 36000),
        VECTOR_KEY("at", O(placement.at), -1e6, 1e6, 3),
        NUMBER_KEY("friction", O(out.friction), 0, 10),
        NESTED_KEY("motion", O(out.motion), read_motion_name),
        NESTED_KEY("look", O(look), read_look),
        {0}};
    struct obstacle *o = out;
    o->look = look_default();
    drape_default_obstacle(&o->out);
    o->out.motion = -1;
    o->placement.scale = 1;
    o->placement.axis[1] = 1;
    o->shape = (struct shape){SHAPE_NONE, {1, 1, 1}, 0.5, 0.5, 0.1, 1, 64};
    int status = json_fields(json, node, keys, o);
    if (status == APP_OK)
        say_idle(json, node, o);
    return status == APP_OK ? make(json, o) : status;
}

int read_obstacles(struct json *json, json_t *node, void *out)
{
    struct scene *scene = out;
    struct json_list list = {
        .read = read_obstacle, .size = sizeof(struct obstacle), .most = 1000};
    int status = json_items(json, node, &list);
    if (status != APP_OK)
        return status;
    size_t count = (size_t)list.count;
    const struct obstacle *o = list.items;
    drape_obstacle *to = pool_take(json->pool, count + 1, sizeof *to);
    scene->obstacle_name = pool_take(json->pool, count + 1, sizeof(char *));
    scene->obstacle_look =
        pool_take(json->pool, count + 1, sizeof(struct look));
    if (!to || !scene->obstacle_name || !scene->obstacle_look)
        return complain(APP_FAILED, "out of memory");
    for (size_t k = 0; k < count; k++) {
        to[k] = o[k].out;
        scene->obstacle_look[k] = o[k].look;
        scene->obstacle_name[k] =
            o[k].name ? o[k].name : pool_text(json->pool, "obstacle");
    }
    scene->def.obstacles = to;
    scene->def.n_obstacles = list.count;
    return APP_OK;
}
