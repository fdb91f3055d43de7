/* SPDX-License-Identifier: Apache-2.0 */
/* Obstacles of a scene: meshes from files or made in code, then placed. */
#include "app/base/app.h"
#include "app/base/file.h"
#include "app/scene/bodies.h"
#include "app/scene/shapes.h"

#include <stdlib.h>
#include <string.h>

struct obstacle {
    drape_obstacle out;
    char *name, *file;
    char *clip; /* of `animation`: its name, empty for none; NULL: the first */
    struct look look;
    struct shape shape;
    struct placement placement;
    struct sequence sequence;
    struct limb limb;
    double apart; /* m, the room between its parts; 0: as they are */
    int parted;   /* rows of the scene's list, with those of obstacles before */
};

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
struct places {
    char scene[FILE_PATH], models[FILE_PATH];
};

static bool look_in(const struct json *json, struct places *in,
                    const char *name, char path[FILE_PATH])
{
    const struct scene *scene = json->user;
    char *folder = in->scene;
    strcpy(folder, scene->file);
    char *slash = strrchr(folder, '/');
    strcpy(slash ? slash : folder, slash ? "" : ".");
    if (name[0] == '/')
        return snprintf(path, FILE_PATH, "%s", name) < FILE_PATH &&
               file_exists(path);
    const char *own = getenv("DRAPE_MODELS"), *data = getenv("DRAPE_DATA");
    if (!file_join(in->models, data && *data ? data : "build/data", "models"))
        return false;
    if (!*folder)
        strcpy(folder, "/");
    const char *folders[] = {folder, in->models, "build/models"};
    for (int k = 0; k < 3; k++) {
        if (k == 1 && find_in_list(own ? own : "", name, path))
            return true;
        if (file_join(path, folders[k], name) && file_exists(path))
            return true;
    }
    return false;
}

int find_mesh(const struct json *json, const char *name, char path[FILE_PATH])
{
    struct places in;
    if (look_in(json, &in, name, path))
        return APP_OK;
    if (name[0] == '/')
        return json_refuse(json, "%s: no such mesh file", name);
    return json_refuse(json,
                       "mesh %s: found neither in %s, $DRAPE_MODELS, %s nor "
                       "build/models (drape fetch-models DIR fetches the "
                       "statues of drape's own scenes)",
                       name, in.scene, in.models);
}

bool has_mesh(const struct json *json, const char *name)
{
    struct places in;
    char path[FILE_PATH];
    return look_in(json, &in, name, path);
}

/* Loads the mesh of a file, with its animation as frames. */
static int load_file(struct json *json, struct obstacle *o, struct mesh *mesh)
{
    struct clip clip = {.name = o->clip};
    char path[FILE_PATH];
    int status = find_mesh(json, o->file, path);
    if (status == APP_OK)
        status = mesh_load_clip(json->pool, path, &clip, mesh);
    if (status == APP_OK && *clip.others)
        complain(APP_OK,
                 "%s: has several animations, of which the first is taken: %s; "
                 "the key animation names another, or false for none",
                 path, clip.others);
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
    } keys[] = {
        {{"extent"}, 1 << SHAPE_PLANE | 1 << SHAPE_BOX},
        {{"radius"},
         1 << SHAPE_SPHERE | 1 << SHAPE_CAPSULE | 1 << SHAPE_LIMB |
             1 << SHAPE_FUNNEL},
        {{"length"}, 1 << SHAPE_CAPSULE | 1 << SHAPE_LIMB | 1 << SHAPE_FUNNEL},
        {{"bend"}, 1 << SHAPE_LIMB},
        {{"throat"}, 1 << SHAPE_FUNNEL},
        {{"height"}, 1 << SHAPE_FUNNEL | 1 << SHAPE_STATUE},
        {{"detail"},
         1 << SHAPE_SPHERE | 1 << SHAPE_CAPSULE | 1 << SHAPE_LIMB |
             1 << SHAPE_FUNNEL | 1 << SHAPE_STATUE}};
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

