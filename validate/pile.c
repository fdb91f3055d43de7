/* SPDX-License-Identifier: Apache-2.0 */
/* Several cloths and what they touch in one world. spec/validation.md §13 */
#include "validate/pile.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

const struct scheme schemes[SCHEMES] = {
    {"baraff-witkin", DRAPE_BW, 0},
    {"baraff-witkin with newton 4", DRAPE_BW, 4},
    {"bdf2", DRAPE_BDF2, 0},
    {"choi-ko", DRAPE_CK, 0}};

void pile_make(const struct validate *v, struct pile *p,
               const struct scheme *how, double dt)
{
    drape_cloth cloth;
    memset(p, 0, sizeof *p);
    drape_default(&p->def);
    drape_default_cloth(&cloth);
    p->material = cloth.material;
    p->def.backend = v->backend;
    p->def.precision = v->bits;
    p->def.integrator = how->integrator;
    p->def.newton = how->newton;
    p->def.sleep = 0;
    p->def.dt = dt;
    p->def.cloths = p->cloth;
    p->def.obstacles = p->obstacle;
    p->def.motions = p->motion;
}

int pile_sheet(struct pile *p, int m, int n, double h, const double at[3])
{
    int number = p->def.n_cloths++;
    size_t count = (size_t)m * (size_t)n;
    drape_cloth *c = &p->cloth[number];
    drape_default_cloth(c);
    c->material = p->material;
    c->m = m;
    c->n = n;
    c->width = (m - 1) * h;
    c->height = (n - 1) * h;
    double(*x)[3] = p->place[number] = take(count, sizeof *x);
    p->speed[number] = take(count, sizeof *x);
    p->pin[number] = take(count, sizeof *p->pin[number]);
    for (size_t k = 0; k < count; k++) {
        x[k][0] = at[0] + h * (double)(k % (size_t)m);
        x[k][1] = at[1];
        x[k][2] = at[2] + h * (double)(k / (size_t)m);
    }
    c->x = (const double(*)[3])x;
    c->velocity = (const double(*)[3])p->speed[number];
    c->pins = p->pin[number];
    return number;
}

void pile_pin(struct pile *p, int cloth, int i, int j, int motion)
{
    p->pin[cloth][p->cloth[cloth].n_pins++] = (drape_pin){i, j, motion};
}

int pile_body(struct pile *p, int vertices, int triangles, double friction)
{
    int number = p->def.n_obstacles++;
    drape_obstacle *o = &p->obstacle[number];
    drape_default_obstacle(o);
    p->corner[number] = take((size_t)vertices, sizeof *p->corner[number]);
    p->face[number] = take((size_t)triangles, sizeof *p->face[number]);
    o->n_vertices = vertices;
    o->n_triangles = triangles;
    o->x = (const double(*)[3])p->corner[number];
    o->tri = (const int32_t(*)[3])p->face[number];
    o->friction = friction;
    return number;
}

int pile_floor(struct pile *p, double friction)
{
    static const int32_t tri[2][3] = {{0, 2, 1}, {0, 3, 2}};
    static const double corner[4][3] = {
        {-6, 0, -6}, {6, 0, -6}, {6, 0, 6}, {-6, 0, 6}};
    int number = pile_body(p, 4, 2, friction);
    memcpy(p->corner[number], corner, sizeof corner);
    memcpy(p->face[number], tri, sizeof tri);
    return number;
}

int pile_box(struct pile *p, const double lo[3], const double hi[3],
             double friction)
{
    static const int32_t tri[12][3] = {
        {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}, {0, 1, 5}, {0, 5, 4},
        {2, 6, 7}, {2, 7, 3}, {0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}};
    int number = pile_body(p, 8, 12, friction);
    for (int k = 0; k < 8; k++)
        for (int c = 0; c < 3; c++)
            p->corner[number][k][c] = k >> c & 1 ? hi[c] : lo[c];
    memcpy(p->face[number], tri, sizeof tri);
    return number;
}

