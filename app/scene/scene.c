/* SPDX-License-Identifier: Apache-2.0 */
/* Scenes: reads a JSON file (app/scenes/README.md) into a drape_def. */
#include "app/scene/scene.h"
#include "app/base/app.h"
#include "app/scene/bodies.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static int read_wind(struct json *json, json_t *node, void *out)
{
#define WIND(name) offsetof(drape_wind, name)
    static const struct json_key keys[] = {
        VECTOR_KEY("velocity", WIND(velocity), -1e4, 1e4, 3),
        NUMBER_KEY("density", WIND(density), 0, 1e4),
        NUMBER_KEY("drag", WIND(drag), 0, 1e3),
        NUMBER_KEY("lift", WIND(lift), 0, 1e3),
        {0}};
    static const char *const of_air[] = {"velocity", "drag", "lift", NULL};
    static const char *const of_force[] = {"velocity", "density", NULL};
    drape_wind *wind = out;
    wind->density = 1.2; /* a scene with a wind key has air */
    int status = json_fields(json, node, keys, wind);
    if (status == APP_OK && wind->density == 0)
        json_idle(json, node, of_air, "there is no density");
    else if (status == APP_OK && wind->drag == 0 && wind->lift == 0)
        json_idle(json, node, of_force, "there is neither drag nor lift");
    return status;
}

static int read_camera(struct json *json, json_t *node, void *out)
{
    static const struct json_key keys[] = {
        VECTOR_KEY("eye", offsetof(struct camera, eye), -1e6, 1e6, 3),
        VECTOR_KEY("target", offsetof(struct camera, target), -1e6, 1e6, 3),
        NUMBER_KEY("fov", offsetof(struct camera, fov), 1, 150),
        NUMBER_KEY("turn", offsetof(struct camera, turn), -3600, 3600),
        VECTOR_KEY("sun", offsetof(struct camera, sun), -1e6, 1e6, 3),
        NUMBER_KEY("light", offsetof(struct camera, light), 0, 10),
        VECTOR_KEY("floor", offsetof(struct camera, floor), 0, 1, 3),
        {0}};
    static const char *const sun[] = {"sun", NULL};
    struct camera *camera = out;
    int status = json_fields(json, node, keys, camera);
    if (status == APP_OK && camera->light == 0)
        json_idle(json, node, sun, "it has no light");
    return status;
}

static const char *const backends[] = {"ref", "gpu", NULL};
static const char *const integrators[] = {
    "euler",         "midpoint", "verlet", "rk4",
    "baraff-witkin", "choi-ko",  "bdf2",   NULL};
static const char *const preconds[] = {"jacobi", "multigrid", NULL};
static const char *const solvers[] = {"exact", "cublas", NULL};
static const char *const responses[] = {"solve", "impulses", NULL};
static const char *const matrices[] = {"cdf", "compact", NULL};

