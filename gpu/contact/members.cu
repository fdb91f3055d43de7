/* SPDX-License-Identifier: Apache-2.0 */
/* Finds the connected components of the pairs, and lists the members of each
 * zone. spec/contact/zones.md §1 */
#include "gpu/contact/members.cuh"

#include "gpu/base/compact.cuh"
#include "gpu/base/unite.cuh"
#include "gpu/contact/contact.cuh"

/* Thread k owns corner k of the pairs: sets its vertex's label to the vertex
 * itself. */
KERNEL zones_label_kernel(const struct zones &s, int64_t *words)
{
    ITEM(k, s.n4);
    int32_t i = s.pair[k];
    if (i < 0 || i >= s.nv)
        words[MEMBERS_BAD] = 1;
    else
        s.label[i] = i;
}

/* Thread k owns pair k: joins its free vertices into one component. */
KERNEL zones_unite_kernel(const struct zones &s, const int64_t *words)
{
    ITEM(k, s.n);
    if (words[MEMBERS_BAD])
        return;
    int32_t v[4];
    load_pair(s.pair, k, v);
    int32_t first = -1;
    for (int j = 0; j < 4; j++) {
        if (!(s.w[v[j]] > 0))
            continue;
        if (first < 0)
            first = v[j];
        else
            unite(s.label, first, v[j]);
    }
}

/* Thread k owns corner k: writes its member's key, or a key above all others if
 * its pair has no zone. */
KERNEL zones_key_kernel(const struct zones &s, const int64_t *words)
{
    ITEM(k, s.n4);
    struct key key = {UINT64_MAX, UINT64_MAX, 0};
    if (!words[MEMBERS_BAD]) {
        int32_t v[4];
        load_pair(s.pair, k / 4, v);
        for (int j = 0; j < 4 && key.hi == UINT64_MAX; j++)
            if (s.w[v[j]] > 0)
                key.hi = (uint32_t)root_of(s.label, v[j]);
        key.lo = (uint32_t)v[k % 4];
    }
    s.key[k] = key;
}

/* Members, zones and free vertices, each in order */

/* Whether a sorted key is the first of a member, of a zone, of a free member.
 */
struct begins {
    bool member, zone, free;
};

static __device__ struct begins begins_at(const struct zones *s,
                                          const struct key *key, int64_t k,
                                          const int64_t *words)
{
    struct begins b = {false, false, false};
    if (words[MEMBERS_BAD] || k >= s->n4 || key[k].hi == UINT64_MAX)
        return b;
    b.zone = k == 0 || key[k].hi != key[k - 1].hi;
    b.member = b.zone || key[k].lo != key[k - 1].lo;
    b.free = b.member && s->w[key[k].lo] > 0;
    return b;
}

/* A block owns COMPACT_BLOCK sorted keys: counts the members, zones and free
 * vertices that begin there. `first` holds three streams of counts.
 */
KERNEL zones_count_kernel(const struct zones &s, const struct key *key,
                          int64_t *first, int64_t *words)
{
    struct begins b = begins_at(&s, key, compact_item(), words);
    int members, zones, free;
    block_compact(b.member, &members);
    block_compact(b.zone, &zones);
    block_compact(b.free, &free);
    if (threadIdx.x > 0)
        return;
    first[blockIdx.x] = members;
    int64_t blocks = compact_blocks(s.n4);
    first[blocks + blockIdx.x] = zones;
    first[2 * blocks + blockIdx.x] = free;
    count_up(&words[MEMBERS_ALL], members);
    count_up(&words[MEMBERS_ZONES], zones);
    count_up(&words[MEMBERS_FREE], free);
}

/* A block owns COMPACT_BLOCK sorted keys: writes the members, zones and free
 * vertices that begin there to their places. */
KERNEL zones_emit_kernel(const struct zones &s, const struct key *key,
                         struct key *member, const int64_t *first,
                         const int64_t *words)
{
    int64_t k = compact_item();
    struct begins b = begins_at(&s, key, k, words);
    int count;
    int64_t at = first[blockIdx.x] + block_compact(b.member, &count);
    int64_t blocks = compact_blocks(s.n4);
    int64_t zone = first[blocks + blockIdx.x] - words[MEMBERS_ALL] +
                   block_compact(b.zone, &count);
    int64_t free = first[2 * blocks + blockIdx.x] - words[MEMBERS_ALL] -
                   words[MEMBERS_ZONES] + block_compact(b.free, &count);
    if (b.member)
        member[at] = key[k];
    if (b.zone)
        s.zone[zone].first = at;
    if (b.free)
        s.vertex[free] = (int32_t)key[k].lo;
}

struct key *gpu_members(struct gpu *g, struct zones *s, int64_t *words)
{
    int64_t blocks = compact_blocks(s->n4);
    int64_t *first =
        (int64_t *)gpu_scratch(g, SLOT_STAGE, 3 * blocks, sizeof *first);
    LAUNCH(g, s->n4, zones_label_kernel, *s, words);
    LAUNCH(g, s->n, zones_unite_kernel, *s, words);
    LAUNCH(g, s->n4, zones_key_kernel, *s, words);
    struct key *key = gpu_sort(g, s->n4, s->key, s->spare);
    struct key *member = key == s->key ? s->spare : s->key;
    LAUNCH_PARTS(g, blocks, COMPACT_BLOCK, 1, zones_count_kernel, *s, key,
                 first, words);
    gpu_scan(g, first, 3 * blocks);
    LAUNCH_PARTS(g, blocks, COMPACT_BLOCK, 1, zones_emit_kernel, *s, key,
                 member, first, words);
    return member;
}
