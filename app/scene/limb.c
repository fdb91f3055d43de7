/* SPDX-License-Identifier: Apache-2.0 */
/* Bends a limb. Its axis goes up, bends towards +x along the middle half of its
 * length, evenly, and goes on straight; cross-sections keep their shape and
 * stay at right angles to it. So no part of it stretches along the axis, and it
 * does not fold into itself as long as it bends by less than its middle half is
 * longer than its radius. */
#include "app/base/app.h"
#include "app/scene/bodies.h"

#include <math.h>
#include <string.h>

/* Degrees between two frames, at most: a cubic between them leaves the arcs
 * that vertices go along by 1e-6 of the radius (kinematics.md §4.4). */
enum { STEP = 5 };

static int read_key(struct json *json, json_t *node, void *out)
{
    static const struct json_key keys[] = {
        NUMBER_KEY("time", offsetof(struct limb_key, time), 0, 1e6),
        NUMBER_KEY("angle", offsetof(struct limb_key, angle), -180, 180),
        {0}};
    return json_fields(json, node, keys, out);
}

int read_limb(struct json *json, json_t *node, void *out)
{
    struct limb *limb = out;
    struct json_list list = {
        .read = read_key, .size = sizeof *limb->keys, .most = 10000};
    int status = json_items(json, node, &list);
    limb->keys = list.items;
    limb->n_keys = list.count;
    if (status == APP_OK && list.count == 0)
        return json_refuse(json, "expected a key");
    for (int k = 1; status == APP_OK && k < list.count; k++)
        if (!(limb->keys[k].time > limb->keys[k - 1].time))
            return json_refuse(json, "times must ascend");
    return status;
}

/* Where a vertex of the straight limb is when it is bent by an angle, in turns;
 * joint: the length of the part that bends. */
static void bend_vertex(const double x[3], double turns, double joint,
                        double to[3])
{
    double pi = 3.14159265358979323846, along = x[1] + joint / 2;
    double part = along < 0 ? 0 : along < joint ? along / joint : 1;
    double c, s, r = turns == 0 ? 0 : joint / (2 * pi * turns);
    double rest = along < 0 ? along : along < joint ? 0 : along - joint;
    circle(part * turns, &c, &s);
    double axis[2] = {r * (1 - c) + rest * s,
                      (turns == 0 ? part * joint : r * s) + rest * c};
    to[0] = axis[0] + x[0] * c;
    to[1] = axis[1] - joint / 2 - x[0] * s;
    to[2] = x[2];
}

/* Number of frames from key k to the next one. */
static int count_steps(const struct limb_key *k)
{
    return 1 + (int)(fabs(k[1].angle - k[0].angle) / STEP);
}

/* Writes a frame of all vertices, and when it is. */
struct film {
    const struct mesh *mesh;
    double joint, *time;
    double (*x)[3];
    int frames;
};

static void add_frame(struct film *film, double time, double angle)
{
    double(*to)[3] = film->x + film->frames * film->mesh->nv;
    for (int64_t k = 0; k < film->mesh->nv; k++)
        bend_vertex(film->mesh->x[k], angle / 360, film->joint, to[k]);
    film->time[film->frames++] = time;
}

int limb_bend(struct json *json, const struct limb *limb,
              const struct shape *shape, const struct placement *placement,
              struct mesh *mesh, drape_obstacle *out)
{
    const struct limb_key *key = limb->keys;
    struct film film = {.mesh = mesh, .joint = shape->length / 2};
    double most = film.joint / shape->radius * (180 / 3.14159265358979323846);
    int64_t frames = 1;
    for (int k = 0; k < limb->n_keys; k++) {
        if (!(fabs(key[k].angle) < most))
            return json_refuse(
                json,
                "bend[%d]: %g degrees: expected less than %.4g, at "
                "which a limb of this radius and length folds "
                "into itself",
                k, key[k].angle, most);
        frames += k ? count_steps(key + k - 1) : 0;
    }
    film.time = pool_take(json->pool, (size_t)frames, sizeof *film.time);
    film.x = pool_take(json->pool, (size_t)(frames * mesh->nv), sizeof *film.x);
    if (!film.time || !film.x)
        return complain(APP_FAILED, "out of memory");
    add_frame(&film, key[0].time, key[0].angle);
    for (int k = 1; k < limb->n_keys; k++) {
        const struct limb_key *a = &key[k - 1], *b = &key[k];
        int steps = count_steps(a);
        for (int i = 1; i <= steps; i++) {
            double part = (double)i / steps;
            add_frame(&film, a->time + part * (b->time - a->time),
                      a->angle + part * (b->angle - a->angle));
        }
    }
    memcpy(mesh->x, film.x, (size_t)mesh->nv * sizeof *mesh->x);
    mesh_place_frames(film.x, mesh->nv, frames, placement);
    out->frames = film.frames;
    out->between = DRAPE_CUBIC;
    out->frame_time = film.time;
    out->frame = (const double(*)[3])film.x;
    return APP_OK;
}
