/* SPDX-License-Identifier: Apache-2.0 */
/* Proves which patches of cloth cannot touch themselves, on the device.
 * spec/broad/cones.md */
#include "gpu/base/cluster.cuh"
#include "gpu/broad/bvtt.cuh"
#include "gpu/broad/cones.cuh"
#include "gpu/broad/nodes.cuh"

/* BITS: how many bits of `clear` a node has; a thread computes one of them.
 * TOP_BLOCK: the threads in a block of the cluster that computes the upper
 * levels of the BVH, which have few nodes. */
enum { BITS = CLEAR_NW + 1 };
#ifdef __CUDACC__
enum { TOP_BLOCK = 512 };
#else
enum { TOP_BLOCK = 64 };
#endif

/* §2: bounds of tangents, from the leaves up. */

/* Bounds the four edges of the cell with corner v, at one end of the step. */
static __device__ struct tangents cell_edges(const vec *x, int32_t v, int32_t m)
{
    vec a = x[v], b = x[v + 1], c = x[v + m], d = x[v + m + 1];
    vec u0 = sub(b, a), u1 = sub(d, c), v0 = sub(c, a), v1 = sub(d, b);
    struct tangents t = {min_of(u0, u1), max_of(u0, u1), min_of(v0, v1),
                         max_of(v0, v1)};
    return t;
}

static __device__ struct tangents bound_cell(const struct cones *s, int32_t a)
{
    const struct tree_grid *g = &s->map.grid[s->tree.mesh[a]];
    int32_t i = s->tree.place[a] & 0xffff, j = s->tree.place[a] >> 16;
    int32_t v = g->base + i + g->m * j;
    return join(cell_edges(s->x0, v, g->m), cell_edges(s->x1, v, g->m));
}

static __device__ struct tangents *inner(const struct cones *s, int32_t a)
{
    return &s->tangents[a - (s->tree.n_cloth - s->n_inner)];
}

/* Returns the tangent bounds of a full node of level l. A leaf's are computed
 * here, as few leaves are read twice. */
static __device__ struct tangents tangents_of(const struct cones *s, int l,
                                              int32_t a)
{
    return l ? fetch_as<word16>(inner(s, a)) : bound_cell(s, a);
}

static __device__ void fit_node(const struct cones *s, int l, int32_t a)
{
    if (!s->map.full[a] || !s->stir[a])
        return;
    int32_t c = s->tree.first[a];
    struct tangents b = tangents_of(s, l - 1, c);
    for (int k = 1; k < s->tree.count[a]; k++)
        b = join(b, tangents_of(s, l - 1, c + k));
    put_as<word16>(inner(s, a), b);
}

/* §4, §5: the bits of `clear`, from the root down. */

/* The grid of a node, and the node's position on its level. */
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

/* Returns the node at offset (di, dj) from the spot on its level, or -1. */
static __device__ int32_t find_neighbour(const struct cones *s,
                                         const struct spot *p, int di, int dj)
{
    int i = p->i + di, j = p->j + dj;
    if (i < 0 || j < 0 || i >= p->w || j >= p->h)
        return -1;
    return s->map.at[p->g->at[p->l] + i + p->w * j];
}

/* §4 for a full node a at spot p and its neighbour. The reference joins some
 * nodes twice; joining a node once can only change the sign of a zero, which no
 * comparison of spread() sees. */
static __device__ bool patch_spread(const struct cones *s, int32_t a,
                                    const struct spot *p, int di, int dj)
{
    struct tangents b = tangents_of(s, p->l, a);
    for (int k = 1; k < 4; k++) {
        if ((k & 1 && !di) || (k & 2 && !dj))
            continue;
        int32_t c = find_neighbour(s, p, k & 1 ? di : 0, k & 2 ? dj : 0);
        if (c < 0 || !s->map.full[c])
            return false;
        b = join(b, tangents_of(s, p->l, c));
    }
    return spread(b, s->r);
}

/* Node a and its neighbour b in the direction of bit k; b is -1 where there is
 * no neighbour. */
struct neighbour {
    struct spot p;
    int di, dj;
    struct duo e;
};

static __device__ struct neighbour neighbour_of(const struct cones *s,
                                                int32_t a, int k)
{
    /* directions (0,0) (1,0) (1,1) (0,1) (-1,1) */
    int dj = k >= CLEAR_NE, di = k ? (dj ? CLEAR_N - k : 1) : 0;
    struct spot p = spot_of(s, a);
    return neighbour{p, di, dj, {a, find_neighbour(s, &p, di, dj)}};
}

static __device__ bool spread_neighbour(const struct cones *s,
                                        const struct neighbour *n)
{
    return s->map.full[n->e.a] && patch_spread(s, n->e.a, &n->p, n->di, n->dj);
}

/* Returns the pair of the parents of two neighbours; a < 0 above root nodes. */
static __device__ struct duo above(const struct tree *t, struct duo e)
{
    return duo{t->parent[e.a], t->parent[e.b]};
}

/* Whether a node of the pair stirs. Otherwise the pair keeps its bit (§6). */
static __device__ bool stirs(const struct cones *s, struct duo e)
{
    return s->stir[e.a] | s->stir[e.b];
}
static __device__ bool kept(const struct cones *s, struct duo e, int k)
{
    return s->clear[e.a] >> k & 1;
}

/* §5: a pair of neighbours is clear if the pair of parents is, or by the test
 * of §4. */