/* Lets parts of the body give way to each other. */
static int part(struct json *json, struct obstacle *o, const struct mesh *mesh)
{
    struct scene *scene = json->user;
    struct parted_list *list = &scene->parted;
    bool moving = o->out.frames > 0;
    int pressed = 0, failed = 0, first = list->count, frame[2] = {-1, -1};
    double deep = 0;
    int closed = apart_closed(mesh);
    if (closed < 0)
        return no_memory();
    if (!closed)
        return json_refuse(json,
                           "apart: expected a closed mesh, in which every edge "
                           "has two triangles");
    int frames = moving ? o->out.frames : 1;
    int status =
        apart(json->pool, mesh, moving ? (double(*)[3])o->out.frame : mesh->x,
              frames, o->apart, list);
    for (int k = first; k < list->count; k++) {
        const struct parted *row = &list->row[k];
        pressed += row->frame != frame[0];
        failed += !row->parted && row->frame != frame[1];
        frame[0] = row->frame;
        frame[1] = row->parted ? frame[1] : row->frame;
        deep = row->parted && row->depth > deep ? row->depth : deep;
    }
    o->parted = list->count;
    if (pressed)
        complain(APP_OK,
                 "%s: %s: note: parts press on each other in %d of %d frames "
                 "and give way by up to %.2g m; in %d frames some are too deep "
                 "in each other and do not (parted.json)",
                 json->file, json->where, pressed, frames, deep, failed);
    return status;
}

/* Makes the obstacle's mesh; exactly one of mesh, shape and frames is given,
 * but for a point cache and a lead, which have a mesh beside them. */
static int make(struct json *json, struct obstacle *o)
{
    struct mesh mesh = {0};
    struct sequence *s = &o->sequence;
    bool shape = o->shape.kind != SHAPE_NONE, beside = s->file || s->lead > 0;
    if (shape + (s->files != NULL) + (o->file != NULL) != 1 &&
        !(beside && !shape))
        return json_refuse(json, "expected one of mesh, shape and frames");
    bool bends = o->limb.keys && o->shape.kind == SHAPE_LIMB;
    if (o->clip && (!o->file || beside))
        return json_refuse(json, "animation: expected a mesh beside it");
    int status =
        s->files || beside
            ? sequence_load(json, s, o->file, &o->placement, &mesh, &o->out)
        : shape ? shape_make(json->pool, &o->shape, &mesh)
                : load_file(json, o, &mesh);
    if (status != APP_OK)
        return status;
    if (bends)
        status =
            limb_bend(json, &o->limb, &o->shape, &o->placement, &mesh, &o->out);
    if (status != APP_OK)
        return status;
    mesh_place(&mesh, &o->placement);
    o->parted = ((struct scene *)json->user)->parted.count;
    if (o->apart > 0)
        status = part(json, o, &mesh);
    if (status != APP_OK)
        return status;
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
    "plane", "box", "sphere", "capsule", "limb", "funnel", "statue", NULL};

static int read_obstacle(struct json *json, json_t *node, void *out)
{
#define O(name) offsetof(struct obstacle, name)
    static const struct json_key keys[] = {
        TEXT_KEY("name", O(name)),
        TEXT_KEY("mesh", O(file)),
        CHOICE_KEY("shape", O(shape.kind), shape_names),
        NESTED_KEY("frames", O(sequence), read_sequence),
        NESTED_KEY("bend", O(limb), read_limb),
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
        NUMBER_KEY("apart", O(apart), 0, 1),
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
        for (int row = k ? o[k - 1].parted : 0; row < o[k].parted; row++)
            scene->parted.row[row].body = (int)k;
        scene->obstacle_look[k] = o[k].look;
        scene->obstacle_name[k] =
            o[k].name ? o[k].name : pool_text(json->pool, "obstacle");
    }
    scene->def.obstacles = to;
    scene->def.n_obstacles = list.count;
    return APP_OK;
}
