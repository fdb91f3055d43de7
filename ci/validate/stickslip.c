/* SPDX-License-Identifier: Apache-2.0 */
/* Stick and slip of a strip that is pressed onto a floor. spec/validation.md
 * §12 */
#include "ci/validate/shooting.h"
#include "ci/validate/validate.h"

#include <math.h>
#include <stdlib.h>

/* The elastica without weight that is clamped upright and pressed onto a
 * floor. */
struct pressed {
    double quotient; /* of the floor's friction and its normal force */
    double way;      /* of the tip from where it stood, over the length */
};

struct reaction { /* of the floor on the tip */
    double side, up;
};

/* y: distance from the clamp's line, depth, angle from straight down, its
 * derivative. */
static void slope(const void *user, double s, const double *y, double *dy)
{
    const struct reaction *r = user;
    (void)s;
    dy[0] = sin(y[2]);
    dy[1] = cos(y[2]);
    dy[2] = y[3];
    dy[3] = -(r->side * cos(y[2]) + r->up * sin(y[2]));
}

static const struct ode equations = {4, 200, slope};

/* What is known of the tip: its depth, and that it stands below the clamp, or
 * the quotient of the forces. */
struct known {
    double depth, quotient;
    bool slides;
};

/* y at the arc length s, by the forces u[0], u[1] and the curvature u[2] at the
 * clamp: shapes of a part of a strip are those of a shorter one. */
static void from_clamp(const double *u, double s, double y[4])
{
    struct reaction r = {u[0] * s * s, u[1] * s * s};
    y[0] = y[1] = y[2] = 0;
    y[3] = u[2] * s;
    runge_kutta(&equations, &r, y);
    y[0] *= s;
    y[1] *= s;
}

/* The tip turns freely. */
static void at_tip(const void *user, const double *u, double *miss)
{
    const struct known *k = user;
    double y[4];
    from_clamp(u, 1, y);
    miss[0] = y[3];
    miss[1] = y[1] - k->depth;
    miss[2] = k->slides ? u[0] + k->quotient * u[1] : y[0];
}

/* The unknowns of a strip whose tip stands still or, where the quotient would
 * exceed `friction`, slides. */
static bool equilibrium(double share, double friction, double u[3])
{
    enum { INCREMENTS = 30 };
    /* A column that is clamped and hinged buckles at Euler's load k², tan k =
     * k, to a shape of slope a (1 - cos ks - k sin ks), which the shortening,
     * half the mean of its square, gives the amplitude a. */
    double k = 4.493409457909064, start = share / INCREMENTS, mean = 0;
    for (int i = 0; i < 1000; i++) {
        double at = k * (i + 0.5) / 1000, lean = 1 - cos(at) - k * sin(at);
        mean += lean * lean / 2000;
    }
    double a = sqrt(start / mean);
    u[0] = u[2] = -k * k * a;
    u[1] = k * k;
    struct known known = {1 - start, friction, false};
    for (int i = 1; i <= INCREMENTS; i++) {
        known.depth = 1 - start * i;
        if (!shoot(3, u, at_tip, &known))
            return false;
        if (known.slides || fabs(u[0]) <= friction * u[1])
            continue;
        known.slides = true;
        known.quotient = u[0] < 0 ? friction : -friction;
        if (!shoot(3, u, at_tip, &known))
            return false;
    }
    return true;
}

/* The strip's clamp has come nearer to the floor by a share of the length,
 * from where the strip just stood on it. NAN: no equilibrium was found. */
static struct pressed pressed(double share, double friction)
{
    struct pressed out = {NAN, NAN};
    double u[3], y[4];
    if (!equilibrium(share, friction, u))
        return out;
    from_clamp(u, 1, y);
    out.quotient = fabs(u[0]) / u[1];
    out.way = fabs(y[0]);
    return out;
}

/* Where n points are while the tip stands still, the first half a cell behind
 * the clamp and the last one the tip: their way to the side and their depth
 * below the clamp, over the length. */
static void pressed_shape(double share, int n, double (*at)[2])
{
    double u[3] = {NAN, NAN, NAN}, y[4];
    equilibrium(share, INFINITY, u);
    for (int k = 0; k < n; k++) {
        from_clamp(u, (k + 0.5) / (n - 0.5), y);
        at[k][0] = y[0];
        at[k][1] = y[1];
    }
}

static const double length = 0.1, thickness = 2e-4; /* m */
static const double first = 0.05; /* the share by which it starts pressed */

struct press {
    double share, friction;
};

/* A strip of so many cells of length and one of width, clamped upright, that
 * starts buckled: a straight one would snap when its load passes Euler's. Two
 * rows are pinned, so the clamp is half a cell before the second of them;
 * `motion` moves them. */
