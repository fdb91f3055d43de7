/* SPDX-License-Identifier: Apache-2.0 */
/* A rigid block on an inclined plane: friction by stage contacts and rigidity
 * by stage zones together obey Coulomb's law. spec/contact/contacts.md §6 */
#include "ref/contact/contacts.h"
#include "ref/contact/proximity.h"
#include "ref/contact/zones.h"
#include "tests/base/harness.h"

enum { BLOCK = 8, PASSES = 64 };

/* A plane with slope sine / cosine and a block that lies on it. The block's
 * axes point down the slope (along), out of the plane (out), and along z. */
struct incline {
    vec along, out;
    vec x[BLOCK + 4], u[BLOCK + 4], v[BLOCK + 4];
    real w[BLOCK + 4];
    uint16_t of[BLOCK + 4];
    struct surface surface;
    int32_t pair[4 * 2 * BLOCK]; /* each block corner with each triangle */
    uint8_t kind[2 * BLOCK];
};

static void make(struct incline *s, real sine, real cosine, real friction)
{
    memset(s, 0, sizeof *s);
    s->along = vec_make(cosine, -sine, 0);
    s->out = vec_make(sine, cosine, 0);
    s->surface = (struct surface){R(0.002), friction};
    for (int k = 0; k < BLOCK + 4; k++) {
        real side = k < BLOCK ? R(0.1) : 20;
        real height = k < BLOCK ? R(0.001) + R(0.05) * (k >> 2) : 0;
        real a = k & 1 ? side : -side, c = k & 2 ? side : -side;
        s->x[k] = vec_axpy(vec_scale(a, s->along), height, s->out);
        s->x[k].z = c;
        s->w[k] = k < BLOCK ? 4 : 0;
    }
    for (int k = 0; k < 2 * BLOCK; k++) {
        static const int32_t face[2][3] = {{8, 9, 11}, {8, 11, 10}};
        s->pair[4 * k] = k / 2;
        memcpy(s->pair + 4 * k + 1, face[k % 2], sizeof face[0]);
    }
}

/* Finds the contacts at the start of the step. Returns their number, or -1. */
static int64_t find_contacts(const struct incline *s, real dt,
                             struct contact *contact)
{
    int32_t at[2 * BLOCK];
    struct proximity p = {.range = 1,
                          .nv = BLOCK + 4,
                          .n = 2 * BLOCK,
                          .pair = s->pair,
                          .kind = s->kind,
                          .x = s->x,
                          .w = s->w,
                          .surfaces = {1, s->of, &s->surface},
                          .dt = dt,
                          .at = at,
                          .cap = 2 * BLOCK,
                          .contact = contact};
    return ref_proximity(&p) == DRAPE_OK ? p.found : -1;
}

static int push(struct incline *s, struct contact *contact, int64_t n, int warm)
{
    int32_t start[BLOCK + 5], item[8 * BLOCK], vertex[8 * BLOCK];
    int32_t acting[BLOCK + 4], parts[BLOCK + 4];
    real lack[2 * BLOCK], lookahead[2 * BLOCK];
    vec pushes[2 * BLOCK], before[2 * BLOCK];
    uint8_t moved[8 * BLOCK], contact_awake[2 * BLOCK], vertex_awake[BLOCK + 4];
    struct contacts c = {.nv = BLOCK + 4,
                         .n = n,
                         .w = s->w,
                         .iterations = 8,
                         .contact = contact,
                         .u = s->u,
                         .v = s->v,
                         .nv1 = BLOCK + 5,
                         .n4 = 4 * n,
                         .start = start,
                         .item = item,
                         .acting = acting,
                         .parts = parts,
                         .lack = lack,
                         .lookahead = lookahead,
                         .push = pushes,
                         .before = before,
                         .warm = warm,
                         .vertex = vertex,
                         .contact_awake = contact_awake,
                         .vertex_awake = vertex_awake,
                         .moved = moved};
    return ref_contacts(&c);
}

/* Makes all eight corners one zone and moves it. */
static int make_zone(struct incline *s, real dt)
{
    enum { N = 3 };
    static const int32_t pair[4 * N] = {0, 1, 2, 3, 4, 5, 6, 7, 0, 4, 1, 5};
    int32_t label[BLOCK + 4], vertex[4 * N];
    struct key key[4 * N], spare[4 * N];
    struct zone_sum sum[4 * N];
    struct zone zone[N];
    struct zones z = {.nv = BLOCK + 4,
                      .n = N,
                      .pair = pair,
                      .w = s->w,
                      .x0 = s->x,
                      .dt = dt,
                      .u = s->u,
                      .n4 = 4 * N,
                      .label = label,
                      .key = key,
                      .spare = spare,
                      .sum = sum,
                      .zone = zone,
                      .vertex = vertex};
    return ref_zones(&z);
}

/* Makes steps of dt. Returns the distance down the slope in m, or NaN. */
static double slide(struct incline *s, int steps, real dt)
{
    struct contact contact[2 * BLOCK];
    for (int step = 0; step < steps; step++) {
        for (int k = 0; k < BLOCK; k++)
            s->u[k].y -= dt * R(9.81);
        int64_t n = find_contacts(s, dt, contact);
        for (int pass = 0; pass < PASSES; pass++)
            if (n < 0 || push(s, contact, n, pass > 0) != DRAPE_OK ||
                make_zone(s, dt) != DRAPE_OK)
                return (double)NAN;
        for (int k = 0; k < BLOCK; k++)
            s->x[k] = vec_axpy(s->x[k], dt, s->u[k]);
    }
    vec sum = {0, 0, 0};
    for (int k = 0; k < BLOCK; k++)
        sum = vec_add(sum, s->x[k]);
    return (double)vec_dot(sum, s->along) / BLOCK;
}

static double magnitude(double a)
{
    return a < 0 ? -a : a;
}

const char *test_block_incline(void)
{
    static const struct {
        double sine, cosine, friction;
    } row[] = {{5.0 / 13, 12.0 / 13, 0.5}, /* tan 0.417 */
               {3.0 / 5, 4.0 / 5, 0.8},    /* 0.75 */
               {3.0 / 5, 4.0 / 5, 0.76},   {3.0 / 5, 4.0 / 5, 0.6},
               {3.0 / 5, 4.0 / 5, 0.5},    {3.0 / 5, 4.0 / 5, 0},
               {5.0 / 13, 12.0 / 13, 0.2}, {0, 1, 0.1}};
    const int steps = 100;
    const double dt = 0.01;
    for (size_t k = 0; k < sizeof row / sizeof *row; k++) {
        double a = 9.81 * (row[k].sine - row[k].friction * row[k].cosine);
        struct incline s;
        make(&s, (real)row[k].sine, (real)row[k].cosine, (real)row[k].friction);
        double way = slide(&s, steps, (real)dt);
        /* symplectic Euler from rest: a dt² (1 + 2 + … + steps) */
        double due = a > 0 ? a * dt * dt * steps * (steps + 1) / 2 : 0;
        EXPECT(magnitude(way - due) <= 1e-5 * due + 1e-6);
        ran(1);
    }
    return NULL;
}
