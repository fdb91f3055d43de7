/* SPDX-License-Identifier: Apache-2.0 */
/* Motions of a scene: keyframes of a translation and a rotation about an axis.
 */
#include "app/base/app.h"
#include "app/scene/bodies.h"
#include "app/scene/shapes.h"

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

static int read_key(struct json *json, json_t *node, void *out)
{
    static const struct json_key keys[] = {
        NUMBER_KEY("time", offsetof(struct key, time), 0, 1e6),
        VECTOR_KEY("move", offsetof(struct key, move), -1e6, 1e6, 3),
        VECTOR_KEY("axis", offsetof(struct key, axis), -1e6, 1e6, 3),
        NUMBER_KEY("angle", offsetof(struct key, angle), -36000, 36000),
        {0}};
    struct key *key = out;
    key->axis[1] = 1;
    int status = json_fields(json, node, keys, key);
    double *a = key->axis;
    double n = square_root(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
    if (status == APP_OK && !(n > 0))
        return json_refuse(json, "axis: expected a direction, not zero");
    for (int i = 0; i < 3; i++)
        a[i] /= n;
    return status;
}

static int read_keys(struct json *json, json_t *node, void *out)
{
    struct motion *motion = out;
    struct json_list list = {
        .read = read_key, .size = sizeof(struct key), .most = 10000};
    int status = json_items(json, node, &list);
    motion->keys = list.items;
    motion->n_keys = list.count;
    for (int k = 1; status == APP_OK && k < list.count; k++)
        if (!(motion->keys[k].time > motion->keys[k - 1].time))
            return json_refuse(json, "times must ascend");
    return status;
}

/* Says which keys are of a turn, where nothing turns. */
static void say_idle(struct json *json, json_t *node, const struct motion *m)
{
    static const char *const axis[] = {"axis", NULL};
    static const char *const pivot[] = {"pivot", NULL};
    json_t *keys = json_object_get(node, "keys");
    for (int k = 0; k < m->n_keys; k++)
        if (m->keys[k].angle != 0)
            return;
    json_idle(json, node, pivot, "no key has an angle");
    for (int k = 0; k < m->n_keys; k++) {
        size_t length = json_enter(json, ".keys[%d]", k);
        json_idle(json, json_array_get(keys, (size_t)k), axis,
                  "no key has an angle");
        json_leave(json, length);
    }
}

static int read_motion(struct json *json, json_t *node, void *out)
{
    static const struct json_key keys[] = {
        TEXT_KEY("name", offsetof(struct motion, name)),
        VECTOR_KEY("pivot", offsetof(struct motion, pivot), -1e6, 1e6, 3),
        NESTED_KEY("keys", 0, read_keys),
        {0}};
    struct motion *motion = out;
    int status = json_fields(json, node, keys, motion);
    if (status == APP_OK && (!motion->name || motion->n_keys < 1))
        return json_refuse(json, "expected a name and at least one key");
    if (status == APP_OK)
        say_idle(json, node, motion);
    return status;
}

enum { BETWEEN = 16 }; /* pieces of a rotation whose axis changes: 2^k */

/* The motion between two keys. The library interpolates quaternions along
 * chords, so a rotation is cut into small pieces. */
struct way {
    const struct key *a, *b;
    double axis[3], from, to; /* rotation about one axis, degrees */
    bool bent;                /* the two keys have no common axis */
    int steps;
};

/* Finds the common axis of two keys. A key of angle 0 has its neighbour's axis;
 * opposite axes are the same axis with the opposite angle. */
static struct way way_between(const struct key *a, const struct key *b)
{
    struct way way = {.a = a, .b = b, .from = a->angle, .to = b->angle};
    double along = 0;
    for (int i = 0; i < 3; i++)
        along += a->axis[i] * b->axis[i];
    memcpy(way.axis, a->angle == 0 ? b->axis : a->axis, sizeof way.axis);
    bool one = fabs(along) > 1 - 1e-12;
    if (one && along < 0 && a->angle != 0)
        way.to = -b->angle;
    way.bent = !one && a->angle != 0 && b->angle != 0;
    way.steps = way.bent ? BETWEEN : 1 + (int)(fabs(way.to - way.from) / 15);
    return way;
}

static void about(const double axis[3], double degrees, double q[4])
{
    double s;
    circle(degrees / 720, &q[0], &s);
    for (int i = 0; i < 3; i++)
        q[1 + i] = s * axis[i];
}

/* Interpolates evenly from q[0] to q[n], along the shorter arc: the middle of
 * two unit quaternions is their normalised sum; both halves are then divided in
 * the same way. */
static void halve(double (*q)[4], int n)
{
    if (n < 2)
        return;
    double dot = 0, sum = 0, *m = q[n / 2];
    for (int i = 0; i < 4; i++)
        dot += q[0][i] * q[n][i];
    for (int i = 0; i < 4; i++) {
        m[i] = q[0][i] + (dot < 0 ? -q[n][i] : q[n][i]);
        sum += m[i] * m[i];
    }
    for (int i = 0; i < 4; i++)
        m[i] /= square_root(sum);
    halve(q, n / 2);
    halve(q + n / 2, n / 2);
}

/* Appends the library's keys after the key of a, up to the key of b. */
static void place(const struct motion *motion, const struct way *way,
                  drape_motion *out)
{
    const struct key *a = way->a, *b = way->b;
    double(*position)[3] = (double(*)[3])out->position + out->keys;
    double(*rotation)[4] = (double(*)[4])out->rotation + out->keys;
    double *time = (double *)out->time + out->keys, turn[BETWEEN + 1][4];
    about(a->axis, a->angle, turn[0]);
    about(b->axis, b->angle, turn[BETWEEN]);
    halve(turn, BETWEEN);
    for (int k = 0; k < way->steps; k++) {
        double t = (double)(k + 1) / way->steps;
        time[k] = a->time + t * (b->time - a->time);
        for (int i = 0; i < 3; i++)
            position[k][i] =
                motion->pivot[i] + a->move[i] + t * (b->move[i] - a->move[i]);
        if (way->bent)
            memcpy(rotation[k], turn[k + 1], sizeof rotation[k]);
        else
            about(way->axis, way->from + t * (way->to - way->from),
                  rotation[k]);
    }
    out->keys += way->steps;
}

static int64_t count_keys(const struct motion *motion)
{
    int64_t count = 1;
    for (int k = 1; k < motion->n_keys; k++)
        count += way_between(&motion->keys[k - 1], &motion->keys[k]).steps;
    return count;
}

static int convert(struct pool *pool, const struct motion *motion,
                   drape_motion *out)
{
    const struct key *keys = motion->keys;
    size_t count = (size_t)count_keys(motion);
    memcpy(out->pivot, motion->pivot, sizeof out->pivot);
    out->time = pool_take(pool, count, sizeof *out->time);
    out->position = pool_take(pool, count, sizeof *out->position);
    out->rotation = pool_take(pool, count, sizeof *out->rotation);
    if (!out->time || !out->position || !out->rotation)
        return complain(APP_FAILED, "out of memory");
    struct way none = way_between(keys, keys);
    place(motion, &none, out);
    for (int k = 1; k < motion->n_keys; k++) {
        struct way way = way_between(&keys[k - 1], &keys[k]);
        place(motion, &way, out);
    }
    return APP_OK;
}

int read_motions(struct json *json, json_t *node, void *out)
{
    struct scene *scene = out;
    struct json_list list = {
        .read = read_motion, .size = sizeof(struct motion), .most = 1000};
    int status = json_items(json, node, &list);
    if (status != APP_OK)
        return status;
    size_t count = (size_t)list.count;
    const struct motion *motion = list.items;
    drape_motion *to = pool_take(json->pool, count + 1, sizeof *to);
    scene->motion_name = pool_take(json->pool, count + 1, sizeof(char *));
    if (!to || !scene->motion_name)
        return complain(APP_FAILED, "out of memory");
    int64_t sum = 0;
    for (int k = 0; k < list.count; k++)
        sum += count_keys(&motion[k]);
    if (sum > 1 << 24)
        return json_refuse(json,
                           "the turns come to %lld steps of 15 degrees; "
                           "expected at most 2^24",
                           (long long)sum);
    for (int k = 0; k < list.count && status == APP_OK; k++) {
        scene->motion_name[k] = motion[k].name;
        status = convert(json->pool, &motion[k], &to[k]);
    }
    scene->def.motions = to;
    scene->def.n_motions = list.count;
    return status;
}

int read_motion_name(struct json *json, json_t *node, void *out)
{
    const struct scene *scene = json->user;
    if (!json_is_string(node))
        return json_refuse(json, "expected the name of a motion");
    int k = scene->motion_name
                ? json_choice((const char *const *)scene->motion_name,
                              json_string_value(node))
                : -1;
    if (k < 0)
        return json_refuse(json, "\"%s\": no motion of this name",
                           json_string_value(node));
    *(int *)out = k;
    return APP_OK;
}