static void strip(const struct validate *v, struct sheet *s, int cells,
                  drape_motion *motion)
{
    double h = length / (cells - 0.5);
    sheet_make(v, s, 2, cells + 1, h);
    s->cloth.material.bend = 1e-5;
    s->cloth.material.density = 0.2;
    s->cloth.material.thickness = thickness;
    double(*at)[2] = take((size_t)cells, sizeof *at);
    pressed_shape(first, cells, at);
    for (int p = 2; p < s->n; p++) { /* a row to the next, a chord as long as
                                        the cell */
        int k = p / 2 - 1;
        double aside = at[k][0] - (k ? at[k - 1][0] : 0);
        double down = at[k][1] - (k ? at[k - 1][1] : -h / 2 / length);
        double part = h / hypot(aside, down);
        s->x[p][2] = s->x[p - 2][2] + part * aside;
        s->x[p][1] = s->x[p - 2][1] - part * down;
    }
    free(at);
    for (int k = 0; k < 4; k++) {
        sheet_pin(s, k % 2, k / 2);
        s->pin[k].motion = 0;
    }
    s->def.motions = motion;
    s->def.n_motions = 1;
    s->def.max_slices = 32;
    s->def.gravity[1] = 0;
}

/* What the floor does: friction and normal force of the last quarter of a
 * second, the tip's way, and the largest quotient of the two of a contact in a
 * step, over the coefficient. */
struct found {
    double quotient, way, most;
};

/* Adds the floor's impulses of a step. */
static bool watch(drape_world *world, const struct press *t, double sum[2],
                  double *most)
{
    drape_contact_list list;
    if (drape_contacts(world, &list) != DRAPE_OK)
        return false;
    for (int64_t k = 0; k < list.n; k++) {
        const double *f = list.contact[k].impulse;
        double across = hypot(f[0], f[2]), up = fabs(f[1]);
        if (up > 0)
            *most = fmax(*most, across / up / t->friction);
    }
    sum[0] += list.impulse[0][2];
    sum[1] += list.impulse[0][1];
    return true;
}

static struct found pressed_sheet(const struct validate *v,
                                  const struct press *t, int cells)
{
    enum { STEPS = 600, LAST = 60 };
    struct sheet s;
    struct found out = {NAN, NAN, 0};
    double way[2][3] = {{0, 0, 0}, {0, (first - t->share) * length, 0}};
    const double time[2] = {0, 2}, dt = 1.0 / 240;
    drape_motion motion = {
        .keys = 2, .time = time, .position = (const double(*)[3])way};
    strip(v, &s, cells, &motion);
    double low = s.x[s.n - 1][1] - 0.999 * thickness;
    const double corner[3][3] = {{-9, low, -9}, {0, low, 9}, {9, low, -9}};
    const int32_t tri[1][3] = {{0, 1, 2}};
    drape_obstacle floor;
    drape_default_obstacle(&floor);
    floor.n_vertices = 3;
    floor.n_triangles = 1;
    floor.x = corner;
    floor.tri = tri;
    floor.friction = s.cloth.material.friction = t->friction;
    s.def.obstacles = &floor;
    s.def.n_obstacles = 1;
    drape_world *world = sheet_world(&s, dt);
    bool good = world;
    double sum[2] = {0, 0}, early[2] = {0, 0};
    for (int k = 0; good && k < STEPS; k++)
        good = drape_step(world, NULL) == DRAPE_OK &&
               watch(world, t, k < STEPS - LAST ? early : sum, &out.most);
    if (good) {
        double(*x)[3] = take((size_t)s.n + 3, sizeof *x);
        drape_read(world, x, NULL);
        out.quotient = fabs(sum[0] / sum[1]);
        out.way = fabs(x[s.n - 1][2] - s.x[s.n - 1][2]) / length;
        free(x);
    }
    drape_destroy(world);
    sheet_free(&s);
    return out;
}

void part_stickslip(struct validate *v)
{
    static const int cells[SIZES] = {12, 25, 50, 100};
    static const struct press kinds[] = {{0.1, 1}, {0.3, 1}, {0.3, 0.2}};
    static const char *const what[] = {
        "friction over normal force", "way of the tip",
        "largest quotient of a contact in a step; over its coefficient"};
    if (v->bits == 32)
        return;
    for (int k = 0; k < (v->quick ? 1 : 3); k++) {
        const struct press *t = &kinds[k];
        struct pressed due = pressed(t->share, t->friction);
        struct property p[3];
        char name[3][160];
        bool slides = due.way > 1e-6;
        const double theory[3] = {due.quotient, due.way, 1};
        for (int q = 0; q < 3; q++) {
            snprintf(name[q], sizeof name[q], "%s; pressed by %g L; %s",
                     slides ? "friction 0.2 slides" : "friction 1 stands",
                     t->share, what[q]);
            p[q] = (struct property){.part = "stickslip",
                                     .name = name[q],
                                     .unit = q == 1 ? "of L" : "1",
                                     .theory = theory[q],
                                     .bar = q == 0   ? 0.03
                                            : q == 1 ? 0.005
                                                     : 1e-3,
                                     .share = q == 0,
                                     .promised = !slides};
        }
        for (int c = 0; c < (v->quick ? 2 : SIZES); c++) {
            struct found got = pressed_sheet(v, t, cells[c]);
            property_add(&p[0], length / cells[c], got.quotient);
            property_add(&p[1], length / cells[c], got.way);
            property_add(&p[2], length / cells[c], got.most);
        }
        for (int q = 0; q < (slides ? 3 : 2); q++)
            property_end(v, &p[q]);
    }
}
