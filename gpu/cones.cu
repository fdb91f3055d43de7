/* SPDX-License-Identifier: Apache-2.0 */
/* Which patches of cloth cannot touch themselves. spec/21_cones.md */
#include "gpu/bvtt.cuh"
#include "gpu/nodes.cuh"

static __device__ struct tangents join(const struct tangents &a,
                                       const struct tangents &b)
{
    struct tangents c = {least(a.ulo, b.ulo), most(a.uhi, b.uhi),
                         least(a.vlo, b.vlo), most(a.vhi, b.vhi)};
    return c;
}

/* ---- §2, from the leaves up ---- */

/* The four edges of the cell with corner v at one end of the step. */
static __device__ struct tangents cell(const vec *x, int32_t v, int32_t m)
{
    vec a = x[v], b = x[v + 1], c = x[v + m], d = x[v + m + 1];
    vec u0 = sub(b, a), u1 = sub(d, c), v0 = sub(c, a), v1 = sub(d, b);
    struct tangents t = {least(u0, u1), most(u0, u1), least(v0, v1),
                         most(v0, v1)};
    return t;
}

static __device__ void fit_leaf(const struct cones *s, int32_t a)
{
    if (!s->map.full[a])
        return;
    const struct tree_grid *g = &s->map.grid[s->tree.mesh[a]];
    int32_t i = s->tree.place[a] & 0xffff, j = s->tree.place[a] >> 16;
    int32_t v = g->base + i + g->m * j;
    put_as<word16>(&s->tangents[a],
                   join(cell(s->x0, v, g->m), cell(s->x1, v, g->m)));
}

static __device__ void fit_inner(const struct cones *s, int32_t a)
{
    if (!s->map.full[a])
        return;
    int32_t c = s->tree.first[a];
    struct tangents b = fetch_as<word16>(&s->tangents[c]);
    for (int k = 1; k < s->tree.count[a]; k++)
        b = join(b, fetch_as<word16>(&s->tangents[c + k]));
    put_as<word16>(&s->tangents[a], b);
}

/* ---- §3 ---- */

/* The range of p·x over a box, and the sum of its largest terms. */
struct span {
    real lo, hi, size;
};

static __device__ struct span span_axis(real p, real lo, real hi)
{
    real a = p * lo, b = p * hi;
    struct span s = {least(a, b), most(a, b), most(magnitude(a), magnitude(b))};
    return s;
}

static __device__ struct span span_dot(vec p, vec lo, vec hi)
{
    struct span x = span_axis(p.x, lo.x, hi.x);
    struct span y = span_axis(p.y, lo.y, hi.y);
    struct span z = span_axis(p.z, lo.z, hi.z);
    struct span s = {(x.lo + y.lo) + z.lo, (x.hi + y.hi) + z.hi,
                     (x.size + y.size) + z.size};
    return s;
}

/* Whether the tangents keep every two points of the patch more than r apart. */
static __device__ bool spread(const struct tangents &b, real r)
{
    const real room = 32 * REAL_UNIT, tiny = R(0x1p-100);
    vec u = scale(R(0.5), add(b.ulo, b.uhi));
    vec v = scale(R(0.5), add(b.vlo, b.vhi));
    real uu = dot(u, u), uv = dot(u, v), vv = dot(v, v);
    real det = uu * vv - uv * uv;
    if (!(det > 0))
        return false;
    vec pu = scale(1 / det, sub(scale(vv, u), scale(uv, v)));
    vec pv = scale(1 / det, sub(scale(uu, v), scale(uv, u)));
    struct span a = span_dot(pu, b.ulo, b.uhi);
    struct span d = span_dot(pv, b.vlo, b.vhi);
    struct span e = span_dot(pu, b.vlo, b.vhi);
    struct span f = span_dot(pv, b.ulo, b.uhi);
    real norm = root(dot(pu, pu) + dot(pv, pv));
    real mu = R(1.5) * r * norm * (1 + room) + tiny;
    real am = a.lo - (a.size * room + mu);
    real bm = d.lo - (d.size * room + mu);
    real c = R(0.5) * most(magnitude(e.lo + f.lo), magnitude(e.hi + f.hi));
    real cm = c + ((e.size + f.size) * room + tiny);
    return am > 0 && bm > 0 && am * bm > cm * cm;
}

/* ---- §4, §5, from the roots down ---- */

/* A node's grid and its place there. */
struct spot {
    const struct tree_grid *g;
    int l, i, j, w, h;
};

