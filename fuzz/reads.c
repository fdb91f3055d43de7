/* SPDX-License-Identifier: Apache-2.0 */
/* Fuzzes the calls that only tell of a world: they succeed, agree on both
 * backends, and change nothing. */
#include <math.h>
#include <stdlib.h>

#include "fuzz/play.h"

const char *play_read(struct play *p)
{
    int64_t nv = drape_vertices(p->world[0]);
    double(*x)[3] = malloc((size_t)nv * sizeof *x);
    double(*v)[3] = malloc((size_t)nv * sizeof *v);
    uint32_t which = pick(&p->b, 4);
    int status = x && v ? drape_read(p->world[0], which & 1 ? NULL : x,
                                     which & 2 ? NULL : v)
                        : DRAPE_ENOMEM;
    free(x);
    free(v);
    EXPECT(status == DRAPE_OK);
    return play_unchanged(p);
}

const char *play_triangles(struct play *p)
{
    int64_t nt = drape_triangles(p->world[0]), wrong = 0;
    int32_t(*tri)[3] = malloc((size_t)nt * sizeof *tri);
    int status = tri ? drape_read_triangles(p->world[0], tri) : DRAPE_ENOMEM;
    for (int64_t k = 0; status == DRAPE_OK && k < 3 * nt; k++)
        wrong += tri[k / 3][k % 3] < 0 ||
                 tri[k / 3][k % 3] >= drape_vertices(p->world[0]);
    free(tri);
    EXPECT(status == DRAPE_OK && wrong == 0);
    return play_unchanged(p);
}

const char *play_first(struct play *p)
{
    const drape_world *w = p->world[0];
    int bodies = p->s.def.n_cloths + p->s.def.n_obstacles;
    int body = pick(&p->b, 2) ? draw_int(&p->b) : (int)pick(&p->b, 8) - 1;
    int64_t v = drape_first_vertex(w, body), t = drape_first_triangle(w, body);
    if (body < 0 || body > bodies) {
        EXPECT(v == DRAPE_EARG && t == DRAPE_EARG);
        return NULL;
    }
    EXPECT(v >= 0 && v <= drape_vertices(w) && (v == 0) == (body == 0));
    EXPECT(t >= 0 && t <= drape_triangles(w) && (body || t == 0));
    EXPECT(body < bodies || v == drape_vertices(w));
    return NULL;
}

const char *play_borrow(struct play *p)
{
    drape_view view;
    memset(&view, 0x5a, sizeof view);
    EXPECT(drape_borrow(p->world[0], &view) == DRAPE_OK);
    EXPECT(view.x && view.v && view.tri &&
           view.precision == p->s.def.precision);
    EXPECT(view.vertices == drape_vertices(p->world[0]));
    EXPECT(view.triangles == drape_triangles(p->world[0]));
    int64_t n = 3 * view.vertices;
    double *x = malloc((size_t)n * sizeof *x);
    bool good =
        x && drape_read(p->world[0], (double(*)[3])(void *)x, NULL) == DRAPE_OK;
    /* the memory of an emulated device is host memory */
    for (int64_t k = 0; k < n && good; k++)
        good =
            x[k] == (view.precision == 32 ? (double)((const float *)view.x)[k]
                                          : ((const double *)view.x)[k]);
    free(x);
    EXPECT(good);
    return play_unchanged(p);
}

const char *play_plan(struct play *p)
{
    enum { ROOM = 40 };
    drape_plan_row row[ROOM + 1];
    memset(row, 0x5a, sizeof row);
    int capacity = (int)pick(&p->b, ROOM + 1);
    int rows = drape_plan(p->world[0], row, capacity);
    EXPECT(rows > 0 && rows < ROOM);
    for (int k = 0; k < capacity && k < rows; k++)
        EXPECT(row[k].stage && row[k].why && row[k].on >> 1 == 0);
    const unsigned char *rest = (const void *)&row[capacity];
    EXPECT(rest[0] == 0x5a && rest[sizeof *row - 1] == 0x5a);
    return play_unchanged(p);
}

