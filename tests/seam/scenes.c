/* SPDX-License-Identifier: Apache-2.0 */
/* Sewn cloths in whole scenes, through the public API: what is sewn acts as one
 * piece, gaps go to their targets, momentum is kept, and sewn cloths fall, rest
 * and wake together. spec/seam/seam.md */
#include "tests/seam/sewn.h"
#include "tests/world/scene.h"

#include <stdlib.h>

/* A cell's part that a gap may be off ten steps after a change of load. */
static const double GAP = 1e-3;

static const double strip[2] = {0.1, 0.4};

/* How far down the last row of the last cloth is, m. Ends the world. */
static const char *end_low(const struct sewn *s, drape_world *world,
                           double *low)
{
    int64_t nv = drape_vertices(world);
    int m = s->cloth[s->def.n_cloths - 1].m;
    double(*x)[3] = malloc((size_t)nv * sizeof *x);
    EXPECT(x && drape_read(world, x, NULL) == DRAPE_OK);
    *low = 0;
    for (int k = 1; k <= m; k++)
        *low -= x[nv - k][1] / m;
    free(x);
    drape_destroy(world);
    return NULL;
}

/* How far down a strip hangs, m, after so many steps; the seam's gap is small
 * from the tenth on. */
static const char *hang(struct sewn *s, int steps, double *low)
{
    drape_world *world;
    drape_step_report r;
    EXPECT(drape_create(&s->def, &world, NULL) == DRAPE_OK);
    for (int k = 0; k < steps; k++) {
        EXPECT(drape_step(world, &r) == DRAPE_OK && r.outcome == 0);
        EXPECT(k < 10 || s->def.n_seams == 0 || sewn_gap(s, world, NULL) < GAP);
    }
    if (s->def.n_seams) { /* §4: the pull is the weight below */
        const drape_cloth *c = s->cloth;
        double pull[3], sign = s->seam.cloth[0] ? 1 : -1;
        double weight = c->material.density * c->width * c->height * 9.81;
        sewn_pull(s, world, pull);
        EXPECT(fabs(pull[1] * sign - weight) < 1e-2 * weight);
    }
    return end_low(s, world, low);
}

/* §1: a strip of two panels is as stiff as a whole one, within 0.1 %, also
 * where the edges have other numbers of particles. */
const char *test_seam_strip(void)
{
    static const int side[3][2] = {{11, 11}, {11, 14}, {13, 9}};
    static struct sewn s;
    for (int how = DRAPE_BW; how <= DRAPE_BDF2; how++)
        for (int k = 0; k < 3; k++) {
            double low[2];
            sewn_make(&s, side[k], strip, true, 0);
            s.def.integrator = how;
            s.def.sleep = 0;
            s.cloth[0].material.damping = s.cloth[1].material.damping = 1e-2;
            sewn_pin_row(&s, 0, 0, -1);
            const char *failed = hang(&s, 60, &low[0]);
            if (failed)
                return failed;
            s.cloth[0].n = 2 * s.cloth[0].n - 1;
            s.cloth[0].height *= 2;
            s.def.n_cloths = 1;
            s.def.n_seams = 0;
            failed = hang(&s, 60, &low[1]);
            if (failed)
                return failed;
            double a = low[0] - strip[1], b = low[1] - strip[1];
            EXPECT(b > 1e-4 && fabs(a - b) < 1e-3 * b);
            ran(1);
        }
    return NULL;
}

/* How far the end of a strip that is clamped at its first two rows has sunk
 * after so many steps, m. */
static const char *sink(struct sewn *s, int steps, double *down)
{
    drape_world *world;
    EXPECT(drape_create(&s->def, &world, NULL) == DRAPE_OK);
    for (int k = 0; k < steps; k++)
        EXPECT(drape_step(world, NULL) == DRAPE_OK);
    return end_low(s, world, down);
}

/* §6: a cantilever of two panels sinks as a whole one does, within 0.5 %, also
 * where the edges have other numbers of particles, and with half the cells. By
 * the methods of order 2 it swings for seconds, so it is looked at as it sinks
 * for the first time. */
