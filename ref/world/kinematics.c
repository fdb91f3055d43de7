/* SPDX-License-Identifier: Apache-2.0 */
/* Computes the prescribed positions of obstacles and pins.
 * spec/world/kinematics.md */
#include "ref/world/kinematics.h"

/* §2: returns the last key at or before time t, and in *blend the fraction of
 * the way from that key to the next. */
static int find_key(const drape_motion *m, double t, double *blend)
{
    int k = 0;
    *blend = 0;
    while (k + 1 < m->keys && m->time[k + 1] <= t)
        k++;
    if (k + 1 < m->keys && t > m->time[k])
        *blend = (t - m->time[k]) / (m->time[k + 1] - m->time[k]);
    return k;
}

/* §2.2: interpolates linearly between two unit quaternions by the shorter way
 * round, and normalises the result q. */
static void blend_rotations(const double a[4], const double b[4], double s,
                            double q[4])
{
    double along = a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3];
    double sign = along < 0 ? -1 : 1;
    for (int i = 0; i < 4; i++)
        q[i] = a[i] + s * (sign * b[i] - a[i]);
    double norm = sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    for (int i = 0; i < 4; i++)
        q[i] = norm > 0 ? q[i] / norm : (i == 0);
}

static void write_rows(const double q[4], double r[9])
{
    double w = q[0], x = q[1], y = q[2], z = q[3];
    r[0] = 1 - 2 * (y * y + z * z);
    r[1] = 2 * (x * y - w * z);
    r[2] = 2 * (x * z + w * y);
    r[3] = 2 * (x * y + w * z);
    r[4] = 1 - 2 * (x * x + z * z);
    r[5] = 2 * (y * z - w * x);
    r[6] = 2 * (x * z - w * y);
    r[7] = 2 * (y * z + w * x);
    r[8] = 1 - 2 * (x * x + y * y);
}

struct pose kinematics_pose(const drape_motion *motion, double t)
{
    struct pose pose;
    double blend, q[4] = {1, 0, 0, 0};
    int k = find_key(motion, t, &blend);
    int next = blend > 0 ? k + 1 : k;
    for (int i = 0; i < 3; i++) {
        double a = motion->position[k][i], b = motion->position[next][i];
        pose.p[i] = a + blend * (b - a);
        pose.pivot[i] = motion->pivot[i];
    }
    if (motion->rotation)
        blend_rotations(motion->rotation[k], motion->rotation[next], blend, q);
    write_rows(q, pose.rotation);
    return pose;
}

/* §4.1: returns the last frame at or before time t, or the first, and in *part
 * how much of the way to the next frame has passed. */
static int find_frame(const struct sequence *s, double t, double *part)
{
    int low = 0, high = s->count - 1;
    *part = 0;
    if (!s->time) {
        double at = t / s->dt;
        if (!(at > 0))
            return 0;
        if (at >= high)
            return high;
        *part = at - (int)at;
        return (int)at;
    }
    if (!(t > s->time[0]))
        return 0;
    if (t >= s->time[high])
        return high;
    while (low + 1 < high) {
        int middle = low + (high - low) / 2;
        *(s->time[middle] <= t ? &low : &high) = middle;
    }
    *part = (t - s->time[low]) / (s->time[high] - s->time[low]);
    return low;
}

/* §4.3: the time from frame k to the next, over that and the time from another
 * frame to its next. */
static double share_of(const struct sequence *s, int k, int other)
{
    if (!s->time)
        return 0.5;
    double here = s->time[k + 1] - s->time[k];
    return here / (here + (s->time[other + 1] - s->time[other]));
}

/* Adds frame `index` to what a place is made of. */
static void add_frame(struct kinematics *s, const double *frame, int64_t index,
                      double weight)
{
    s->other[s->others] = frame + 3 * s->n * index;
    s->weight[s->others++] = weight;
}

/* §4.2, §4.3: a cubic, a of the way from frame k to the next. */
static void add_cubic(const struct sequence *frames, const double *frame, int k,
                      double a, struct kinematics *s)
{
    bool first = k == 0, last = k + 2 == frames->count;
    double leave = first ? 0 : share_of(frames, k, k - 1);
    double reach = last ? 0 : share_of(frames, k, k + 1);
    double out = a * (1 - a) * (1 - a), in = a * a * (a - 1);
    add_frame(s, frame, k + 1,
              a * a * (3 - 2 * a) + out * (first ? 2 : leave) +
                  in * (last ? 2 - leave : 0));
    if (!first)
        add_frame(s, frame, k - 1, -leave * (last ? out - in : out));
    if (!last)
        add_frame(s, frame, k + 2, reach * (first ? in - out : in));
}

void kinematics_frame(const struct sequence *frames, const double *frame,
                      double t, struct kinematics *s)
{
    double part;
    int k = find_frame(frames, t, &part);
    s->rest = frame + 3 * s->n * k;
    s->others = 0;
    if (!(part > 0))
        return;
    if (frames->between == DRAPE_CUBIC && frames->count > 2)
        add_cubic(frames, frame, k, part, s);
    else
        add_frame(s, frame, k + 1, part);
}

static bool place_vertex(const struct kinematics *s, int64_t k)
{
    double a[3], d[3];
    for (int i = 0; i < 3; i++) {
        double rest = s->rest[3 * k + i];
        a[i] = rest;
        for (int f = 0; f < KINEMATICS_OTHERS; f++)
            if (f < s->others)
                a[i] += s->weight[f] * (s->other[f][3 * k + i] - rest);
    }
    if (s->motion[k] >= 0) {
        const struct pose *p = &s->pose[s->motion[k]];
        const double *r = p->rotation;
        for (int i = 0; i < 3; i++)
            d[i] = a[i] - p->pivot[i];
        for (int i = 0; i < 3; i++, r += 3)
            a[i] = p->p[i] + (r[0] * d[0] + r[1] * d[1] + r[2] * d[2]);
    }
    s->x[k] = vec_make((real)a[0], (real)a[1], (real)a[2]);
    return vec_sane(s->x[k]);
}

int ref_kinematics(struct kinematics *s)
{
    int bad = 0;
#pragma omp parallel for schedule(static) reduction(| : bad)
    for (int64_t k = 0; k < s->n; k++)
        bad |= !place_vertex(s, k);
    return bad ? DRAPE_EDATA : DRAPE_OK;
}
