/* SPDX-License-Identifier: Apache-2.0 */
/* Traverses the BVTT on the device from the front down to pairs of triangles.
 * spec/broad/walk.md */
#include "gpu/broad/passes.cuh"

extern "C" {
#include "ref/broad/walk.h"
}

/* Words of gpu_words: the most node pairs that a pass made, the triangle pairs,
 * the node pairs visited, the pairs that only cones rejected, and the tiles
 * with a child that is no leaf. */
enum { WORD_NEED, WORD_TRI, WORD_VISITED, WORD_CLEARED, WORD_DEEPER, WORDS };
/* KIDS threads share an item when its children are tested, one for each child.
 * In large blocks FOURS threads share an item when its triangles are tested and
 * its outputs are written. */
enum { KIDS = 16, FOURS = 4 };

/* The input and output streams of one pass. */
struct pass {
    const int32_t (*from)[2];
    int64_t n;
    int32_t (*to)[2];
    bool front; /* true: these are the front's own pairs, not tested yet */
    struct tiles tiles;
    int64_t *word;
};

/* §1: whether a pair passes. *stopped counts the pairs that only the cones
 * reject. */
template <class BOX>
static __device__ bool passes(const struct walk *s, real reach, struct duo e,
                              uint32_t *stopped)
{
    if (!(s->stir[e.a] | s->stir[e.b]) || !boxes_meet<BOX>(&s->in, reach, e))
        return false;
    bool clear = cleared(&s->in.tree, s->in.clear, e);
    *stopped += clear;
    return !clear;
}

/* Shared state of a tile while its items are processed. */
struct work {
    uint32_t mask[BVTT_BLOCK]; /* children that pass */
    uint32_t stopped, deeper;
};

/* Writes the masks and the counts of a tile. All masks must be complete. */
static __device__ void count(const struct walk *s, const struct pass *p,
                             const struct work *w, int64_t tile)
{
    int t = rank_thread();
    int64_t k = tile * BVTT_BLOCK + t;
    uint32_t total, mask = t < BVTT_BLOCK ? w->mask[t] : 0;
    if (t < BVTT_BLOCK && k < p->n)
        s->mask[k] = (uint16_t)mask;
    block_scan(t, (uint32_t)__popc(mask), &total);
    if (t == 0) {
        p->tiles.sum[tile] = total;
        word_add(&p->word[WORD_CLEARED], w->stopped);
        word_add(&p->word[WORD_DEEPER], w->deeper);
    }
}

/* Resets the shared state before a tile. */
static __device__ void begin(struct work *w)
{
    int t = rank_thread();
    __syncthreads(); /* the state of the last tile may still be read */
    if (t < BVTT_BLOCK)
        w->mask[t] = 0;
    if (t == 0)
        w->stopped = w->deeper = 0;
}

/* §1: finds the children that pass, for a tile. One thread lists an item's
 * children and sixteen threads test them, since they read the same few
 * boxes. */
template <class BOX>
static __device__ void test_children(const struct walk *s, const struct pass *p,
                                     real reach, int64_t tile)
{
    __shared__ struct work w;
    __shared__ struct duo item[BVTT_BLOCK];
    __shared__ uint32_t kids[BVTT_BLOCK];
    int t = rank_thread(), c = t % KIDS;
    int64_t k = tile * BVTT_BLOCK + t;
    uint32_t stopped = 0;
    begin(&w);
    if (t < BVTT_BLOCK)
        kids[t] = 0;
    if (t < BVTT_BLOCK && k < p->n) {
        struct duo e = fetch_duo(&p->from[k]);
        int d = descent(&s->in.tree, e);
        item[t] = e;
        if (!p->front || passes<BOX>(s, reach, e, &stopped)) {
            w.mask[t] = d == 0; /* a pair of leaves counts as its own only
                                   child */
            kids[t] = d ? children(&s->in.tree, d, e) | (uint32_t)d << KIDS : 0;
        }
    }
    __syncthreads();
    for (int i = t / KIDS; i < BVTT_BLOCK; i += rank_threads() / KIDS) {
        if (!(kids[i] >> c & 1))
            continue;
        struct duo e = child(&s->in.tree, kids[i] >> KIDS, c, item[i]);
        if (!passes<BOX>(s, reach, e, &stopped))
            continue;
        atomicOr(&w.mask[i], 1u << c);
        if (descent(&s->in.tree, e))
            w.deeper = 1;
    }
    if (stopped)
        atomicAdd(&w.stopped, stopped);
    __syncthreads();
    count(s, p, &w, tile);
}