static __device__ bool clear_neighbour(const struct cones *s, int32_t a, int k)
{
    struct neighbour n = neighbour_of(s, a, k);
    if (n.e.b < 0)
        return false;
    if (!stirs(s, n.e))
        return kept(s, n.e, k);
    struct duo up = above(&s->tree, n.e);
    return (up.a >= 0 && cleared(&s->tree, s->clear, up)) ||
           spread_neighbour(s, &n);
}

/* Returns the bit by §4 alone, or the kept bit (§6). */
static __device__ bool clear_alone(const struct cones *s, int32_t a, int k)
{
    struct neighbour n = neighbour_of(s, a, k);
    if (n.e.b < 0)
        return false;
    return stirs(s, n.e) ? spread_neighbour(s, &n) : kept(s, n.e, k);
}

/* Returns the bit by §5: whether some pair above is clear. The `clear` bits of
 * the pairs above must hold at least the result of §4. */
static __device__ bool clear_above(const struct cones *s, int32_t a, int k)
{
    struct duo e = neighbour_of(s, a, k).e;
    if (e.b < 0 || !stirs(s, e))
        return false;
    bool found = false;
    for (e = above(&s->tree, e); e.a >= 0 && !found;) {
        struct duo next = above(&s->tree, e); /* loaded early to hide latency */
        found = cleared(&s->tree, s->clear, e);
        e = next;
    }
    return found;
}

static __device__ uint8_t joined(const uint8_t *bit)
{
    int bits = 0;
    for (int k = 0; k < BITS; k++)
        bits |= bit[k] << k;
    return (uint8_t)bits;
}

/* Each thread owns nodes of level l in a grid-stride loop and writes their
 * tangents. The level below must be complete. */
KERNEL cones_level_kernel(const struct cones &s, int l)
{
    EACH_NODE(a, s.tree, 1, l)
    fit_node(&s, l, a);
}

/* Each thread owns a bit of nodes of level l in a grid-stride loop; the first
 * threads of a block write the nodes' `clear`. The tangents of all levels and
 * `clear` of the level above must be complete. */
KERNEL cones_mark_kernel(const struct cones &s, int l)
{
    enum { NODES = GPU_BLOCK / (int)BITS };
    __shared__ uint8_t bit[GPU_BLOCK];
    int t = (int)threadIdx.x;
    for (int64_t first = (int64_t)blockIdx.x * NODES;
         level_node(&s.tree, 1, l, first) >= 0;
         first += (int64_t)gridDim.x * NODES) {
        int64_t a = level_node(&s.tree, 1, l, first + t / BITS);
        bit[t] = a >= 0 && clear_neighbour(&s, (int32_t)a, t % BITS);
        __syncthreads();
        a = level_node(&s.tree, 1, l, first + t);
        if (t < NODES && a >= 0)
            s.clear[a] = joined(bit + BITS * t);
        __syncthreads();
    }
}

/* Computes the bits of all nodes of level l and above, one bit a thread: first
 * by §4 alone, then by walking up (§5). In the second phase a bit that is read
 * may already be final, which does not change the result. The bits of a node
 * are joined in memory that no other block reads. */
static __device__ void mark_top(const struct cones *s, int l, bool entire)
{
    uint8_t *bit = (uint8_t *)cluster_shared();
    int t = rank_thread(), nodes = rank_threads() / BITS;
    int64_t end = s->tree.n_cloth, step = (int64_t)group_ranks() * nodes;
    for (int64_t all = s->tree.range[l]; all < end; all += step) {
        int64_t first = all + group_rank() * nodes, a = first + t / BITS;
        if (t < BITS * nodes && a < end)
            bit[t] = entire ? clear_above(s, (int32_t)a, t % BITS)
                            : clear_alone(s, (int32_t)a, t % BITS);
        cluster_sync(!entire);
        a = first + t;
        if (t < nodes && a < end)
            s->clear[a] = joined(bit + BITS * t) | (entire ? s->clear[a] : 0);
        cluster_sync(false);
    }
}

/* One thread-block cluster computes the tangents of level l and above, then
 * their bits. */
KERNEL cones_top_kernel(const struct cones &s, int l)
{
    for (int k = l; k < s.tree.levels; k++) {
        EACH_NODE(a, s.tree, 1, k)
        fit_node(&s, k, a);
        cluster_sync(false);
    }
    mark_top(&s, l, false);
    mark_top(&s, l, true);
}

/* Returns the number of blocks for level l of a tree of n nodes. */
static int64_t mark_blocks(int64_t n, int l)
{
    return level_threads(n, l) * BITS / GPU_BLOCK + 1;
}

int gpu_cones(struct gpu *g, struct cones *s)
{
    if (!(s->r >= 0 && s->r <= REAL_BIG))
        return DRAPE_EDATA;
    int64_t n = s->tree.n_cloth;
    int top = level_top(n, s->tree.levels);
    for (int l = 1; l < top; l++)
        LAUNCH(g, level_threads(n, l), cones_level_kernel, *s, l);
    if (n > 0 && top < s->tree.levels)
        LAUNCH_CLUSTER(g, TOP_BLOCK, TOP_BLOCK, cones_top_kernel, *s, top);
    for (int l = top - 1; l >= 0 && n > 0; l--)
        LAUNCH_BLOCKS(g, mark_blocks(n, l), GPU_BLOCK, cones_mark_kernel, *s,
                      l);
    return gpu_status(g);
}
