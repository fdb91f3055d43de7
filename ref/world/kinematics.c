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

static bool place_vertex(const struct kinematics *s, int64_t k)
{
    double a[3], d[3];
    for (int i = 0; i < 3; i++) {
        a[i] = s->rest[3 * k + i];
        if (s->next)
            a[i] += s->blend * (s->next[3 * k + i] - a[i]);
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