const char *test_seam_bends(void)
{
    static const int side[4][2] = {{11, 11}, {11, 14}, {13, 9}, {21, 17}};
    static const double size[2] = {0.1, 0.2};
    static struct sewn s;
    for (int how = DRAPE_BW; how <= DRAPE_BDF2; how++)
        for (int k = 0; k < 4; k++) {
            double down[2];
            int steps = how == DRAPE_BW ? 150 : 10;
            sewn_make(&s, side[k], size, false, 0);
            s.def.integrator = how;
            s.def.sleep = 0;
            for (int c = 0; c < 2; c++) {
                s.cloth[c].material.damping = 1e-2;
                s.cloth[c].material.bend = 5e-3;
            }
            sewn_pin_row(&s, 0, 0, -1);
            sewn_pin_row(&s, 0, 1, -1);
            const char *failed = sink(&s, steps, &down[0]);
            if (failed)
                return failed;
            s.cloth[0].n = 2 * s.cloth[0].n - 1;
            s.cloth[0].height *= 2;
            s.def.n_cloths = 1;
            s.def.n_seams = 0;
            failed = sink(&s, steps, &down[1]);
            if (failed)
                return failed;
            EXPECT(down[1] > 0.02 && fabs(down[0] - down[1]) < 0.005 * down[1]);
            ran(1);
        }
    return NULL;
}

/* §3: ten steps after a pull that begins within one step the gap is closed. */
const char *test_seam_loads(void)
{
    static const int side[2] = {21, 21};
    static const double size[2] = {0.2, 0.4}, time[2] = {0, 1.0 / 60};
    static const double way[2][3] = {{0, 0, 0}, {0, -0.0076, 0}};
    const drape_motion motion = {2, time, way, NULL, {0, 0, 0}};
    static struct sewn s;
    for (int how = DRAPE_BW; how <= DRAPE_BDF2; how++) {
        drape_world *world;
        sewn_make(&s, side, size, true, 0);
        sewn_pin_row(&s, 0, 0, -1);
        sewn_pin_row(&s, 1, s.cloth[1].n - 1, 0);
        s.def.integrator = how;
        s.def.motions = &motion;
        s.def.n_motions = 1;
        EXPECT(drape_create(&s.def, &world, NULL) == DRAPE_OK);
        for (int k = 0; k < 20; k++) {
            EXPECT(drape_step(world, NULL) == DRAPE_OK);
            EXPECT(k < 10 || sewn_gap(&s, world, NULL) < GAP);
        }
        double pull[3]; /* at 1.9 % strain */
        sewn_pull(&s, world, pull);
        EXPECT(fabs(-pull[1] - 0.019 * 1000 * 0.2) < 0.1 * 0.019 * 1000 * 0.2);
        drape_destroy(world);
        ran(1);
    }
    return NULL;
}

/* §2: a seam of half the strength that the weight below asks for pulls by its
 * strength and lets the cloth fall at g/2; one of twice as much holds it. */
const char *test_seam_yields(void)
{
    static const int side[2] = {9, 9};
    static struct sewn s;
    for (int how = DRAPE_BW; how <= DRAPE_BDF2; how++)
        for (int holds = 0; holds < 2; holds++) {
            drape_world *world;
            drape_step_report r;
            double pull[SEWN_SIDE][3], mean = 0, sum = 0;
            sewn_make(&s, side, strip, true, 0);
            s.def.integrator = how;
            sewn_pin_row(&s, 0, 0, -1);
            const drape_cloth *c = &s.cloth[1];
            double mass = c->material.density * c->width * c->height;
            double all = mass * 9.81 * (holds ? 2 : 0.5);
            s.seam.strength = all / (double)s.seam.n;
            EXPECT(drape_create(&s.def, &world, NULL) == DRAPE_OK);
            for (int k = 0; k < 20; k++) {
                EXPECT(drape_step(world, &r) == DRAPE_OK && r.outcome == 0);
                EXPECT(drape_seam_state(world, 0, NULL, pull) == DRAPE_OK);
                sum = 0;
                for (int i = 0; i < s.seam.n; i++) {
                    double size =
                        sqrt(pull[i][0] * pull[i][0] + pull[i][1] * pull[i][1] +
                             pull[i][2] * pull[i][2]);
                    EXPECT(size <= 1.00001 * s.seam.strength);
                    sum += size;
                }
                EXPECT(holds || sum > 0.999 * all);
                EXPECT(!holds || k < 10 || sewn_gap(&s, world, NULL) < GAP);
            }
            static double v[4 * SEWN_SIDE * SEWN_SIDE][3];
            EXPECT(drape_read(world, NULL, v) == DRAPE_OK);
            for (int j = 0, p = s.cloth[0].m * s.cloth[0].n; j < c->n; j++)
                for (int i = 0; i < c->m; i++, p++)
                    mean -= v[p][1] * (i % (c->m - 1) ? 1 : 0.5) *
                            (j % (c->n - 1) ? 1 : 0.5);
            mean /= (c->m - 1) * (c->n - 1);
            EXPECT(holds || fabs(mean - 4.905 / 3) < 0.01 * 4.905 / 3);
            drape_destroy(world);
            ran(1);
        }
    return NULL;
}

