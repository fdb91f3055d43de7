/* SPDX-License-Identifier: Apache-2.0 */
/* Computes the next search direction and its product with the matrix, in one
 * pass if the matrix is compact. spec/solve/pcg.md §3 */
#include "gpu/solve/pcg.cuh"
#include "gpu/solve/sweep.cuh"

/* A source of x: the vector s + β p, computed where a product reads it, so that
 * it need not be in memory first. */
struct mixed {
    const vec *s, *p;
    const struct pcg_state *c;
};

struct mixed_parts {
    bool first;
    vec s, p;
};

static __device__ struct mixed_parts take(const struct mixed *m,
                                          struct place at)
{
    struct mixed_parts x = {m->c->first != 0, m->s[at.p], {0, 0, 0}};
    if (!x.first)
        x.p = m->p[at.p];
    return x;
}

static __device__ vec made(const struct mixed *m, struct mixed_parts x,
                           struct place at)
{
    (void)at;
    return x.first ? x.s : axpy(x.s, m->c->beta, x.p);
}

/* The end of a row of the product: writes p[k], q[k] and item[k]. */
struct image {
    const uint8_t *fixed;
    vec *p, *q;
    real *item;
};

static __device__ bool about(const struct image *e, struct place at)
{
    return e->fixed[at.p];
}

static __device__ void arrive(const struct image *e, struct place at,
                              bool fixed, vec x, vec y)
{
    vec q = fixed ? make(0, 0, 0) : y;
    e->p[at.p] = x;
    e->q[at.p] = q;
    e->item[at.p] = dot(x, q);
}

/* Does the same with compressed diagonals, in two kernels: this one computes
 * the direction, the next one its product. */
KERNEL pcg_direction_kernel(const struct mixed &m, vec *p, int64_t count)
{
    ITEM(k, count);
    if (m.c->go)
        p[k] = value_at(&m, place{(int32_t)k, 0, 0});
}

KERNEL pcg_product_kernel(const struct product &a, const struct cdf &d,
                          const struct image &e, const int32_t *go)
{
    ITEM(k, a.count);
    if (!*go)
        return;
    struct place at = place_of(grid{a.m, a.n}, k);
    arrive(&e, at, about(&e, at), a.x[k], cdf_row(&a, &d, at));
}

bool gpu_pcg_sweeps(const struct pcg *s)
{
    return !s->n_cdf && sweeps(grid{s->m, s->n});
}

bool gpu_rates_help(const struct gpu *g, const struct pcg *s)
{
    return g->bulk && s->solver == DRAPE_EXACT && s->form == DRAPE_COMPACT &&
           s->precond == DRAPE_JACOBI && !s->whole && sweeps(grid{s->m, s->n});
}

void gpu_pcg_search(struct gpu *g, const struct pcg *s, struct search a)
{
    const sym *extra = s->n_extra ? s->extra : NULL;
    const int32_t *go = &a.c->go;
    struct grid grid = {s->m, s->n};
    struct mixed m = {s->s, a.p, a.c};
    struct image e = {s->fixed, a.to, s->q, a.item};
    struct product y = pcg_product(s, a.to, s->q);
    if (s->n_cdf) {
        LAUNCH(g, s->count, pcg_direction_kernel, m, a.to, s->count);
        LAUNCH(g, s->count, pcg_product_kernel, y, cdf_of(s->m, s->n), e, go);
    } else if (a.rate) {
        edges<struct rate> t = {grid, s->mass, extra, NULL, a.rate};
        sweep<SPRINGS>(g, t, m, e, go);
    } else {
        edges<sym> t = {grid, s->mass, extra, NULL, s->block};
        product_of<SPRINGS>(g, t, m, e, go);
    }
}
