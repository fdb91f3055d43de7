/* SPDX-License-Identifier: Apache-2.0 */
/* Stick and slip of a strip that is pressed onto a floor. spec/validation.md
 * §12 */
#include "validate/shooting.h"
#include "validate/validate.h"

#include <math.h>
#include <stdlib.h>

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

/* What is known of the tip, which turns freely: where it is. */
struct known {
    double depth, aside;
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

static void at_tip(const void *user, const double *u, double *miss)
{
    const struct known *k = user;
    double y[4];
    from_clamp(u, 1, y);
    miss[0] = y[3];
    miss[1] = y[1] - k->depth;
    miss[2] = y[0] - k->aside;
}

/* The unknowns of a strip that is pressed by a share of its length while its
 * tip stands below the clamp. */
static bool equilibrium(double share, double u[3])
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
    struct known known = {1 - start, 0};
    for (int i = 1; i <= INCREMENTS; i++) {
        known.depth = 1 - start * i;
        if (!shoot(3, u, at_tip, &known))
            return false;
    }
    return true;
}

/* The quotient of the floor's forces on a tip that stands; NAN: none found. */
static double quotient_of(double share)
{
    double u[3];
    return equilibrium(share, u) ? fabs(u[0]) / u[1] : NAN;
}

/* The share by which the strip is pressed when this quotient is q. */
static double share_of(double q)
{
    double low = 0.02, high = 0.5;
    for (int i = 0; i < 40; i++) {
        double share = (low + high) / 2;
        *(quotient_of(share) < q ? &low : &high) = share;
    }
    return low;
}

/* The ways from below the clamp at which a tip that has slid as far as it can
 * may rest, of the length: where the quotient is within the friction. The more
 * a tip slides the harder it is driven, until the strip is bent to one side. */
static void rests(double share, double friction, double way[2])
{
    const double fine = 1e-3;
    double u[3];
    struct known known = {1 - share, 0};
    way[0] = way[1] = NAN;
    bool found = equilibrium(share, u);
    for (bool far = false; found && u[1] > 0; known.aside += fine) {
        found = shoot(3, u, at_tip, &known);
        double q = fabs(u[0]) / u[1];
        far = far || q > 2 * friction;
        if (far && q <= friction)
            way[isnan(way[0]) ? 0 : 1] = known.aside;
        else if (!isnan(way[1]))
            return;
    }
}

/* Where n points are while the tip stands still, the first half a cell behind
 * the clamp and the last one the tip: their way to the side and their depth
 * below the clamp, over the length. */
