/* SPDX-License-Identifier: Apache-2.0 */
/* A small sheet that slides down a ball of flat facets. spec/validation.md §9
 */
#include "ci/validate/validate.h"

#include <math.h>
#include <stdlib.h>

enum { MOST = 101 };
static const double RADIUS = 2, SIZE = 0.2, START = 0.6, SECONDS = 0.4;

/* The point of a ball at two angles from its pole, along the way and across. */
static void place(double radius, double along, double across, double x[3])
{
    x[0] = radius * sin(along);
    x[1] = radius * cos(along) * cos(across);
    x[2] = radius * cos(along) * sin(across);
}

/* The part of the ball that the sheet comes to, in cells² pairs of triangles.
 */
struct ground {
    double x[MOST * MOST][3];
    int32_t tri[2 * (MOST - 1) * (MOST - 1)][3];
    drape_obstacle obstacle;
};

static void make_ground(struct ground *s, int cells, double friction)
{
    int m = cells + 1, tris = 0;
    for (int k = 0; k < m * m; k++)
        place(RADIUS, START - 0.3 + 1.2 * (k % m) / cells,
              0.6 * (k / m) / cells - 0.3, s->x[k]);
    for (int k = 0; k < cells * cells; k++) {
        int32_t p = k % cells + m * (k / cells), q = p + m;
        const int32_t two[2][3] = {{p, p + 1, q}, {p + 1, q + 1, q}};
        for (int e = 0; e < 6; e++)
            s->tri[tris + e / 3][e % 3] = two[e / 3][e % 3];
        tris += 2;
    }
    drape_default_obstacle(&s->obstacle);
    s->obstacle.n_vertices = m * m;
    s->obstacle.n_triangles = tris;
    s->obstacle.x = (const double(*)[3])s->x;
    s->obstacle.tri = (const int32_t(*)[3])s->tri;
    s->obstacle.friction = friction;
}

/* How far the ground is from the ball's middle at these angles: where the ray
 * meets the nearer plane of the two triangles there, as the ground is convex.
 */
static double height_of(const struct ground *s, int cells, double along,
                        double across)
{
    double ray[3], least = INFINITY;
    int i = (int)((along - START + 0.3) / 1.2 * cells);
    int j = (int)((across + 0.3) / 0.6 * cells);
    place(1, along, across, ray);
    for (int t = 0; t < 2; t++) {
        const int32_t *v = s->tri[2 * (i + cells * j) + t];
        double e[3], f[3], n[3], up = 0, to = 0;
        for (int c = 0; c < 3; c++) {
            e[c] = s->x[v[1]][c] - s->x[v[0]][c];
            f[c] = s->x[v[2]][c] - s->x[v[0]][c];
        }
        for (int c = 0; c < 3; c++) {
            int d = (c + 1) % 3, g = (c + 2) % 3;
            n[c] = e[d] * f[g] - e[g] * f[d];
            up += n[c] * s->x[v[0]][c];
            to += n[c] * ray[c];
        }
        least = fmin(least, up / to);
    }
    return least;
}

/* The angle at which the sheet's middle is, by the mean of its vertices. */
static double angle_of(const drape_world *world, int64_t n)
{
    size_t all = (size_t)drape_vertices(world);
    double(*x)[3] = take(all, sizeof *x), sum[2] = {0, 0};
    drape_read(world, x, NULL);
    for (int64_t p = 0; p < n; p++) {
        sum[0] += x[p][0];
        sum[1] += x[p][1];
    }
    free(x);
    return atan2(sum[0], sum[1]);
}

/* The same for a point that slides by Coulomb's law, θ'' R = g sin θ − μ (g cos
 * θ − R θ'²), in as long steps: the new speed moves it, as in Baraff–Witkin's,
 * which adds half a step of way. Its load is that of the step's start; with the
 * ground's push along the normal of the step's end, as backward Euler has it,
 * the point would go up to 1.2 % farther. */
static double angle_due(double friction, double dt)
{
    double a = START, w = 0;
    for (int k = 0; k < (int)(SECONDS / dt + 0.5); k++) {
        double push = fmax(0, 9.81 * cos(a) / RADIUS - w * w);
        w += dt * (9.81 * sin(a) / RADIUS - friction * push);
        a += dt * w;
    }
    return a;
}

/* A sheet of side² particles on a ball cut in cells² pairs of triangles. */
struct ride {
    int side, cells;
    double friction, dt, tolerance;
};

