/* SPDX-License-Identifier: Apache-2.0 */
/* Galerkin coarsening at one coarse particle: its blocks, excess, factor and
 * rule. Several kernels use these functions. spec/solve/multigrid.md §2, §3 */
#ifndef GPU_GALERKIN_CUH
#define GPU_GALERKIN_CUH

#include "gpu/solve/coarsen.cuh"
#include "gpu/solve/jacobi.cuh"
#include "gpu/solve/recipe.cuh"

static __device__ inline sym plus(sym a, real w, sym b)
{
    return sym{a.xx + w * b.xx, a.xy + w * b.xy, a.xz + w * b.xz,
               a.yy + w * b.yy, a.yz + w * b.yz, a.zz + w * b.zz};
}

/* Returns four times the weight that fine particle (x, y) gives to coarse
 * particle (ci, cj). */
static __device__ inline int weight(const struct coarsen *s, int x, int y,
                                    int ci, int cj)
{
    if (!within(grid{s->m, s->n}, x, y))
        return 0;
    return part_of(s->rule[x + s->m * y], x - 2 * ci, y - 2 * cj);
}

/* Writes to coarse_rule[p] whether a fine particle that matters to coarse
 * particle p has a rule. coarse_rule gets the rules themselves only later. */
static __device__ inline void find(const struct coarsen *s, struct place at)
{
    int x0 = max_of(2 * at.i - 5, 0), x1 = min_of(2 * at.i + 5, s->m - 1);
    int y0 = max_of(2 * at.j - 3, 0), y1 = min_of(2 * at.j + 5, s->n - 1);
    int cut = 0;
    for (int y = y0; y <= y1; y++)
        for (int x = x0; x <= x1; x++)
            cut |= s->rule[x + s->m * y];
    s->coarse_rule[at.p] = (uint8_t)cut;
}

/* Returns the sum of a recipe's terms at a coarse particle. AHEAD terms are
 * read before the first is added, to hide the latency of memory. */
template <int AHEAD>
static __device__ inline sym cook(const struct coarsen *s,
                                  const struct recipe *r, struct place at)
{
    struct grid f = {s->m, s->n};
    sym sum = {0, 0, 0, 0, 0, 0};
    for (int first = 0; first < r->terms; first += AHEAD) {
        static_assert(TERMS % AHEAD == 0, "reads behind the last");
        sym block[AHEAD];
        real weight[AHEAD];
        UNROLL
        for (int k = 0; k < AHEAD; k++) {
            struct term t = r->term[first + k]; /* 0 after the last term */
            int x = 2 * at.i + t.di, y = 2 * at.j + t.dj, p = x + s->m * y;
            bool good = t.weight && within(f, x, y) &&
                        (!s->n_live || s->live[p] >> t.o & 1);
            weight[k] = good ? (real)t.weight * R(0.0625) : 0;
            block[k] = fetch(s->block + (good ? t.o * s->count + p : 0));
        }
        UNROLL
        for (int k = 0; k < AHEAD; k++)
            if (weight[k] != 0)
                sum = plus(sum, weight[k], block[k]);
    }
    return sum;
}

/* Returns four times the weights that the nine fine particles around coarse
 * particle (ci, cj) give to it, in four bits each. */
static __device__ inline uint64_t weights_near(const struct coarsen *s, int ci,
                                               int cj)
{
    uint64_t all = 0;
    for (int k = 0; k < 9; k++) {
        int x = 2 * ci + k % 3 - 1, y = 2 * cj + k / 3 - 1;
        all |= (uint64_t)weight(s, x, y, ci, cj) << 4 * k;
    }
    return all;
}

/* Returns the weight of the fine particle (dx, dy) steps away. */
static __device__ inline int pick_weight(uint64_t all, int dx, int dy)
{
    bool near = (unsigned)(dx + 1) < 3u && (unsigned)(dy + 1) < 3u;
    return near ? (int)(all >> 4 * (dx + 1 + 3 * (dy + 1)) & 15) : 0;
}

/* Returns the sum that `cook` returns, but with weights computed from the
 * rules: the same terms in the same order, for coarse direction (ci, cj).
 * EDGES: the fine grid's directions, those of springs or of couplings. */
