/* SPDX-License-Identifier: Apache-2.0 */
/* Whole sheets on slopes of triangles, by the public API: they slide as
 * Coulomb's law says, however the slope is cut. spec/contact/coulomb.md §2,
 * spec/contact/proximity.md §3.2 */
#include <stdlib.h>

#include "tests/base/harness.h"

enum { MOST_SIDE = 201, MOST_CELLS = 40 };
enum { MOST_GROUND = (MOST_CELLS + 1) * (MOST_CELLS + 1) };

struct row {
    int side, cells; /* particles of the sheet, cells of the slope, a side */
    int integrator, hz;
    double sine, cosine, friction;
};

/* What a run gives: the way down the slope, the speed at its end, and friction
 * by normal impulse in all steps, and by how much the worst step exceeds it. */
struct ride {
    double way, speed, ratio, worst;
    double height; /* over the plane, thicknesses, of the sheet's mean at the
                      end */
};

struct slope {
    drape_def def;
    drape_cloth cloth;
    drape_obstacle obstacle;
    double x[MOST_GROUND][3];
    int32_t tri[2 * MOST_CELLS * MOST_CELLS][3];
};

/* The slope is the plane y = 0, and gravity is turned: the way is along x. The
 * sheet of 1/2 m starts at rest, 0.02 mm within its thickness. */
static void make_slope(struct slope *s, const struct row *r)
{
    drape_default(&s->def);
    drape_default_cloth(&s->cloth);
    drape_default_obstacle(&s->obstacle);
    for (int k = 0; k < (r->cells + 1) * (r->cells + 1); k++) {
        s->x[k][0] = -1 + 5.7 * (k % (r->cells + 1)) / r->cells;
        s->x[k][1] = 0;
        s->x[k][2] = -1.1 + 2.9 * (k / (r->cells + 1)) / r->cells;
    }
    int tris = 0;
    for (int k = 0; k < r->cells * r->cells; k++) {
        int32_t p = k % r->cells + (r->cells + 1) * (k / r->cells);
        int32_t q = p + r->cells + 1;
        memcpy(s->tri[tris++], (int32_t[]){p, q, p + 1}, sizeof *s->tri);
        memcpy(s->tri[tris++], (int32_t[]){p + 1, q, q + 1}, sizeof *s->tri);
    }
    s->obstacle.n_vertices = (r->cells + 1) * (r->cells + 1);
    s->obstacle.n_triangles = tris;
    s->obstacle.x = (const double(*)[3])s->x;
    s->obstacle.tri = (const int32_t(*)[3])s->tri;
    s->obstacle.friction = s->cloth.material.friction = r->friction;
    s->cloth.m = s->cloth.n = r->side;
    s->cloth.width = s->cloth.height = 0.5;
    s->cloth.origin[1] = s->cloth.material.thickness - 2e-5;
    s->def.precision = REAL_BITS;
    s->def.gravity[0] = 9.81 * r->sine;
    s->def.gravity[1] = -9.81 * r->cosine;
    s->def.integrator = r->integrator;
    s->def.dt = 1.0 / r->hz;
    s->def.sleep = 0;
    s->def.cloths = &s->cloth;
    s->def.n_cloths = 1;
    s->def.obstacles = &s->obstacle;
    s->def.n_obstacles = 1;
}

/* The mean over the sheet's mass of a component of a. */
static double mean(const double (*a)[3], int side, int axis)
{
    double sum = 0, mass = 0;
    for (int k = 0; k < side * side; k++) {
        int i = k % side, j = k / side;
        double m = (i == 0 || i == side - 1 ? 0.5 : 1) *
                   (j == 0 || j == side - 1 ? 0.5 : 1);
        sum += m * a[k][axis];
        mass += m;
    }
    return sum / mass;
}

