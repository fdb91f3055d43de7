/* SPDX-License-Identifier: Apache-2.0 */
/* A small sheet that slides down a ball of flat facets. spec/validation.md §9
 */
#include "validate/validate.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

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

static void make_ground(struct ground *s, int cells)
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
}

/* The angle at which the sheet's middle is, by the mean of its vertices. */
static double angle_of(const struct sheet *s)
{
    double sum[2] = {0, 0};
    for (int64_t p = 0; p < s->n; p++) {
        sum[0] += s->x[p][0];
        sum[1] += s->x[p][1];
    }
    return atan2(sum[0], sum[1]);
}

/* The same for a point that slides by Coulomb's law, θ'' R = g sin θ − μ (g cos
 * θ − R θ'²), in as long steps: the new speed moves it, as in Baraff–Witkin's,
 * which adds half a step of way. Its load is that of the step's start; with the
 * ground's push along the normal of the step's end, as backward Euler has it,
 * the point would go up to 1.2 % farther. */
static double angle_due(double friction, double dt, double from)
{
    double a = from, w = 0;
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
    bool chaotic; /* the median of several starts counts */
};

/* Steps of dt for so long, with this friction, from s->x at rest, which becomes
 * the last state. Returns the angle at which its middle is then; NAN: a step
 * failed. *most: the largest quotient of friction and normal force of a
 * contact in a step. */
static double go(struct sheet *s, drape_obstacle *ground, double friction,
                 double dt, double seconds, double *most)
{
    double angle = NAN;
    s->cloth.material.friction = ground->friction = friction;
    drape_world *world = sheet_world(s, dt);
    int status = world ? DRAPE_OK : DRAPE_EARG;
    for (int k = 0; k < (int)(seconds / dt + 0.5) && status >= DRAPE_OK; k++) {
        status = drape_step(world, NULL);
        *most = sheet_steepest(world, *most);
    }
    if (status >= DRAPE_OK) {
        size_t all = (size_t)drape_vertices(world);
        double(*x)[3] = take(all, sizeof *x);
        drape_read(world, x, NULL);
        memcpy(s->x, x, (size_t)s->n * sizeof *x);
        free(x);
        angle = angle_of(s);
    }
    drape_destroy(world);
    return angle;
}

/* The sheet's way over a point's. It starts at rest, where half a second with
 * much friction has left it: as it is laid, it is above the facets' middles. */
static double slide(const struct validate *v, const struct ride *r,
                    double start, double *most)
{
    static struct ground ground;
    struct sheet s;
    int side = r->side;
    double h = SIZE / (side - 1);
    make_ground(&ground, r->cells);
    sheet_make(v, &s, side, side, h);
    s.cloth.material.bend = 1e-6;
    double gap = fmin(s.cloth.material.thickness, h / 2);
    for (int p = 0; p < s.n; p++)
        place(RADIUS + gap, start + (h * (p % side) - SIZE / 2) / RADIUS,
              (h * (p / side) - SIZE / 2) / RADIUS, s.x[p]);
    s.def.obstacles = &ground.obstacle;
    s.def.n_obstacles = 1;
    s.def.max_slices = 32;
    s.def.tolerance = r->tolerance;
    double from = go(&s, &ground.obstacle, 2, 1.0 / 60, 0.5, most);
    *most = 0;
    double to = go(&s, &ground.obstacle, r->friction, r->dt, SECONDS, most);
    double way = (to - from) / (angle_due(r->friction, r->dt, from) - from);
    sheet_free(&s);
    return way;
}

static int compare(const void *a, const void *b)
{
    const double *x = a, *y = b;
    return (*x > *y) - (*x < *y);
}

/* The way from START; of a chaotic ride the median of those from starts that
 * are 2 µm apart. */
static double usual_way(const struct validate *v, const struct ride *r,
                        double *most)
{
    enum { STARTS = 5 };
    double way[STARTS];
    int n = r->chaotic ? STARTS : 1;
    for (int k = 0; k < n; k++) {
        way[k] = slide(v, r, START + 1e-6 * k, most);
        if (!isfinite(way[k]))
            return NAN;
    }
    qsort(way, (size_t)n, sizeof *way, compare);
    return way[n / 2];
}

/* The way, and the quotient of contacts, at so many sizes: of a step, or of a
 * cell. */
static void add_rides(struct validate *v, const char *name, bool promised,
                      int sizes, const struct ride ride[SIZES],
                      const double size[SIZES])
{
    char other[192];
    snprintf(other, sizeof other,
             "%.*s; largest quotient of a contact in a step; over its "
             "coefficient",
             (int)(strrchr(name, ';') - name), name);
    struct property p = {.part = "ball",
                         .name = name,
                         .unit = "1",
                         .theory = 1,
                         .bar = 0.05,
                         .up_to = 1,
                         .promised = promised};
    struct property cone = {.part = "ball",
                            .name = other,
                            .unit = "1",
                            .theory = 1,
                            .bar = 1e-3,
                            .promised = false,
                            .up_to = 1};
    for (int c = 0; c < sizes; c++) {
        double most = 0;
        property_add(&p, size[c], usual_way(v, &ride[c], &most));
        property_add(&cone, size[c], fmax(1, most / ride[c].friction));
    }
    property_end(v, &p);
    if (ride[0].friction > 0 && !promised)
        property_end(v, &cone);
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
            ride[c] = (struct ride){21,      kinds[k].cells, kinds[k].friction,
                                    step[c], 1e-5,           false};
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
            ride[c] =
                (struct ride){side[c], 60, friction[k], 1.0 / 60, 1e-3, false};
        }
        add_rides(v, name[k], false, SIZES, ride, cell);
    }
}

/* The coarse cells of the last of these rows, which are promised and also part
 * of the small form. */
static void coarse(struct validate *v)
{
    static const struct ride ride[SIZES] = {
        {21, 60, 0.3, 1.0 / 60, 1e-3, true},
        {41, 60, 0.3, 1.0 / 60, 1e-3, true}};
    static const double cell[SIZES] = {SIZE / 20, SIZE / 40};
    add_rides(
        v,
        "facets of 40 mm; friction 0.3; cells of 10 and 5 mm; median way over "
        "a point's",
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
