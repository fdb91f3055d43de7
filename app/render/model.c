/* SPDX-License-Identifier: Apache-2.0 */
/* Loads a run's frames as models for pictures. */
#include "app/render/model.h"
#include "app/base/app.h"
#include "app/base/file.h"
#include "app/base/vec.h"
#include "app/read/json.h"
#include "app/render/paint.h"
#include "app/render/rim.h"
#include "app/write/output.h"

#include <string.h>

/* Returns number k of a list, or `otherwise` if the list has no such number. */
static double number(json_t *node, int k, double otherwise)
{
    json_t *item = k < 0 ? node : json_array_get(node, (size_t)k);
    return json_is_number(item) ? json_number_value(item) : otherwise;
}

static json_t *get(json_t *node, const char *name)
{
    return json_object_get(node, name);
}

/* Reads a number; false if it is not in lo … hi. */
static bool bounded(json_t *node, int k, double lo, double hi, double *out)
{
    *out = number(node, k, NAN);
    return *out >= lo && *out <= hi;
}

/* Reads a camera; false if no scene could have it. */
static bool load_camera(json_t *node, struct camera *camera)
{
    bool good = true;
    for (int i = 0; i < 3; i++)
        good = good &&
               bounded(get(node, "eye"), i, -1e6, 1e6, &camera->eye[i]) &&
               bounded(get(node, "target"), i, -1e6, 1e6, &camera->target[i]);
    return good && bounded(get(node, "fov"), -1, 0, 150, &camera->fov);
}

/* Reads light, floor and turn; false if no scene could have them. */
static bool load_picture(json_t *node, struct camera *camera)
{
    bool good = bounded(get(node, "fov"), -1, 0, 150, &camera->fov) &&
                bounded(get(node, "turn"), -1, -3600, 3600, &camera->turn) &&
                bounded(get(node, "light"), -1, 0, 10, &camera->light);
    for (int i = 0; i < 3; i++)
        good = good &&
               bounded(get(node, "sun"), i, -1e6, 1e6, &camera->sun[i]) &&
               bounded(get(node, "floor"), i, 0, 1, &camera->floor[i]);
    return good;
}

/* Reads a cloth's look; false if no run could have written it. */
static bool load_cloth(json_t *body, struct look_cloth *cloth)
{
    json_t *grid = get(body, "particles"), *size = get(body, "size");
    double first, m, n;
    if (!bounded(get(body, "first_vertex"), -1, 0, INT32_MAX, &first) ||
        !bounded(grid, 0, 2, 32768, &m) || !bounded(grid, 1, 2, 32768, &n) ||
        !bounded(size, 0, 0, 1e9, &cloth->width) ||
        !bounded(size, 1, 0, 1e9, &cloth->height))
        return false;
    if (!look_restore(get(body, "look"), &cloth->look))
        return false;
    cloth->first = (int64_t)first;
    cloth->m = (int)m;
    cloth->n = (int)n;
    return true;
}

/* Reads an obstacle's look; false if no run could have written it. */
static bool load_obstacle(json_t *body, struct look_obstacle *obstacle)
{
    double first;
    if (!bounded(get(body, "first_triangle"), -1, 0, INT32_MAX, &first))
        return false;
    obstacle->first = (int64_t)first;
    return look_restore(get(body, "look"), &obstacle->look);
}

static int load_bodies(struct pool *pool, json_t *bodies, const char *path,
                       struct run_look *look)
{
    json_t *body;
    size_t count = json_array_size(bodies), k;
    look->cloths = pool_take(pool, count + 1, sizeof *look->cloths);
    look->obstacles = pool_take(pool, count + 1, sizeof *look->obstacles);
    if (!look->cloths || !look->obstacles)
        return complain(APP_FAILED, "out of memory");
    json_array_foreach(bodies, k, body)
    {
        bool cloth = get(body, "particles");
        if (cloth ? load_cloth(body, &look->cloths[look->count++])
                  : load_obstacle(body, &look->obstacles[look->n_obstacles++]))
            continue;
        return complain(APP_USAGE, "%s: $.bodies[%d]: expected %s, and a look",
                        path, (int)k,
                        cloth ? "a cloth's first_vertex, particles and size"
                              : "an obstacle's first_triangle");
    }
    return APP_OK;
}