/* §2: Σ c = 0: in a seam forces cancel. What is sewn together is one island of
 * momentum.md §3: one cloth pulls the other along. */
const char *test_seam_momentum(void)
{
    static const int side[2] = {9, 12};
    static const double size[2] = {0.2, 0.4};
    static struct sewn s;
    static double v[4 * SEWN_SIDE * SEWN_SIDE][3];
    for (int how = DRAPE_BW; how <= DRAPE_BDF2; how++) {
        drape_world *world;
        double sum[2][3] = {{0}}, most = 0, second = 0;
        sewn_make(&s, side, size, false, 0);
        s.def.integrator = how;
        s.def.gravity[1] = 0;
        int n = s.cloth[0].m * s.cloth[0].n;
        for (int p = 0; p < n; p++)
            v[p][2] = -0.5, v[p][1] = 0.3 * p / n, v[p][0] = 0.4;
        s.cloth[0].velocity = (const double(*)[3])v;
        EXPECT(drape_create(&s.def, &world, NULL) == DRAPE_OK);
        for (int step = 0; step <= 30; step++) {
            static double u[4 * SEWN_SIDE * SEWN_SIDE][3];
            if (step)
                EXPECT(drape_step(world, NULL) == DRAPE_OK);
            EXPECT(drape_read(world, NULL, u) == DRAPE_OK);
            memset(sum[1], 0, sizeof sum[1]);
            most = second = 0;
            for (int c = 0, p = 0; c < 2; c++)
                for (int j = 0; j < s.cloth[c].n; j++)
                    for (int i = 0; i < s.cloth[c].m; i++, p++) {
                        const drape_cloth *d = &s.cloth[c];
                        double cell =
                            d->width * d->height / ((d->m - 1) * (d->n - 1));
                        double m = cell * d->material.density;
                        m *= i == 0 || i == d->m - 1 ? 0.5 : 1;
                        m *= j == 0 || j == d->n - 1 ? 0.5 : 1;
                        for (int a = 0; a < 3; a++) {
                            sum[1][a] += m * u[p][a];
                            most += m * fabs(u[p][a]);
                        }
                        second += c ? m * u[p][0] : 0;
                    }
            if (step == 0)
                memcpy(sum[0], sum[1], sizeof sum[0]);
        }
        for (int a = 0; a < 3; a++)
            EXPECT(fabs(sum[1][a] - sum[0][a]) <
                   (REAL_BITS == 32 ? 2e-6 : 1e-14) * most);
        EXPECT(fabs(second) > 0.02 * most); /* what the second one has */
        drape_destroy(world);
        ran(1);
    }
    return NULL;
}

/* §4: targets that shrink by 0.5 m/s from 0.3 m are followed, and end closed.
 */
const char *test_seam_closes(void)
{
    static const int side[2] = {17, 17};
    static const double size[2] = {0.2, 0.4};
    static struct sewn s;
    static double start[SEWN_SIDE][3], to[SEWN_SIDE][3];
    for (int how = DRAPE_BW; how <= DRAPE_BDF2; how++) {
        drape_world *world;
        drape_step_report r;
        sewn_make(&s, side, size, false, 0.3);
        s.def.integrator = how;
        s.def.gravity[1] = 0;
        EXPECT(drape_create(&s.def, &world, NULL) == DRAPE_OK);
        EXPECT(drape_seam_state(world, 0, start, NULL) == DRAPE_OK);
        EXPECT(fabs(start[3][2] - 0.3) < 1e-6);
        for (int k = 1; k <= 46; k++) {
            double part = fmax(0, 1 - k / 36.0);
            for (int i = 0; i < s.seam.n; i++)
                for (int a = 0; a < 3; a++)
                    to[i][a] = part * start[i][a];
            EXPECT(drape_seam_target(world, 0,
                                     k < 36 ? (const double(*)[3])to : NULL) ==
                   DRAPE_OK);
            EXPECT(drape_step(world, &r) == DRAPE_OK && r.outcome == 0);
            EXPECT(sewn_gap(&s, world, (const double(*)[3])to) < GAP);
        }
        drape_destroy(world);
        ran(1);
    }
    return NULL;
}

