/* SPDX-License-Identifier: Apache-2.0 */
/* Tests of the cycle over cloths that seams join. spec/solve/sewn.md */
#include "ref/api/handle.h"
#include "ref/base/sum.h"
#include "ref/solve/joint.h"
#include "ref/world/state.h"
#include "tests/base/choices.h"
#include "tests/base/harness.h"

#include <stdio.h>
#include <stdlib.h>

/* PANELS in a row, of SIDE² particles, or at most MOST of LONG², and two small
 * cloths that are sewn anyway, so that all worlds that are compared have seams.
 */
enum { PANELS = 6, SIDE = 33, SMALL = 5, MOST = 12, LONG = 128 };
enum { ALL = MOST + 2 };
enum { COUNT = PANELS * SIDE * SIDE + 2 * SMALL * SMALL };
static const double cell = 5e-3;

struct row {
    drape_def def;
    drape_cloth cloth[ALL];
    drape_seam seam[ALL];
    drape_pin pin[ALL][2];
    int32_t particle[ALL][LONG], onto[ALL][LONG][2];
    double part[LONG];
};

enum way { WHOLE, SEWN, APART };

/* Sews the right edge of cloth k to the left one of the next. */
static void sew_next(struct row *s, int k)
{
    int m = s->cloth[k].m, n = s->cloth[k].n;
    for (int j = 0; j < n; j++) {
        s->particle[k][j] = m - 1 + m * j;
        s->onto[k][j][0] = s->onto[k][j][1] = s->cloth[k + 1].m * j;
    }
    s->seam[s->def.n_seams++] =
        (drape_seam){.cloth = {k, k + 1},
                     .n = n,
                     .particle = s->particle[k],
                     .onto = (const int32_t(*)[2])s->onto[k],
                     .part = s->part};
}

/* Adds a cloth of m × n particles from x = `at` on, held at the corners of its
 * upper edge that are asked for. */
static void add_cloth(struct row *s, int m, int n, const double at[2],
                      bool left, bool right)
{
    int k = s->def.n_cloths++;
    drape_cloth *c = &s->cloth[k];
    drape_default_cloth(c);
    c->m = m;
    c->n = n;
    c->width = (m - 1) * cell;
    c->height = (n - 1) * cell;
    c->origin[0] = at[0];
    c->origin[1] = at[1];
    c->v[1] = -0.8;
    c->v[2] = 0.6;
    c->pins = s->pin[k];
    if (left)
        s->pin[k][c->n_pins++] = (drape_pin){.i = 0, .motion = -1};
    if (right)
        s->pin[k][c->n_pins++] = (drape_pin){.i = m - 1, .motion = -1};
}

/* A sheet that falls, held at two corners: whole, or n panels of side² that are
 * sewn; or these panels apart, each held at two corners. */
static void make_row(struct row *s, int n, int side, enum way way)
{
    int panels = way == WHOLE ? 1 : n, m = n * (side - 1) / panels + 1;
    double step = (m - 1) * cell + (way == APART ? 0.1 : 0);
    memset(s, 0, sizeof *s);
    drape_default(&s->def);
    s->def.cloths = s->cloth;
    s->def.seams = s->seam;
    s->def.precision = REAL_BITS;
    for (int k = 0; k < panels; k++)
        add_cloth(s, m, side, (double[]){k * step, 0}, way == APART || k == 0,
                  way == APART || k == panels - 1);
    for (int k = 0; k < panels - 1 && way == SEWN; k++)
        sew_next(s, k);
    for (int k = 0; k < 2; k++)
        add_cloth(s, SMALL, SMALL, (double[]){k * (SMALL - 1) * cell, 1}, true,
                  true);
    sew_next(s, panels);
}