#define SCENE(name) offsetof(struct scene, name)
static const struct json_key scene_keys[] = {
    TEXT_KEY("name", SCENE(name)),
    NUMBER_KEY("memory", SCENE(memory), 0.001, 1e6),
    INTEGER_KEY("frames", SCENE(frames), 0, 1e6),
    INTEGER_KEY("steps_per_frame", SCENE(steps_per_frame), 1, 1e4),
    CHOICE_KEY("backend", SCENE(def.backend), backends),
    INTEGER_KEY("precision", SCENE(def.precision), 32, 64),
    INTEGER_KEY("threads", SCENE(def.threads), 0, 4096),
    INTEGER_KEY("block", SCENE(def.block), 0, 256),
    NUMBER_KEY("dt", SCENE(def.dt), 1e-7, 1),
    VECTOR_KEY("gravity", SCENE(def.gravity), -1e4, 1e4, 3),
    NESTED_KEY("wind", SCENE(def.wind), read_wind),
    CHOICE_KEY("integrator", SCENE(def.integrator), integrators),
    INTEGER_KEY("max_substeps", SCENE(def.max_substeps), 1, 1e9),
    CHOICE_KEY("precond", SCENE(def.precond), preconds),
    CHOICE_KEY("matrix", SCENE(def.matrix), matrices),
    CHOICE_KEY("solver", SCENE(def.solver), solvers),
    CHOICE_KEY("response", SCENE(def.response), responses),
    NUMBER_KEY("tolerance", SCENE(def.tolerance), 1e-15, 0.5),
    INTEGER_KEY("max_iterations", SCENE(def.max_iterations), 1, 1e6),
    INTEGER_KEY("newton", SCENE(def.newton), 0, 64),
    BOOLEAN_KEY("self_collision", SCENE(def.self_collision)),
    INTEGER_KEY("max_rounds", SCENE(def.max_rounds), 0, 1e4),
    INTEGER_KEY("max_slices", SCENE(def.max_slices), 1, 64),
    BOOLEAN_KEY("allow_intersecting", SCENE(def.allow_intersecting)),
    BOOLEAN_KEY("sleep", SCENE(def.sleep)),
    NESTED_KEY("motions", 0, read_motions),
    NESTED_KEY("cloths", 0, read_cloths),
    NESTED_KEY("garments", 0, read_garments), /* after cloths */
    NESTED_KEY("obstacles", 0, read_obstacles),
    NESTED_KEY("camera", SCENE(camera), read_camera),
    {0}};

void scene_settings(FILE *out, const struct scene *scene)
{
    json_write(out, scene_keys, scene);
}

/* Says which friction of obstacles is less than that of all cloths, so that no
 * pair takes it. */
static void say_unused(struct json *json, json_t *root, const drape_def *def)
{
    static const char *const friction[] = {"friction", NULL};
    double least = INFINITY;
    for (int k = 0; k < def->n_cloths; k++)
        least = fmin(least, def->cloths[k].material.friction);
    for (int k = 0; k < def->n_obstacles; k++) {
        size_t length = json_enter(json, ".obstacles[%d]", k);
        json_t *list = json_object_get(root, "obstacles");
        if (def->obstacles[k].friction < least)
            json_idle(json, json_array_get(list, (size_t)k), friction,
                      "a pair takes the larger, which is a cloth's");
        json_leave(json, length);
    }
}

static int read_scene(struct json *json, json_t *root, struct scene *scene)
{
    static const char *const of_solver[] = {
        "precond",        "matrix", "solver",   "tolerance",
        "max_iterations", "newton", "response", NULL};
    static const char *const of_substeps[] = {"max_substeps", NULL};
    int status = json_fields(json, root, scene_keys, scene);
    if (status != APP_OK)
        return status;
    bool implicit = scene->def.integrator >= DRAPE_BW;
    json_idle(json, root, implicit ? of_substeps : of_solver,
              implicit ? "the integrator is implicit"
                       : "the integrator is explicit");
    say_unused(json, root, &scene->def);
    if (scene->def.precision != 32 && scene->def.precision != 64)
        return json_refuse(json, "precision: expected 32 or 64");
    if (scene->def.n_cloths < 1)
        return json_refuse(json, "cloths: expected at least one, or a garment");
    return APP_OK;
}

/* Four fifths of this machine's memory, in GB: below this limit the system
 * should not have to kill processes. */
static double default_memory(void)
{
    long pages = sysconf(_SC_PHYS_PAGES), size = sysconf(_SC_PAGESIZE);
    return pages > 0 && size > 0 ? 0.8e-9 * (double)pages * (double)size : 8;
}

/* Sets what no key of a scene gives. */
static int begin(struct scene *scene, const char *file)
{
    memset(scene, 0, sizeof *scene);
    drape_default(&scene->def);
    scene->frames = 120;
    scene->steps_per_frame = 1;
    scene->def.threads = 0;
    scene->camera =
        (struct camera){.fov = 35, .light = 1, .floor = {.635, .627, .623}};
    scene->memory = default_memory();
    scene->pool.most = &scene->memory;
    if (strlen(file) >= sizeof scene->file)
        return complain(APP_USAGE, "%.60s…: the path is too long", file);
    strcpy(scene->file, file);
    return APP_OK;
}

