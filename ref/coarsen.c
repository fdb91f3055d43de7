/* SPDX-License-Identifier: Apache-2.0 */
/* Galerkin coarsening with bilinear interpolation. spec/14_multigrid.md */
#include "ref/coarsen.h"

#include "ref/jacobi.h"

/* §2: `weight` sixteenths of fine block o of the particle at (di, dj) from
 * the coarse one's place. */
struct term {
    int8_t o, di, dj, weight;
};

enum { TERMS = 64 };

/* The terms of one coarse direction. */
struct recipe {
    int terms;
    struct term term[TERMS];
};

/* Four times the bilinear weight of a fine particle in its coarse one. */
static int hat(int di, int dj)
{
    int a = 2 - (di < 0 ? -di : di), b = 2 - (dj < 0 ? -dj : dj);
    return a > 0 && b > 0 ? a * b : 0;
}

/* §2: weights -(wᵢ - wᵢ')(wⱼ - wⱼ') of all springs for a pair of coarse
 * particles, the second (ci, cj) steps from the first. */
static struct recipe recipe_of(int springs, const int8_t *si, const int8_t *sj,
                               int ci, int cj)
{
    struct recipe r = {0};
    for (int o = 0; o < springs; o++)
        for (int dj = -3; dj <= 1; dj++)
            for (int di = -3; di <= 3; di++) {
                int a = hat(di, dj) - hat(di + si[o], dj + sj[o]);
                int b = hat(di - 2 * ci, dj - 2 * cj) -
                        hat(di + si[o] - 2 * ci, dj + sj[o] - 2 * cj);
                struct term t = {(int8_t)o, (int8_t)di, (int8_t)dj,
                                 (int8_t)(-a * b)};
                if (t.weight && r.terms < TERMS)
                    r.term[r.terms++] = t;
            }
    return r;
}

static sym add_scaled(sym a, real w, sym b)
{
    a.xx += w * b.xx;
    a.xy += w * b.xy;
    a.xz += w * b.xz;
    a.yy += w * b.yy;
    a.yz += w * b.yz;
    a.zz += w * b.zz;
    return a;
}

/* The sum of a recipe at coarse (i, j). */
static sym cook(const struct coarsen *s, const struct recipe *r, int32_t i,
                int32_t j)
{
    sym sum = {0, 0, 0, 0, 0, 0};
    for (int k = 0; k < r->terms; k++) {
        struct term t = r->term[k];
        int32_t x = 2 * i + t.di, y = 2 * j + t.dj;
        int64_t p = x + (int64_t)s->m * y;
        if (x < 0 || x >= s->m || y < 0 || y >= s->n ||
            (s->n_live && !(s->live[p] >> t.o & 1)))
            continue;
        sum =
            add_scaled(sum, t.weight * R(0.0625), s->block[t.o * s->count + p]);
    }
    return sum;
}

/* §2: what the fine excess gives to the pair: -wᵢ wⱼ, and to (i, j) itself:
 * wᵢ, each over the particles around (i, j). */
static sym share(const struct coarsen *s, int32_t i, int32_t j, int ci, int cj)
{
    sym sum = {0, 0, 0, 0, 0, 0};
    bool self = ci == 0 && cj == 0;
    for (int dj = -1; dj <= 1; dj++)
        for (int di = -1; di <= 1; di++) {
            int32_t x = 2 * i + di, y = 2 * j + dj;
            int w = self ? 4 * hat(di, dj)
                         : -hat(di, dj) * hat(di - 2 * ci, dj - 2 * cj);
            if (w && x >= 0 && x < s->m && y >= 0 && y < s->n)
                sum = add_scaled(sum, (real)w * R(0.0625),
                                 s->excess[x + (int64_t)s->m * y]);
        }
    return sum;
}

