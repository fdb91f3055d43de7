/* SPDX-License-Identifier: Apache-2.0 */
/* Motions of a scene: keyframes of a move and a turn about an axis. */
#include "app/app.h"
#include "app/bodies.h"
#include "app/shapes.h"

#include <math.h>
#include <string.h>

struct key {
    double time, move[3], axis[3], angle;
};

struct motion {
    char *name;
    double pivot[3];
    struct key *keys;
    int n_keys;
};

static int read_key(struct json *json, const cJSON *node, void *out)
{
    static const struct json_key keys[] = {
        NUMBER_KEY("time", offsetof(struct key, time), 0, 1e6),
        VECTOR_KEY("move", offsetof(struct key, move), -1e6, 1e6, 3),
        VECTOR_KEY("axis", offsetof(struct key, axis), -1e6, 1e6, 3),
        NUMBER_KEY("angle", offsetof(struct key, angle), -36000, 36000),
        {0}};
    struct key *key = out;
    key->axis[1] = 1;
    int status = json_object(json, node, keys, key);
    double *a = key->axis;
    double n = square_root(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
    if (status == APP_OK && !(n > 0))
        return json_refuse(json, "axis: expected a direction, not zero");
    for (int i = 0; i < 3; i++)
        a[i] /= n;
    return status;
}

static int read_keys(struct json *json, const cJSON *node, void *out)
{
    struct motion *motion = out;
    struct json_list list = {read_key, sizeof(struct key), 10000, NULL, 0};
    int status = json_array(json, node, &list);
    motion->keys = list.items;
    motion->n_keys = list.count;
    for (int k = 1; status == APP_OK && k < list.count; k++)
        if (!(motion->keys[k].time > motion->keys[k - 1].time))
            return json_refuse(json, "times must ascend");
    return status;
}

static int read_motion(struct json *json, const cJSON *node, void *out)
{
    static const struct json_key keys[] = {
        TEXT_KEY("name", offsetof(struct motion, name)),
        VECTOR_KEY("pivot", offsetof(struct motion, pivot), -1e6, 1e6, 3),
        NESTED_KEY("keys", 0, read_keys),
        {0}};
    struct motion *motion = out;
    int status = json_object(json, node, keys, motion);
    if (status == APP_OK && (!motion->name || motion->n_keys < 1))
        return json_refuse(json, "expected a name and at least one key");
    return status;
}

/* Steps between two keys: the library turns along chords between
 * quaternions, so that a turn is cut into steps of at most 15 degrees. */
static int steps(const struct key *a, const struct key *b)
{
    return 1 + (int)(fabs(b->angle - a->angle) / 15);
}

/* Key k of the library's motion, at part t of the way from a to b. */
static void place(const struct motion *motion, const struct key *a,
                  const struct key *b, double t, drape_motion *out)
{
    int k = out->keys++;
    double(*position)[3] = (double(*)[3])out->position;
    double(*rotation)[4] = (double(*)[4])out->rotation;
    double c, s;
    ((double *)out->time)[k] = a->time + t * (b->time - a->time);
    circle((a->angle + t * (b->angle - a->angle)) / 720, &c, &s);
    rotation[k][0] = c;
    for (int i = 0; i < 3; i++) {
        position[k][i] =
            motion->pivot[i] + a->move[i] + t * (b->move[i] - a->move[i]);
        rotation[k][1 + i] = s * (a->axis[i] + t * (b->axis[i] - a->axis[i]));
    }
}

static int convert(struct pool *pool, const struct motion *motion,
                   drape_motion *out)
{
    int count = 1;
    for (int k = 1; k < motion->n_keys; k++)
        count += steps(&motion->keys[k - 1], &motion->keys[k]);
    memcpy(out->pivot, motion->pivot, sizeof out->pivot);
    out->time = pool_take(pool, (size_t)count, sizeof *out->time);
    out->position = pool_take(pool, (size_t)count, sizeof *out->position);
    out->rotation = pool_take(pool, (size_t)count, sizeof *out->rotation);
    if (!out->time || !out->position || !out->rotation)
        return complain(APP_FAILED, "out of memory");
    place(motion, motion->keys, motion->keys, 0, out);
    for (int k = 1; k < motion->n_keys; k++) {
        const struct key *a = &motion->keys[k - 1], *b = a + 1;
        int n = steps(a, b);
        for (int j = 1; j <= n; j++)
            place(motion, a, b, (double)j / n, out);
    }
    return APP_OK;
}

int read_motions(struct json *json, const cJSON *node, void *out)
{
    struct scene *scene = out;
    struct json_list list = {read_motion, sizeof(struct motion), 1000, NULL, 0};
    int status = json_array(json, node, &list);
    if (status != APP_OK)
        return status;
    size_t count = (size_t)list.count;
    const struct motion *motion = list.items;
    drape_motion *to = pool_take(json->pool, count + 1, sizeof *to);
    scene->motion_name = pool_take(json->pool, count + 1, sizeof(char *));
    if (!to || !scene->motion_name)
        return complain(APP_FAILED, "out of memory");
    for (int k = 0; k < list.count && status == APP_OK; k++) {
        scene->motion_name[k] = motion[k].name;
        status = convert(json->pool, &motion[k], &to[k]);
    }
    scene->def.motions = to;
    scene->def.n_motions = list.count;
    return status;
}

int read_motion_name(struct json *json, const cJSON *node, void *out)
{
    const struct scene *scene = json->user;
    if (!cJSON_IsString(node))
        return json_refuse(json, "expected the name of a motion");
    int k = scene->motion_name
                ? json_choice((const char *const *)scene->motion_name,
                              node->valuestring)
                : -1;
    if (k < 0)
        return json_refuse(json, "\"%s\": no motion of this name",
                           node->valuestring);
    *(int *)out = k;
    return APP_OK;
}