int look_load(struct pool *pool, const char *directory, struct run_look *look)
{
    char path[FILE_PATH];
    *look = (struct run_look){.rate = 60};
    look->camera =
        (struct camera){.fov = 35, .light = 1, .floor = {.635, .627, .623}};
    if (!file_join(path, directory, "report.json"))
        return APP_USAGE;
    if (!file_exists(path))
        return APP_OK;
    json_t *root = json_parse(path);
    if (!root)
        return APP_USAGE;
    int status = load_bodies(pool, get(root, "bodies"), path, look);
    json_t *camera = get(root, "camera"), *picture = get(root, "picture");
    if (status == APP_OK && picture && !load_picture(picture, &look->camera))
        status = complain(APP_USAGE,
                          "%s: $.picture: expected fov, turn, light, sun and "
                          "floor",
                          path);
    if (status == APP_OK && camera && !load_camera(camera, &look->camera))
        status = complain(APP_USAGE,
                          "%s: $.camera: expected eye, target and fov", path);
    double frame = number(get(root, "dt"), -1, 1.0 / 60) *
                   number(get(root, "steps_per_frame"), -1, 1);
    if (status == APP_OK && !(frame > 1e-9 && frame < 1e9))
        status = complain(APP_USAGE,
                          "%s: $.dt: expected a time between two frames", path);
    look->rate = 1 / frame;
    json_decref(root);
    return status;
}

/* Whether triangle k is level: level triangles are drawn as an endless floor.
 */
static bool is_floor(const struct mesh *mesh, int64_t k, float *floor)
{
    const int32_t *t = mesh->tri[k];
    double y = mesh->x[t[0]][1], area = 0;
    if (mesh->x[t[1]][1] != y || mesh->x[t[2]][1] != y)
        return false;
    for (int i = 0; i < 3; i++) {
        const double *a = mesh->x[t[i]], *b = mesh->x[t[(i + 1) % 3]];
        area += (a[0] * b[2] - a[2] * b[0]) / 2;
    }
    if (!(area > 1 || area < -1))
        return false;
    *floor = (float)y;
    return true;
}

/* Appends a mesh; obstacles get their paint, which follows that of cloths: of
 * one cloth where no report names any. */
static void append(struct model *m, const struct mesh *mesh,
                   const struct run_look *look, bool cloth)
{
    int of = 0, cloths = look->count ? look->count : 1;
    int64_t first = m->nv;
    for (int64_t k = 0; k < mesh->nv; k++)
        for (int i = 0; i < 3; i++)
            m->x[first + k][i] = (float)mesh->x[k][i];
    m->nv += mesh->nv;
    for (int64_t k = 0; k < mesh->nt; k++) {
        while (!cloth && of + 1 < look->n_obstacles &&
               look->obstacles[of + 1].first - look->obstacles[0].first <= k)
            of++;
        if (!cloth && is_floor(mesh, k, &m->floor))
            continue;
        for (int i = 0; i < 3; i++)
            m->tri[m->nt][i] = (uint32_t)(first + mesh->tri[k][i]);
        m->paint[m->nt++] = (uint16_t)(cloths + of);
    }
}

static void set_box(struct model *m)
{
    for (int i = 0; i < 3; i++) {
        m->lo[i] = INFINITY;
        m->hi[i] = -INFINITY;
    }
    for (int64_t k = 0; k < 3 * m->nt; k++)
        for (int i = 0; i < 3; i++) {
            double x = (double)m->x[m->tri[k / 3][k % 3]][i];
            m->lo[i] = fmin(m->lo[i], x);
            m->hi[i] = fmax(m->hi[i], x);
        }
}

/* Checks that the model can be drawn: the fourth powers of its lengths must fit
 * into a float. */
static int check_box(const struct model *m, const char *directory, int k)
{
    for (int i = 0; i < 3; i++)
        if (!(m->lo[i] >= -1e9 && m->hi[i] <= 1e9))
            return complain(APP_USAGE,
                            "render: %s: frame %d: expected coordinates up to "
                            "1e9 m",
                            directory, k);
    return APP_OK;
}

/* Vertex normals: the mean of the triangles' normals, weighted by area. */
static void set_normals(struct model *m)
{
    for (int64_t k = 0; k < m->nt; k++) {
        const uint32_t *t = m->tri[k];
        vec a = from(m->x[t[0]]);
        vec n = cross(sub(from(m->x[t[1]]), a), sub(from(m->x[t[2]]), a));
        for (int i = 0; i < 3; i++) {
            float *sum = m->normal[t[i]];
            sum[0] += n.x;
            sum[1] += n.y;
            sum[2] += n.z;
        }
    }
    for (int64_t k = 0; k < m->nv; k++) {
        vec n = unit(from(m->normal[k]));
        m->normal[k][0] = n.x;
        m->normal[k][1] = n.y;
        m->normal[k][2] = n.z;
    }
}