/* §2: tests EACH triangles, from i on, of the first of two leaves against all
 * triangles of the second, whose boxes are in registers in a still query. */
template <class BOX, int EACH>
static __device__ uint32_t test_triangles(const struct walk *s, real reach,
                                          struct duo e, int i)
{
    enum { STILL = sizeof(BOX) < sizeof(struct box) };
    const struct tree *t = &s->in.tree;
    const int32_t *of_a = t->order + t->first[e.a];
    const int32_t *of_b = t->order + t->first[e.b];
    int na = min_of((int)t->count[e.a], i + EACH), nb = t->count[e.b];
    BOX b[FOURS];
    uint32_t mask = 0;
    UNROLL_IF(STILL)
    for (int j = 0; j < FOURS; j++)
        if (j < nb && i < na)
            b[j] = face_box<BOX>(s->x0, s->x1, t->tri[of_b[j]]);
    UNROLL_IF(false)
    for (; i < na; i++) {
        BOX a = face_box<BOX>(s->x0, s->x1, t->tri[of_a[i]]);
        UNROLL_IF(STILL)
        for (int j = 0; j < FOURS; j++)
            if (j < nb && (j > i || e.a != e.b) && meets(a, b[j], reach))
                mask |= 1u << (4 * i + j);
    }
    return mask;
}

/* Runs look_triangles for a tile of pairs of leaves; SHARE threads share a
 * pair. */
template <class BOX, int THREADS_EACH>
static __device__ void test_leaves(const struct walk *s, const struct pass *p,
                                   real reach, int64_t tile)
{
    enum { EACH = FOURS / THREADS_EACH };
    __shared__ struct work w;
    int t = rank_thread();
    begin(&w);
    __syncthreads();
    for (int i = t / THREADS_EACH; i < BVTT_BLOCK;
         i += rank_threads() / THREADS_EACH) {
        int64_t k = tile * BVTT_BLOCK + i;
        if (k >= p->n)
            break;
        uint32_t mask = test_triangles<BOX, EACH>(
            s, reach, fetch_duo(&p->from[k]), t % THREADS_EACH * EACH);
        if (mask)
            atomicOr(&w.mask[i], mask);
    }
    __syncthreads();
    count(s, p, &w, tile);
}

/* Writes the children that a tile's masks name, or their triangles, from the
 * tile's place on; SHARE threads share an item. */
template <int THREADS_EACH>
static __device__ void emit(const struct walk *s, const struct pass *p,
                            int64_t tile, bool triangles)
{
    enum { EACH = KIDS / THREADS_EACH };
    __shared__ uint32_t before[BVTT_BLOCK];
    const struct tree *tree = &s->in.tree;
    int t = rank_thread(), c = t % THREADS_EACH * EACH;
    int64_t first = tile * BVTT_BLOCK;
    bool there = t < BVTT_BLOCK && first + t < p->n;
    uint32_t total, own = there ? (uint32_t)__popc(s->mask[first + t]) : 0;
    own = block_scan(t, own, &total);
    if (t < BVTT_BLOCK)
        before[t] = own;
    __syncthreads();
    for (int i = t / THREADS_EACH; i < BVTT_BLOCK;
         i += rank_threads() / THREADS_EACH) {
        uint32_t mask = first + i < p->n ? s->mask[first + i] : 0;
        uint32_t mine = mask >> c & ((1u << EACH) - 1);
        if (!mine)
            continue;
        struct duo e = fetch_duo(&p->from[first + i]);
        int d = triangles ? 3 : descent(tree, e);
        int64_t at =
            p->tiles.place[tile] + before[i] + __popc(mask & ((1u << c) - 1));
        for (int k = c; mine; k++, mine >>= 1)
            if (mine & 1) {
                struct duo to = child(tree, d, k, e);
                if (triangles)
                    to = {tree->order[to.a], tree->order[to.b]};
                put_duo(&p->to[at++], to);
            }
    }
}

/* Finishes a pass whose counts are complete: scans them and writes the outputs
 * if the capacity suffices. Returns the number of outputs. */
