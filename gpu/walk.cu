/* SPDX-License-Identifier: Apache-2.0 */
/* Walks from the front down to pairs of triangles. spec/23_walk.md */
#include "gpu/bvtt.cuh"

/* Passes that are queued before the host looks, and the words of each: how
 * many children pass, how many pairs cones stop, 1: some children are not
 * leaves, 1: they are written. */
enum { WORD_NEED, WORD_CLEARED, WORD_DEEPER, WORD_DONE, WORDS, PASSES = 3 };
/* Threads to an item where its children are tested, one for each. */
enum { KIDS = 16, AT_ONCE = BVTT_BLOCK / KIDS };

/* What a pass reads, and where it writes. */
struct pass {
    const int32_t (*from)[2];
    int64_t n;
    int32_t (*to)[2];
    real reach;
    bool front;    /* the front's own pairs are not tested yet */
    int64_t *word; /* [WORDS] of this pass, behind those of the ones before */
    int64_t bound; /* of items: its blocks are enough for so many */
    int64_t cap;   /* of to */
    bool later;    /* its items are what the pass before has written, not n */
};

/* The items of a pass, none if it is not to be. */
static __device__ int64_t items_of(const struct pass *p)
{
    const int64_t *before = p->word - WORDS;
    if (!p->later)
        return p->n;
    bool good = before[WORD_DONE] && before[WORD_DEEPER] &&
                before[WORD_NEED] <= p->bound;
    return good ? before[WORD_NEED] : 0;
}

/* Whether a pair passes; one that only its cones stop is counted. */
static __device__ bool looks(const struct walk *s, real reach, struct duo e,
                             uint32_t *stopped)
{
    if (!(s->stir[e.a] | s->stir[e.b]) || !boxes_meet(&s->in, reach, e))
        return false;
    bool clear = cleared(&s->in.tree, s->in.clear, e);
    *stopped += clear;
    return !clear;
}

/* Thread t's mask is known, and how many pairs it saw stopped: writes the mask
 * and the block's counts. */
static __device__ void count(const struct walk *s, const struct pass *p,
                             int64_t n, uint32_t mask, uint32_t stopped)
{
    int64_t k = (int64_t)blockIdx.x * BVTT_BLOCK + threadIdx.x;
    uint32_t total;
    if (k < n)
        s->mask[k] = (uint16_t)mask;
    block_scan((uint32_t)__popc(mask) | stopped << 16, &total);
    if (threadIdx.x == 0) {
        s->sum[blockIdx.x] = total & 0xffff;
        word_add(&p->word[WORD_NEED], total & 0xffff);
        word_add(&p->word[WORD_CLEARED], total >> 16);
    }
}

/* Block k owns items 256 k …: §1, children that pass, into mask, their number
 * into sum[k] and the words. A thread finds an item's children; sixteen test
 * them, since they read the same few boxes. */
static __global__ void __launch_bounds__(BVTT_BLOCK)
    walk_look_kernel(struct walk s, struct pass p)
{
    __shared__ struct duo item[BVTT_BLOCK];
    __shared__ uint32_t kids[BVTT_BLOCK], in[BVTT_BLOCK], deeper;
    int t = (int)threadIdx.x, c = t % KIDS;
    int64_t first = (int64_t)blockIdx.x * BVTT_BLOCK, k = first + t;
    int64_t n = items_of(&p);
    uint32_t stopped = 0;
    if (first >= n)
        return;
    kids[t] = in[t] = 0;
    if (t == 0)
        deeper = 0;
    if (k < n) {
        struct duo e = fetch_duo(&p.from[k]);
        int d = descent(&s.in.tree, e);
        item[t] = e;
        if (!p.front || looks(&s, p.reach, e, &stopped)) {
            in[t] = d == 0; /* a pair of leaves is its own child */
            kids[t] = d ? children(&s.in.tree, d, e) | (uint32_t)d << KIDS : 0;
        }
    }
    __syncthreads();
    for (int i = t / KIDS; i < BVTT_BLOCK; i += AT_ONCE) {
        if (!(kids[i] >> c & 1))
            continue;
        struct duo e = child(&s.in.tree, kids[i] >> KIDS, c, item[i]);
        if (!looks(&s, p.reach, e, &stopped))
            continue;
        atomicOr(&in[i], 1u << c);
        if (descent(&s.in.tree, e))
            deeper = 1;
    }
    __syncthreads();
    count(&s, &p, n, in[t], stopped);
    if (t == 0)
        word_add(&p.word[WORD_DEEPER], deeper);
}

/* §2: the pairs of triangles of two leaves whose boxes meet. */
static __device__ uint32_t look_leaves(const struct walk *s, real reach,
                                       struct duo e)
{
    const struct tree *t = &s->in.tree;
    const int32_t *of_a = t->order + t->first[e.a];
    const int32_t *of_b = t->order + t->first[e.b];
    int na = t->count[e.a], nb = t->count[e.b];
    struct box b[4];
    uint32_t mask = 0;
    for (int j = 0; j < nb; j++)
        b[j] = face_box(s->x0, s->x1, t->tri[of_b[j]]);
    for (int i = 0; i < na; i++) {
        struct box a = face_box(s->x0, s->x1, t->tri[of_a[i]]);
        for (int j = e.a == e.b ? i + 1 : 0; j < nb; j++)
            if (meets(a, b[j], reach))
                mask |= 1u << (4 * i + j);
    }
    return mask;
}

