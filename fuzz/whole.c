/* SPDX-License-Identifier: Apache-2.0 */
/* Draws a whole definition from choices. See fuzz/whole.h. */
#include "fuzz/whole.h"

#include <string.h>

enum { SIDE = 9 };

/* Places of the fields that may hold any value; counts of arrays are not among
 * them. */
enum kind { DOUBLE, INTEGER, POINTER };
struct place {
    enum kind kind;
    size_t at;
};
#define D(type, name)                                                          \
    {                                                                          \
        DOUBLE, offsetof(type, name)                                           \
    }
#define I(type, name)                                                          \
    {                                                                          \
        INTEGER, offsetof(type, name)                                          \
    }
#define P(type, name)                                                          \
    {                                                                          \
        POINTER, offsetof(type, name)                                          \
    }
#define END                                                                    \
    {                                                                          \
        POINTER, SIZE_MAX                                                      \
    }

static const struct place in_def[] = {I(drape_def, precision),
                                      I(drape_def, threads),
                                      I(drape_def, block),
                                      D(drape_def, dt),
                                      D(drape_def, gravity[1]),
                                      D(drape_def, wind.velocity[2]),
                                      D(drape_def, wind.density),
                                      D(drape_def, wind.drag),
                                      D(drape_def, wind.lift),
                                      I(drape_def, integrator),
                                      I(drape_def, max_substeps),
                                      I(drape_def, precond),
                                      I(drape_def, matrix),
                                      I(drape_def, solver),
                                      D(drape_def, tolerance),
                                      I(drape_def, max_iterations),
                                      I(drape_def, newton),
                                      I(drape_def, self_collision),
                                      I(drape_def, max_rounds),
                                      I(drape_def, max_slices),
                                      I(drape_def, allow_intersecting),
                                      I(drape_def, sleep),
                                      P(drape_def, cloths),
                                      P(drape_def, obstacles),
                                      P(drape_def, motions),
                                      P(drape_def, allocator.allocate),
                                      P(drape_def, device_allocator.release),
                                      END};
static const struct place in_cloth[] = {D(drape_cloth, width),
                                        D(drape_cloth, height),
                                        D(drape_cloth, material.density),
                                        D(drape_cloth, material.stretch),
                                        D(drape_cloth, material.shear),
                                        D(drape_cloth, material.bend),
                                        D(drape_cloth, material.damping),
                                        D(drape_cloth, material.thickness),
                                        D(drape_cloth, material.friction),
                                        D(drape_cloth, material.limit[1]),
                                        D(drape_cloth, material.table[0][0][0]),
                                        D(drape_cloth, material.table[2][0][1]),
                                        D(drape_cloth, origin[0]),
                                        D(drape_cloth, u[1]),
                                        D(drape_cloth, v[2]),
                                        P(drape_cloth, x),
                                        P(drape_cloth, velocity),
                                        P(drape_cloth, hole),
                                        P(drape_cloth, cut),
                                        P(drape_cloth, pins),
                                        END};
static const struct place in_obstacle[] = {D(drape_obstacle, friction),
                                           I(drape_obstacle, motion),
                                           D(drape_obstacle, frame_dt),
                                           I(drape_obstacle, between),
                                           P(drape_obstacle, frame_time),
                                           P(drape_obstacle, x),
                                           P(drape_obstacle, tri),
                                           P(drape_obstacle, frame),
                                           END};
static const struct place in_motion[] = {
    D(drape_motion, pivot[0]), P(drape_motion, time), P(drape_motion, position),
    P(drape_motion, rotation), END};

/* Sets one field of the struct to any value. */
static void spoil(struct bytes *b, const struct place *place, void *record)
{
    uint32_t n = 0;
    while (place[n].at != SIZE_MAX)
        n++;
    const struct place *p = &place[pick(b, n)];
    unsigned char *at = (unsigned char *)record + p->at;
    double number = draw_any(b);
    int whole = draw_int(b);
    if (p->kind == DOUBLE)
        memcpy(at, &number, sizeof number);
    else if (p->kind == INTEGER)
        memcpy(at, &whole, sizeof whole);
    else
        memset(at, 0, sizeof(void *));
}