/* Runs one second. DRAPE_OK or what failed. */
static int run(const struct row *r, struct ride *ride)
{
    static struct slope s;
    static double x[MOST_SIDE * MOST_SIDE + MOST_GROUND][3];
    static double v[MOST_SIDE * MOST_SIDE + MOST_GROUND][3];
    drape_world *world = NULL;
    drape_step_report report;
    double along = 0, out = 0, rub = 0, push = 0, start = 0;
    *ride = (struct ride){0};
    make_slope(&s, r);
    int status = drape_create(&s.def, &world, NULL);
    if (status == DRAPE_OK)
        status = drape_read(world, x, NULL);
    start = mean((const double(*)[3])x, r->side, 0);
    for (int k = 0; k < r->hz && status == DRAPE_OK; k++) {
        status = drape_step(world, &report);
        if (status == DRAPE_OK)
            status = drape_read(world, x, v);
        double vx = mean((const double(*)[3])v, r->side, 0);
        double vy = mean((const double(*)[3])v, r->side, 1);
        double t = along + s.def.gravity[0] * s.def.dt - vx;
        double n = vy - out - s.def.gravity[1] * s.def.dt;
        double left = fmax(report.residual - 1e-3, 0);
        if (n > 0.5 * 9.81 * r->cosine * s.def.dt)
            ride->worst = fmax(ride->worst, t / n - r->friction - left);
        rub += t;
        push += n;
        along = vx;
        out = vy;
    }
    ride->way = mean((const double(*)[3])x, r->side, 0) - start;
    ride->height = mean((const double(*)[3])x, r->side, 1);
    ride->height /= (double)s.cloth.material.thickness;
    ride->speed = along;
    ride->ratio = rub / push;
    drape_destroy(world);
    return status;
}

/* The way of n steps from rest under a constant acceleration a, in units of
 * a dt²: the integrator's own. spec/cloth/implicit.md §5 */
static double steps_way(int integrator, double n)
{
    if (integrator == DRAPE_BW)
        return n * (n + 1) / 2;
    return n * n / 2 + 0.75 * (1 - pow(3, -n));
}

/* How far a sheet slides in a second by Coulomb's law, m. */
static double due_of(const struct row *r)
{
    double a = 9.81 * (r->sine - r->friction * r->cosine);
    return a / r->hz / r->hz * steps_way(r->integrator, r->hz);
}

/* The way is Coulomb's to 0.2 %, friction to 0.1 % in the mean. In the worst
 * step it is on the cone to 1e-3 of the normal force: so much of what contacts
 * push the tolerance allows a slice to leave (lagrange.md §3.4), however small
 * friction is; or to what the slice reports as left, where it ended by its
 * number of systems, as the first one may, which finds all contacts anew. */
const char *test_slide_way(void)
{
    static const struct row row[] = {
        {13, 1, DRAPE_BW, 60, 5.0 / 13, 12.0 / 13, 0.3},
        {21, 1, DRAPE_BW, 60, 5.0 / 13, 12.0 / 13, 0.3},
        {21, 7, DRAPE_BW, 60, 3.0 / 5, 4.0 / 5, 0.3},
        {33, 3, DRAPE_BW, 60, 3.0 / 5, 4.0 / 5, 0.5},
        {9, 20, DRAPE_BW, 60, 8.0 / 17, 15.0 / 17, 0.3},
        {17, 20, DRAPE_BW, 240, 8.0 / 17, 15.0 / 17, 0.3},
        {21, 40, DRAPE_BW, 240, 8.0 / 17, 15.0 / 17, 0.3},
        {41, 40, DRAPE_BW, 60, 8.0 / 17, 15.0 / 17, 0.3},
        {13, 7, DRAPE_BW, 60, 7.0 / 25, 24.0 / 25, 0.05},
        {21, 7, DRAPE_CK, 60, 3.0 / 5, 4.0 / 5, 0.3},
        {13, 20, DRAPE_CK, 120, 5.0 / 13, 12.0 / 13, 0.3}};
    for (size_t k = 0; k < sizeof row / sizeof *row; k++) {
        const struct row *r = &row[k];
        struct ride ride;
        double due = due_of(r);
        EXPECT(run(r, &ride) == DRAPE_OK);
        EXPECT(fabs(ride.way - due) <= 0.002 * due);
        EXPECT(fabs(ride.ratio - r->friction) <= 0.001 * r->friction);
        EXPECT(ride.worst <= 1e-3);
        ran(1);
    }
    return NULL;
}

/* Starts a sheet at a height over its thickness, and looks at each step of half
 * a second. Returns how far it is off its integrator's way or speed at most,
 * in units of a dt² and a dt; or a status below 0. */
