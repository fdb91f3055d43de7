/* SPDX-License-Identifier: Apache-2.0 */
/* Exact continuous collision detection on the device, one kernel a tier. A tier
 * appends the pairs that it cannot decide to a list for the next tier. The
 * order of a list does not affect the result, because each item writes only its
 * own toi and tier. spec/narrow/narrow.md */
#include "gpu/base/compact.cuh"
#include "gpu/broad/pair.cuh"
#include "gpu/narrow/exact.cuh"
#include "gpu/narrow/split.cuh"

/* The words of gpu_words in this stage: a fault of the input, and the lengths
 * of the lists. */
enum { WORD_BAD, WORD_SPLIT, WORD_EXACT, WORD_LONG, WORD_LEFT, WORDS = 6 };

/* Sizes of tiers 2 and 3. A worker of tier 3 is one thread of 32, so that no
 * worker waits for another's branch. It has an arena of SHORT_ROOM words, or of
 * LONG_ROOM words, which suffice for every input (§6.5). Tier 2 has several
 * times as many threads as run at once on a large device. In emulation there
 * are few workers, so that each has several items. */
enum { APART = 32, LONG_ROOM = 65536 };
#ifdef __CUDACC__
enum { SHORT_ROOM = 2304, SHORT_WORKERS = 2048, LONG_WORKERS = 32 };
enum { SPLIT_WORKERS = 1 << 18 };
#else
enum { SHORT_ROOM = 512, SHORT_WORKERS = 3, LONG_WORKERS = 2 };
enum { SPLIT_WORKERS = 16 };
#endif

/* A list of candidates on the device. */
struct list {
    uint32_t *item, *count;
};

static __device__ bool finite(vec a)
{
    /* an infinity or NaN minus itself is NaN */
    return a.x - a.x == 0 && a.y - a.y == 0 && a.z - a.z == 0;
}

static __device__ void load_quad(const struct narrow *s, int64_t k,
                                 struct quad *p)
{
    int32_t v[4];
    load_pair(s->pair, k, v);
    p->ee = s->kind[k] != 0;
    for (int j = 0; j < 4; j++) {
        p->x[0][j] = s->x0[v[j]];
        p->x[1][j] = s->x1[v[j]];
    }
}

static __device__ void settle(const struct narrow *s, int64_t k, uint32_t toi,
                              int tier)
{
    s->toi[k] = toi;
    s->tier[k] = (uint8_t)tier;
}

/* Thread k checks that the positions of vertex k are finite. */
KERNEL finite_kernel(const struct narrow &s, uint32_t *bad)
{
    ITEM(k, s.nv);
    if (!finite(s.x0[k]) || !finite(s.x1[k]))
        atomicOr(bad, 1u);
}

/* Runs tier 1 on candidate k. Returns true if tier 2 must decide. */
static __device__ bool filter_leaves(const struct narrow *s, int64_t k,
                                     uint32_t *bad)
{
    int32_t v[4];
    struct quad p;
    load_pair(s->pair, k, v);
    if (!in_range(v, s->nv) || s->kind[k] > 1) {
        atomicOr(bad, 1u);
        return false;
    }
    load_quad(s, k, &p);
    if (!filter_misses(&p))
        return true;
    settle(s, k, NARROW_MISS, 1);
    return false;
}

/* Thread k owns candidate k: it reads the vertices and writes toi[k] and
 * tier[k], or appends k to the list. A block reserves its places in the list
 * with one atomic. */
KERNEL filter_kernel(const struct narrow &s, const struct list &left,
                     uint32_t *bad)
{
    __shared__ uint32_t first;
    int64_t k = (int64_t)blockIdx.x * COMPACT_BLOCK + threadIdx.x;
    bool leaves = k < s.n && filter_leaves(&s, k, bad);
    int total, place = block_compact(leaves, &total);
    if (threadIdx.x == 0 && total)
        first = atomicAdd(left.count, (uint32_t)total);
    __syncthreads();
    if (leaves)
        left.item[first + (uint32_t)place] = (uint32_t)k;
}

/* Thread k owns items k, k + threads, … of the list: it writes their toi and
 * tier, or appends them to the next list. */
