/* SPDX-License-Identifier: Apache-2.0 */
/* Galerkin coarsening with bilinear interpolation. spec/14_multigrid.md §2 */
#include "gpu/coarsen.cuh"

#include "gpu/jacobi.cuh"

/* `weight` sixteenths of fine block o of the particle at (di, dj) from the
 * coarse one's place. */
struct term {
    int8_t o, di, dj, weight;
};

/* Terms of one coarse direction, and of all; AROUND: origins of ties that
 * may reach a coarse particle. */
enum { TERMS = 64, AROUND = 7 * 5 };
struct recipe {
    int terms;
    struct term term[TERMS];
};
struct book {
    struct recipe recipe[STENCIL];
};

/* ---- the recipes, where nothing is cut: made on the host ---- */

/* Four times the bilinear weight at (i, j) of a coarse particle at 0. */
static int hat(int i, int j)
{
    int a = i < 0 ? -i : i, b = j < 0 ? -j : j;
    return (a < 2 ? 2 - a : 0) * (b < 2 ? 2 - b : 0);
}

/* -(wᵢ - wᵢ')(wⱼ - wⱼ') of all ties for coarse direction `to`. */
template <int TIES> static void write_recipe(struct recipe *r, int to)
{
    int ci = 2 * toward_i<STENCIL>(to), cj = 2 * toward_j<STENCIL>(to);
    memset((void *)r, 0, sizeof *r);
    for (int k = 0; k < TIES * AROUND; k++) {
        int o = k / AROUND, di = k % AROUND % 7 - 3, dj = k % AROUND / 7 - 3;
        int zi = di + toward_i<TIES>(o), zj = dj + toward_j<TIES>(o);
        int a = hat(di, dj) - hat(zi, zj);
        int b = hat(di - ci, dj - cj) - hat(zi - ci, zj - cj);
        struct term t = {(int8_t)o, (int8_t)di, (int8_t)dj, (int8_t)(-a * b)};
        if (a * b != 0 && r->terms < TERMS)
            r->term[r->terms++] = t;
    }
}

template <int TIES> static struct book write_book(void)
{
    struct book b;
    for (int o = 0; o < STENCIL; o++)
        write_recipe<TIES>(&b.recipe[o], o);
    return b;
}

/* Written once: that takes as long as a grid's kernels. */
template <int TIES> static const struct book *book_of(void)
{
    static const struct book book = write_book<TIES>();
    return &book;
}

/* ---- kernels ---- */

static __device__ sym plus(sym a, real w, sym b)
{
    return sym{a.xx + w * b.xx, a.xy + w * b.xy, a.xz + w * b.xz,
               a.yy + w * b.yy, a.yz + w * b.yz, a.zz + w * b.zz};
}

/* Four times the weight of coarse (ci, cj) in fine (x, y). */
static __device__ int weight(const struct coarsen *s, int x, int y, int ci,
                             int cj)
{
    if (!within(grid{s->m, s->n}, x, y))
        return 0;
    return part_of(s->rule[x + s->m * y], x - 2 * ci, y - 2 * cj);
}

/* Thread p of the coarse particles: whether one that matters to it has a
 * rule, into coarse_rule[p], which is not needed for itself yet. */
static __global__ void __launch_bounds__(GPU_BLOCK)
    coarsen_find_kernel(struct coarsen s, struct grid c)
{
    ITEM(item, s.n_coarse);
    struct place at = place_of(c, item);
    int x0 = most(2 * at.i - 5, 0), x1 = least(2 * at.i + 5, s.m - 1);
    int y0 = most(2 * at.j - 3, 0), y1 = least(2 * at.j + 5, s.n - 1);
    int cut = 0;
    for (int y = y0; y <= y1; y++)
        for (int x = x0; x <= x1; x++)
            cut |= s.rule[x + s.m * y];
    s.coarse_rule[at.p] = (uint8_t)cut;
}

/* The sum of a recipe at a coarse particle. AHEAD terms are read before the
 * first is added, as a thread has nothing else to wait for. */
