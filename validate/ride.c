/* SPDX-License-Identifier: Apache-2.0 */
/* A small sheet that slides down a flank, and points beside it.
 * spec/validation.md §9 */
#include "validate/ride.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ROW, POINTS: every second particle of a row and a column. FEW: points that
 * may come to no end. */
enum { ROW = (RIDE_SIDE + 1) / 2, POINTS = ROW * ROW, FEW = 3 };
/* s: steps of points beside an integrator of second order, which has none of
 * their error. */
static const double FINE = 1.0 / 960;

/* A sheet on its way, and the point beside it. */
struct slide {
    struct sheet sheet;
    drape_obstacle obstacle;
    drape_world *world;
    struct point point;
    double gap, start[3];    /* start: of the sheet's middle */
    double (*x)[3], (*u)[3]; /* all vertices of the world */
    double work, due;       /* of friction, by contacts, and by Coulomb's law */
    double energy[2][2];    /* J/kg, kinetic and elastic, of sheet and point,
                               after the first step and now */
    double potential[2][2]; /* J/kg, of gravity, likewise */
    double rested[3];       /* the sheet's middle after 0.1 s */
    double steepest;        /* a contact's friction over its load, at most */
};

/* Lays the sheet on the ground with its middle where the point is: on the
 * smooth surface, and then each particle on the triangle below. */
static void lay(const struct ground *g, struct slide *t)
{
    double n[3], down[3], across[3], h = RIDE_SIZE / (RIDE_SIDE - 1);
    const double *at = t->point.x;
    ground_height(g, at, n);
    for (int c = 0; c < 3; c++)
        down[c] = (n[1] * n[c] - (c == 1)) / sqrt(1 - n[1] * n[1]);
    cross3(n, down, across);
    for (int p = 0; p < RIDE_N; p++) {
        double i = h * (p % RIDE_SIDE - RIDE_SIDE / 2),
               j = h * (p / RIDE_SIDE - RIDE_SIDE / 2);
        double *x = t->sheet.x[p], up[3];
        for (int c = 0; c < 3; c++)
            x[c] = at[c] + i * down[c] + j * across[c];
        ground_put(g, x, t->gap);
        ground_height(g, x, up);
        double lift = ground_lift(&t->obstacle, x, up, t->gap);
        for (int c = 0; c < 3 && !isnan(lift); c++)
            x[c] += lift * up[c];
    }
}

/* Reads the state. The sheet's middle is the mean of its particles, moved along
 * the normal to the height of the point, as the mean of a curved sheet is too
 * low. Returns the speed of the slowest particle; NAN: the middle is not near
 * the ground. */
static double look(const struct ground *g, struct slide *t, double middle[3])
{
    double slowest = INFINITY;
    drape_read(t->world, t->x, t->u);
    memset(middle, 0, 3 * sizeof *middle);
    for (int p = 0; p < RIDE_N; p++) {
        for (int c = 0; c < 3; c++)
            middle[c] += t->x[p][c] / RIDE_N;
        slowest = fmin(slowest, sqrt(dot3(t->u[p], t->u[p])));
    }
    return ground_put(g, middle, t->gap) ? slowest : NAN;
}

/* Adds friction's work in a step, and what it should be: the coefficient times
 * normal impulse times slip, of each contact. Both take the velocities at the
 * step's end, so that their quotient is a mean of friction over its limit. */
static void add_work(struct slide *t, double friction)
{
    drape_contact_list list;
    if (drape_contacts(t->world, &list) != DRAPE_OK)
        return;
    for (int64_t k = 0; k < list.n; k++) {
        const drape_contact *a = &list.contact[k];
        double slip[3] = {0};
        for (int i = 0; i < 4; i++)
            for (int c = 0; c < 3; c++)
                slip[c] += a->weight[i] * t->u[a->vertex[i]][c];
        double along = dot3(slip, a->normal);
        for (int c = 0; c < 3; c++)
            slip[c] -= along * a->normal[c];
        t->work -= dot3(a->impulse, slip);
        t->due +=
            friction * dot3(a->impulse, a->normal) * sqrt(dot3(slip, slip));
    }
}