template <int EDGES>
static __device__ inline sym cook_cut(const struct coarsen *s, struct place at,
                                      int ci, int cj)
{
    struct grid f = {s->m, s->n};
    sym sum = {0, 0, 0, 0, 0, 0};
    uint64_t here = weights_near(s, at.i, at.j);
    uint64_t there = weights_near(s, at.i + ci, at.j + cj);
    for (int k = 0; k < EDGES * AROUND; k++) {
        int o = k / AROUND, dx = k % AROUND % 7 - 3, dy = k % AROUND / 7 - 3;
        int zx = dx + toward_i<EDGES>(o), zy = dy + toward_j<EDGES>(o);
        int a = pick_weight(here, dx, dy) - pick_weight(here, zx, zy);
        int b = pick_weight(there, dx - 2 * ci, dy - 2 * cj) -
                pick_weight(there, zx - 2 * ci, zy - 2 * cj);
        int x = 2 * at.i + dx, y = 2 * at.j + dy, p = x + s->m * y;
        if (a * b == 0 || !within(f, x, y) ||
            !within(f, 2 * at.i + zx, 2 * at.j + zy) ||
            (EDGES == SPRINGS && !(s->live[p] >> o & 1)))
            continue;
        sum = plus(sum, (real)(-a * b) * R(0.0625),
                   fetch(&s->block[o * s->count + p]));
    }
    return sum;
}

/* Returns the contribution of the fine excess to coarse direction (ci, cj), or
 * for (0, 0) to the excess of the coarse particle. All terms are read before
 * the first is added. */
static __device__ inline sym coarse_sum(const struct coarsen *s,
                                        struct place at, int ci, int cj)
{
    enum { AROUND = 9 };
    sym sum = {0, 0, 0, 0, 0, 0}, excess[AROUND];
    int rule[AROUND];
    UNROLL
    for (int k = 0; k < AROUND; k++) {
        int x = 2 * at.i + k % 3 - 1, y = 2 * at.j + k / 3 - 1;
        bool good = within(grid{s->m, s->n}, x, y);
        int p = good ? x + s->m * y : 0;
        rule[k] = good ? s->rule[p] : -1;
        excess[k] = fetch(s->excess + p);
    }
    UNROLL
    for (int k = 0; k < AROUND; k++) {
        int dx = k % 3 - 1, dy = k / 3 - 1;
        int a = rule[k] < 0 ? 0 : part_of(rule[k], dx, dy);
        int w = ci == 0 && cj == 0
                    ? 4 * a
                    : -a * part_of(rule[k], dx - 2 * ci, dy - 2 * cj);
        sum = w != 0 ? plus(sum, (real)w * R(0.0625), excess[k]) : sum;
    }
    return sum;
}

/* Makes an item. Item o·n_coarse + p is block o of coarse particle p; the items
 * after the last direction are the excess of each p. coarse_rule must be as
 * `find` has left it. */
template <int AHEAD>
static __device__ inline void make_item(const struct coarsen *s, struct grid c,
                                        const struct book *book, int64_t item)
{
    int o = (int)(item / s->n_coarse);
    struct place at = place_of(c, item - o * s->n_coarse);
    if (o == STENCIL) {
        s->coarse_excess[at.p] = coarse_sum(s, at, 0, 0);
        return;
    }
    int ci = toward_i<STENCIL>(o), cj = toward_j<STENCIL>(o);
    sym sum;
    if (!s->coarse_rule[at.p])
        sum = cook<AHEAD>(s, &book->recipe[o], at);
    else if (s->n_live)
        sum = cook_cut<SPRINGS>(s, at, ci, cj);
    else
        sum = cook_cut<STENCIL>(s, at, ci, cj);
    if (ci >= -1 && ci <= 1 && cj <= 1)
        sum = add(sum, coarse_sum(s, at, ci, cj));
    s->coarse_block[item] = sum;
}

/* §3: makes factor[p] from the blocks around p and the excess of p. */
static __device__ inline void make_factor(const struct coarsen *s,
                                          struct grid c, struct place at)
{
    enum { AHEAD = 4 }; /* directions that are read before the first is added */
    struct wide_sym d = {{0, 0, 0, 0, 0, 0}};
    d = add(d, s->coarse_excess[at.p]);
    UNROLL
    for (int first = 0; first < STENCIL; first += AHEAD) {
        sym block[2 * AHEAD];
        bool good[2 * AHEAD];
        UNROLL
        for (int k = 0; k < 2 * AHEAD; k++) {
            int o = first + k / 2;
            int di = toward_i<STENCIL>(o), dj = toward_j<STENCIL>(o);
            good[k] = k % 2 == 0 || within(c, at.i - di, at.j - dj);
            int from = k % 2 && good[k] ? at.p - (di + c.m * dj) : at.p;
            block[k] = fetch(s->coarse_block + o * s->n_coarse + from);
        }
        UNROLL
        for (int k = 0; k < 2 * AHEAD; k++)
            d = good[k] ? add(d, block[k]) : d;
    }
    s->factor[at.p] = factored(d);
}

static __device__ inline int make_rule(const struct coarsen *s, struct grid c,
                                       struct place at)
{
    int rule = rule_at(c, at, s->coarse_block,
                       s->coarse_block + STENCIL_UP * s->n_coarse);
    s->coarse_rule[at.p] = (uint8_t)rule;
    return rule;
}

#endif
