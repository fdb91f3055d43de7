/* SPDX-License-Identifier: Apache-2.0 */
/* The V-cycle of geometric multigrid with Galerkin coarsening.
 * spec/solve/multigrid.md */
#include "ref/solve/multigrid.h"

#include "ref/solve/coarsen.h"
#include "ref/solve/coarsest.h"
#include "ref/solve/jacobi.h"
#include "ref/solve/level.h"
#include "ref/solve/product.h"

/* §5: lays out the grids, from fine to coarse, in the streams of scratch.
 * Returns the number of grids. */
int multigrid_lay_out(const struct multigrid *s, struct level *l)
{
    sym *a = s->pool;
    vec *v = s->room;
    struct level fine = {.m = s->m,
                         .n = s->n,
                         .count = s->count,
                         .fixed = s->fixed,
                         .rule = s->live + s->count,
                         .excess = a,
                         .factor = s->factor,
                         .b = s->r,
                         .x = s->z,
                         .y = v};
    int levels = 1;
    l[0] = fine;
    a += s->count;
    v += s->count;
    while (s->depth ? levels <= s->depth
                    : levels == 1 || l[levels - 1].count > COARSEST) {
        struct level *c = &l[levels], *f = &l[levels - 1];
        c->m = coarse_size(f->m);
        c->n = coarse_size(f->n);
        int64_t k = c->count = (int64_t)c->m * c->n;
        c->fixed = NULL;
        c->rule = f->rule + f->count;
        c->excess = a;
        c->factor = a + k;
        c->block = a + 2 * k;
        c->x = v;
        c->b = v + k;
        c->y = v + 2 * k;
        a += (2 + STENCIL) * k;
        v += 3 * k;
        levels++;
    }
    return levels;
}

int64_t ref_multigrid_size(struct multigrid *s)
{
    if (s->m < 1 || s->n < 1)
        return 0;
    int32_t m = s->m, n = s->n;
    s->count = (int64_t)m * n;
    s->n_blocks = SPRINGS * s->count;
    s->n_parts = s->n_packed ? s->n_blocks : 0;
    s->n_pool = s->count;
    s->n_room = s->count;
    s->n_live = 2 * s->count;
    s->n_dense = DENSE * DENSE;
    int32_t levels = 1;
    do {
        m = coarse_size(m);
        n = coarse_size(n);
        s->n_pool += (2 + STENCIL) * (int64_t)m * n;
        s->n_room += 3 * (int64_t)m * n;
        s->n_live += (int64_t)m * n;
        levels++;
    } while (s->depth ? levels <= s->depth : (int64_t)m * n > COARSEST);
    return s->n_pool * (int64_t)sizeof(sym) + s->n_room * (int64_t)sizeof(vec) +
           s->n_live + s->n_dense * (int64_t)sizeof(double) +
           s->n_parts * (int64_t)sizeof *s->parts;
}

/* §3: computes y = A x on a coarse grid. */
static void multiply_coarse(const struct level *l)
{
    struct couplings c = {.m = l->m,
                          .n = l->n,
                          .count = l->count,
                          .directions = STENCIL,
                          .di = stencil_di,
                          .dj = stencil_dj,
                          .block = l->block,
                          .x = l->x,
                          .y = l->y};
    EACH_MANY(l->count)
    for (int64_t p = 0; p < l->count; p++)
        l->y[p] = vec_add(sym_apply(l->excess[p], l->x[p]), vec_make(0, 0, 0));
    product_couplings(&c);
}

/* §3: computes y = A x on any grid; on the finest grid with the packed blocks,
 * if there are any. */
static void multiply_level(const struct multigrid *s, const struct level *l)
{
    struct product a = {.count = s->count,
                        .mass = s->mass,
                        .n_extra = s->n_extra,
                        .extra = s->extra,
                        .x = l->x,
                        .y = l->y};
    struct couplings c = {.m = l->m,
                          .n = l->n,
                          .count = l->count,
                          .directions = SPRINGS,
                          .di = spring_di,
                          .dj = spring_dj,
                          .block = s->block,
                          .x = l->x,
                          .y = l->y};
    if (l->block) {
        multiply_coarse(l);
    } else {
        c.packed = s->n_packed ? s->parts : NULL;
        product_start(&a);
        product_couplings(&c);
    }
}

/* §4: the part of F (b - A x) by which a grid is smoothed, where the
 * eigenvalues of F A are at most `high`. */
static real damping_of(double high)
{
    return (real)(16 / (9 * high));
}

/* Smooths from x = 0. */
static void smooth_zero(const struct level *l, real damping)
{
    EACH_MANY(l->count)
    for (int64_t p = 0; p < l->count; p++)
        l->x[p] = vec_scale(damping, factor_solve(l->factor[p], l->b[p]));
}

static void smooth_level(const struct multigrid *s, const struct level *l,
                         real damping)
{
    multiply_level(s, l);
    EACH_MANY(l->count)
    for (int64_t p = 0; p < l->count; p++) {
        vec r = vec_sub(l->b[p], l->y[p]);
        vec d = vec_scale(damping, factor_solve(l->factor[p], r));
        l->x[p] = vec_add(l->x[p], d);
    }
}

/* Computes the residual that is restricted: y = b - A x, 0 where fixed. */
static void find_residual(const struct multigrid *s, const struct level *l)
{
    multiply_level(s, l);
    EACH_MANY(l->count)
    for (int64_t p = 0; p < l->count; p++)
        l->y[p] = l->fixed && l->fixed[p] ? vec_make(0, 0, 0)
                                          : vec_sub(l->b[p], l->y[p]);
}

