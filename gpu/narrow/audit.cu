/* SPDX-License-Identifier: Apache-2.0 */
/* Finds every intersecting pair of triangles on the device. Neither the order
 * of triangles nor that of the lists affects the result, because the pairs are
 * sorted at the end. spec/narrow/audit.md */
#include "gpu/base/compact.cuh"
#include "gpu/narrow/audit.cuh"
#include "gpu/narrow/tritri.cuh"

/* Integer arithmetic is done by workers. A worker is one thread of 32, so that
 * no worker waits for another's branch, with an arena of its own. The lists
 * begin with a capacity of PAIRS_EACH pairs a triangle and PAIRS_MORE more. In
 * emulation all of these are small, so that workers have several items and
 * lists overflow. */
enum { APART = 32 };
#ifdef __CUDACC__
enum { WORKERS = 512, DECIDE_WORKERS = 1 << 16 };
enum { PAIRS_EACH = 1, PAIRS_MORE = 1024 };
#else
enum { WORKERS = 3, DECIDE_WORKERS = 16 };
enum { PAIRS_EACH = 0, PAIRS_MORE = 8 };
#endif

/* Lists on the device: triangles, and pairs a < b stored as a·2^32 + b. */
struct lists {
    uint32_t *orientation;         /* [nt] */
    uint64_t *left, *unsure, *hit; /* [room] each */
    int64_t room;
    uint32_t *slab; /* [WORKERS · SIGNS_ROOM] */
};

/* §1.1: degenerate triangles. */

static __device__ struct face face_of(const struct audit *s, int32_t t)
{
    struct face f;
    for (int j = 0; j < 3; j++) {
        f.v[j] = s->tri[t][j];
        struct wide x = widen(s->x[f.v[j]]);
        f.p[j][0] = x.x;
        f.p[j][1] = x.y;
        f.p[j][2] = x.z;
    }
    return f;
}

static __device__ void mark(const struct audit *s, int32_t t, bool flat,
                            int64_t *word)
{
    s->degenerate[t] = flat;
    if (flat)
        count_up(&word[AUDIT_FLAT], 1);
}

/* Thread t owns triangle t: it writes degenerate[t], or appends t to the list
 * `orientation` where the filter is not certain. A block counts its triangles
 * of group 0. */
KERNEL mark_kernel(const struct audit &s, const struct lists &l, int64_t *word)
{
    int64_t t = compact_item();
    int total, at;
    block_compact(t < s.nt && s.group && s.group[t] == 0, &total);
    if (threadIdx.x == 0)
        count_up(&word[AUDIT_FIXED], total);
    if (t >= s.nt || word[AUDIT_BAD])
        return;
    if (!in_mesh(s.tri[t], s.nv)) {
        audit_bad(word, AUDIT_BAD_NAME);
        return;
    }
    struct signs w = {NULL, false};
    struct face f = face_of(&s, (int32_t)t);
    int sign = orientation(&w, f.p, &at);
    if (sign == 0 && w.unsure)
        l.orientation[audit_next(&word[AUDIT_ORIENTATIONS])] = (uint32_t)t;
    else
        mark(&s, (int32_t)t, sign == 0, word);
}

/* Returns the number of the worker that this thread is, and sets its arena.
 * Returns a number beyond all items if the thread is no worker. */
static __device__ int64_t worker_of(const struct lists *l, struct big_arena *m)
{
    uint32_t thread = blockIdx.x * blockDim.x + threadIdx.x;
    uint32_t worker = thread / APART;
    if (thread % APART != 0 || worker >= WORKERS)
        return INT64_MAX;
    *m = {l->slab + worker * SIGNS_ROOM, SIGNS_ROOM, 0, false};
    return worker;
}

/* A worker owns items of the list `orientation` and writes their degenerate[].
 */
KERNEL turn_kernel(const struct audit &s, const struct lists &l, int64_t *word)
{
    struct big_arena m;
    int64_t n = word[AUDIT_BAD] ? 0 : word[AUDIT_ORIENTATIONS];
    for (int64_t i = worker_of(&l, &m); i < n; i += WORKERS) {
        int at;
        struct signs w = {&m, false};
        struct face f = face_of(&s, (int32_t)l.orientation[i]);
        mark(&s, (int32_t)l.orientation[i], orientation(&w, f.p, &at) == 0,
             word);
    }
}

/* §4.3: pairs. */

static __device__ bool overlap(const struct audit_span *a,
                               const struct audit_span *b)
{
    return b->lo.x <= a->hi.x && a->lo.x <= b->hi.x && b->lo.y <= a->hi.y &&
           a->lo.y <= b->hi.y && b->lo.z <= a->hi.z && a->lo.z <= b->hi.z;
}

/* Appends triangles p and q to the list `left` if no filter proves them
 * disjoint. f is the face of p. */
static __device__ void filter_pair(const struct audit *s, const struct lists *l,
                                   const struct face *f, int32_t p, int32_t q,
                                   int64_t *word)
{
    if (s->degenerate[q])
        return;
    struct face g = face_of(s, q);
    if (tritri_apart(f, &g))
        return;
    int64_t at = audit_next(&word[AUDIT_LEFT]);
    if (at < l->room)
        l->left[at] = (uint64_t)min_of(p, q) << 32 | (uint32_t)max_of(p, q);
}

/* Thread i owns place i of the order. It visits all later places, without those
 * of group 0, whose boxes meet its own box. The traversal has no stack: from a
 * box it goes to the next box or to the first child, and goes up where the next
 * box would be a first child. */