/* Block k owns pairs of leaves 256 k …: masks and counts as above. */
static __global__ void __launch_bounds__(BVTT_BLOCK)
    walk_leaves_kernel(struct walk s, struct pass p)
{
    int64_t k = (int64_t)blockIdx.x * BVTT_BLOCK + threadIdx.x;
    count(&s, &p, p.n,
          k < p.n ? look_leaves(&s, p.reach, fetch_duo(&p.from[k])) : 0, 0);
}

/* One block: where the blocks' children go, if there is room for all. */
static __global__ void __launch_bounds__(BVTT_BLOCK)
    walk_place_kernel(struct walk s, struct pass p)
{
    int64_t n = items_of(&p);
    bool on = n > 0 && p.word[WORD_NEED] <= p.cap;
    if (on)
        place_blocks(s.sum, (n + BVTT_BLOCK - 1) / BVTT_BLOCK);
    if (threadIdx.x == 0)
        p.word[WORD_DONE] = on;
}

/* Block k owns the same items: writes the children in mask, or their
 * triangles, from sum[k] on. */
static __global__ void __launch_bounds__(BVTT_BLOCK)
    walk_emit_kernel(struct walk s, struct pass p, bool triangles)
{
    int64_t first = (int64_t)blockIdx.x * BVTT_BLOCK, k = first + threadIdx.x;
    const struct tree *t = &s.in.tree;
    int64_t n = p.word[WORD_DONE] ? items_of(&p) : 0;
    if (first >= n)
        return;
    uint32_t mask = k < n ? s.mask[k] : 0, total;
    int64_t at = s.sum[blockIdx.x] + block_scan((uint32_t)__popc(mask), &total);
    if (!mask)
        return;
    struct duo e = fetch_duo(&p.from[k]);
    int d = triangles ? 3 : descent(t, e);
    for (int c = 0; mask; c++, mask >>= 1)
        if (mask & 1) {
            struct duo to = child(t, d, c, e);
            if (triangles)
                to = {t->order[to.a], t->order[to.b]};
            put_duo(&p.to[at++], to);
        }
}

static void turn(const struct walk *s, struct pass *p)
{
    p->from = (const int32_t(*)[2])p->to;
    p->to = p->to == s->pair ? s->other : s->pair;
    p->front = false;
}

/* PASSES passes, each if the one before was not the last, and what they
 * counted. */
static const int64_t *queue(struct gpu *g, const struct walk *s, struct pass p)
{
    int64_t blocks = blocks_of(p.n);
    p.word = gpu_words(g);
    for (int k = 0; k < PASSES; k++) {
        LAUNCH_BLOCKS(g, blocks, BVTT_BLOCK, walk_look_kernel, *s, p);
        LAUNCH_BLOCKS(g, 1, BVTT_BLOCK, walk_place_kernel, *s, p);
        LAUNCH_BLOCKS(g, blocks, BVTT_BLOCK, walk_emit_kernel, *s, p, false);
        turn(s, &p);
        p.word += WORDS;
        p.later = true;
        blocks = blocks_of(p.bound);
    }
    return gpu_read_words(g, PASSES * WORDS);
}

/* Passes until all pairs are leaves. */
static int go_down(struct gpu *g, struct walk *s, struct pass *p)
{
    for (bool deeper = true; deeper;) {
        p->bound = p->n + p->n / 4 + 1024;
        p->bound = p->bound < s->cap ? p->bound : s->cap;
        const int64_t *seen = queue(g, s, *p);
        if (gpu_status(g) != DRAPE_OK)
            return gpu_status(g);
        bool on = true;
        for (int k = 0; k < PASSES && deeper && on; k++, seen += WORDS) {
            int64_t need = seen[WORD_NEED];
            s->visited += p->n;
            s->cleared += seen[WORD_CLEARED];
            s->need = need > s->need ? need : s->need;
            if (s->need > s->cap)
                return DRAPE_EFULL;
            turn(s, p);
            p->n = need;
            deeper = seen[WORD_DEEPER] > 0;
            on = need <= p->bound;
        }
    }
    return DRAPE_OK;
}

/* From pairs of leaves to those of triangles. */
static int finish(struct gpu *g, struct walk *s, struct pass *p)
{
    p->to = s->tri;
    p->cap = s->cap_tri;
    p->word = gpu_words(g);
    LAUNCH_BLOCKS(g, blocks_of(p->n), BVTT_BLOCK, walk_leaves_kernel, *s, *p);
    LAUNCH_BLOCKS(g, 1, BVTT_BLOCK, walk_place_kernel, *s, *p);
    LAUNCH_BLOCKS(g, blocks_of(p->n), BVTT_BLOCK, walk_emit_kernel, *s, *p,
                  true);
    s->need_tri = gpu_read_words(g, WORDS)[WORD_NEED];
    if (gpu_status(g) != DRAPE_OK)
        return gpu_status(g);
    if (s->need_tri > s->cap_tri)
        return DRAPE_EFULL;
    s->n_tri = s->need_tri;
    return DRAPE_OK;
}

int gpu_walk(struct gpu *g, struct walk *s)
{
    struct pass p = {};
    p.from = s->front;
    p.n = s->n_front;
    p.to = s->pair;
    p.reach = reach_of(s->in.r);
    p.front = true;
    p.cap = s->cap;
    if (!(s->in.r >= 0 && s->in.r <= REAL_BIG))
        return DRAPE_EDATA;
    s->n_tri = s->need_tri = s->visited = s->cleared = 0;
    s->need = s->n_front;
    if (s->n_front > s->cap)
        return DRAPE_EFULL;
    int status = go_down(g, s, &p);
    return status == DRAPE_OK ? finish(g, s, &p) : status;
}
