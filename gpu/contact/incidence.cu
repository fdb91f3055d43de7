/* SPDX-License-Identifier: Apache-2.0 */
/* Lists the contacts of each free vertex. Items are counted by atomics, in any
 * order; each item is then placed by the number of smaller items of its vertex,
 * so the result does not depend on the order of threads.
 * spec/contact/contacts.md §1 */
#include "gpu/contact/incidence.cuh"

extern "C" {
#include "gpu/contact/queue.h"
}

/* Where the words lie among the late words: behind refit's. */
enum { LATE_CONTACTS = 2 };
static_assert(LATE_CONTACTS + (int)INCIDENCE_WORDS <= (int)GPU_LATE, "words");

int64_t *gpu_queue_words(struct gpu *g)
{
    return gpu_late_words(g) + LATE_CONTACTS;
}

bool gpu_queue_bad(const struct gpu *g)
{
    const int64_t *seen = gpu_late_seen(g) + LATE_CONTACTS;
    return seen[INCIDENCE_BAD] != 0;
}

/* Scratch. A vertex's word is its number of items, plus 2^32 if that is not 0.
 * One scan of the words then gives, for each vertex, the place of its first
 * item (low half) and the number of vertices in contact before it (high half).
 */
struct lists {
    int64_t *word; /* [nv + 1] */
    int32_t *rank; /* [4 n] rank of an item within its vertex, in any order;
                      at the end its place in the lists */
    int32_t *any;  /* [4 n] items by vertex, in the order of rank */
};

static __device__ bool can_push(const struct incidence *s, int64_t item,
                                int32_t *vertex)
{
    const struct contact *c = &s->contact[item / 4];
    *vertex = c->v[item % 4];
    return c->c[item % 4] != 0 && s->w[*vertex] > 0;
}

/* Thread k owns item k: writes rank[k], and adds to its vertex's word by
 * atomics. */
KERNEL incidence_count_kernel(const struct incidence &s, const struct lists &l,
                              int64_t *words)
{
    ITEM(k, 4 * s.n);
    int32_t i = s.contact[k / 4].v[k % 4];
    if (i < 0 || i >= s.nv) {
        words[INCIDENCE_BAD] = 1;
        return;
    }
    if (!can_push(&s, k, &i)) {
        l.rank[k] = -1;
        return;
    }
    unsigned long long *word = (unsigned long long *)&l.word[i];
    int32_t rank = (int32_t)(uint32_t)atomicAdd(word, 1ull);
    if (rank == 0)
        atomicAdd(word, 1ull << 32);
    l.rank[k] = rank;
}

/* Thread i owns vertex i of nv + 1: reads its word and the next word; writes
 * start[i], and i into `vertex` if it is in contact. */
KERNEL incidence_start_kernel(const struct incidence &s, const struct lists &l,
                              int64_t *words)
{
    ITEM(i, s.nv + 1);
    int64_t word = l.word[i];
    s.start[i] = (int32_t)(uint32_t)word;
    if (i == s.nv)
        words[INCIDENCE_VERTICES] = word >> 32;
    else if (l.word[i + 1] >> 32 != word >> 32)
        s.vertex[word >> 32] = (int32_t)i;
}

/* Thread k owns item k: writes it to its vertex's list, ordered by rank. */
KERNEL incidence_place_kernel(const struct incidence &s, const struct lists &l,
                              const int64_t *words)
{
    ITEM(k, 4 * s.n);
    int32_t i;
    if (!words[INCIDENCE_BAD] && can_push(&s, k, &i))
        l.any[s.start[i] + l.rank[k]] = (int32_t)k;
}

/* Thread k owns place k of all lists: moves its item behind the smaller items
 * of its vertex. */
KERNEL incidence_order_kernel(const struct incidence &s, const struct lists &l,
                              const int64_t *words)
{
    ITEM(k, 4 * s.n);
    if (words[INCIDENCE_BAD] || k >= s.start[s.nv])
        return;
    int32_t item = l.any[k], i = s.contact[item / 4].v[item % 4];
    int32_t first = s.start[i], end = s.start[i + 1], at = first;
    for (int32_t j = first; j < end; j++)
        at += l.any[j] < item;
    s.item[at] = item;
    l.rank[item] = at;
}

int32_t *gpu_incidence(struct gpu *g, const struct incidence *s, int64_t *words)
{
    int64_t items = 4 * s->n;
    struct lists l = {
        (int64_t *)gpu_scratch(g, SLOT_STAGE, s->nv + 1, sizeof *l.word),
        (int32_t *)gpu_scratch(g, SLOT_STAGE + 1, items, sizeof *l.rank),
        (int32_t *)gpu_scratch(g, SLOT_STAGE + 2, items, sizeof *l.any)};
    gpu_clear(g, l.word, (size_t)(s->nv + 1) * sizeof *l.word);
    LAUNCH(g, items, incidence_count_kernel, *s, l, words);
    gpu_scan(g, l.word, s->nv + 1);
    LAUNCH(g, s->nv + 1, incidence_start_kernel, *s, l, words);
    LAUNCH(g, items, incidence_place_kernel, *s, l, words);
    LAUNCH(g, items, incidence_order_kernel, *s, l, words);
    return l.rank;
}
