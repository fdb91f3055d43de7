/* SPDX-License-Identifier: Apache-2.0 */
/* Reads the cloths of a scene: grid, start, material, holes, cuts and pins. */
#include "app/scene/cloth.h"
#include "app/base/app.h"
#include "app/scene/bodies.h"
#include "app/scene/fabrics.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

/* One number s is the strain of every direction: the shear angle is then 2 s,
 * by which a square cell's diagonals strain by s. */
static int read_limit(struct json *json, json_t *node, void *out)
{
    static const struct json_key one = NUMBER_KEY("limit", 0, 0, 10);
    static const struct json_key each = VECTOR_KEY("limit", 0, 0, 10, 3);
    bool single = json_is_number(node);
    double *limit = out;
    int status = json_value(json, node, single ? &one : &each, limit);
    if (single && status == APP_OK) {
        limit[1] = limit[0];
        limit[2] = 2 * limit[0];
    }
    for (int k = 0; k < 3 && status == APP_OK; k++)
        if (limit[k] > 0 && limit[k] < 0.01)
            status = json_refuse(
                json, "%.15g: expected 0, for none, or 0.01 to 10", limit[k]);
    return status;
}

static int read_point(struct json *json, json_t *node, void *out)
{
    static const struct json_key strain = NUMBER_KEY("", 0, 1e-6, 10);
    static const struct json_key force = NUMBER_KEY("", 0, 1e-6, 1e9);
    double *point = out;
    if (!json_is_array(node) || json_array_size(node) != 2)
        return json_refuse(json, "expected [strain, N/m]");
    int status = json_value(json, json_array_get(node, 0), &strain, &point[0]);
    return status == APP_OK
               ? json_value(json, json_array_get(node, 1), &force, &point[1])
               : status;
}

/* The points of a table. The library checks them beside each other. */
static int read_table(struct json *json, json_t *node, void *out)
{
    struct json_list list = {
        .read = read_point, .size = sizeof(double[2]), .most = DRAPE_POINTS};
    double(*table)[2] = out;
    int status = json_items(json, node, &list);
    if (status == APP_OK && !list.count)
        status = json_refuse(json, "expected at least one point");
    if (status == APP_OK)
        memcpy(table, list.items, (size_t)list.count * sizeof *table);
    return status;
}

/* A number, or an object of that number and of measured tensions. */
static int read_stretch(struct json *json, json_t *node, void *out)
{
#define TABLE(name, way)                                                       \
    NESTED_KEY(name, offsetof(drape_material, table[way]), read_table)
    static const struct json_key modulus = NUMBER_KEY("stretch", 0, 1e-4, 1e9);
    static const struct json_key keys[] = {
        NUMBER_KEY("modulus", offsetof(drape_material, stretch), 1e-4, 1e9),
        TABLE("warp", DRAPE_WARP),
        TABLE("weft", DRAPE_WEFT),
        TABLE("bias", DRAPE_BIAS),
        {0}};
    drape_material *material = out;
    if (json_is_object(node))
        return json_fields(json, node, keys, material);
    return json_value(json, node, &modulus, &material->stretch);
}