static void gather_node(const struct coarsen *s, const struct recipe *recipe,
                        int32_t i, int32_t j)
{
    int64_t p = i + (int64_t)coarse_size(s->m) * j;
    s->coarse_excess[p] = share(s, i, j, 0, 0);
    for (int o = 0; o < STENCIL; o++) {
        sym a = cook(s, &recipe[o], i, j);
        if (stencil_di[o] * stencil_di[o] <= 1 && stencil_dj[o] <= 1)
            a = sym_add(a, share(s, i, j, stencil_di[o], stencil_dj[o]));
        s->coarse_block[o * s->n_coarse + p] = a;
    }
}

/* §3: the diagonal block, in binary64. */
static void factor_node(const struct coarsen *s, int32_t i, int32_t j)
{
    int32_t m = coarse_size(s->m), n = coarse_size(s->n);
    int64_t p = i + (int64_t)m * j;
    struct wide_sym d = {{0}};
    d = wide_sym_add(d, s->coarse_excess[p]);
    for (int o = 0; o < STENCIL; o++) {
        const sym *block = s->coarse_block + o * s->n_coarse;
        int32_t x = i - stencil_di[o], y = j - stencil_dj[o];
        d = wide_sym_add(d, block[p]);
        if (x >= 0 && x < m && y >= 0 && y < n)
            d = wide_sym_add(d, block[x + (int64_t)m * y]);
    }
    s->factor[p] = ref_factor(d);
}

int ref_coarsen(struct coarsen *s)
{
    int32_t m = coarse_size(s->m), n = coarse_size(s->n);
    bool springs = s->n_live > 0;
    int64_t each = springs ? SPRINGS : STENCIL;
    if (s->m < 1 || s->n < 1 || s->count != (int64_t)s->m * s->n ||
        s->n_blocks != each * s->count || (springs && s->n_live != s->count) ||
        s->n_coarse != (int64_t)m * n || s->n_out != STENCIL * s->n_coarse)
        return DRAPE_EARG;

    struct recipe recipe[STENCIL];
    for (int o = 0; o < STENCIL; o++)
        recipe[o] = recipe_of((int)each, springs ? spring_di : stencil_di,
                              springs ? spring_dj : stencil_dj, stencil_di[o],
                              stencil_dj[o]);
    EACH_MANY(s->n_coarse)
    for (int32_t j = 0; j < n; j++)
        for (int32_t i = 0; i < m; i++)
            gather_node(s, recipe, i, j);
    EACH_MANY(s->n_coarse)
    for (int32_t j = 0; j < n; j++)
        for (int32_t i = 0; i < m; i++)
            factor_node(s, i, j);
    return DRAPE_OK;
}

/* §1: particle p at (i, j). */
static void excess_node(const struct excess *s, int32_t i, int32_t j)
{
    int64_t p = i + (int64_t)s->m * j;
    sym e = {s->mass[p], 0, 0, s->mass[p], 0, s->mass[p]};
    sym none = {0, 0, 0, 0, 0, 0};
    uint8_t live = 0;
    if (s->n_extra)
        e = sym_add(e, s->extra[p]);
    for (int o = 0; o < SPRINGS; o++) {
        const sym *block = s->block + o * s->count;
        int64_t step = spring_step(s->m, o);
        if (spring_inside(s->m, s->n, i, j, o, 1)) {
            if (s->fixed[p + step])
                e = sym_add(e, block[p]);
            else if (!s->fixed[p])
                live |= (uint8_t)(1 << o);
        }
        if (spring_inside(s->m, s->n, i, j, o, -1) && s->fixed[p - step])
            e = sym_add(e, block[p - step]);
    }
    s->excess[p] = s->fixed[p] ? none : e;
    s->live[p] = live;
}

int ref_excess(struct excess *s)
{
    if (s->m < 1 || s->n < 1 || s->count != (int64_t)s->m * s->n ||
        s->n_blocks != SPRINGS * s->count ||
        (s->n_extra && s->n_extra != s->count))
        return DRAPE_EARG;
    EACH_MANY(s->count)
    for (int32_t j = 0; j < s->n; j++)
        for (int32_t i = 0; i < s->m; i++)
            excess_node(s, i, j);
    return DRAPE_OK;
}