template <int THREADS_EACH, bool GRID>
static __device__ int64_t finish(const struct walk *s, const struct pass *p,
                                 int64_t cap, bool triangles)
{
    group_sync<GRID>();
    int64_t need = place_tiles(&p->tiles, blocks_of(p->n));
    EACH_TILE(tile, need <= cap ? blocks_of(p->n) : 0)
    emit<THREADS_EACH>(s, p, tile, triangles);
    return need;
}

/* §1: makes passes until all pairs are leaves or the capacity is too small. The
 * counters in words are visible after the first barrier of a pass. Returns the
 * largest number of pairs that a pass made. */
template <class BOX, int THREADS_EACH, bool GRID>
static __device__ int64_t go_down(const struct walk *s, struct pass *p,
                                  real reach, int64_t *visited)
{
    int64_t need = p->n, deeper = 0;
    for (bool last = false; !last && need <= s->cap;) {
        EACH_TILE(tile, blocks_of(p->n))
        test_children<BOX>(s, p, reach, tile);
        int64_t made = finish<THREADS_EACH, GRID>(s, p, s->cap, false);
        last = p->word[WORD_DEEPER] == deeper;
        deeper = p->word[WORD_DEEPER];
        *visited += p->n;
        need = max_of(need, made);
        group_sync<GRID>();
        p->from = (const int32_t(*)[2])p->to;
        p->to = p->to == s->pair ? s->other : s->pair;
        p->front = false;
        p->n = made;
    }
    return need;
}

/* Runs the descent of §1, then the triangles of §2. */
template <class BOX, int BLOCKS, bool GRID>
static __device__ void run(const struct walk &s, struct pass p, real reach)
{
    enum { THREADS_EACH = BLOCKS > 1 ? 1 : FOURS };
    int64_t visited = 0, triangles = 0;
    int64_t need = go_down<BOX, THREADS_EACH, GRID>(&s, &p, reach, &visited);
    if (need <= s.cap) {
        p.to = s.tri;
        EACH_TILE(tile, blocks_of(p.n))
        test_leaves<BOX, THREADS_EACH>(&s, &p, reach, tile);
        triangles = finish<THREADS_EACH, GRID>(&s, &p, s.cap_tri, true);
    }
    if (group_rank() == 0 && rank_thread() == 0) {
        p.word[WORD_NEED] = need;
        p.word[WORD_TRI] = triangles;
        p.word[WORD_VISITED] = visited;
    }
}

template <int BLOCKS, bool GRID>
KERNEL walk_kernel(const struct walk &s, struct pass p, real reach)
{
    run<struct box, BLOCKS, GRID>(s, p, reach);
}

template <int BLOCKS, bool GRID>
KERNEL walk_still_kernel(const struct walk &s, struct pass p, real reach)
{
    run<struct still_box, BLOCKS, GRID>(s, p, reach);
}

int gpu_walk(struct gpu *g, struct walk *s)
{
    struct pass p = {s->front, s->n_front, s->pair, true, {}, NULL};
    if (!(s->in.r >= 0 && s->in.r <= REAL_BIG))
        return DRAPE_EDATA;
    s->n_tri = s->need_tri = s->visited = s->cleared = 0;
    s->need = s->n_front;
    if (s->n_front > s->cap)
        return DRAPE_EFULL;
    if (!take_tiles(g, s->cap, &p.tiles))
        return gpu_status(g);
    p.word = gpu_words(g);
    if (s->x0 == s->x1)
        LAUNCH_PASSES(g, s->n_front, walk_still_kernel, *s, p,
                      reach_of(s->in.r));
    else
        LAUNCH_PASSES(g, s->n_front, walk_kernel, *s, p, reach_of(s->in.r));
    const int64_t *seen = gpu_read_back(g, WORDS);
    if (gpu_status(g) != DRAPE_OK)
        return gpu_status(g);
    s->need = seen[WORD_NEED];
    s->need_tri = seen[WORD_TRI];
    s->visited = seen[WORD_VISITED];
    s->cleared = seen[WORD_CLEARED];
    if (s->need > s->cap || s->need_tri > s->cap_tri)
        return DRAPE_EFULL;
    s->n_tri = s->need_tri;
    return DRAPE_OK;
}
