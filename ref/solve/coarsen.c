/* SPDX-License-Identifier: Apache-2.0 */
/* Stages excess and coarsen: the operator of the finest grid in difference
 * form, and Galerkin coarsening by bilinear interpolation, which does not reach
 * across cuts. spec/solve/multigrid.md §1, §2 */
#include "ref/solve/coarsen.h"

#include "ref/solve/jacobi.h"

#include <stdlib.h>

/* §2: a coarse block is a sum of terms. A term is weight/16 times block o of
 * the fine particle that lies (di, dj) from the coarse particle. */
struct term {
    int8_t o, di, dj, weight;
};

/* TERMS: the capacity of a recipe. AROUND: how many fine particles may have a
 * forward spring that contributes to a coarse particle. */
enum { TERMS = 64, AROUND = 7 * 5 };

/* The terms of the coarse blocks of one direction, away from cuts. */
struct recipe {
    int terms;
    struct term term[TERMS];
};

/* Returns four times the weight of interpolation away from cuts, where the rule
 * is 0. */
static int hat_weight(int di, int dj)
{
    return weight_of(0, di, dj);
}

/* §2: whether a block couples two particles, that is, is not 0. */
static bool is_coupling(sym b)
{
    return b.xx != 0 || b.yy != 0 || b.zz != 0;
}

/* §2: returns the rule of the particle at (i, j). right, up: the blocks of the
 * directions (1, 0) and (0, 1). */
static uint8_t rule_of(int32_t m, int32_t n, int32_t i, int32_t j,
                       const sym *right, const sym *up)
{
    int64_t p = i + (int64_t)m * j;
    int rule = 0;
    if (i % 2 && i + 1 < m &&
        is_coupling(right[p - 1]) != is_coupling(right[p]))
        rule |= is_coupling(right[p]) ? ONLY_RIGHT : ONLY_LEFT;
    if (j % 2 && j + 1 < n && is_coupling(up[p - m]) != is_coupling(up[p]))
        rule |= is_coupling(up[p]) ? ONLY_UP : ONLY_DOWN;
    return (uint8_t)rule;
}

/* §2: returns the recipe for a pair of coarse particles, the second (ci, cj)
 * steps from the first: the non-zero weights -(w_pI - w_qI)(w_pJ - w_qJ) over
 * all fine springs (p, q). */