int pile_drum(struct pile *p, double radius, double half, int facets,
              double friction)
{
    int number = pile_body(p, 2 * facets, 2 * facets, friction);
    for (int k = 0; k < facets; k++) {
        double angle = 2 * acos(-1) * k / facets;
        int32_t a = 2 * k, b = 2 * ((k + 1) % facets);
        for (int side = 0; side < 2; side++) {
            double *x = p->corner[number][2 * k + side];
            x[0] = radius * cos(angle);
            x[1] = radius * sin(angle);
            x[2] = side ? half : -half;
        }
        const int32_t tri[2][3] = {{a, b, a + 1}, {b, b + 1, a + 1}};
        memcpy(p->face[number] + 2 * k, tri, sizeof tri);
    }
    return number;
}

int pile_motion(struct pile *p, double from, double to, double ramp,
                const double velocity[3])
{
    enum { RAMP = PILE_KEYS - 2 };
    int number = p->def.n_motions++, keys = ramp > 0 ? RAMP + 1 : 1;
    for (int k = 0; k < keys; k++) {
        double part = ramp > 0 ? (double)k / RAMP : 0;
        p->time[number][k] = from + part * ramp;
        for (int c = 0; c < 3; c++)
            p->way[number][k][c] = velocity[c] * part * part * ramp / 2;
    }
    p->time[number][keys] = to;
    for (int c = 0; c < 3; c++)
        p->way[number][keys][c] = velocity[c] * (to - from - ramp / 2);
    p->motion[number] =
        (drape_motion){.keys = keys + 1,
                       .time = p->time[number],
                       .position = (const double(*)[3])p->way[number]};
    return number;
}

bool pile_start(struct pile *p)
{
    drape_error error;
    if (drape_create(&p->def, &p->world, &error) != DRAPE_OK) {
        fprintf(stderr, "validate: %s\n", error.text);
        return false;
    }
    size_t all = (size_t)drape_vertices(p->world);
    p->x = take(all, sizeof *p->x);
    p->u = take(all, sizeof *p->u);
    drape_read(p->world, p->x, p->u);
    return true;
}

bool pile_step(struct pile *p)
{
    if (!p->world || drape_step(p->world, &p->report) != DRAPE_OK ||
        (p->report.outcome & DRAPE_DIVERGED))
        return false;
    p->steps++;
    p->iterations += p->report.iterations;
    drape_read(p->world, p->x, p->u);
    return true;
}

bool pile_until(struct pile *p, double time)
{
    bool good = p->world;
    while (good && (double)p->steps + 0.5 < time / p->def.dt)
        good = pile_step(p);
    return good;
}

bool pile_contacts(struct pile *p)
{
    return drape_contacts(p->world, &p->list) == DRAPE_OK;
}

/* The mass of a particle in a sheet of mass 1 a cell. */
static double part_of(const drape_cloth *c, int64_t k)
{
    int64_t i = k % c->m, j = k / c->m;
    return (i == 0 || i == c->m - 1 ? 0.5 : 1) *
           (j == 0 || j == c->n - 1 ? 0.5 : 1);
}

void pile_mean(const struct pile *p, int cloth, double (*of)[3], double out[3])
{
    const drape_cloth *c = &p->cloth[cloth];
    int64_t n = (int64_t)c->m * c->n;
    double all = (double)(c->m - 1) * (c->n - 1);
    of += drape_first_vertex(p->world, cloth);
    out[0] = out[1] = out[2] = 0;
    for (int64_t k = 0; k < n; k++)
        for (int d = 0; d < 3; d++)
            out[d] += part_of(c, k) / all * of[k][d];
}

double pile_mass(const struct pile *p, int cloth)
{
    const drape_cloth *c = &p->cloth[cloth];
    return c->material.density * c->width * c->height;
}

double pile_thickness(const struct pile *p, int cloth)
{
    const drape_cloth *c = &p->cloth[cloth];
    return fmin(c->material.thickness, c->width / (c->m - 1) / 2);
}

void pile_free(struct pile *p)
{
    drape_destroy(p->world);
    for (int k = 0; k < p->def.n_cloths; k++) {
        free(p->place[k]);
        free(p->speed[k]);
        free(p->pin[k]);
    }
    for (int k = 0; k < p->def.n_obstacles; k++) {
        free(p->corner[k]);
        free(p->face[k]);
    }
    free(p->x);
    free(p->u);
}

struct property pile_row(const char *part, const char *name, const char *unit,
                         double theory, double bar)
{
    return (struct property){.part = part,
                             .name = name,
                             .unit = unit,
                             .theory = theory,
                             .bar = bar,
                             .promised = true,
                             .up_to = 1};
}
