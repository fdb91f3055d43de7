/* SPDX-License-Identifier: Apache-2.0 */
/* Takes the contacts with led sides where the step ends, not where it starts.
 * spec/contact/ahead.md */
#include "gpu/base/cluster.cuh"
#include "gpu/base/compact.cuh"
#include "gpu/base/scan.cuh"
#include "gpu/contact/incidence.cuh"
#include "gpu/contact/lists.cuh"

extern "C" {
#include "ref/contact/proximity.h"
}

/* Words of the device after those of the lists. TICKET: for ends_last. */
enum { FOUND = INCIDENCE_WORDS, BAD, TICKET, WORDS };

static __device__ bool is_led(const struct ahead *s, const struct contact *c)
{
    return has_led((int)c->kind, c->v, s->w);
}

/* Whether a vertex that contact c moves met something on the way. */
static __device__ bool has_met(const struct ahead *s, const struct contact *c)
{
    bool met = false;
    for (int j = 0; j < 4; j++)
        met = met || (c->c[j] != 0 && s->met[c->v[j]]);
    return met;
}

/* §2: the heights over led surfaces at which the contacts of a vertex are to
 * end, x, times their weights, y. */
struct ahead_heights {
    struct ahead s;
    const int32_t *start;
    __device__ int32_t end(int64_t i) const { return start[i + 1]; }
    __device__ vec value(int32_t at) const
    {
        int32_t item = s.item[at];
        const struct contact *c = &s.before[item / 4];
        real part = is_led(&s, c) ? magnitude(c->c[item % 4]) : R(0.0);
        return make(part * (c->gap + s.dt * c->target), part, 0);
    }
    __device__ vec first(int64_t) const { return make(0, 0, 0); }
    __device__ void done(int64_t i, vec sum) const
    {
        s.height[i] = sum.y > 0 ? max_of(sum.x / sum.y, R(0.0)) : R(-1.0);
    }
};

/* §2. Thread i owns vertex i: reads its items, writes height[i]. */
KERNEL ahead_height_kernel(const struct ahead &s, const int64_t *words)
{
    sum_list(ahead_heights{s, s.start},
             words[INCIDENCE_BAD] ? -1 : own_list(s.nv));
}

/* §2: how far apart the sides of contact c are to end. */
static __device__ real height_of(const struct ahead *s, const struct contact *c)
{
    real thickness = surface_of(&s->skin, c->v).thickness, sum = 0, all = 0;
    for (int j = 0; j < 4; j++) {
        int32_t i = c->v[j];
        if (!(s->w[i] > 0) || c->c[j] == 0)
            continue;
        real part = magnitude(c->c[j]);
        sum += part * (s->height[i] < 0 ? thickness : s->height[i]);
        all += part;
    }
    return min_of(sum / all, thickness);
}

/* Contact k of both lists; those at the start come first. */
static __device__ const struct contact *item_of(const struct ahead *s,
                                                int64_t k)
{
    return k < s->n ? &s->before[k] : &s->after[k - s->n];
}

/* §1: whether contact k of both lists stays. */
static __device__ bool stays(const struct ahead *s, int64_t k, int64_t *words)
{
    const struct contact *c = item_of(s, k);
    if (!in_range(c->v, s->nv)) {
        words[BAD] = 1;
        return false;
    }
    bool led = is_led(s, c), met = has_met(s, c);
    return k < s->n ? !led || met : led && !met;
}

/* A block owns COMPACT_BLOCK contacts: writes to at whether they stay, and
 * counts these. The block that ends last scans the counts into the place of
 * each block's first. */
KERNEL ahead_count_kernel(const struct ahead &s, int64_t *first, int64_t *words)
{
    int64_t k = compact_item();
    bool stay = k < s.n_all && stays(&s, k, words);
    int count;
    block_compact(stay, &count);
    if (k < s.n_all)
        s.at[k] = stay;
    if (threadIdx.x == 0) {
        first[blockIdx.x] = count;
        count_up(&words[FOUND], count);
    }
    __syncthreads(); /* other threads may still read block_compact's words */
    if (ends_last((unsigned *)&words[TICKET], compact_blocks(s.n_all)))
        scan_blocks(first, compact_blocks(s.n_all));
}

/* A block owns COMPACT_BLOCK contacts: writes those that stay to their places.
 */
KERNEL ahead_emit_kernel(const struct ahead &s, const int64_t *first)
{
    int64_t k = compact_item();
    bool stay = k < s.n_all && s.at[k];
    int count;
    int64_t to = block_compact(stay, &count) + first[blockIdx.x];
    if (!stay)
        return;
    struct contact c = *item_of(&s, k);
    if (k >= s.n) {
        real way = s.dt * dot(c.n, pair_sum(&c, s.u));
        c.gap = c.gap - way;
        c.target = (height_of(&s, &c) - c.gap) / s.dt;
    }
    c.held = 0;
    c.impulse = c.slide = c.along = 0;
    c.tangent = make(0, 0, 0);
    s.contact[to] = c;
}

int gpu_ahead(struct gpu *g, struct ahead *s)
{
    if (!(s->dt > 0) || s->nv1 != s->nv + 1 || s->n4 != 4 * s->n ||
        s->n_all != s->n + s->n_new || s->n_all > INT32_MAX / 4)
        return DRAPE_EARG;
    int64_t blocks = compact_blocks(s->n_all), *words = gpu_words(g);
    struct incidence by = {s->nv,    s->n,    s->w,      s->before,
                           s->start, s->item, s->vertex, 0};
    gpu_incidence(g, &by, words);
    int64_t *first =
        (int64_t *)gpu_scratch(g, SLOT_STAGE, blocks, sizeof *first);
    LAUNCH_LISTS(g, s->nv, ahead_height_kernel, *s, words);
    LAUNCH_PARTS(g, blocks, COMPACT_BLOCK, 1, ahead_count_kernel, *s, first,
                 words);
    const int64_t *seen = gpu_read_back(g, WORDS);
    if (seen[INCIDENCE_BAD] || seen[BAD])
        return DRAPE_EARG;
    s->found = seen[FOUND];
    if (s->found)
        LAUNCH_PARTS(g, blocks, COMPACT_BLOCK, 1, ahead_emit_kernel, *s, first);
    return gpu_status(g);
}
