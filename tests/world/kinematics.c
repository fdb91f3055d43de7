/* SPDX-License-Identifier: Apache-2.0 */
/* Stage kinematics: generator, properties and tests.
 * spec/world/kinematics.md */
#include "ref/world/kinematics.h"

#include "tests/base/harness.h"

const struct field fields_kinematics[] = {
    IN(kinematics, rest, n, 3), IN(kinematics, motion, n, 1),
    IN(kinematics, pose, poses, 1), OUT(kinematics, x, n, 1), FIELD_END};

/* Picks a rotation about a coordinate axis by a multiple of 90°, or a random
 * rotation. */
static void pick_rotation(struct bytes *b, double q[4])
{
    double norm = 0;
    for (int i = 0; i < 4; i++) {
        q[i] = pick(b, 2) ? (double)pick_uniform(b, -1, 1)
                          : (double)pick(b, 3) - 1;
        norm += q[i] * q[i];
    }
    for (int i = 0; i < 4; i++)
        q[i] = norm > 0 ? q[i] / sqrt(norm) : (i == 0);
}

void gen_kinematics(struct bytes *b, struct kinematics *s)
{
    s->n = for_bench(b) ? 1 << 20 : pick_size(b);
    s->poses = 2;
    double *rest = take(b, s->n, 3 * sizeof *rest);
    int32_t *motion = take(b, s->n, sizeof *motion);
    struct pose *pose = take(b, s->poses, sizeof *pose);
    for (int k = 0; k < 2; k++) {
        double time[2] = {0, 1}, position[2][3] = {{0}}, rotation[2][4];
        drape_motion m = {2,
                          time,
                          (const double(*)[3])position,
                          (const double(*)[4])rotation,
                          {1, 2, 3}};
        for (int i = 0; i < 3; i++)
            position[1][i] = (double)pick_real(b, 8);
        pick_rotation(b, rotation[0]);
        pick_rotation(b, rotation[1]);
        pose[k] = kinematics_pose(&m, (double)pick_uniform(b, -1, 2));
    }
    for (int64_t k = 0; k < s->n; k++) {
        motion[k] = (int32_t)pick(b, 3) - 1;
        for (int i = 0; i < 3; i++)
            rest[3 * k + i] = (double)pick_real(b, 16);
    }
    s->rest = rest;
    s->motion = motion;
    s->pose = pose;
}

const char *prop_kinematics(const struct kinematics *s)
{
    for (int64_t k = 0; k < s->n; k++) {
        const double *a = s->rest + 3 * k;
        vec x = s->x[k];
        if (s->motion[k] < 0) { /* §1: without a motion, x is rest */
            EXPECT(x.x == (real)a[0] && x.y == (real)a[1] && x.z == (real)a[2]);
            continue;
        }
        /* §3: distances from the pivot are kept. The coordinates are below
         * 2^5, so 2^-19 relative covers one rounding to the state and R. */
        const struct pose *p = &s->pose[s->motion[k]];
        double want = 0, have = 0;
        double y[3] = {(double)x.x, (double)x.y, (double)x.z};
        for (int i = 0; i < 3; i++) {
            want += (a[i] - p->pivot[i]) * (a[i] - p->pivot[i]);
            have += (y[i] - p->p[i]) * (y[i] - p->p[i]);
        }
        EXPECT(fabs(sqrt(have) - sqrt(want)) <= 0x1p-18 * 32);
    }
    return NULL;
}

/* §2: a motion passes through its keys, is linear between them, and rests
 * before the first key and after the last. */
const char *test_motion_keys(void)
{
    const double time[] = {1, 2, 4};
    const double position[][3] = {{0, 0, 0}, {2, 0, 0}, {2, 4, 0}};
    const double rotation[][4] = {{1, 0, 0, 0}, {0, 0, 0, 1}, {0, 0, 0, -1}};
    drape_motion m = {3, time, position, rotation, {0, 0, 0}};
    for (int k = 0; k < 3; k++) {
        struct pose p = kinematics_pose(&m, time[k]);
        for (int i = 0; i < 3; i++)
            EXPECT(p.p[i] == position[k][i]);
        ran(1);
    }
    EXPECT(kinematics_pose(&m, 0).p[0] == 0);
    EXPECT(kinematics_pose(&m, 9).p[1] == 4);
    EXPECT(kinematics_pose(&m, 3).p[1] == 2);
    /* §2.2: q and -q are the same rotation: between keys 1 and 2 nothing turns
     */
    EXPECT(kinematics_pose(&m, 3).rotation[0] == -1);
    /* half way through a half turn about z, x has turned to y */
    EXPECT(fabs(kinematics_pose(&m, 1.5).rotation[3] - 1) <= 0x1p-50);
    return NULL;
}