int read_material(struct json *json, json_t *node, void *out)
{
#define MATERIAL(name, lo, hi)                                                 \
    NUMBER_KEY(#name, offsetof(drape_material, name), lo, hi)
    static const struct json_key keys[] = {
        NESTED_KEY("name", 0, read_fabric), /* first: the others override it */
        MATERIAL(density, 1e-4, 1e3),
        NESTED_KEY("stretch", 0, read_stretch),
        MATERIAL(shear, 0, 1e9),
        MATERIAL(bend, 0, 1e6),
        MATERIAL(damping, 0, 1e3),
        MATERIAL(thickness, 1e-6, 1),
        MATERIAL(friction, 0, 10),
        NESTED_KEY("limit", offsetof(drape_material, limit), read_limit),
        {0}};
    if (json_is_string(node))
        return read_fabric(json, node, out);
    return json_fields(json, node, keys, out);
}

static const char *const start_shapes[] = {"flat", "hung", "rolled", NULL};

static int read_start(struct json *json, json_t *node, void *out)
{
#define START(name) offsetof(struct start, name)
    static const struct json_key keys[] = {
        CHOICE_KEY("shape", START(shape), start_shapes),
        VECTOR_KEY("at", START(at), -1e6, 1e6, 3),
        VECTOR_KEY("u", START(u), -1e6, 1e6, 3),
        VECTOR_KEY("v", START(v), -1e6, 1e6, 3),
        NUMBER_KEY("folds", START(folds), 0, 1e4),
        NUMBER_KEY("depth", START(depth), 0, 1e3),
        NUMBER_KEY("radius", START(radius), 1e-4, 1e3),
        NUMBER_KEY("gap", START(gap), 1e-6, 1e3),
        {0}};
    static const char *const hung[] = {"folds", "depth", NULL};
    static const char *const folds[] = {"folds", NULL};
    static const char *const depth[] = {"depth", NULL};
    static const char *const rolled[] = {"radius", "gap", NULL};
    struct start *start = out;
    int status = json_fields(json, node, keys, start);
    if (status == APP_OK && start->shape != START_HUNG)
        json_idle(json, node, hung, "the cloth is not hung");
    else if (status == APP_OK && start->folds == 0)
        json_idle(json, node, depth, "there are no folds");
    else if (status == APP_OK && start->depth == 0)
        json_idle(json, node, folds, "they have no depth");
    if (status == APP_OK && start->shape != START_ROLLED)
        json_idle(json, node, rolled, "the cloth is not rolled");
    json_t *v = json_object_get(node, "v");
    if (status == APP_OK && start->shape == START_HUNG && !v) {
        start->v[1] = -1;
        start->v[2] = 0;
    }
    return status;
}

static int read_region(struct json *json, json_t *node, void *out)
{
    static const struct json_key keys[] = {
        VECTOR_KEY("disc", offsetof(struct region, disc), 0, 1e6, 3),
        VECTOR_KEY("rect", offsetof(struct region, rect), 0, 1e6, 4),
        {0}};
    struct region *region = out;
    region->disc[2] = -1;
    region->rect[2] = -1;
    int status = json_fields(json, node, keys, region);
    if (status == APP_OK && region->disc[2] < 0 && region->rect[2] < 0)
        return json_refuse(json, "expected disc or rect");
    return status;
}

static int read_regions(struct json *json, json_t *node, void *out)
{
    struct regions *regions = out;
    struct json_list list = {
        .read = read_region, .size = sizeof(struct region), .most = 10000};
    int status = json_items(json, node, &list);
    regions->list = list.items;
    regions->count = list.count;
    return status;
}

static const char *const edges[] = {"u0", "u1", "v0", "v1", NULL};

static int read_pin(struct json *json, json_t *node, void *out)
{
    static const struct json_key keys[] = {
        CHOICE_KEY("edge", offsetof(struct pin, edge), edges),
        VECTOR_KEY("at", offsetof(struct pin, at), 0, 1e6, 2),
        NUMBER_KEY("every", offsetof(struct pin, every), 1e-6, 1e6),
        INTEGER_KEY("outline", offsetof(struct pin, outline), 0, 1e6),
        NESTED_KEY("motion", offsetof(struct pin, motion), read_motion_name),
        {0}};
    static const char *const every[] = {"every", NULL};
    struct pin *pin = out;
    *pin =
        (struct pin){.edge = -1, .motion = -1, .outline = -1, .at = {-1, -1}};
    int status = json_fields(json, node, keys, pin);
    int named = (pin->edge >= 0) + (pin->at[0] >= 0) + (pin->outline >= 0);
    if (status == APP_OK && named != 1)
        return json_refuse(json, "expected either edge or at");
    if (status == APP_OK && pin->edge < 0)
        json_idle(json, node, every, "the pin is a single particle");
    return status;
}

static int read_pins(struct json *json, json_t *node, void *out)
{
    struct cloth *cloth = out;
    struct json_list list = {
        .read = read_pin, .size = sizeof(struct pin), .most = 10000};
    int status = json_items(json, node, &list);
    cloth->pins = list.items;
    cloth->n_pins = list.count;
    for (int k = 0; k < list.count && status == APP_OK; k++) {
        const double *at = cloth->pins[k].at;
        int most = cloth->panel ? cloth->panel->edges : 0;
        if (cloth->pins[k].outline >= most)
            status = json_refuse(json, "[%d].outline: %d: expected %s", k,
                                 cloth->pins[k].outline,
                                 most ? "an edge of the panel"
                                      : "a cloth that is "
                                        "a panel");
        else if (most && cloth->pins[k].edge >= 0)
            status = json_refuse(json,
                                 "[%d].edge: a panel has edges of its outline: "
                                 "expected outline or at",
                                 k);
        if (status != APP_OK)
            break;
        double h = cloth->size[0] / (cloth->particles[0] - 1);
        double g = cloth->size[1] / (cloth->particles[1] - 1);
        if (at[0] < cloth->size[0] + h / 2 && at[1] < cloth->size[1] + g / 2)
            continue;
        size_t length = json_enter(json, "[%d].at", k);
        status = json_refuse(json,
                             "[%.15g, %.15g]: expected a place on the "
                             "cloth, up to [%.15g, %.15g]",
                             at[0], at[1], cloth->size[0], cloth->size[1]);
        json_leave(json, length);
    }
    return status;
}

static const char *const bendings[] = {"triples", "springs", NULL};

/* Refuses keys of a rectangle beside `panel`. */
static int check_panel_keys(struct json *json, json_t *node)
{
    static const char *const others[] = {"particles", "size", "holes", "cuts",
                                         NULL};
    if (!json_object_get(node, "panel"))
        return APP_OK;
    for (int k = 0; others[k]; k++)
        if (json_object_get(node, others[k]))
            return json_refuse(json, "%s: not beside panel, which has its own",
                               others[k]);
    return APP_OK;
}

static int read_cloth(struct json *json, json_t *node, void *out)
{
#define CLOTH(name) offsetof(struct cloth, name)
    static const struct json_key keys[] = {
        TEXT_KEY("name", CLOTH(name)),
        NESTED_KEY("panel", 0, read_panel), /* before what it replaces */
        VECTOR_KEY("particles", CLOTH(particles), 2, 32768, 2),
        VECTOR_KEY("size", CLOTH(size), 1e-6, 1e6, 2),
        NESTED_KEY("material", CLOTH(out.material), read_material),
        CHOICE_KEY("bending", CLOTH(out.bending), bendings),
        NESTED_KEY("start", CLOTH(start), read_start),
        VECTOR_KEY("velocity", CLOTH(velocity), -1e6, 1e6, 3),
        NESTED_KEY("holes", CLOTH(holes), read_regions),
        NESTED_KEY("cuts", CLOTH(cuts), read_regions),
        NESTED_KEY("pins", 0, read_pins),
        NESTED_KEY("look", CLOTH(look), read_look),
        {0}};
    struct cloth *cloth = out;
    drape_cloth *c = &cloth->out;
    drape_default_cloth(c);
    cloth->look = look_default();
    cloth->particles[0] = c->m;
    cloth->particles[1] = c->n;
    cloth->size[0] = c->width;
    cloth->size[1] = c->height;
    cloth->start = (struct start){
        .u = {1, 0, 0}, .v = {0, 0, 1}, .radius = 0.05, .gap = 0.01};
    int status = check_panel_keys(json, node);
    if (status == APP_OK)
        status = json_fields(json, node, keys, cloth);
    if (status != APP_OK)
        return status;
    if (cloth->panel && cloth->start.shape != START_FLAT)
        return json_refuse(json, "start: a panel starts flat, or where its "
                                 "pattern places it");
    if (cloth->panel && !json_object_get(node, "start"))
        cloth->out.x = cloth->panel->placed;
    struct scene *scene = json->user;
    double count = cloth->particles[0] * cloth->particles[1];
    scene->particles += count;
    if (floor(cloth->particles[0]) != cloth->particles[0] ||
        floor(cloth->particles[1]) != cloth->particles[1])
        return json_refuse(json, "particles: expected whole numbers");
    if (scene->particles * PARTICLE_BYTES > scene->memory * 1e9)
        return json_refuse(json,
                           "particles: %.0f so far need more than the memory "
                           "limit of %.3g GB",
                           scene->particles, scene->memory);
    c->m = (int)cloth->particles[0];
    c->n = (int)cloth->particles[1];
    c->width = cloth->size[0];
    c->height = cloth->size[1];
    return cloth_sew(json, cloth);
}

int read_cloths(struct json *json, json_t *node, void *out)
{
    struct scene *scene = out;
    struct json_list list = {
        .read = read_cloth, .size = sizeof(struct cloth), .most = 1000};
    int status = json_items(json, node, &list);
    if (status != APP_OK)
        return status;
    size_t count = (size_t)list.count;
    const struct cloth *cloth = list.items;
    drape_cloth *to = pool_take(json->pool, count + 1, sizeof *to);
    scene->cloth_name = pool_take(json->pool, count + 1, sizeof(char *));
    scene->pin_from = pool_take(json->pool, count + 1, sizeof(int *));
    scene->cloth_look = pool_take(json->pool, count + 1, sizeof(struct look));
    if (!to || !scene->cloth_name || !scene->pin_from || !scene->cloth_look)
        return complain(APP_FAILED, "out of memory");
    for (size_t k = 0; k < count; k++) {
        to[k] = cloth[k].out;
        scene->pin_from[k] = cloth[k].pin_from;
        scene->cloth_look[k] = cloth[k].look;
        scene->cloth_name[k] =
            cloth[k].name ? cloth[k].name : pool_text(json->pool, "cloth");
    }
    scene->def.cloths = to;
    scene->def.n_cloths = list.count;
    return APP_OK;
}