/* Steps a row. Returns the iterations of a system, in the mean. */
static double iterations_of(const struct row *s, int steps)
{
    drape_world *world;
    double iterations = 0, systems = 0;
    if (drape_create(&s->def, &world, NULL) != DRAPE_OK)
        return 0;
    for (int k = 0; k < steps; k++) {
        drape_step_report r;
        if (drape_step(world, &r) != DRAPE_OK || r.outcome != 0)
            systems = INFINITY;
        iterations += r.iterations;
        systems += r.work.solves;
    }
    drape_destroy(world);
    return iterations / systems;
}

/* The table of bench/h200/README.md, and the whole sheet. */
static void print_iterations(struct row *s)
{
    static const int row[][2] = {{6, 33}, {6, 65}, {6, 128}, {12, 128}};
    for (int k = 0; k < 4; k++) {
        double found[3];
        for (int way = WHOLE; way <= APART; way++) {
            make_row(s, row[k][0], row[k][1], (enum way)way);
            found[way] = iterations_of(s, 5);
        }
        printf("%d panels of %d: whole %.1f, sewn %.1f, apart %.1f\n",
               row[k][0], row[k][1], found[WHOLE], found[SEWN], found[APART]);
    }
}

/* A system of a sheet of panels takes at most 1.5 times the iterations of one
 * of the whole sheet. */
const char *test_seam_iterations(void)
{
    static struct row s;
    if (getenv("DRAPE_ITERATIONS"))
        print_iterations(&s);
    make_row(&s, PANELS, SIDE, WHOLE);
    double whole = iterations_of(&s, 5);
    make_row(&s, PANELS, SIDE, SEWN);
    double sewn = iterations_of(&s, 5);
    EXPECT(whole > 1 && sewn > 1 && sewn <= 1.5 * whole);
    ran(1);
    return NULL;
}

/* q = M⁻¹ r of all particles of a world. */
static void precondition(struct world *w, const vec *r, vec *q)
{
    struct joint *j = &w->lagrange.joint;
    size_t bytes = (size_t)w->nc * sizeof *r;
    real value;
    ref_joint_measure(w, j, r, &value);
    memcpy(q, j->q, bytes);
}

static double product_of(int64_t n, const vec *a, const vec *b)
{
    double sum = 0;
    for (int64_t k = 0; k < n; k++)
        sum += (double)a[k].x * (double)b[k].x +
               (double)a[k].y * (double)b[k].y +
               (double)a[k].z * (double)b[k].z;
    return sum;
}

/* §3.1: M is symmetric, to rounding, and positive definite. multigrid.md §4
 * bounds the roundings of a cycle. */
const char *test_seam_cycle(void)
{
    static struct row s;
    drape_world *world;
    struct bytes b = {.seed = 7, .size = -1};
    double u = REAL_BITS == 32 ? 0x1p-24 : 0x1p-53;
    make_row(&s, PANELS, SIDE, SEWN);
    EXPECT(drape_create(&s.def, &world, NULL) == DRAPE_OK);
    for (int k = 0; k < 3; k++)
        EXPECT(drape_step(world, NULL) == DRAPE_OK);
    struct world *w = world->world;
    static vec v[4][COUNT];
    memset(v, 0, sizeof v);
    EXPECT(w->nc == COUNT);
    for (int turn = 0; turn < 10; turn++) {
        for (int k = 0; k < 2; k++) {
            for (int64_t p = 0; p < w->nc; p++)
                if (w->w[p] > 0)
                    v[k][p] = vec_make(pick_uniform(&b, -1, 1),
                                       pick_uniform(&b, -1, 1),
                                       pick_uniform(&b, -1, 1));
            precondition(w, v[k], v[2 + k]);
        }
        double xx = product_of(w->nc, v[0], v[2]);
        double yy = product_of(w->nc, v[1], v[3]);
        double xy = product_of(w->nc, v[0], v[3]);
        double yx = product_of(w->nc, v[1], v[2]);
        EXPECT(xx > 0 && yy > 0);
        EXPECT(fabs(xy - yx) <= 2112 * u * sqrt(xx * yy));
        ran(1);
    }
    drape_destroy(world);
    return NULL;
}