static __device__ struct spot spot_of(const struct cones *s, int32_t a)
{
    const struct tree_grid *g = &s->map.grid[s->tree.mesh[a]];
    int l = s->tree.level[a], less = (1 << l) - 2;
    struct spot p = {g,
                     l,
                     s->tree.place[a] & 0xffff,
                     s->tree.place[a] >> 16,
                     (g->m + less) >> l,
                     (g->n + less) >> l};
    return p;
}

/* The node beside the spot on its level, or -1. */
static __device__ int32_t beside(const struct cones *s, const struct spot *p,
                                 int di, int dj)
{
    int i = p->i + di, j = p->j + dj;
    if (i < 0 || j < 0 || i >= p->w || j >= p->h)
        return -1;
    return s->map.at[p->g->at[p->l] + i + p->w * j];
}

/* §4 of a full node a at spot p and the one beside it. What is there already
 * is not joined again: that could change the sign of a zero only, and no
 * comparison of spread sees it. */
static __device__ bool patch_spread(const struct cones *s, int32_t a,
                                    const struct spot *p, int di, int dj)
{
    struct tangents b = fetch_as<word16>(&s->tangents[a]);
    for (int k = 1; k < 4; k++) {
        if ((k & 1 && !di) || (k & 2 && !dj))
            continue;
        int32_t c = beside(s, p, k & 1 ? di : 0, k & 2 ? dj : 0);
        if (c < 0 || !s->map.full[c])
            return false;
        b = join(b, fetch_as<word16>(&s->tangents[c]));
    }
    return spread(b, s->r);
}

/* §5: a pair of neighbours is clear if its parents are, or by itself. */
static __device__ void mark(const struct cones *s, int32_t a)
{
    struct spot p = spot_of(s, a);
    int32_t up = s->tree.parent[a];
    bool full = s->map.full[a];
    int bits = 0;
    for (int k = CLEAR_SELF; k <= CLEAR_NW; k++) {
        /* (0,0) (1,0) (1,1) (0,1) (-1,1) */
        int dj = k >= CLEAR_NE, di = k ? (dj ? CLEAR_N - k : 1) : 0;
        int32_t b = beside(s, &p, di, dj);
        if (b < 0)
            continue;
        struct duo above = {up, up < 0 ? up : s->tree.parent[b]};
        if ((up >= 0 && cleared(&s->tree, s->clear, above)) ||
            (full && patch_spread(s, a, &p, di, dj)))
            bits |= 1 << k;
    }
    s->clear[a] = (uint8_t)bits;
}

/* ---- Kernels ---- */

/* A thread owns every so-many-th leaf: writes its tangents. */
static __global__ void __launch_bounds__(GPU_BLOCK)
    cones_leaves_kernel(struct cones s)
{
    EACH_NODE(a, s.tree, 1, 0)
    fit_leaf(&s, a);
}

/* The same of nodes of level l, of which the level below is written. */
static __global__ void __launch_bounds__(GPU_BLOCK)
    cones_level_kernel(struct cones s, int l)
{
    EACH_NODE(a, s.tree, 1, l)
    fit_inner(&s, a);
}

/* The same: writes clear; tangents and clear of the level above are written. */
static __global__ void __launch_bounds__(GPU_BLOCK)
    cones_mark_kernel(struct cones s, int l)
{
    EACH_NODE(a, s.tree, 1, l)
    mark(&s, a);
}

/* One block: the levels from l up, and down again. */
static __global__ void __launch_bounds__(GPU_BLOCK)
    cones_top_kernel(struct cones s, int l)
{
    for (int k = l; k < s.tree.levels; k++) {
        EACH_NODE(a, s.tree, 1, k)
        fit_inner(&s, a);
        __syncthreads();
    }
    for (int k = (int)s.tree.levels - 1; k >= l; k--) {
        EACH_NODE(a, s.tree, 1, k)
        mark(&s, a);
        __syncthreads();
    }
}

int gpu_cones(struct gpu *g, struct cones *s)
{
    if (!(s->r >= 0 && s->r <= REAL_BIG))
        return DRAPE_EDATA;
    int64_t n = s->tree.n_cloth;
    int top = level_top(n, s->tree.levels);
    LAUNCH(g, n, cones_leaves_kernel, *s);
    for (int l = 1; l < top; l++)
        LAUNCH(g, level_threads(n, l), cones_level_kernel, *s, l);
    LAUNCH_BLOCKS(g, n > 0 && top < s->tree.levels, GPU_BLOCK, cones_top_kernel,
                  *s, top);
    for (int l = top - 1; l >= 0 && n > 0; l--)
        LAUNCH(g, level_threads(n, l), cones_mark_kernel, *s, l);
    return gpu_status(g);
}
