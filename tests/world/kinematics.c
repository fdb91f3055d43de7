/* SPDX-License-Identifier: Apache-2.0 */
/* Stage kinematics: generator, properties and tests.
 * spec/world/kinematics.md */
#include "ref/world/kinematics.h"

#include "tests/base/harness.h"

const struct field fields_kinematics[] = {
    IN(kinematics, rest, n, 3),     IN(kinematics, other[0], n, 3),
    IN(kinematics, other[1], n, 3), IN(kinematics, other[2], n, 3),
    IN(kinematics, motion, n, 1),   IN(kinematics, pose, poses, 1),
    OUT(kinematics, x, n, 1),       FIELD_END};

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
    s->others = (int)pick(b, KINEMATICS_OTHERS + 1);
    for (int f = 0; f < KINEMATICS_OTHERS; f++) {
        double *other = take(b, s->n, 3 * sizeof *other);
        for (int64_t k = 0; k < 3 * s->n; k++)
            other[k] = pick(b, 4) ? (double)pick_real(b, 16) : rest[k];
        s->other[f] = other;
        s->weight[f] = (double)pick_uniform(b, f ? -0.25 : 0, f ? 0.25 : 1);
    }
    s->rest = rest;
    s->motion = motion;
    s->pose = pose;
}

const char *prop_kinematics(const struct kinematics *s)
{
    for (int64_t k = 0; k < s->n; k++) {
        double a[3];
        vec x = s->x[k];
        for (int i = 0; i < 3; i++) { /* §1 */
            a[i] = s->rest[3 * k + i];
            for (int f = 0; f < s->others; f++)
                a[i] += s->weight[f] *
                        (s->other[f][3 * k + i] - s->rest[3 * k + i]);
        }
        if (s->motion[k] < 0) { /* §1: without a motion x is this place */
            EXPECT(x.x == (real)a[0] && x.y == (real)a[1] && x.z == (real)a[2]);
            continue;
        }
        /* §3: distances from the pivot are kept. The coordinates are below
         * 2^7, so 2^-18 of them covers one rounding to the state and R. */
        const struct pose *p = &s->pose[s->motion[k]];
        double want = 0, have = 0;
        double y[3] = {(double)x.x, (double)x.y, (double)x.z};
        for (int i = 0; i < 3; i++) {
            want += (a[i] - p->pivot[i]) * (a[i] - p->pivot[i]);
            have += (y[i] - p->p[i]) * (y[i] - p->p[i]);
        }
        EXPECT(fabs(sqrt(have) - sqrt(want)) <= 0x1p-18 * 128);
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

/* §4: frames of one vertex at these times, and its place at any time. */
enum { FRAMES = 6 };
struct line {
    struct sequence frames;
    double time[FRAMES], x[FRAMES][3];
};

static void place_at(const struct line *l, double t, double x[3])
{
    static const int32_t none = -1;
    struct kinematics s = {.n = 1, .motion = &none};
    vec at;
    s.x = &at;
    kinematics_frame(&l->frames, l->x[0], t, &s);
    for (int i = 0; i < 3; i++) { /* as §1, but in binary64 */
        x[i] = s.rest[i];
        for (int f = 0; f < s.others; f++)
            x[i] += s.weight[f] * (s.other[f][i] - s.rest[i]);
    }
}

static void make_line(struct line *l, int count, int between, bool even)
{
    for (int k = 0; k < FRAMES; k++)
        l->time[k] = even ? 0.25 * k : 0.25 * k + 0.1 * (k % 3) - 0.5;
    l->frames = (struct sequence){count, between, 0.25, even ? NULL : l->time};
}

/* §4.1: the frames themselves at their times, before and after. */
static const char *check_frames(const struct line *l)
{
    int last = l->frames.count - 1;
    double x[3];
    for (int k = 0; k <= last; k++) {
        place_at(l, l->time[k], x);
        EXPECT(memcmp(x, l->x[k], sizeof x) == 0);
    }
    place_at(l, l->time[0] - 9, x);
    EXPECT(memcmp(x, l->x[0], sizeof x) == 0);
    place_at(l, l->time[last] + 9, x);
    EXPECT(memcmp(x, l->x[last], sizeof x) == 0);
    ran(last + 3);
    return NULL;
}

/* The largest |X_k+1 - X_k-1| there may be of frames within [-1, 1]. */
#define MOST_WAY 2.0

/* §4.2, §4.4: how far a place may be from the line between its frames, and
 * §4.3: velocities are the same from both sides of a frame. `step` of a span
 * changes a quotient of differences by at most the second derivative of the
 * cubic, 6 · 4 ways a span squared, times the step. */
static const char *check_between(const struct line *l)
{
    bool cubic = l->frames.between == DRAPE_CUBIC && l->frames.count > 2;
    double step = 0x1p-20;
    for (int k = 0; k + 1 < l->frames.count; k++) {
        bool end = k == 0 || k + 2 == l->frames.count;
        double most = cubic ? 4.0 / 27 * (end ? 4 : 2) * MOST_WAY : 0;
        double h = l->time[k + 1] - l->time[k], x[3], y[3], left = 0;
        for (int p = 1; p < 16; p++) {
            place_at(l, l->time[k] + p * h / 16, x);
            for (int i = 0; i < 3; i++) {
                double line =
                    l->x[k][i] + p / 16.0 * (l->x[k + 1][i] - l->x[k][i]);
                EXPECT(fabs(x[i] - line) <= most + 0x1p-48);
                left = fmax(left, fabs(x[i] - line));
            }
        }
        EXPECT(!cubic || left > 1e-3); /* it does bend */
        if (!cubic || k == 0)
            continue;
        double before = l->time[k] - l->time[k - 1];
        place_at(l, l->time[k] + step, x);
        place_at(l, l->time[k] - step, y);
        for (int i = 0; i < 3; i++) {
            double after = (x[i] - l->x[k][i]) / step;
            double until = (l->x[k][i] - y[i]) / step;
            double mean = (l->x[k + 1][i] - l->x[k - 1][i]) / (h + before);
            double slack = 24 * MOST_WAY * step / fmin(h * h, before * before);
            EXPECT(fabs(after - mean) <= slack && fabs(until - mean) <= slack);
        }
    }
    ran(1);
    return NULL;
}

/* §4.4: a motion that is even in time, and with even times one that is
 * quadratic, is exact to rounding; ends included. */
static const char *check_exact(int between, bool even)
{
    struct line l;
    double x[3];
    make_line(&l, FRAMES, between, even);
    for (int k = 0; k < FRAMES; k++)
        for (int i = 0; i < 3; i++) {
            double t = l.time[k];
            l.x[k][i] = (i + 1) * t + (even && between ? 3 * t * t : 0) - 1;
        }
    for (int p = 0; p <= 200; p++) {
        double t = l.time[0] + p / 200.0 * (l.time[FRAMES - 1] - l.time[0]);
        place_at(&l, t, x);
        for (int i = 0; i < 3; i++) {
            double want = (i + 1) * t + (even && between ? 3 * t * t : 0) - 1;
            EXPECT(fabs(x[i] - want) <= 0x1p-47);
        }
    }
    ran(1);
    return NULL;
}

/* §4.4 of a circle of radius 1, turned by `turn` between frames: from
 * velocities that err by turn² / 6 a place errs by turn³ / 24, and the cubic
 * itself by turn⁴ / 384; ends have a velocity of order turn² and are left out.
 */
static const char *check_circle(double turn)
{
    struct line l;
    double x[3], most = turn * turn * turn / 24 + pow(turn, 4) / 384;
    make_line(&l, FRAMES, DRAPE_CUBIC, true);
    for (int k = 0; k < FRAMES; k++) {
        l.x[k][0] = cos(turn * k);
        l.x[k][1] = sin(turn * k);
        l.x[k][2] = 0;
    }
    for (int p = 0; p <= 100; p++) {
        double at = 1 + (FRAMES - 3) * p / 100.0;
        place_at(&l, 0.25 * at, x);
        EXPECT(hypot(x[0] - cos(turn * at), x[1] - sin(turn * at)) <=
               most + 0x1p-48);
    }
    ran(1);
    return NULL;
}

const char *test_kinematics_frames(void)
{
    const char *failed = NULL;
    for (int how = 0; how < 4 * FRAMES && !failed; how++) {
        struct line l;
        make_line(&l, 1 + how / 4, how % 2, how / 2 % 2);
        for (int k = 0; k < 3 * FRAMES; k++) /* within [-1, 1], none alike */
            l.x[k / 3][k % 3] = sin(37.0 * k * k + 11 * k + how);
        failed = check_frames(&l);
        failed = failed ? failed : check_between(&l);
    }
    for (int how = 0; how < 4 && !failed; how++)
        failed = check_exact(how % 2, how / 2);
    for (int k = 1; k < 8 && !failed; k++)
        failed = check_circle(0.1 * k);
    return failed;
}