/* The sheet that a ride begins with, not yet in its place. */
static void begin(const struct validate *v, const struct ride *r,
                  struct slide *t)
{
    double h = RIDE_SIZE / (RIDE_SIDE - 1);
    struct sheet *s = &t->sheet;
    memset(t, 0, sizeof *t);
    sheet_make(v, s, RIDE_SIDE, RIDE_SIDE, h);
    t->gap = s->cloth.material.thickness = h / 4;
    s->cloth.material.bend = 1e-6;
    ground_near(r->ground, r->start, 0.35, &t->obstacle);
    memcpy(t->point.x, r->start, sizeof t->point.x);
    ground_put(r->ground, t->point.x, t->gap);
    s->def.obstacles = &t->obstacle;
    s->def.n_obstacles = 1;
    s->def.max_slices = 32;
    s->def.tolerance = 1e-5;
    s->def.integrator = r->integrator;
    s->def.newton = r->newton;
}

/* Makes a world of the sheet as it stands, and looks at it. False: there is
 * none, or the sheet is not near the ground. */
static bool make_world(const struct ride *r, struct slide *t)
{
    t->obstacle.friction = t->sheet.cloth.material.friction = r->friction;
    t->world = sheet_world(&t->sheet, r->dt);
    if (!t->world)
        return false;
    size_t all = (size_t)drape_vertices(t->world);
    t->x = take(all, sizeof *t->x);
    t->u = take(all, sizeof *t->u);
    return !isnan(look(r->ground, t, t->start));
}

static void end(struct slide *t)
{
    drape_destroy(t->world);
    free((void *)t->obstacle.x);
    free((void *)t->obstacle.tri);
    free(t->x);
    free(t->u);
    sheet_free(&t->sheet);
}

/* A step of the point: one of Baraff–Witkin's as long as the sheet's, or short
 * ones. */
static bool advance_point(const struct ride *r, struct slide *t)
{
    const struct floor smooth = floor_smooth(r->ground);
    int steps = r->integrator == DRAPE_BW ? 1 : (int)(r->dt / FINE + 0.5);
    bool good = true;
    for (int k = 0; k < steps && good; k++)
        good =
            point_step(&smooth, &t->point, r->friction, r->dt / steps, t->gap);
    return good;
}

/* Step k of sheet and point; false: one of them fails, or leaves the ground. */
static bool advance(const struct ride *r, struct slide *t, int k,
                    double middle[3])
{
    drape_step_report report;
    if (drape_step(t->world, &report) != DRAPE_OK || !advance_point(r, t))
        return false;
    double slowest = look(r->ground, t, middle);
    t->steepest = sheet_steepest(t->world, t->steepest);
    double mass = t->sheet.cloth.material.density * RIDE_SIZE * RIDE_SIZE;
    /* The list has the contacts of the last slice alone, and friction is at its
     * limit only where things slide. */
    if (report.slices == 1 && slowest > 0.05)
        add_work(t, r->friction);
    t->potential[0][k > 0] = report.potential / mass;
    t->energy[0][k > 0] = (report.kinetic + report.elastic) / mass;
    t->potential[1][k > 0] = PATH_GRAVITY * t->point.x[1];
    t->energy[1][k > 0] = dot3(t->point.v, t->point.v) / 2;
    if ((k + 1) * r->dt < 0.1 + 1e-9)
        memcpy(t->rested, middle, sizeof t->rested);
    return !isnan(slowest);
}

/* The share of gravity's work since the first step that is neither in motion
 * nor in springs, of the sheet or of the point. */
static double lost(const struct slide *t, int which)
{
    double fall = t->potential[which][0] - t->potential[which][1];
    return 1 - (t->energy[which][1] - t->energy[which][0]) / fall;
}

