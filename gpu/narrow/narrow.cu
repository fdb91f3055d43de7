/* SPDX-License-Identifier: Apache-2.0 */
/* Exact continuous collision on the device. What a tier cannot settle it puts
 * on a list for the next; the order of a list cannot show, as each item writes
 * its own toi and tier only. spec/narrow/narrow.md */
#include "gpu/base/place.cuh"
#include "gpu/contact/contact.cuh"
#include "gpu/narrow/exact.cuh"
#include "gpu/narrow/split.cuh"

/* g->words: a fault of the input, and the lists' lengths. */
enum { WORD_BAD, WORD_SPLIT, WORD_EXACT, WORD_LONG, WORD_LEFT, WORDS = 6 };

/* The third tier's workers: a room each, short or for every input (§6.5). A
 * worker is one thread of 32, so that none waits for another's branch. Halving
 * workers: as many as fit on a large device, a few times over. Where emulated
 * there are few, so that each has several items. */
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
    /* infinity and NaN minus themselves are NaN */
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

/* Thread k looks at vertex k. */
static __global__ void __launch_bounds__(GPU_BLOCK)
    finite_kernel(struct narrow s, uint32_t *bad)
{
    ITEM(k, s.nv);
    if (!finite(s.x0[k]) || !finite(s.x1[k]))
        atomicOr(bad, 1u);
}

/* Candidate k by the first tier; true: it is for the second. */
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

/* Thread k owns candidate k: reads its vertices, writes toi[k] and tier[k] or
 * puts k on the list; a block takes its places there at once. */
static __global__ void __launch_bounds__(PLACE_BLOCK, 3)
    filter_kernel(struct narrow s, struct list left, uint32_t *bad)
{
    __shared__ uint32_t first;
    int64_t k = (int64_t)blockIdx.x * PLACE_BLOCK + threadIdx.x;
    bool leaves = k < s.n && filter_leaves(&s, k, bad);
    int total, place = block_place(leaves, &total);
    if (threadIdx.x == 0 && total)
        first = atomicAdd(left.count, (uint32_t)total);
    __syncthreads();
    if (leaves)
        left.item[first + (uint32_t)place] = (uint32_t)k;
}

/* Thread k owns items k, k + threads, … of the list: writes their toi and tier
 * or puts them on the next. */
static __global__ void __launch_bounds__(GPU_BLOCK)
    split_kernel(struct narrow s, struct list in, struct list left,
                 const uint32_t *bad)
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

/* The third tier's workers: a slab of scratch each, a workspace and `words`
 * words of room. */
struct crew {
    char *slab;
    int workers, words;
};

static size_t slab_bytes(int words)
{
    return sizeof(struct workspace) + (size_t)words * sizeof(uint32_t);
}

/* Worker i, thread i·APART, owns items i, i + workers, … of the list and slab
 * i. Writes toi and tier; what finds no room it puts on the next list. */
static __global__ void __launch_bounds__(GPU_BLOCK)
    exact_kernel(struct narrow s, struct list in, struct list left,
                 const uint32_t *bad, struct crew crew)
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
    if (s->n > INT32_MAX) /* the lists' items; the pairs would fill 36 GB */
        return DRAPE_ENOMEM;
    uint32_t *item = (uint32_t *)gpu_scratch(g, SLOT_STAGE, 2 * s->n, 4);
    struct list a = {item, word + WORD_SPLIT};
    struct list b = {item + s->n, word + WORD_EXACT};
    LAUNCH(g, s->nv, finite_kernel, *s, bad);
    LAUNCH_BLOCKS(g, place_blocks(s->n), PLACE_BLOCK, filter_kernel, *s, a,
                  bad);
    int64_t workers = s->n < SPLIT_WORKERS ? s->n : (int64_t)SPLIT_WORKERS;
    LAUNCH(g, workers, split_kernel, *s, a, b, bad);
    a.count = word + WORD_LONG;
    exact(g, s, s->n, b, a, crew{NULL, SHORT_WORKERS, SHORT_ROOM});
    b.count = word + WORD_LEFT;
    exact(g, s, s->n, a, b, crew{NULL, LONG_WORKERS, LONG_ROOM});
    const uint32_t *seen = (const uint32_t *)gpu_read_words(g, WORDS / 2);
    int status = gpu_status(g);
    if (status == DRAPE_OK && seen[WORD_BAD])
        return DRAPE_EDATA;
    if (status == DRAPE_OK && seen[WORD_LEFT]) /* which §6.5 excludes */
        return DRAPE_EDEVICE;
    return status;
}