KERNEL split_kernel(const struct narrow &s, const struct list &in,
                    const struct list &left, const uint32_t *bad)
{
    uint32_t step = gridDim.x * blockDim.x, n = *bad ? 0 : *in.count;
    for (uint32_t i = blockIdx.x * blockDim.x + threadIdx.x; i < n; i += step) {
        struct quad p;
        struct forms f;
        uint32_t k = in.item[i], toi = 0;
        load_quad(&s, k, &p);
        int end = make_forms(&p, &f) ? split(&f, &toi) : SPLIT_UNSURE;
        if (end == SPLIT_UNSURE)
            left.item[atomicAdd(left.count, 1u)] = k;
        else
            settle(&s, k, end == SPLIT_HIT ? toi : NARROW_MISS, 2);
    }
}

/* The workers of tier 3. Each has a slab of scratch memory: a workspace and an
 * arena of `words` words. */
struct crew {
    char *slab;
    int workers, words;
};

static size_t slab_bytes(int words)
{
    return sizeof(struct workspace) + (size_t)words * sizeof(uint32_t);
}

/* Worker i, which is thread i·APART, owns items i, i + workers, … of the list
 * and slab i. It writes their toi and tier; items that overflow its arena go to
 * the next list. */
KERNEL exact_kernel(const struct narrow &s, const struct list &in,
                    const struct list &left, const uint32_t *bad,
                    const struct crew &crew)
{
    uint32_t thread = blockIdx.x * blockDim.x + threadIdx.x;
    uint32_t worker = thread / APART, n = *bad ? 0 : *in.count;
    if (thread % APART != 0 || worker >= (uint32_t)crew.workers)
        return;
    size_t bytes =
        sizeof(struct workspace) + (size_t)crew.words * sizeof(uint32_t);
    struct workspace *own = (struct workspace *)(crew.slab + worker * bytes);
    for (uint32_t i = worker; i < n; i += (uint32_t)crew.workers) {
        struct quad p;
        uint32_t k = in.item[i], toi = 0;
        load_quad(&s, k, &p);
        if (exact_contact(&p, own, (uint32_t *)(own + 1), crew.words, &toi))
            settle(&s, k, toi, 3);
        else
            left.item[atomicAdd(left.count, 1u)] = k;
    }
}

static void exact(struct gpu *g, struct narrow *s, int64_t n, struct list in,
                  struct list left, struct crew crew)
{
    const uint32_t *bad = (const uint32_t *)g->words + WORD_BAD;
    if (crew.workers > n)
        crew.workers = (int)n;
    crew.slab = (char *)gpu_scratch(g, SLOT_STAGE + 1, crew.workers,
                                    slab_bytes(crew.words));
    LAUNCH(g, (int64_t)crew.workers * APART, exact_kernel, *s, in, left, bad,
           crew);
}

int gpu_narrow(struct gpu *g, struct narrow *s)
{
    uint32_t *word = (uint32_t *)gpu_words(g), *bad = word + WORD_BAD;
    if (s->n > INT32_MAX) /* list items are 32-bit; so many pairs would fill
                             36 GB */
        return DRAPE_ENOMEM;
    uint32_t *item = (uint32_t *)gpu_scratch(g, SLOT_STAGE, 2 * s->n, 4);
    struct list a = {item, word + WORD_SPLIT};
    struct list b = {item + s->n, word + WORD_EXACT};
    LAUNCH(g, s->nv, finite_kernel, *s, bad);
    LAUNCH_PARTS(g, compact_blocks(s->n), COMPACT_BLOCK, 3, filter_kernel, *s,
                 a, bad);
    int64_t workers = s->n < SPLIT_WORKERS ? s->n : (int64_t)SPLIT_WORKERS;
    LAUNCH(g, workers, split_kernel, *s, a, b, bad);
    a.count = word + WORD_LONG;
    exact(g, s, s->n, b, a, crew{NULL, SHORT_WORKERS, SHORT_ROOM});
    b.count = word + WORD_LEFT;
    exact(g, s, s->n, a, b, crew{NULL, LONG_WORKERS, LONG_ROOM});
    const uint32_t *seen = (const uint32_t *)gpu_read_back(g, WORDS / 2);
    int status = gpu_status(g);
    if (status == DRAPE_OK && seen[WORD_BAD])
        return DRAPE_EDATA;
    if (status == DRAPE_OK && seen[WORD_LEFT]) /* cannot happen, by §6.5 */
        return DRAPE_EDEVICE;
    return status;
}