/* §2: returns the restricted residual of coarse particle (i, j), (Pᵀ y)_ij. */
static vec restrict_residual(const struct level *f, int32_t i, int32_t j)
{
    vec sum = {0, 0, 0};
    for (int dj = -1; dj <= 1; dj++)
        for (int di = -1; di <= 1; di++) {
            int32_t x = 2 * i + di, y = 2 * j + dj;
            int64_t p = x + (int64_t)f->m * y;
            if (x >= 0 && x < f->m && y >= 0 && y < f->n)
                sum =
                    vec_axpy(sum, R(0.25) * (real)weight_of(f->rule[p], di, dj),
                             f->y[p]);
        }
    return sum;
}

static void restrict_to(const struct level *f, const struct level *c)
{
    vec *b = c->x + c->count; /* c->b, const elsewhere */
    EACH_MANY(c->count)
    for (int32_t j = 0; j < c->n; j++)
        for (int32_t i = 0; i < c->m; i++)
            b[i + (int64_t)c->m * j] = restrict_residual(f, i, j);
}

/* §2: returns the correction of the coarse grid, interpolated to fine particle
 * (i, j). */
static vec prolonged_correction(const struct level *c, uint8_t rule, int32_t i,
                                int32_t j)
{
    vec sum = {0, 0, 0};
    for (int32_t y = j / 2; y <= (j + 1) / 2; y++)
        for (int32_t x = i / 2; x <= (i + 1) / 2; x++)
            sum = vec_axpy(
                sum, R(0.25) * (real)weight_of(rule, i - 2 * x, j - 2 * y),
                c->x[x + (int64_t)c->m * y]);
    return sum;
}

static void prolong_level(const struct level *c, const struct level *f)
{
    EACH_MANY(f->count)
    for (int32_t j = 0; j < f->n; j++)
        for (int32_t i = 0; i < f->m; i++) {
            int64_t p = i + (int64_t)f->m * j;
            if (!f->fixed || !f->fixed[p])
                f->x[p] =
                    vec_add(f->x[p], prolonged_correction(c, f->rule[p], i, j));
        }
}

struct coarsest multigrid_coarsest(const struct multigrid *s,
                                   const struct level *l)
{
    return (struct coarsest){.m = l->m,
                             .n = l->n,
                             .count = l->count,
                             .excess = l->excess,
                             .block = l->block,
                             .dense = s->dense};
}

int ref_multigrid_build(struct multigrid *s)
{
    struct level l[LEVELS];
    int levels = multigrid_lay_out(s, l);
    struct excess e = {.m = s->m,
                       .n = s->n,
                       .count = s->count,
                       .mass = s->mass,
                       .n_extra = s->n_extra,
                       .extra = s->extra,
                       .n_blocks = s->n_blocks,
                       .block = s->block,
                       .fixed = s->fixed,
                       .excess = l[0].excess,
                       .live = s->live,
                       .rule = l[0].rule};
    int status = ref_excess(&e);
    EACH_ITEM
    for (int64_t k = 0; k < s->n_packed; k++)
        s->parts[k] = packed_open(s->packed[k]);
    for (int k = 1; k < levels && status == DRAPE_OK; k++) {
        struct coarsen c = {.m = l[k - 1].m,
                            .n = l[k - 1].n,
                            .count = l[k - 1].count,
                            .excess = l[k - 1].excess,
                            .rule = l[k - 1].rule,
                            .coarse_rule = l[k].rule,
                            .n_blocks = STENCIL * l[k - 1].count,
                            .block = l[k - 1].block,
                            .n_coarse = l[k].count,
                            .n_out = STENCIL * l[k].count,
                            .coarse_excess = l[k].excess,
                            .coarse_block = l[k].block,
                            .factor = l[k].excess + l[k].count};
        if (k == 1) {
            c.n_blocks = s->n_blocks;
            c.block = s->block;
            c.n_live = s->count;
            c.live = s->live;
        }
        status = ref_coarsen(&c);
    }
    if (status == DRAPE_OK) {
        struct coarsest d = multigrid_coarsest(s, &l[levels - 1]);
        coarsest_invert(&d);
    }
    return status;
}

real multigrid_damping(const struct multigrid *s, int k)
{
    return k ? damping_of(s->n_extra ? 4 : 2.5)
             : damping_of(s->triples ? 2.7 : 2);
}

void multigrid_descend(const struct multigrid *s, const struct level *l, int k)
{
    smooth_zero(&l[k], multigrid_damping(s, k));
    find_residual(s, &l[k]);
}

void multigrid_restrict(const struct multigrid *s, const struct level *l, int k)
{
    (void)s;
    restrict_to(&l[k], &l[k + 1]);
}

void multigrid_prolong(const struct multigrid *s, const struct level *l, int k)
{
    (void)s;
    prolong_level(&l[k + 1], &l[k]);
}

void multigrid_smooth(const struct multigrid *s, const struct level *l, int k)
{
    smooth_level(s, &l[k], multigrid_damping(s, k));
}

void ref_multigrid_cycle(struct multigrid *s)
{
    struct level l[LEVELS];
    int last = multigrid_lay_out(s, l) - 1;
    for (int k = 0; k < last; k++) {
        multigrid_descend(s, l, k);
        multigrid_restrict(s, l, k);
    }
    struct coarsest d = multigrid_coarsest(s, &l[last]);
    coarsest_solve(&d, l[last].b, l[last].x);
    for (int k = last - 1; k >= 0; k--) {
        multigrid_prolong(s, l, k);
        multigrid_smooth(s, l, k);
    }
}

int ref_multigrid(struct multigrid *s)
{
    int status = ref_multigrid_build(s);
    if (status == DRAPE_OK)
        ref_multigrid_cycle(s);
    return status;
}