static void pressed_shape(double share, int n, double (*at)[2])
{
    double u[3] = {NAN, NAN, NAN}, y[4];
    equilibrium(share, u);
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
    int steps;
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

/* What the floor does: friction over normal force and the tip's way, of the
 * length, at the end; the greatest quotient of the two forces in a step, and of
 * the two impulses of a contact, over the coefficient, until the tip has slid
 * by a twentieth of the length; the share by which the strip is pressed when
 * the quotient reaches `edge` of the coefficient. */
struct found {
    double quotient, way, whole, most, share;
};

static const double edge = 0.98;

/* Adds the floor's impulses of a step to sum. */
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

/* How far the tip is from where it stood, over the length. */
static double way_of(drape_world *world, const struct sheet *s, double (*x)[3])
{
    drape_read(world, x, NULL);
    return fabs(x[s->n - 1][2] - s->x[s->n - 1][2]) / length;
}

/* Steps until the strip has settled on the floor, and until the clamp rests;
 * until a tip that stands, or one that has slid and swings for a while, rests
 * as well; and of these the last ones, in which the forces are measured. */
enum { SETTLED = 60, PRESSES = 480, STANDS = 600, RESTS = 1800, LAST = 60 };

/* Takes the steps. */
static bool press(drape_world *world, const struct press *t,
                  const struct sheet *s, struct found *out)
{
    double(*x)[3] = take((size_t)s->n + 3, sizeof *x);
    double end[2] = {0, 0}, before = 0;
    bool good = true, stands = true;
    for (int k = 0; good && k < t->steps; k++) {
        double sum[2] = {0, 0}, most = 0;
        good =
            drape_step(world, NULL) == DRAPE_OK && watch(world, t, sum, &most);
        double q = fabs(sum[0] / sum[1]) / t->friction;
        stands = stands && way_of(world, s, x) < 0.05;
        if (stands && k >= SETTLED) {
            out->whole = fmax(out->whole, q);
            out->most = fmax(out->most, most);
        }
        if (k >= SETTLED && isnan(out->share) && q >= edge)
            out->share = first + (t->share - first) / PRESSES *
                                     (k + (edge - before) / (q - before));
        before = q;
        for (int i = 0; i < 2 && k >= t->steps - LAST; i++)
            end[i] += sum[i];
    }
    out->quotient = fabs(end[0] / end[1]);
    out->way = way_of(world, s, x);
    free(x);
    return good;
}

static struct found pressed_sheet(const struct validate *v,
                                  const struct press *t, int cells)
{
    struct sheet s;
    const struct found none = {NAN, NAN, NAN, NAN, NAN};
    struct found out = {NAN, NAN, 0, 0, NAN};
    double way[2][3] = {{0, 0, 0}, {0, (first - t->share) * length, 0}};
    const double time[2] = {0, 2}, dt = time[1] / PRESSES;
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
    bool good = world && press(world, t, &s, &out);
    drape_destroy(world);
    sheet_free(&s);
    return good ? out : none;
}

/* A tip that stands. */
static void stand(struct validate *v, double share)
{
    static const int cells[SIZES] = {12, 25, 50, 100};
    const struct press t = {share, 1, STANDS};
    struct property p[2] = {
        {.unit = "1", .theory = quotient_of(share), .bar = 0.03, .share = true},
        {.unit = "of L", .bar = 0.005}};
    static const char *const what[] = {"friction over normal force",
                                       "way of the tip"};
    char name[2][160];
    for (int c = 0; c < (v->quick ? 2 : SIZES); c++) {
        struct found got = pressed_sheet(v, &t, cells[c]);
        property_add(&p[0], length / cells[c], got.quotient);
        property_add(&p[1], length / cells[c], got.way);
    }
    for (int q = 0; q < 2; q++) {
        snprintf(name[q], sizeof name[q],
                 "friction 1 stands; pressed by %g L; %s", share, what[q]);
        p[q].part = "stickslip";
        p[q].name = name[q];
        p[q].promised = true;
        property_end(v, &p[q]);
    }
}

/* A tip that slides away when friction does not suffice. */
static void slide(struct validate *v, double share, double friction)
{
    static const int cells[SIZES] = {12, 25, 50, 100};
    const struct press t = {share, friction, RESTS};
    double way[2];
    rests(share, friction, way);
    struct property p[] = {
        {.name = "share of L at which friction is 0.98 of the coefficient",
         .unit = "1",
         .theory = share_of(edge * friction),
         .bar = 0.05,
         .share = true,
         .promised = true},
        {.name = "greatest friction over normal force; over the coefficient",
         .unit = "1",
         .theory = 1,
         .bar = 0.03,
         .promised = true},
        {.name = "the same of a contact",
         .unit = "1",
         .theory = 1,
         .bar = 1e-3,
         .promised = true},
        {.name = "friction over normal force at rest; within the coefficient",
         .unit = "1",
         .bar = friction,
         .promised = true},
        {.name = "way of the tip at rest",
         .unit = "of L",
         .theory = (way[0] + way[1]) / 2,
         .bar = (way[1] - way[0]) / 2,
         .promised = true}};
    enum { KINDS = sizeof p / sizeof *p };
    for (int c = 0; c < SIZES; c++) {
        struct found f = pressed_sheet(v, &t, cells[c]);
        const double got[] = {f.share, f.whole, f.most, f.quotient, f.way};
        for (int q = 0; q < KINDS; q++)
            property_add(&p[q], length / cells[c], got[q]);
    }
    for (int q = 0; q < KINDS; q++) {
        char name[160];
        snprintf(name, sizeof name, "friction %g; pressed by %g L; %s",
                 friction, share, p[q].name);
        p[q].part = "stickslip";
        p[q].name = name;
        property_end(v, &p[q]);
    }
}

void part_stickslip(struct validate *v)
{
    if (v->bits == 32)
        return;
    stand(v, 0.1);
    if (v->quick)
        return;
    stand(v, 0.3);
    slide(v, 0.3, 0.2);
    slide(v, 0.3, 0.3);
}