static __device__ sym cook(const struct coarsen *s, const struct recipe *r,
                           struct place at)
{
    enum { AHEAD = 8 };
    struct grid f = {s->m, s->n};
    sym sum = {0, 0, 0, 0, 0, 0};
    for (int first = 0; first < r->terms; first += AHEAD) {
        sym block[AHEAD];
        real weight[AHEAD];
        UNROLL
        for (int k = 0; k < AHEAD; k++) {
            struct term t = r->term[first + k]; /* 0 behind the last */
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

/* Four times the weights of coarse (ci, cj) in the nine fine particles around
 * its place, four bits each. */
static __device__ uint64_t weights_near(const struct coarsen *s, int ci, int cj)
{
    uint64_t all = 0;
    for (int k = 0; k < 9; k++) {
        int x = 2 * ci + k % 3 - 1, y = 2 * cj + k / 3 - 1;
        all |= (uint64_t)weight(s, x, y, ci, cj) << 4 * k;
    }
    return all;
}

/* The one that is (dx, dy) from the place. */
static __device__ int pick_weight(uint64_t all, int dx, int dy)
{
    bool near = (unsigned)(dx + 1) < 3u && (unsigned)(dy + 1) < 3u;
    return near ? (int)(all >> 4 * (dx + 1 + 3 * (dy + 1)) & 15) : 0;
}

/* The same terms in the same order from the rules, for coarse direction
 * (ci, cj), TIES springs or couplings. */
template <int TIES>
static __device__ sym cook_cut(const struct coarsen *s, struct place at, int ci,
                               int cj)
{
    struct grid f = {s->m, s->n};
    sym sum = {0, 0, 0, 0, 0, 0};
    uint64_t here = weights_near(s, at.i, at.j);
    uint64_t there = weights_near(s, at.i + ci, at.j + cj);
    for (int k = 0; k < TIES * AROUND; k++) {
        int o = k / AROUND, dx = k % AROUND % 7 - 3, dy = k % AROUND / 7 - 3;
        int zx = dx + toward_i<TIES>(o), zy = dy + toward_j<TIES>(o);
        int a = pick_weight(here, dx, dy) - pick_weight(here, zx, zy);
        int b = pick_weight(there, dx - 2 * ci, dy - 2 * cj) -
                pick_weight(there, zx - 2 * ci, zy - 2 * cj);
        int x = 2 * at.i + dx, y = 2 * at.j + dy, p = x + s->m * y;
        if (a * b == 0 || !within(f, x, y) ||
            !within(f, 2 * at.i + zx, 2 * at.j + zy) ||
            (TIES == SPRINGS && !(s->live[p] >> o & 1)))
            continue;
        sum = plus(sum, (real)(-a * b) * R(0.0625),
                   fetch(&s->block[o * s->count + p]));
    }
    return sum;
}

/* What the fine excess gives to coarse direction (ci, cj), or to the particle
 * itself. */
static __device__ sym share(const struct coarsen *s, struct place at, int ci,
                            int cj)
{
    sym sum = {0, 0, 0, 0, 0, 0};
    for (int k = 0; k < 9; k++) {
        int x = 2 * at.i + k % 3 - 1, y = 2 * at.j + k / 3 - 1;
        int a = weight(s, x, y, at.i, at.j);
        int w = ci == 0 && cj == 0 ? 4 * a
                                   : -a * weight(s, x, y, at.i + ci, at.j + cj);
        if (w != 0)
            sum = plus(sum, (real)w * R(0.0625), s->excess[x + s->m * y]);
    }
    return sum;
}

/* Item o·n_coarse + p owns coarse block o of coarse particle p; those behind
 * the last direction own the excess of p. Reads coarse_rule as found above. */
static __global__ void __launch_bounds__(GPU_BLOCK)
    coarsen_kernel(struct coarsen s, struct grid c,
                   const __grid_constant__ struct book book)
{
    ITEM(item, (STENCIL + 1) * s.n_coarse);
    int o = (int)(item / s.n_coarse);
    struct place at = place_of(c, item - o * s.n_coarse);
    if (o == STENCIL) {
        s.coarse_excess[at.p] = share(&s, at, 0, 0);
        return;
    }
    int ci = toward_i<STENCIL>(o), cj = toward_j<STENCIL>(o);
    sym sum;
    if (!s.coarse_rule[at.p])
        sum = cook(&s, &book.recipe[o], at);
    else if (s.n_live)
        sum = cook_cut<SPRINGS>(&s, at, ci, cj);
    else
        sum = cook_cut<STENCIL>(&s, at, ci, cj);
    if (ci >= -1 && ci <= 1 && cj <= 1)
        sum = add(sum, share(&s, at, ci, cj));
    s.coarse_block[item] = sum;
}

/* Thread p of the coarse particles owns factor[p] and coarse_rule[p]; reads
 * coarse blocks and excess of all. §3 */
static __global__ void __launch_bounds__(GPU_BLOCK)
    coarsen_factor_kernel(struct coarsen s, struct grid c)
{
    ITEM(item, s.n_coarse);
    struct place at = place_of(c, item);
    struct wide_sym d = {{0, 0, 0, 0, 0, 0}};
    d = add(d, s.coarse_excess[at.p]);
    for (int o = 0; o < STENCIL; o++) {
        const sym *block = s.coarse_block + o * s.n_coarse;
        int di = toward_i<STENCIL>(o), dj = toward_j<STENCIL>(o);
        d = add(d, fetch(block + at.p));
        if (within(c, at.i - di, at.j - dj))
            d = add(d, fetch(block + (at.p - (di + c.m * dj))));
    }
    s.factor[at.p] = factored(d);
    s.coarse_rule[at.p] = rule_at(c, at, s.coarse_block,
                                  s.coarse_block + STENCIL_UP * s.n_coarse);
}

int gpu_coarsen(struct gpu *g, struct coarsen *s)
{
    struct grid c = {s->m / 2 + 1, s->n / 2 + 1};
    bool springs = s->n_live > 0;
    if (s->m < 1 || s->n < 1 || s->count != (int64_t)s->m * s->n ||
        s->n_blocks != (springs ? (int)SPRINGS : (int)STENCIL) * s->count ||
        (springs && s->n_live != s->count) ||
        s->n_coarse != (int64_t)c.m * c.n || s->n_out != STENCIL * s->n_coarse)
        return DRAPE_EARG;
    const struct book *book = springs ? book_of<SPRINGS>() : book_of<STENCIL>();
    LAUNCH(g, s->n_coarse, coarsen_find_kernel, *s, c);
    LAUNCH(g, (STENCIL + 1) * s->n_coarse, coarsen_kernel, *s, c, *book);
    LAUNCH(g, s->n_coarse, coarsen_factor_kernel, *s, c);
    return gpu_status(g);
}