/* Why a JSON file of another program is no scene; NULL: it may be one. */
static const char *is_other(json_t *root)
{
    if (json_object_get(json_object_get(root, "pattern"), "panels"))
        return "is a sewing pattern of GarmentCode, which `drape pattern` "
               "cuts and `drape sew` sews";
    if (json_object_get(json_object_get(root, "asset"), "version"))
        return "is a glTF file; expected a scene, which names it as the mesh "
               "of an obstacle (app/scenes/README.md)";
    return NULL;
}

/* Reads a scene's JSON, NULL if it has been refused, and deletes it. */
static int load(struct scene *scene, json_t *root)
{
    struct json json = {
        .file = scene->file, .where = "$", .pool = &scene->pool, .user = scene};
    if (!root)
        return APP_USAGE;
    const char *other = is_other(root);
    int status = other ? complain(APP_USAGE, "%s: %s", scene->file, other)
                       : read_scene(&json, root, scene);
    json_decref(root);
    if (status == APP_OK && !scene->name)
        scene->name = strcmp(scene->file, "-") == 0
                          ? pool_text(&scene->pool, "scene")
                          : pool_stem(&scene->pool, scene->file);
    return status;
}

int scene_load(struct scene *scene, const char *file)
{
    int status = begin(scene, file);
    return status == APP_OK ? load(scene, json_parse(file)) : status;
}

int scene_load_text(struct scene *scene, const char *text, size_t size,
                    const char *file)
{
    int status = begin(scene, file);
    return status == APP_OK ? load(scene, json_parse_text(text, size, file))
                            : status;
}

const char *scene_integrator(const struct scene *scene)
{
    return integrators[scene->def.integrator];
}

void scene_free(struct scene *scene)
{
    pool_free(&scene->pool);
    free(scene->parted.row);
}

/* An allocator of the library that enforces the scene's limit. */
static void *allocate(void *user, size_t bytes)
{
    struct budget *budget = user;
    size_t rounded = (bytes + 63) / 64 * 64;
    if (rounded < bytes || rounded > budget->most - budget->held)
        return NULL;
    void *p = aligned_alloc(64, rounded ? rounded : 64);
    if (p)
        budget->held += rounded;
    return p;
}

static void release(void *user, void *p, size_t bytes)
{
    struct budget *budget = user;
    if (p)
        budget->held -= (bytes + 63) / 64 * 64;
    free(p);
}

/* The name of a body that the library calls `cloth 0`, say. */
static const char *name_of(const struct scene *scene, const char *kind, int k)
{
    bool cloth = strcmp(kind, "cloth") == 0;
    if (k < 0 || k >= (cloth ? scene->def.n_cloths : scene->def.n_obstacles))
        return "?";
    return cloth ? scene->cloth_name[k] : scene->obstacle_name[k];
}

/* Writes the library's words on a start that intersects, with the names of the
 * two bodies. False if the text is about something else. */
static bool name_bodies(const struct scene *scene, const char *text,
                        char out[512])
{
    static const char begin[] = "the start state is intersecting: ";
    char kind[2][16];
    int body[2], triangle[2], end;
    if (strncmp(text, begin, sizeof begin - 1) != 0 ||
        sscanf(text + sizeof begin - 1,
               "%15[a-z] %d triangle %d and %15[a-z] %d triangle %d%n", kind[0],
               &body[0], &triangle[0], kind[1], &body[1], &triangle[1],
               &end) != 6)
        return false;
    snprintf(out, 512,
             "%s%s %d (%.60s) triangle %d and %s %d (%.60s) triangle %d%s; "
             "move them apart, as `drape untangle` does, or allow it by "
             "\"allow_intersecting\": true",
             begin, kind[0], body[0], name_of(scene, kind[0], body[0]),
             triangle[0], kind[1], body[1], name_of(scene, kind[1], body[1]),
             triangle[1], text + sizeof begin - 1 + end);
    return true;
}