/* Draws a count: small, with an array to match; or a count that the library
 * must refuse; or a count for which no array is given. */
static int count(struct bytes *b, int least, int most)
{
    return pick(b, 24) == 23 ? draw_int(b)
                             : least + (int)pick(b, (uint32_t)(most - least));
}

/* Draws a number for an array; one in 32 is any number. */
static double entry(struct bytes *b, double lo, double hi)
{
    return pick(b, 32) == 31 ? draw_any(b) : draw_in(b, lo, hi);
}

static void make_arrays(struct whole *w, struct bytes *b, drape_cloth *c)
{
    size_t n = (size_t)c->m * (size_t)c->n;
    size_t cells = (size_t)(c->m - 1) * (size_t)(c->n - 1);
    uint32_t which = choose(b);
    double(*x)[3] = shelf_take(&w->shelf, n, sizeof *x);
    double(*v)[3] = shelf_take(&w->shelf, n, sizeof *v);
    uint8_t *hole = shelf_take(&w->shelf, n, 1);
    uint8_t *cut = shelf_take(&w->shelf, cells, 1);
    for (size_t k = 0; which & 1 && k < n; k++) {
        x[k][0] = 0.02 * (double)(k % (size_t)c->m);
        x[k][1] = entry(b, c->origin[1], c->origin[1] + 0.004);
        x[k][2] = 0.02 * (double)(k / (size_t)c->m);
    }
    for (size_t k = 0; which & 2 && k < n; k++)
        for (int i = 0; i < 3; i++)
            v[k][i] = entry(b, -1, 1);
    for (size_t k = 0; which & 4 && k < n; k++)
        hole[k] = (uint8_t)(pick(b, 8) == 7 ? pick(b, 256) : 0);
    for (size_t k = 0; which & 8 && k < cells; k++)
        cut[k] = (uint8_t)(pick(b, 8) == 7 ? pick(b, 256) : 0);
    c->x = which & 1 ? (const double(*)[3])x : NULL;
    c->velocity = which & 2 ? (const double(*)[3])v : NULL;
    c->hole = which & 4 ? hole : NULL;
    c->cut = which & 8 ? cut : NULL;
}

static void make_cloth(struct whole *w, struct bytes *b, int k)
{
    drape_cloth *c = &w->cloth[k];
    drape_default_cloth(c);
    c->m = count(b, 2, SIDE + 1);
    c->n = count(b, 2, SIDE + 1);
    c->width = 0.02 * (c->m > 1 && c->m < 100 ? c->m - 1 : 1);
    c->height = 0.02 * (c->n > 1 && c->n < 100 ? c->n - 1 : 1);
    c->origin[1] = 0.05 + 0.1 * k;
    if (c->m >= 2 && c->m <= SIDE && c->n >= 2 && c->n <= SIDE)
        make_arrays(w, b, c);
    c->n_pins = count(b, 0, 5);
    drape_pin *pin = shelf_take(&w->shelf, 5, sizeof *pin);
    for (int p = 0; p < 5; p++) {
        bool any = pick(b, 32) == 31;
        pin[p].i = any ? draw_int(b) : (int)pick(b, 2);
        pin[p].j = any ? draw_int(b) : (int)pick(b, 2);
        pin[p].motion = any ? draw_int(b) : (int)pick(b, 2) - 1;
    }
    c->pins = c->n_pins <= 5 ? pin : NULL;
    if (pick(b, 4) == 3)
        spoil(b, in_cloth, c);
}

