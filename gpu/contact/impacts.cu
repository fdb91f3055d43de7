/* SPDX-License-Identifier: Apache-2.0 */
/* Selects the candidates that touch and that a response can part.
 * spec/contact/impacts.md */
#include "gpu/base/compact.cuh"
#include "gpu/contact/contact.cuh"

extern "C" {
#include "ref/contact/impacts.h"
#include "ref/narrow/narrow.h"
}

/* at[k] says what candidate k is. HIT: an impact. MISS: it does not touch, or
 * it is left out. RETEST: its toi is 0, so the narrow phase must still say
 * whether it touches at the start already. */
enum { HIT = 0, MISS = -1, RETEST = -2 };
/* The words of the counts. BAD: not 0 if a vertex or a kind is out of range. */
enum { BAD, HITS, PRESCRIBED, RETESTS, WORDS };

/* The candidates that the narrow phase tests with x0 as start and end. */
struct retest {
    int32_t *pair; /* [n][4] */
    int32_t *item; /* [n] index of the candidate */
    uint32_t *toi; /* [n] */
    uint8_t *kind, *tier;
};

/* §1. Thread k owns candidate k: reads toi[k], and w of its vertices if it
 * touches; writes at[k]. */
KERNEL impacts_decide_kernel(const struct impacts &s, int64_t *words)
{
    ITEM(k, s.n);
    int32_t v[4];
    load_pair(s.pair, k, v);
    if (!in_range(v, s.nv) || s.kind[k] > CONTACT_EE) {
        words[BAD] = 1;
        return;
    }
    int32_t at = MISS;
    if (s.toi[k] != NARROW_MISS) {
        bool free = any_free(v, s.w);
        bool later = s.toi[k] > 0;
        at = !free ? MISS : later ? HIT : RETEST;
        count_up(&words[!free ? PRESCRIBED : later ? HITS : RETESTS], 1);
    }
    s.at[k] = at;
}

/* A block owns COMPACT_BLOCK candidates: counts those with at = want. */
KERNEL impacts_count_kernel(const struct impacts &s, int32_t want,
                            int64_t *first)
{
    int64_t k = compact_item();
    int count;
    block_compact(k < s.n && s.at[k] == want, &count);
    if (threadIdx.x == 0)
        first[blockIdx.x] = count;
}

/* A block owns COMPACT_BLOCK candidates: copies those with at = RETEST to its
 * part of a. */
KERNEL impacts_gather_kernel(const struct impacts &s, const int64_t *first,
                             const struct retest &a)
{
    int64_t k = compact_item();
    bool asks = k < s.n && s.at[k] == RETEST;
    int count;
    int64_t at = block_compact(asks, &count) + first[blockIdx.x];
    if (!asks)
        return;
    copy_pair(s.pair, k, a.pair, at);
    a.item[at] = (int32_t)k;
    a.kind[at] = s.kind[k];
}

/* Thread k owns item k of a: writes the answer to at of its candidate. */
KERNEL impacts_answer_kernel(const struct impacts &s, int64_t n,
                             const struct retest &a, int64_t *words)
{
    ITEM(k, n);
    bool hit = a.toi[k] == NARROW_MISS;
    s.at[a.item[k]] = hit ? HIT : MISS;
    if (hit)
        count_up(&words[HITS], 1);
}

/* A block owns COMPACT_BLOCK candidates: copies its hits to their places. */
KERNEL impacts_emit_kernel(const struct impacts &s, const int64_t *first)
{
    int64_t k = compact_item();
    bool hit = k < s.n && s.at[k] == HIT;
    int count;
    int64_t at = block_compact(hit, &count) + first[blockIdx.x];
    if (!hit)
        return;
    copy_pair(s.pair, k, s.hit, at);
    s.hit_kind[at] = s.kind[k];
    s.hit_toi[at] = s.toi[k];
}

/* Returns, for each block, the place of its first candidate with at = want in
 * the list of all of them. */
static int64_t *place_hit(struct gpu *g, const struct impacts *s, int32_t want)
{
    int64_t blocks = compact_blocks(s->n);
    int64_t *first =
        (int64_t *)gpu_scratch(g, SLOT_STAGE, blocks, sizeof *first);
    LAUNCH_PARTS(g, blocks, COMPACT_BLOCK, 1, impacts_count_kernel, *s, want,
                 first);
    gpu_scan(g, first, blocks);
    return first;
}

/* Tests n candidates with toi 0: does the pair touch at the start? */
static int retest_start(struct gpu *g, struct impacts *s, int64_t n)
{
    struct retest a;
    /* the narrow phase uses the scratch slots before this one */
    int32_t *memory = (int32_t *)gpu_scratch(g, SLOT_STAGE + 2, 26 * n, 1);
    if (!memory)
        return gpu_status(g);
    a.pair = memory;
    a.item = memory + 4 * n;
    a.toi = (uint32_t *)(memory + 5 * n);
    a.kind = (uint8_t *)(memory + 6 * n);
    a.tier = a.kind + n;
    int64_t *first = place_hit(g, s, RETEST);
    LAUNCH_PARTS(g, compact_blocks(s->n), COMPACT_BLOCK, 1,
                 impacts_gather_kernel, *s, first, a);
    struct narrow m = {.n = n,
                       .pair = a.pair,
                       .kind = a.kind,
                       .x0 = s->x0,
                       .x1 = s->x0,
                       .nv = s->nv,
                       .toi = a.toi,
                       .tier = a.tier};
    int status = gpu_narrow(g, &m);
    int64_t *words = gpu_words(g);
    LAUNCH(g, n, impacts_answer_kernel, *s, n, a, words);
    int64_t hits = gpu_read_back(g, WORDS)[HITS];
    s->found += hits;
    s->started = n - hits;
    return status == DRAPE_OK ? gpu_status(g) : status;
}

int gpu_impacts(struct gpu *g, struct impacts *s)
{
    int64_t *words = gpu_words(g);
    LAUNCH(g, s->n, impacts_decide_kernel, *s, words);
    const int64_t *seen = gpu_read_back(g, WORDS);
    if (seen[BAD])
        return DRAPE_EARG;
    int64_t asks = seen[RETESTS];
    int status = gpu_status(g);
    s->found = seen[HITS];
    s->prescribed = seen[PRESCRIBED];
    s->started = 0;
    if (asks && status == DRAPE_OK)
        status = retest_start(g, s, asks);
    if (status == DRAPE_OK && s->found > s->cap)
        return DRAPE_EFULL;
    if (!s->found || status != DRAPE_OK)
        return status;
    int64_t *first = place_hit(g, s, HIT);
    LAUNCH_PARTS(g, compact_blocks(s->n), COMPACT_BLOCK, 1, impacts_emit_kernel,
                 *s, first);
    return gpu_status(g);
}
