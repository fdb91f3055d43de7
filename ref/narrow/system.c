/* SPDX-License-Identifier: Apache-2.0 */
/* Makes a pair's polynomials with big-integer coefficients.
 * spec/narrow/narrow.md §2, §6.1 */
#include "ref/narrow/system.h"

#include <stddef.h>

/* A vector that is linear in t: its values at t = 0 and t = 1. */
struct line {
    struct big at[2][3];
};

/* Returns the exponent of the lowest set bit of all 24 coordinates. */
static int common_exponent(double x[2][4][3])
{
    int least = 2000;
    for (int i = 0; i < 24; i++) {
        double a = x[i / 12][i / 3 % 4][i % 3];
        if (a != 0 && big_exponent(a) < least)
            least = big_exponent(a);
    }
    return least;
}

/* Returns vertex a minus vertex b. */
static struct line subtract_vertices(struct big_arena *m, struct line p[4],
                                     int a, int b)
{
    struct line r;
    for (int i = 0; i < 6; i++)
        r.at[i / 3][i % 3] =
            big_sub(m, p[a].at[i / 3][i % 3], p[b].at[i / 3][i % 3]);
    return r;
}

/* Returns component k of f × g. */
static struct poly cross_component(struct big_arena *m, const struct line *f,
                                   const struct line *g, int k)
{
    struct poly p = {2, {{NULL, 0, 0}}};
    int i = k == 2 ? 0 : k + 1, j = 3 - k - i;
    for (int n = 0; n <= 2; n++) {
        int mark = m->used;
        for (int s = n > 1; s <= (n > 0); s++)
            p.c[n] = big_add(m, p.c[n],
                             big_det(m, f->at[s][i], g->at[n - s][j],
                                     f->at[s][j], g->at[n - s][i]));
        p.c[n] = big_keep(m, mark, p.c[n]);
    }
    return p;
}

/* Returns a - b; both have the same degree. */
static struct poly subtract_polys(struct big_arena *m, const struct poly *a,
                                  const struct poly *b)
{
    struct poly p = {a->degree, {{NULL, 0, 0}}};
    for (int i = 0; i <= a->degree; i++)
        p.c[i] = big_sub(m, a->c[i], b->c[i]);
    return p;
}

/* Returns a + b; both have the same degree. */
static struct poly add_polys(struct big_arena *m, const struct poly *a,
                             const struct poly *b)
{
    struct poly p = {a->degree, {{NULL, 0, 0}}};
    for (int i = 0; i <= a->degree; i++)
        p.c[i] = big_add(m, a->c[i], b->c[i]);
    return p;
}

/* Returns f · w. */
static struct poly dot_polys(struct big_arena *m, const struct line *f,
                             const struct poly w[3])
{
    struct poly p = {3, {{NULL, 0, 0}}};
    for (int n = 0; n <= 3; n++) {
        int mark = m->used;
        for (int s = n > 2; s <= (n > 0); s++)
            for (int k = 0; k < 3; k++)
                p.c[n] =
                    big_add(m, p.c[n], big_mul(m, f->at[s][k], w[k].c[n - s]));
        p.c[n] = big_keep(m, mark, p.c[n]);
    }
    return p;
}

static void set_box(struct system *s, int j, const struct line *f)
{
    for (int k = 0; k < 3; k++) {
        struct poly p = {1, {f->at[0][k], f->at[1][k]}};
        s->box[j][k] = p;
    }
}

static void make_vf(struct big_arena *m, struct line p[4], struct system *s)
{
    struct line f[3];
    s->count = 3;
    for (int j = 0; j < 3; j++) {
        f[j] = subtract_vertices(m, p, j + 1, 0);
        set_box(s, j, &f[j]);
    }
    for (int k = 0; k < 3; k++) {
        for (int j = 0; j < 3; j++)
            s->q[j][k] =
                cross_component(m, &f[(j + 1) % 3], &f[(j + 2) % 3], k);
    }
    for (int k = 0; k < 3; k++) {
        struct poly q = add_polys(m, &s->q[0][k], &s->q[1][k]);
        s->n[k] = add_polys(m, &q, &s->q[2][k]);
    }
    struct poly w[3] = {s->q[0][0], s->q[0][1], s->q[0][2]};
    s->v = dot_polys(m, &f[0], w);
}

static void make_ee(struct big_arena *m, struct line p[4], struct system *s)
{
    static const int ends[4][2] = {{2, 0}, {3, 0}, {2, 1}, {3, 1}};
    struct line f[3] = {subtract_vertices(m, p, 2, 0),
                        subtract_vertices(m, p, 1, 0),
                        subtract_vertices(m, p, 3, 2)};
    s->count = 4;
    for (int j = 0; j < 4; j++) {
        struct line e = subtract_vertices(m, p, ends[j][0], ends[j][1]);
        set_box(s, j, &e);
    }
    for (int k = 0; k < 3; k++) {
        s->n[k] = cross_component(m, &f[1], &f[2], k);
        s->q[0][k] = cross_component(m, &f[0], &f[2], k);
        s->q[1][k] = subtract_polys(m, &s->n[k], &s->q[0][k]);
        s->q[2][k] = cross_component(m, &f[0], &f[1], k);
        s->q[3][k] = subtract_polys(m, &s->n[k], &s->q[2][k]);
    }
    s->v = dot_polys(m, &f[0], s->n);
}

void system_make(struct big_arena *m, double x[2][4][3], int kind,
                 struct system *s)
{
    struct line p[4];
    int e = common_exponent(x);
    for (int j = 0; j < 4; j++)
        for (int i = 0; i < 6; i++)
            p[j].at[i / 3][i % 3] = big_make(m, x[i / 3][j][i % 3], e);
    if (kind)
        make_ee(m, p, s);
    else
        make_vf(m, p, s);
}