static void make_obstacle(struct whole *w, struct bytes *b, int k)
{
    drape_obstacle *o = &w->obstacle[k];
    drape_default_obstacle(o);
    o->n_vertices = count(b, 1, 12);
    o->n_triangles = count(b, 1, 12);
    o->frames = pick(b, 3) == 2 ? count(b, 0, 4) : 0;
    o->frame_dt = 0.01;
    o->motion = o->frames ? -1 : (int)pick(b, 2) - 1;
    uint32_t nv =
        o->n_vertices > 0 && o->n_vertices < 12 ? (uint32_t)o->n_vertices : 0;
    if (nv && o->n_triangles > 0 && o->n_triangles < 12) {
        size_t nt = (size_t)o->n_triangles;
        double(*x)[3] = shelf_take(&w->shelf, nv, sizeof *x);
        int32_t(*tri)[3] = shelf_take(&w->shelf, nt, sizeof *tri);
        for (uint32_t p = 0; p < 3 * nv; p++)
            x[p / 3][p % 3] = entry(b, -0.1, 0.04);
        for (uint32_t t = 0; t < 3 * nt; t++)
            tri[t / 3][t % 3] =
                pick(b, 64) == 63 ? draw_int(b) : (int32_t)pick(b, nv);
        o->x = (const double(*)[3])x;
        o->tri = (const int32_t(*)[3])tri;
    }
    if (nv && o->frames > 0 && o->frames < 4) {
        uint32_t n = nv * (uint32_t)o->frames;
        double(*frame)[3] = shelf_take(&w->shelf, n, sizeof *frame);
        for (uint32_t p = 0; p < 3 * n; p++)
            frame[p / 3][p % 3] = entry(b, -0.1, 0.04);
        o->frame = (const double(*)[3])frame;
        o->between = nv % 2 ? DRAPE_CUBIC : DRAPE_LINEAR;
        double *time = shelf_take(&w->shelf, (size_t)o->frames, sizeof *time);
        for (int f = 0; f < o->frames; f++)
            time[f] = 0.01 * f * f - 0.005;
        o->frame_time = o->n_triangles % 2 ? time : NULL;
    }
    if (pick(b, 4) == 3)
        spoil(b, in_obstacle, o);
}

static void make_motion(struct whole *w, struct bytes *b, int k)
{
    drape_motion *m = &w->motion[k];
    m->keys = count(b, 1, 4);
    double *time = shelf_take(&w->shelf, 4, sizeof *time);
    double(*position)[3] = shelf_take(&w->shelf, 4, sizeof *position);
    double(*rotation)[4] = shelf_take(&w->shelf, 4, sizeof *rotation);
    for (int j = 0; j < 4; j++) {
        time[j] = pick(b, 32) == 31 ? draw_any(b) : 0.01 * j;
        rotation[j][pick(b, 4)] = 1;
        for (int i = 0; i < 3 && j; i++)
            position[j][i] = entry(b, -0.02, 0.02);
    }
    if (m->keys <= 4) {
        m->time = time;
        m->position = (const double(*)[3])position;
        m->rotation = pick(b, 2) ? (const double(*)[4])rotation : NULL;
    }
    if (pick(b, 8) == 7)
        spoil(b, in_motion, m);
}

void whole_make(struct whole *w, struct bytes *b, struct bank *bank)
{
    memset(w, 0, sizeof *w);
    drape_def *d = &w->def;
    drape_default(d);
    if (pick(b, 16) != 15)
        d->allocator = d->device_allocator = bank_of(bank);
    d->backend = pick(b, 16) == 15 ? draw_int(b) : DRAPE_REF;
    d->precision = pick(b, 2) ? 64 : 32;
    d->integrator = (DRAPE_BW + (int)pick(b, 7)) % (DRAPE_BDF2 + 1);
    d->max_substeps = 200;
    d->max_iterations = 200;
    d->n_cloths = 1 + (int)pick(b, WHOLE_MOST);
    d->n_obstacles = (int)pick(b, WHOLE_MOST + 1);
    d->n_motions = 1 + (int)pick(b, WHOLE_MOST);
    for (int k = 0; k < WHOLE_MOST; k++) {
        make_motion(w, b, k);
        make_cloth(w, b, k);
        make_obstacle(w, b, k);
    }
    d->cloths = w->cloth;
    d->obstacles = w->obstacle;
    d->motions = w->motion;
    for (uint32_t k = pick(b, 4); k > 1; k--)
        spoil(b, in_def, d);
    if (pick(b, 32) == 31) { /* fewer than needed, or too many */
        int *n[] = {&d->n_cloths, &d->n_obstacles, &d->n_motions};
        int wrong = draw_int(b);
        *n[pick(b, 3)] = wrong < 0 || wrong > 1 << 20 ? wrong : 0;
    }
}

void whole_free(struct whole *w)
{
    shelf_free(&w->shelf);
}
