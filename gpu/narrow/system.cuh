/* SPDX-License-Identifier: Apache-2.0 */
/* Makes a pair's polynomials with big-integer coefficients on the device.
 * spec/narrow/narrow.md §2, §6.1 */
#ifndef GPU_SYSTEM_CUH
#define GPU_SYSTEM_CUH

#include "gpu/narrow/filter.cuh"
#include "gpu/narrow/roots.cuh"

/* A vector that is linear in t: its values at t = 0 and t = 1. */
struct line {
    struct big at[2][3];
};

/* The polynomials of §2, which a worker of tier 3 holds besides its arena. */
struct workspace {
    struct line x[4], f[3]; /* vertices; vectors */
    int count;              /* number of forms, and of box forms */
    struct poly v;          /* the cubic V */
    struct poly q[4][3];    /* forms, by axis */
    struct poly n[3];       /* the normal N, by axis */
    struct poly box[4][3];  /* box forms, by axis */
    struct chain chain[2];
};

static __device__ inline double coordinate(vec a, int k)
{
    return (double)(k == 0 ? a.x : k == 1 ? a.y : a.z);
}

/* Writes the vertices as integers in units of their common lowest bit. */
static __device__ inline void
set_vertices(struct big_arena *m, const struct quad *p, struct workspace *s)
{
    int e = 2000;
    for (int i = 0; i < 24; i++) {
        double a = coordinate(p->x[i / 12][i / 3 % 4], i % 3);
        if (a != 0)
            e = min_of(e, lowest_bit(a));
    }
    for (int i = 0; i < 24; i++) {
        double a = coordinate(p->x[i / 12][i / 3 % 4], i % 3);
        s->x[i / 3 % 4].at[i / 12][i % 3] = big_make(m, a, e);
    }
}

/* Writes vertex a minus vertex b. */
static __device__ __noinline__ void set_edge(struct big_arena *m,
                                             const struct line x[4], int a,
                                             int b, struct line *r)
{
    for (int t = 0; t < 2; t++)
        for (int k = 0; k < 3; k++)
            r->at[t][k] = big_sub(m, x[a].at[t][k], x[b].at[t][k]);
}

/* Writes component k of f × g. */
static __device__ __noinline__ void set_cross(struct big_arena *m,
                                              const struct line *f,
                                              const struct line *g, int k,
                                              struct poly *p)
{
    int i = k == 2 ? 0 : k + 1, j = 3 - k - i;
    p->degree = 2;
    for (int n = 0; n <= 2; n++) {
        int mark = m->used;
        struct big sum = big_zero();
        for (int s = n > 1; s <= (n > 0); s++)
            sum = big_add(m, sum,
                          big_det(m, f->at[s][i], g->at[n - s][j], f->at[s][j],
                                  g->at[n - s][i]));
        p->c[n] = big_keep(m, mark, sum);
    }
}

/* Writes a + b, or a - b where `minus` is set. Both are quadratics. */
static __device__ __noinline__ void set_sum(struct big_arena *m,
                                            const struct poly *a, bool minus,
                                            const struct poly *b,
                                            struct poly *p)
{
    p->degree = 2;
    for (int i = 0; i <= 2; i++)
        p->c[i] = big_add(m, a->c[i], minus ? big_minus(b->c[i]) : b->c[i]);
}

/* Writes V = f · w. */
static __device__ inline void set_cubic(struct big_arena *m,
                                        const struct line *f,
                                        const struct poly w[3], struct poly *v)
{
    v->degree = 3;
    for (int n = 0; n <= 3; n++) {
        int mark = m->used;
        struct big sum = big_zero();
        for (int t = n > 2; t <= (n > 0); t++)
            for (int k = 0; k < 3; k++)
                sum = big_add(m, sum, big_mul(m, f->at[t][k], w[k].c[n - t]));
        v->c[n] = big_keep(m, mark, sum);
    }
}

static __device__ inline void set_box(struct workspace *s, int j,
                                      const struct line *f)
{
    for (int k = 0; k < 3; k++) {
        s->box[j][k].degree = 1;
        s->box[j][k].c[0] = f->at[0][k];
        s->box[j][k].c[1] = f->at[1][k];
    }
}

static __device__ inline void set_vf(struct big_arena *m, struct workspace *s)
{
    s->count = 3;
    for (int j = 0; j < 3; j++) {
        set_edge(m, s->x, j + 1, 0, &s->f[j]);
        set_box(s, j, &s->f[j]);
    }
    for (int k = 0; k < 3; k++) {
        for (int j = 0; j < 3; j++)
            set_cross(m, &s->f[(j + 1) % 3], &s->f[(j + 2) % 3], k,
                      &s->q[j][k]);
        set_sum(m, &s->q[0][k], false, &s->q[1][k], &s->n[k]);
        set_sum(m, &s->n[k], false, &s->q[2][k], &s->n[k]);
    }
}

static __device__ inline void set_ee(struct big_arena *m, struct workspace *s)
{
    s->count = 4;
    for (int j = 0; j < 4; j++) {
        set_edge(m, s->x, 2 + j % 2, j / 2, &s->f[0]);
        set_box(s, j, &s->f[0]);
    }
    set_edge(m, s->x, 2, 0, &s->f[0]);
    set_edge(m, s->x, 1, 0, &s->f[1]);
    set_edge(m, s->x, 3, 2, &s->f[2]);
    for (int k = 0; k < 3; k++) {
        set_cross(m, &s->f[1], &s->f[2], k, &s->n[k]);
        set_cross(m, &s->f[0], &s->f[2], k, &s->q[0][k]);
        set_sum(m, &s->n[k], true, &s->q[0][k], &s->q[1][k]);
        set_cross(m, &s->f[0], &s->f[1], k, &s->q[2][k]);
        set_sum(m, &s->n[k], true, &s->q[2][k], &s->q[3][k]);
    }
}

/* Makes the polynomials of p. They are void where the arena is full. */
static __device__ inline void
set_workspace(struct big_arena *m, const struct quad *p, struct workspace *s)
{
    set_vertices(m, p, s);
    if (p->ee)
        set_ee(m, s);
    else
        set_vf(m, s);
    set_cubic(m, &s->f[0], p->ee ? s->n : s->q[0], &s->v);
}

#endif