/* Sets the rest coordinates of each particle and the cloth of each of the first
 * `triangles`. */
static void set_paint(struct model *m, const struct run_look *look,
                      int64_t triangles)
{
    for (int c = 0; c < look->count; c++) {
        const struct look_cloth *l = &look->cloths[c];
        int64_t count = (int64_t)l->m * l->n;
        for (int64_t k = 0; k < count && l->first + k < m->nv; k++) {
            float *uv = m->uv[l->first + k];
            uv[0] = (float)(l->width * (double)(k % l->m) / (l->m - 1));
            uv[1] = (float)(l->height * (double)(k / l->m) / (l->n - 1));
        }
    }
    for (int64_t k = 0; k < triangles; k++) {
        m->paint[k] = 0;
        for (int c = 0; c < look->count; c++)
            if (m->tri[k][0] >= look->cloths[c].first)
                m->paint[k] = (uint16_t)c;
    }
}

static void set_colour(const double given[3], vec otherwise, float out[3])
{
    const float own[3] = {otherwise.x, otherwise.y, otherwise.z};
    for (int i = 0; i < 3; i++)
        out[i] = given[0] >= 0 ? linear(given[i]) : own[i];
}

/* Makes the surfaces: the cloths', the obstacles', and one for bodies that the
 * report does not name. */
static int set_surfaces(struct pool *pool, struct model *m,
                        const struct run_look *look)
{
    const vec stone = make(.60f, .555f, .49f);
    int cloths = look->count, count = cloths + look->n_obstacles + 2;
    struct surface *surface = pool_take(pool, (size_t)count, sizeof *surface);
    if (!surface)
        return complain(APP_FAILED, "render: out of memory");
    for (int k = 0; k < count; k++) {
        struct look own = look_default();
        bool cloth = k < cloths || (cloths == 0 && k == 0);
        if (k < cloths)
            own = look->cloths[k].look;
        else if (k < cloths + look->n_obstacles)
            own = look->obstacles[k - cloths].look;
        struct surface *s = &surface[k];
        set_colour(own.colour, cloth ? cloth_dye(k, true) : stone, s->side[0]);
        set_colour(own.inside[0] < 0 && !cloth ? own.colour : own.inside,
                   cloth ? cloth_dye(k, false) : stone, s->side[1]);
        s->gloss = own.gloss >= 0 ? 0.1f * (float)own.gloss
                   : cloth        ? 0.007f
                                  : 0.05f;
        s->sheen = cloth ? 0.35f : 0;
        s->check = cloth && own.check;
    }
    m->surface = surface;
    return APP_OK;
}

int model_load(struct pool *pool, const char *directory, int k,
               const struct run_look *look, struct model *model)
{
    struct mesh cloth, stone = {0};
    char path[FILE_PATH];
    if (!output_path(path, directory, "cloth", k))
        return APP_USAGE;
    int status = mesh_load(pool, path, &cloth);
    if (status != APP_OK || !output_path(path, directory, "obstacles", k))
        return APP_USAGE;
    if (!file_exists(path) && !file_join(path, directory, "obstacles.ply"))
        return APP_USAGE;
    if (file_exists(path))
        status = mesh_load(pool, path, &stone);
    if (status != APP_OK)
        return status;
    size_t nv = (size_t)(cloth.nv + stone.nv);
    size_t nt = (size_t)(cloth.nt + stone.nt);
    *model = (struct model){.floor = NAN};
    model->x = pool_take(pool, nv, sizeof *model->x);
    model->normal = pool_take(pool, nv, sizeof *model->normal);
    model->uv = pool_take(pool, nv, sizeof *model->uv);
    model->tri = pool_take(pool, nt, sizeof *model->tri);
    model->paint = pool_take(pool, nt, sizeof *model->paint);
    if (!model->x || !model->normal || !model->uv || !model->tri ||
        !model->paint)
        return complain(APP_FAILED, "render: out of memory");
    append(model, &cloth, look, true);
    int64_t triangles = model->nt;
    append(model, &stone, look, false);
    status = set_surfaces(pool, model, look);
    for (int c = 0; c < look->count && status == APP_OK; c++) {
        const struct look_cloth *l = &look->cloths[c];
        const struct grid grid = {l->first, l->m, l->n};
        status = rim_round(pool, model, &grid, triangles);
    }
    if (status != APP_OK)
        return status;
    set_box(model);
    set_normals(model);
    set_paint(model, look, triangles);
    return check_box(model, directory, k);
}