KERNEL walk_kernel(const struct audit &s, const struct audit_levels &v,
                   const struct lists &l, int64_t *word)
{
    ITEM(i, s.nt);
    if (word[AUDIT_BAD] || s.degenerate[s.order[0][i]])
        return;
    int32_t p = s.order[0][i], fixed = (int32_t)word[AUDIT_FIXED];
    if (s.across && i >= fixed)
        return;
    struct audit_span own = audit_lane(&s, 0, (int32_t)i);
    struct face f = face_of(&s, p);
    int32_t b = max_of((int32_t)i + 1, fixed);
    int level = 0;
    bool next = true; /* false: b was just reached as a first child */
    for (;;) {
        for (; next && level < v.top && b % 4 == 0; level++)
            b /= 4;
        if (b >= v.count[level])
            return;
        struct audit_span box = audit_lane(&s, v.at[level], b);
        bool meets = overlap(&own, &box);
        next = !meets || level == 0;
        if (meets && level == 0)
            filter_pair(&s, &l, &f, p, s.order[0][b], word);
        level -= !next;
        b = next ? b + 1 : 4 * b;
    }
}

/* Decides a pair of a list. Returns false where the pair needs integer
 * arithmetic and `room` is NULL. */
static __device__ bool decide(const struct audit *s, const struct lists *l,
                              uint64_t pair, struct big_arena *room,
                              int64_t *word)
{
    struct face t = face_of(s, (int32_t)(pair >> 32));
    struct face u = face_of(s, (int32_t)(pair & 0xffffffffu));
    struct facing f = facing_of(&t, others(&u, &t), &u, others(&t, &u));
    struct signs w = {room, false};
    bool hit = tritri_decide(&w, &f);
    if (hit && !w.unsure)
        l->hit[audit_next(&word[AUDIT_HITS])] = pair;
    return !w.unsure;
}

/* Thread k owns pairs k, k + threads, … of the list `left`. */
KERNEL decide_kernel(const struct audit &s, const struct lists &l,
                     int64_t *word)
{
    int64_t step = (int64_t)gridDim.x * blockDim.x, n = word[AUDIT_LEFT];
    int64_t k = (int64_t)blockIdx.x * blockDim.x + threadIdx.x;
    if (word[AUDIT_BAD] || n > l.room)
        return;
    for (; k < n; k += step)
        if (!decide(&s, &l, l.left[k], NULL, word))
            l.unsure[audit_next(&word[AUDIT_UNSURE])] = l.left[k];
}

/* A worker owns pairs of the list `unsure` and decides them in integer
 * arithmetic. */
KERNEL unsure_kernel(const struct audit &s, const struct lists &l,
                     int64_t *word)
{
    struct big_arena m;
    int64_t n = word[AUDIT_UNSURE];
    for (int64_t k = worker_of(&l, &m); k < n; k += WORKERS)
        decide(&s, &l, l.unsure[k], &m, word);
}

/* Queues the search for all pairs, with the current capacity of the lists. */
static void search(struct gpu *g, struct audit *s, const struct audit_levels *v,
                   struct lists l, int64_t *word)
{
    LAUNCH(g, s->nt, walk_kernel, *s, *v, l, word);
    LAUNCH(g, (int64_t)DECIDE_WORKERS, decide_kernel, *s, l, word);
    LAUNCH(g, (int64_t)WORKERS * APART, unsure_kernel, *s, l, word);
}

static void take_lists(struct gpu *g, struct lists *l, int64_t room)
{
    l->room = room;
    l->left =
        (uint64_t *)gpu_scratch(g, SLOT_STAGE + 1, 3 * room, sizeof *l->left);
    l->unsure = l->left + room;
    l->hit = l->unsure + room;
}

/* Searches, and searches again where a list was too short. Returns the words of
 * the last readback. */
static const int64_t *pairs(struct gpu *g, struct audit *s, struct lists *l,
                            int64_t *word)
{
    struct audit_levels v = gpu_audit_levels(s->nt);
    gpu_audit_tree(g, s, &v, word);
    take_lists(g, l, PAIRS_EACH * s->nt + PAIRS_MORE);
    for (;;) {
        search(g, s, &v, *l, word);
        const int64_t *seen = gpu_read_back_keep(g, AUDIT_WORDS);
        if (gpu_status(g) || seen[AUDIT_BAD] || seen[AUDIT_LEFT] <= l->room)
            return seen;
        take_lists(g, l, seen[AUDIT_LEFT]);
        gpu_clear(g, word + AUDIT_LEFT, 3 * sizeof *word);
    }
}

int gpu_audit(struct gpu *g, struct audit *s)
{
    struct lists l = {};
    int64_t *word = gpu_words(g);
    s->found = s->n_degenerate = 0;
    gpu_audit_check(g, s, word);
    l.orientation = (uint32_t *)gpu_scratch(g, SLOT_STAGE + 2, s->nt, 4);
    l.slab = (uint32_t *)gpu_scratch(g, SLOT_STAGE + 3,
                                     (int64_t)WORKERS * SIGNS_ROOM, 4);
    LAUNCH_BLOCKS(g, compact_blocks(s->nt), COMPACT_BLOCK, mark_kernel, *s, l,
                  word);
    LAUNCH(g, (int64_t)WORKERS * APART, turn_kernel, *s, l, word);
    const int64_t *seen = pairs(g, s, &l, word);
    int status = gpu_status(g);
    if (status != DRAPE_OK)
        return status;
    if (seen[AUDIT_BAD])
        return seen[AUDIT_BAD] & AUDIT_BAD_PLACE ? DRAPE_EDATA : DRAPE_EARG;
    s->n_degenerate = seen[AUDIT_FLAT];
    s->found = seen[AUDIT_HITS];
    if (s->found > s->cap)
        return DRAPE_EFULL;
    gpu_audit_pairs(g, s, l.hit);
    return gpu_status(g);
}