/* The sheet's way over a point's. */
static double slide(const struct validate *v, const struct ride *r)
{
    static struct ground ground;
    struct sheet s;
    int side = r->side;
    double h = SIZE / (side - 1), way = NAN, dt = r->dt;
    make_ground(&ground, r->cells, r->friction);
    sheet_make(v, &s, side, side, h);
    s.cloth.material.friction = r->friction;
    s.cloth.material.bend = 1e-6;
    double gap = fmin(s.cloth.material.thickness, h / 2);
    for (int p = 0; p < s.n; p++) {
        double along = START + (h * (p % side) - SIZE / 2) / RADIUS;
        double across = (h * (p / side) - SIZE / 2) / RADIUS;
        place(height_of(&ground, r->cells, along, across) + gap, along, across,
              s.x[p]);
    }
    s.def.obstacles = &ground.obstacle;
    s.def.n_obstacles = 1;
    s.def.max_slices = 32;
    s.def.tolerance = r->tolerance;
    drape_world *world = sheet_world(&s, dt);
    int status = world ? DRAPE_OK : DRAPE_EARG;
    for (int k = 0; k < (int)(SECONDS / dt + 0.5) && status >= DRAPE_OK; k++)
        status = drape_step(world, NULL);
    if (status >= DRAPE_OK)
        way = (angle_of(world, s.n) - START) /
              (angle_due(r->friction, dt) - START);
    drape_destroy(world);
    sheet_free(&s);
    return way;
}

/* One property of so many sizes: of a step, or of a cell. */
static void add_rides(struct validate *v, const char *name, bool promised,
                      int sizes, const struct ride ride[SIZES],
                      const double size[SIZES])
{
    struct property p = {.part = "ball",
                         .name = name,
                         .unit = "1",
                         .theory = 1,
                         .bar = 0.02,
                         .up_to = 1,
                         .promised = promised};
    for (int c = 0; c < sizes; c++)
        property_add(&p, size[c], slide(v, &ride[c]));
    property_end(v, &p);
}

/* Cells of 10 mm, by steps. */
static void by_steps(struct validate *v)
{
    static const struct {
        int cells;
        double friction;
        const char *name;
    } kinds[] = {
        {10, 0, "facets of 240 mm; friction 0; way over a point's"},
        {10, 0.2, "facets of 240 mm; friction 0.2; way over a point's"},
        {30, 0, "facets of 80 mm; friction 0; way over a point's"},
        {30, 0.2, "facets of 80 mm; friction 0.2; way over a point's"},
        {100, 0, "facets of 24 mm; friction 0; way over a point's"},
        {100, 0.2, "facets of 24 mm; friction 0.2; way over a point's"}};
    for (size_t k = 0; k < sizeof kinds / sizeof *kinds; k++) {
        struct ride ride[SIZES];
        double step[SIZES];
        for (int c = 0; c < SIZES; c++) {
            step[c] = 1.0 / (60 << c);
            ride[c] = (struct ride){21, kinds[k].cells, kinds[k].friction,
                                    step[c], 1e-5};
        }
        add_rides(v, kinds[k].name, false, SIZES, ride, step);
    }
}

/* Steps of 1/60 s and the default tolerance, by cells. */
static void by_cells(struct validate *v)
{
    static const int side[SIZES] = {21, 41, 61, 121};
    static const double friction[] = {0, 0.3};
    static const char *name[] = {
        "facets of 40 mm; friction 0; by cells; way over a point's",
        "facets of 40 mm; friction 0.3; by cells; way over a point's"};
    for (int k = 0; k < 2; k++) {
        struct ride ride[SIZES];
        double cell[SIZES];
        for (int c = 0; c < SIZES; c++) {
            cell[c] = SIZE / (side[c] - 1);
            ride[c] = (struct ride){side[c], 60, friction[k], 1.0 / 60, 1e-3};
        }
        add_rides(v, name[k], false, SIZES, ride, cell);
    }
}

/* The coarse cells of the last of these rows, which are promised and also part
 * of the small form. */
static void coarse(struct validate *v)
{
    static const struct ride ride[SIZES] = {{21, 60, 0.3, 1.0 / 60, 1e-3},
                                            {41, 60, 0.3, 1.0 / 60, 1e-3}};
    static const double cell[SIZES] = {SIZE / 20, SIZE / 40};
    add_rides(v,
              "facets of 40 mm; friction 0.3; cells of 10 and 5 mm; way over a "
              "point's",
              true, 2, ride, cell);
}

void part_ball(struct validate *v)
{
    if (v->bits == 32)
        return;
    coarse(v);
    if (v->quick)
        return;
    by_steps(v);
    by_cells(v);
}