const char *play_count(struct play *p)
{
    drape_memory m;
    drape_plan_row row[64];
    size_t sum = 0;
    memset(&m, 0x5a, sizeof m);
    EXPECT(drape_count(p->world[0], &m) == DRAPE_OK);
    int rows = drape_plan(p->world[0], row, 64);
    for (int k = 0; k < rows; k++)
        sum += row[k].bytes;
    bool device = !p->world[1] && p->s.def.backend == DRAPE_GPU;
    EXPECT(sum == (device ? m.device_bytes : m.host_bytes));
    EXPECT(m.host_bytes < p->s.host.held && m.host_allocations > 0);
    EXPECT(p->world[1] || m.device_bytes == p->s.device.held);
    return NULL;
}

/* A step that is known ended at p->time; each step is as long as the others. */
const char *play_clock(struct play *p)
{
    for (int k = 0; k < 2 && p->world[k]; k++) {
        int64_t step = -1;
        double time = -1;
        bool first = pick(&p->b, 2);
        EXPECT(drape_clock(p->world[k], first ? &step : NULL,
                           first ? NULL : &time) == DRAPE_OK);
        EXPECT(drape_clock(p->world[k], &step, &time) == DRAPE_OK);
        EXPECT(step >= 0 && step <= p->steps);
        EXPECT(time == (double)step * p->s.def.dt);
        EXPECT(p->time < 0 || time == p->time);
    }
    return play_unchanged(p);
}

static bool within(double a, double lo, double hi)
{
    return a >= lo && a <= hi;
}

/* Both backends tell the same of a cloth, within drape.h's ranges. */
const char *play_set_material(struct play *p)
{
    int n = p->s.def.n_cloths;
    int cloth =
        pick(&p->b, 8) < 7 ? (int)pick(&p->b, (uint32_t)n) : draw_int(&p->b);
    drape_material m[2];
    memset(m, 0, sizeof m);
    for (int k = 0; k < 2 && p->world[k]; k++)
        EXPECT(drape_read_material(p->world[k], cloth, &m[k]) ==
               (cloth >= 0 && cloth < n ? DRAPE_OK : DRAPE_EARG));
    EXPECT(!p->world[1] || !memcmp(&m[0], &m[1], sizeof m[0]));
    if (cloth < 0 || cloth >= n)
        return play_unchanged(p);
    EXPECT(m[0].density > 0 && m[0].thickness > 0 && m[0].stretch > 0);
    EXPECT(within(m[0].shear, 0, m[0].stretch / 2));
    EXPECT(within(m[0].bend, 0, 0x1p60) && within(m[0].damping, 0, 1e6));
    EXPECT(within(m[0].friction, 0, 1e6));
    return play_unchanged(p);
}

const char *play_set_wind(struct play *p)
{
    drape_wind wind[2];
    memset(wind, 0, sizeof wind);
    for (int k = 0; k < 2 && p->world[k]; k++)
        EXPECT(drape_read_wind(p->world[k], &wind[k]) == DRAPE_OK);
    EXPECT(!p->world[1] || !memcmp(&wind[0], &wind[1], sizeof wind[0]));
    for (int k = 0; k < 3; k++)
        EXPECT(fabs(wind[0].velocity[k]) <= 0x1p60);
    EXPECT(within(wind[0].density, 0, 0x1p60));
    EXPECT(within(wind[0].drag, 0, 1e6) && within(wind[0].lift, 0, 1e6));
    return play_unchanged(p);
}

const char *play_set_gravity(struct play *p)
{
    double g[2][3] = {{0}};
    for (int k = 0; k < 2 && p->world[k]; k++)
        EXPECT(drape_read_gravity(p->world[k], g[k]) == DRAPE_OK);
    EXPECT(!p->world[1] || !memcmp(g[0], g[1], sizeof g[0]));
    for (int k = 0; k < 3; k++)
        EXPECT(fabs(g[0][k]) <= 0x1p60);
    return play_unchanged(p);
}