static double off_way(const struct row *r, double height)
{
    static struct slope s;
    static double x[MOST_SIDE * MOST_SIDE + MOST_GROUND][3];
    static double v[MOST_SIDE * MOST_SIDE + MOST_GROUND][3];
    drape_world *world = NULL;
    double most = 0, a_dt = 9.81 * r->sine / r->hz;
    make_slope(&s, r);
    s.cloth.origin[1] = s.cloth.material.thickness + height;
    int status = drape_create(&s.def, &world, NULL);
    if (status == DRAPE_OK)
        status = drape_read(world, x, NULL);
    double start = mean((const double(*)[3])x, r->side, 0);
    for (int n = 1; n <= r->hz / 2 && status == DRAPE_OK; n++) {
        status = drape_step(world, NULL);
        if (status == DRAPE_OK)
            status = drape_read(world, x, v);
        double way = mean((const double(*)[3])x, r->side, 0) - start;
        double units = way / a_dt * r->hz;
        double speed = mean((const double(*)[3])v, r->side, 0) / a_dt;
        most = fmax(most, fabs(units - steps_way(r->integrator, n)));
        most = fmax(most, fabs(speed - n));
    }
    drape_destroy(world);
    return status == DRAPE_OK ? most : status;
}

/* Without friction what presses has no part in the motion along the slope: in
 * each step it is the integrator's, of a sheet that lies there as of one that
 * falls flat and slides on. */
const char *test_slide_free(void)
{
    static const double height[] = {-1e-4, 0.01, 0.1};
    static const int method[] = {DRAPE_BW, DRAPE_CK, DRAPE_BDF2};
    for (int k = 0; k < 9; k++) {
        struct row r = {13, 1, method[k % 3], 60, 5.0 / 13, 12.0 / 13, 0};
        double off = off_way(&r, height[k / 3]);
        EXPECT(off >= 0 && off <= 1e-3);
        ran(1);
    }
    return NULL;
}

/* Cells of 2.5 to 6 mm. */
const char *test_slide_fine(void)
{
    static const struct {
        struct row row;
        double bar;
    } some[] = {{{121, 1, DRAPE_BW, 60, 8.0 / 17, 15.0 / 17, 0.3}, 0.005},
                {{121, 7, DRAPE_BW, 60, 8.0 / 17, 15.0 / 17, 0.3}, 0.005},
                {{81, 40, DRAPE_BW, 60, 8.0 / 17, 15.0 / 17, 0.3}, 0.005},
                {{121, 40, DRAPE_BW, 240, 8.0 / 17, 15.0 / 17, 0.3}, 0.005},
                {{121, 40, DRAPE_BW, 60, 8.0 / 17, 15.0 / 17, 0.3}, 0.005},
                {{201, 7, DRAPE_BW, 60, 8.0 / 17, 15.0 / 17, 0.3}, 0.005},
                {{201, 40, DRAPE_BW, 60, 8.0 / 17, 15.0 / 17, 0.3}, 0.005}};
    if (!getenv("DRAPE_SOAK"))
        return skip("fine sheets take minutes: set DRAPE_SOAK");
    for (size_t k = 0; k < sizeof some / sizeof *some; k++) {
        struct ride ride;
        double due = due_of(&some[k].row);
        EXPECT(run(&some[k].row, &ride) == DRAPE_OK);
        EXPECT(fabs(ride.way - due) <= some[k].bar * due);
        ran(1);
    }
    return NULL;
}

/* Below the critical angle, at nine tenths of it too, a sheet sticks, without
 * creep (coulomb.md §2.1): in a second it goes no millimetre. It lies at its
 * thickness to a thousandth: a contact gives way by the weight of a particle
 * over k_c (coulomb.md §1), here by less than a fifth of that. */
const char *test_slide_rest(void)
{
    static const struct row row[] = {
        {21, 1, DRAPE_BW, 60, 7.0 / 25, 24.0 / 25, 0.4},
        {21, 7, DRAPE_BW, 60, 5.0 / 13, 12.0 / 13, 0.5},
        {13, 20, DRAPE_BW, 60, 3.0 / 5, 4.0 / 5, 1},
        {13, 40, DRAPE_BW, 60, 8.0 / 17, 15.0 / 17, 0.5926},
        {21, 40, DRAPE_BW, 60, 8.0 / 17, 15.0 / 17, 0.5926},
        {21, 40, DRAPE_BW, 60, 3.0 / 5, 4.0 / 5, 0.8333},
        {21, 7, DRAPE_CK, 60, 7.0 / 25, 24.0 / 25, 0.4}};
    for (size_t k = 0; k < sizeof row / sizeof *row; k++) {
        struct ride ride;
        EXPECT(run(&row[k], &ride) == DRAPE_OK);
        EXPECT(ride.way <= 1e-3);
        EXPECT(fabs(ride.height - 1) <= 1e-3);
        ran(1);
    }
    return NULL;
}