/* As it was laid, the sheet touches the ground in few places only. */
bool ride_settle(const struct validate *v, const struct ride *slides,
                 double rest[RIDE_N][3])
{
    struct slide t;
    struct ride r = *slides;
    r.friction = 2;
    r.dt = 1.0 / 60;
    r.integrator = DRAPE_BW;
    r.newton = 0;
    begin(v, &r, &t);
    lay(r.ground, &t);
    bool good = make_world(&r, &t);
    for (int k = 0; k < 30 && good; k++)
        good = drape_step(t.world, NULL) == DRAPE_OK;
    if (good) {
        drape_read(t.world, t.x, NULL);
        memcpy(rest, t.x, RIDE_N * sizeof *rest);
    }
    end(&t);
    return good;
}

/* Where n points on facets are in the mean, at the height of the sheet's
 * middle.
 */
static void middle_of(const struct ground *g, double (*x)[3], int n, double gap,
                      double middle[3])
{
    memset(middle, 0, 3 * sizeof *middle);
    for (int p = 0; p < n; p++)
        for (int c = 0; c < 3; c++)
            middle[c] += x[p][c] / n;
    ground_put(g, middle, gap);
}

void ride_points(const struct validate *v, const struct ride *r,
                 double rest[RIDE_N][3], double from[3], double to[3])
{
    static double x[2][POINTS][3];
    const int steps = (int)(PATH_SECONDS / FINE + 0.5);
    struct slide t;
    int n = 0;
    begin(v, r, &t);
    const struct floor facets = floor_facets(&t.obstacle);
    for (int p = 0; p < POINTS; p++) {
        const double *start = rest[2 * (p / ROW * RIDE_SIDE + p % ROW)];
        struct point point = {.x = {start[0], start[1], start[2]}};
        int k = 0;
        while (k < steps &&
               point_step(&facets, &point, r->friction, FINE, t.gap))
            k++;
        if (k < steps)
            continue;
        memcpy(x[0][n], start, sizeof x[0][n]);
        memcpy(x[1][n++], point.x, sizeof x[1][n]);
    }
    middle_of(r->ground, x[0], n, t.gap, from);
    middle_of(r->ground, x[1], n, t.gap, to);
    to[0] = n >= POINTS - FEW ? to[0] : NAN;
    end(&t);
}

/* How much of the way due was gone, and how far aside, over that way. */
static double part_of(const double from[3], const double to[3],
                      const double went[3], double *aside)
{
    double due[3];
    for (int c = 0; c < 3; c++)
        due[c] = to[c] - from[c];
    *aside = apart3(due, went) / sqrt(dot3(due, due));
    return dot3(due, went) / dot3(due, due);
}

void ride_slide(const struct validate *v, const struct ride *r,
                double rest[RIDE_N][3], double way[2][3],
                double out[RIDE_RESULTS])
{
    struct slide t;
    double middle[3] = {0}, went[3], fell[3], aside;
    int steps = (int)(PATH_SECONDS / r->dt + 0.5), k = 0;
    begin(v, r, &t);
    memcpy(t.sheet.x, rest, RIDE_N * sizeof *rest);
    bool laid = make_world(r, &t);
    memcpy(t.point.x, t.start, sizeof t.start);
    while (laid && k < steps && advance(r, &t, k, middle))
        k++;
    for (int c = 0; c < 3; c++) {
        went[c] = middle[c] - t.start[c];
        fell[c] = way[1][c] - way[0][c];
    }
    bool done = k == steps;
    out[RIDE_FACETS] = done ? part_of(way[0], way[1], went, &aside) : NAN;
    out[RIDE_GROUND] = part_of(t.start, t.point.x, fell, &aside);
    out[RIDE_WAY] = done ? part_of(t.start, t.point.x, went, &aside) : NAN;
    out[RIDE_ASIDE] = done ? aside : NAN;
    out[RIDE_LAW] = done ? t.work / t.due : NAN;
    out[RIDE_CONE] = done ? fmax(1, t.steepest / r->friction) : NAN;
    out[RIDE_LOST] = done ? lost(&t, 0) - lost(&t, 1) : NAN;
    out[RIDE_CREEP] =
        done ? apart3(t.rested, middle) / (PATH_SECONDS - 0.1) : NAN;
    end(&t);
}