/* Prints the library's refusal with the path in the scene's file of the cloth,
 * obstacle or motion that the refusal names. */
static int refuse_world(const struct scene *scene, int code, const char *text)
{
    static const char *const bodies[] = {"cloth", "obstacle", "motion"};
    const char *rest = strstr(text, ": ");
    char name[16];
    int body, pin, end = 0;
    int read = sscanf(text, "%15[a-z] %d: pin %d: %n", name, &body, &pin, &end);
    if (read == 3 && end && body < scene->def.n_cloths &&
        pin < scene->def.cloths[body].n_pins)
        return complain(code, "%s: $.cloths[%d].pins[%d]: %s", scene->file,
                        body, scene->pin_from[body][pin], text + end);
    char start[512];
    if (name_bodies(scene, text, start))
        return complain(code, "%s: %s", scene->file, start);
    for (int k = 0; k < 3 && read >= 2 && rest; k++)
        if (strcmp(name, bodies[k]) == 0)
            return complain(code, "%s: $.%ss[%d]: %s", scene->file, name, body,
                            rest + 2);
    return complain(code, "%s: %s", scene->file, text);
}

int scene_create(struct scene *scene, const struct overrides *overrides,
                 drape_world **world)
{
    drape_def *def = &scene->def;
    if (overrides->backend)
        def->backend = json_choice(backends, overrides->backend);
    if (def->backend < 0)
        return complain(APP_USAGE, "--backend %s: expected ref or gpu",
                        overrides->backend);
    if (overrides->precision >= 0)
        def->precision = overrides->precision;
    if (overrides->threads >= 0)
        def->threads = overrides->threads;
    if (overrides->block >= 0)
        def->block = overrides->block;
    if (overrides->allow_intersecting > 0)
        def->allow_intersecting = 1;
    scene->budget.most = (size_t)(scene->memory * 1e9);
    def->allocator = (drape_allocator){allocate, release, &scene->budget};
    drape_error error = {""};
    int status = drape_create(def, world, &error);
    scene->status = status;
    if (status == DRAPE_OK)
        return APP_OK;
    int code = status == DRAPE_ENOMEM || status == DRAPE_EDEVICE ? APP_FAILED
                                                                 : APP_USAGE;
    if (status == DRAPE_ENOMEM)
        return complain(code,
                        "%s: needs more memory than the limit of "
                        "%.3g GB (key memory)",
                        scene->file, scene->memory);
    return refuse_world(scene, code,
                        *error.text ? error.text : drape_status_text(status));
}

static bool is_named(const drape_def *def, int motion)
{
    for (int k = 0; k < def->n_obstacles; k++)
        if (def->obstacles[k].motion == motion)
            return true;
    for (int k = 0; k < def->n_cloths; k++)
        for (int i = 0; i < def->cloths[k].n_pins; i++)
            if (def->cloths[k].pins[i].motion == motion)
                return true;
    return false;
}

void scene_idle(const struct scene *scene, const struct overrides *overrides)
{
    const drape_def *def = &scene->def;
    bool gpu = def->backend == DRAPE_GPU;
    if (overrides->block < 0 && def->block > 0 && !gpu)
        complain(APP_OK,
                 "%s: $.block: note: has no effect: backend ref computes",
                 scene->file);
    if (overrides->threads < 0 && def->threads > 0 && gpu)
        complain(APP_OK,
                 "%s: $.threads: note: has no effect: backend gpu computes",
                 scene->file);
    for (int k = 0; k < def->n_motions; k++)
        if (!is_named(def, k))
            complain(APP_OK,
                     "%s: $.motions[%d]: note: has no effect: neither an "
                     "obstacle nor a pin names it",
                     scene->file, k);
}