/* The pairs of triangles that intersect, with cloth; *sewn: those that a seam
 * joins. */
static int64_t audit(const drape_world *world, int cloths, int64_t *sewn)
{
    enum { MOST = 1 << 14 };
    static int32_t pair[MOST][2];
    int64_t nv = drape_vertices(world), nt = drape_triangles(world), n = -1;
    double(*x)[3] = malloc((size_t)nv * sizeof *x);
    int32_t(*tri)[3] = malloc((size_t)nt * sizeof *tri);
    int32_t *group = malloc((size_t)nt * sizeof *group);
    *sewn = 0;
    if (x && tri && group && drape_read(world, x, NULL) == DRAPE_OK &&
        drape_read_triangles(world, tri) == DRAPE_OK) {
        for (int64_t k = 0; k < nt; k++)
            group[k] = k < drape_first_triangle(world, cloths);
        drape_mesh mesh = {.nv = nv,
                           .nt = nt,
                           .x = (const double(*)[3])x,
                           .tri = (const int32_t(*)[3])tri,
                           .group = group};
        if (drape_audit(&mesh, MOST, pair, &n, NULL) != DRAPE_OK || n > MOST)
            n = -1;
    }
    for (int64_t k = 0; k < n; k++)
        *sewn += drape_are_sewn(world, pair[k][0], pair[k][1]);
    free(x);
    free(tri);
    free(group);
    return n - *sewn;
}

/* §5: sewn cloths fall on a ball: nothing intersects but what is sewn. */
const char *test_seam_falls(void)
{
    static const int side[2][2] = {{13, 13}, {11, 14}};
    static const double size[2] = {0.3, 0.6};
    static struct sewn s;
    for (int k = 0; k < 3; k++) {
        drape_world *world;
        drape_step_report r;
        int64_t sewn, contacts = 0;
        sewn_make(&s, side[k % 2], size, false, 0);
        s.def.integrator = DRAPE_BW + k;
        sewn_add_ball(&s, 0.12);
        for (int c = 0; c < 2; c++) {
            s.cloth[c].origin[0] -= 0.15;
            s.cloth[c].origin[1] = 0.125;
            s.cloth[c].origin[2] += 0.28;
        }
        EXPECT(drape_create(&s.def, &world, NULL) == DRAPE_OK);
        for (int step = 0; step < 24; step++) {
            EXPECT(drape_step(world, &r) == DRAPE_OK);
            EXPECT(!(r.outcome & (DRAPE_TRAPPED | DRAPE_DIVERGED)));
            EXPECT(audit(world, 2, &sewn) == 0);
            contacts += r.contacts;
        }
        EXPECT(contacts > 500);
        EXPECT(sewn_gap(&s, world, NULL) < 20 * GAP); /* in motion */
        drape_destroy(world);
        ran(1);
    }
    return NULL;
}

/* §4: sewn cloths fall asleep together and wake together, with the pull that
 * they had; a target wakes them, and one that is met lets them rest. */
const char *test_seam_sleeps(void)
{
    static const int side[2] = {11, 11};
    static struct sewn s;
    drape_world *world;
    drape_step_report r = {0};
    double pull[3], woken[3];
    sewn_make(&s, side, strip, true, 0);
    s.cloth[0].material.damping = s.cloth[1].material.damping = 1e-2;
    sewn_pin_row(&s, 0, 0, -1);
    EXPECT(drape_create(&s.def, &world, NULL) == DRAPE_OK);
    for (int k = 0; k < 400 && r.asleep == 0; k++)
        EXPECT(drape_step(world, &r) == DRAPE_OK);
    EXPECT(r.asleep == 2);
    sewn_pull(&s, world, pull);
    EXPECT(drape_step(world, &r) == DRAPE_OK && r.outcome == DRAPE_ASLEEP);
    EXPECT(drape_seam_target(world, 0, NULL) == DRAPE_OK);
    EXPECT(drape_step(world, &r) == DRAPE_OK && r.asleep == 0);
    sewn_pull(&s, world, woken);
    EXPECT(r.work.solves <= 1 && fabs(woken[1] - pull[1]) < 1e-2 * -pull[1]);
    EXPECT(sewn_gap(&s, world, NULL) < GAP);
    drape_destroy(world);
    ran(1);
    return NULL;
}
