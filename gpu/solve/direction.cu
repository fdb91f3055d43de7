/* SPDX-License-Identifier: Apache-2.0 */
/* The next search direction and its product with the matrix, in one pass where
 * the matrix is compact. spec/solve/pcg.md §3 */
#include "gpu/solve/march.cuh"
#include "gpu/solve/pcg.cuh"

/* s + β p, as what a product reads. */
struct mixed {
    const vec *s, *p;
    const struct course *c;
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

/* Of A p: writes p[k], q[k] and item[k]. */
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

/* The same from the compressed diagonals, p being there. */
static __global__ void __launch_bounds__(GPU_BLOCK)
    pcg_direction_kernel(struct mixed m, vec *p, int64_t count)
{
    ITEM(k, count);
    if (m.c->go)
        p[k] = value_at(&m, place{(int32_t)k, 0, 0});
}

static __global__ void __launch_bounds__(GPU_BLOCK)
    pcg_product_kernel(struct product a, struct cdf d, struct image e,
                       const int32_t *go)
{
    ITEM(k, a.count);
    if (!*go)
        return;
    struct place at = place_of(grid{a.m, a.n}, k);
    arrive(&e, at, about(&e, at), a.x[k], cdf_row(&a, &d, at));
}

bool gpu_pcg_marches(const struct pcg *s)
{
    return !s->n_cdf && marches(grid{s->m, s->n});
}

bool gpu_rates_help(const struct gpu *g, const struct pcg *s)
{
    return g->bulk && s->solver == DRAPE_EXACT && s->form == DRAPE_COMPACT &&
           s->precond == DRAPE_JACOBI && marches(grid{s->m, s->n});
}

void gpu_pcg_search(struct gpu *g, const struct pcg *s, struct search a)
{
    const sym *extra = s->n_extra ? s->extra : NULL;
    const int32_t *go = &a.c->go;
    struct grid grid = {s->m, s->n};
    struct mixed m = {s->s, a.p, a.c};
    struct image e = {s->fixed, a.to, s->q, a.item};
    struct product y = {s->m, s->n, s->count, s->mass, s->n_extra, s->extra,
                        0,    NULL, s->n_cdf, s->cdf,  a.to,       s->q};
    if (s->n_cdf) {
        LAUNCH(g, s->count, pcg_direction_kernel, m, a.to, s->count);
        LAUNCH(g, s->count, pcg_product_kernel, y, cdf_of(s->m, s->n), e, go);
    } else if (a.rates.of) {
        ties<struct rate> t = {grid, s->mass, extra, NULL, a.rates.of};
        march<SPRINGS>(g, t, grounded<struct mixed>{m, a.rates.x}, e, go);
    } else {
        ties<sym> t = {grid, s->mass, extra, NULL, s->block};
        product_of<SPRINGS>(g, t, m, e, go);
    }
}