static struct recipe recipe_of(int springs, const int8_t *si, const int8_t *sj,
                               int ci, int cj)
{
    struct recipe r = {0};
    for (int o = 0; o < springs; o++)
        for (int dj = -3; dj <= 1; dj++)
            for (int di = -3; di <= 3; di++) {
                int a = hat_weight(di, dj) - hat_weight(di + si[o], dj + sj[o]);
                int b = hat_weight(di - 2 * ci, dj - 2 * cj) -
                        hat_weight(di + si[o] - 2 * ci, dj + sj[o] - 2 * cj);
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

/* §2: returns the sum of a recipe's terms for coarse particle (i, j). */
static sym sum_recipe(const struct coarsen *s, const struct recipe *r,
                      int32_t i, int32_t j)
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

/* Returns four times the weight of coarse particle (ci, cj) in the
 * interpolation to fine particle (x, y). */
static int interpolation_weight(const struct coarsen *s, int32_t x, int32_t y,
                                int32_t ci, int32_t cj)
{
    if (x < 0 || x >= s->m || y < 0 || y >= s->n)
        return 0;
    return weight_of(s->rule[x + (int64_t)s->m * y], x - 2 * ci, y - 2 * cj);
}

/* Four times the weights of a coarse particle in the interpolation to the fine
 * ones around coarse particle (i, j), by their place from it. */
enum { WIDE = 5, BELOW = 3 };
struct share {
    int8_t of[2 * BELOW + 1][2 * WIDE + 1];
};

/* The share of the coarse particle (ci, cj) steps from (i, j). */
static struct share share_of(const struct coarsen *s, int32_t i, int32_t j,
                             int ci, int cj)
{
    struct share w = {{{0}}};
    for (int k = 0; k < 9; k++) {
        int di = 2 * ci + k % 3 - 1, dj = 2 * cj + k / 3 - 1;
        if (abs(di) <= WIDE && abs(dj) <= BELOW)
            w.of[dj + BELOW][di + WIDE] = (int8_t)interpolation_weight(
                s, 2 * i + di, 2 * j + dj, i + ci, j + cj);
    }
    return w;
}

/* §2: adds the same terms in the same order near a cut, where the weights
 * follow from the rules and not from a recipe. */
static void sum_near_cut(const struct coarsen *s, int32_t i, int32_t j,
                         sym sum[STENCIL])
{
    struct share own = share_of(s, i, j, 0, 0), other[STENCIL];
    for (int k = 0; k < STENCIL; k++)
        other[k] = share_of(s, i, j, stencil_di[k], stencil_dj[k]);
    for (int k = 0; k < AROUND * (int)(s->n_blocks / s->count); k++) {
        int o = k / AROUND, di = k % AROUND % 7 - 3, dj = k % AROUND / 7 - 3;
        int ei = di + (s->n_live ? spring_di[o] : stencil_di[o]);
        int ej = dj + (s->n_live ? spring_dj[o] : stencil_dj[o]);
        int32_t x = 2 * i + di, y = 2 * j + dj, z = 2 * i + ei, t = 2 * j + ej;
        int64_t p = x + (int64_t)s->m * y;
        int a = own.of[dj + BELOW][di + WIDE] - own.of[ej + BELOW][ei + WIDE];
        if (a == 0 || x < 0 || x >= s->m || y < 0 || y >= s->n || z < 0 ||
            z >= s->m || t >= s->n || (s->n_live && !(s->live[p] >> o & 1)))
            continue;
        for (int q = 0; q < STENCIL; q++) {
            int b = other[q].of[dj + BELOW][di + WIDE] -
                    other[q].of[ej + BELOW][ei + WIDE];
            if (b != 0)
                sum[q] = add_scaled(sum[q], (real)(-a * b) * R(0.0625),
                                    s->block[o * s->count + p]);
        }
    }
}

/* Whether a fine particle that contributes to coarse particle (i, j) has a rule
 * other than 0. */
static bool is_cut(const struct coarsen *s, int32_t i, int32_t j)
{
    for (int32_t y = 2 * j - 3; y <= 2 * j + 5; y++)
        for (int32_t x = 2 * i - 5; x <= 2 * i + 5; x++)
            if (x >= 0 && x < s->m && y >= 0 && y < s->n &&
                s->rule[x + (int64_t)s->m * y])
                return true;
    return false;
}

/* §2: returns the contribution of the fine excesses around coarse particle (i,
 * j): to the block of the pair with (i + ci, j + cj), weighted by -w_I w_J; or,
 * with ci = cj = 0, to the coarse excess of (i, j), weighted by w_I. */
static sym coarse_sum(const struct coarsen *s, int32_t i, int32_t j, int ci,
                      int cj)
{
    sym sum = {0, 0, 0, 0, 0, 0};
    bool self = ci == 0 && cj == 0;
    for (int dj = -1; dj <= 1; dj++)
        for (int di = -1; di <= 1; di++) {
            int32_t x = 2 * i + di, y = 2 * j + dj;
            int a = interpolation_weight(s, x, y, i, j);
            int w = self ? 4 * a
                         : -a * interpolation_weight(s, x, y, i + ci, j + cj);
            if (w != 0)
                sum = add_scaled(sum, (real)w * R(0.0625),
                                 s->excess[x + (int64_t)s->m * y]);
        }
    return sum;
}

static void gather_node(const struct coarsen *s, const struct recipe *recipe,
                        int32_t i, int32_t j)
{
    int64_t p = i + (int64_t)coarse_size(s->m) * j;
    sym sum[STENCIL] = {{0}};
    if (is_cut(s, i, j))
        sum_near_cut(s, i, j, sum);
    else
        for (int o = 0; o < STENCIL; o++)
            sum[o] = sum_recipe(s, &recipe[o], i, j);
    s->coarse_excess[p] = coarse_sum(s, i, j, 0, 0);
    for (int o = 0; o < STENCIL; o++) {
        int di = stencil_di[o], dj = stencil_dj[o];
        if (di >= -1 && di <= 1 && dj <= 1)
            sum[o] = sym_add(sum[o], coarse_sum(s, i, j, di, dj));
        s->coarse_block[o * s->n_coarse + p] = sum[o];
    }
}

/* §3: sums the diagonal block in binary64 and factors it; then sets the rule.
 */
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
    s->coarse_rule[p] = rule_of(m, n, i, j, s->coarse_block,
                                s->coarse_block + STENCIL_UP * s->n_coarse);
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

/* §1: sets the excess, the live springs and the rule of particle (i, j). */
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
    s->rule[p] = rule_of(s->m, s->n, i, j, s->block, s->block + s->count);
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
