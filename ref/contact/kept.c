/* SPDX-License-Identifier: Apache-2.0 */
/* The multipliers that all contacts carry from slice to slice.
 * spec/contact/carry.md §3 */
#include "ref/contact/kept.h"

#include "ref/base/change.h"
#include "ref/base/keys.h"
#include "ref/sleep/rest.h"
#include "ref/world/state.h"

static const uint64_t EDGES = UINT64_C(1) << 63; /* of hi: two edges */

/* A vertex of each side of the pair. */
static void sides_of(const struct kept *k, int32_t v[2])
{
    v[0] = (int32_t)((k->hi & ~EDGES) >> 32);
    v[1] = (int32_t)(k->lo >> 32);
}

static int body_of(const struct world *w, int32_t v)
{
    return w->home->body[v];
}

/* Whether a side of the pair is of a cloth that is asleep. */
static bool is_asleep(const struct world *w, const struct kept *k)
{
    int32_t v[2];
    sides_of(k, v);
    for (int j = 0; j < 2; j++) {
        int body = body_of(w, v[j]);
        if (body < w->def.n_cloths && !sleep_awake(w, body))
            return true;
    }
    return false;
}

/* Leaves out entries without a normal impulse, and sorts the rest by key. */
static int sort_kept(const struct world *w, struct kept *list, int64_t *n)
{
    int64_t found = 0;
    for (int64_t k = 0; k < *n; k++)
        if (list[k].lambda > 0)
            list[found++] = list[k];
    struct key *key = arena_take(w->arena, ARENA_OTHER, 2 * found, sizeof *key);
    struct kept *to = arena_take(w->arena, ARENA_OTHER, found, sizeof *to);
    for (int64_t k = 0; k < found && key && to; k++) {
        key[k] = (struct key){list[k].hi, list[k].lo, k};
        to[k] = list[k];
    }
    if (key && to && found > 0) {
        const struct key *sorted = keys_sort(found, key, key + found);
        for (int64_t k = 0; k < found; k++)
            list[k] = to[sorted[k].item];
    }
    *n = found;
    bool good = key && to;
    arena_give(w->arena, key);
    arena_give(w->arena, to);
    return good ? DRAPE_OK : DRAPE_ENOMEM;
}

int kept_gather(const struct world *w, struct kept **list, int64_t *n)
{
    const struct lagrange *a = &w->lagrange;
    int64_t awake = a->n_kept[0], all = awake + a->n_resting;
    *n = all;
    *list = arena_take(w->arena, ARENA_OTHER, all, sizeof **list);
    if (!*list)
        return DRAPE_ENOMEM;
    size_t size = sizeof **list;
    w->run->fetch(w->on, *list, a->kept[0].data, (size_t)awake * size);
    w->run->fetch(w->on, *list + awake, a->resting.data,
                  (size_t)a->n_resting * size);
    int status = w->run->status(w->on);
    return status == DRAPE_OK ? sort_kept(w, *list, n) : status;
}

/* Room for n entries in a pool that has `used`, which stay. */
static int widen_pool(struct world *w, struct pool *p, int64_t used, int64_t n)
{
    struct pool wide = {0};
    if (n <= p->cap)
        return DRAPE_OK;
    int status = w->run->grow(w->on, &wide, ARENA_RESPONSE, n,
                              sizeof(struct kept), true);
    if (status != DRAPE_OK)
        return status;
    w->run->copy(w->on, wide.data, p->data, (size_t)used * sizeof(struct kept));
    w->run->give(w->on, p->data);
    *p = wide;
    return DRAPE_OK;
}

int kept_room(struct world *w, int64_t n, struct kept **part)
{
    struct lagrange *a = &w->lagrange;
    *part = arena_take(w->arena, ARENA_OTHER, n, sizeof **part);
    int status = *part ? DRAPE_OK : DRAPE_ENOMEM;
    if (status == DRAPE_OK)
        status = widen_pool(w, &a->kept[0], a->n_kept[0], n);
    if (status == DRAPE_OK)
        status = widen_pool(w, &a->resting, a->n_resting, n);
    return status;
}

int kept_spread(struct world *w, const struct kept *list, int64_t n,
                struct kept *part)
{
    struct lagrange *a = &w->lagrange;
    for (int asleep = 0; asleep < 2; asleep++) {
        const struct pool *to = asleep ? &a->resting : &a->kept[0];
        int64_t *found = asleep ? &a->n_resting : &a->n_kept[0];
        *found = 0;
        for (int64_t k = 0; k < n; k++)
            if (is_asleep(w, &list[k]) == asleep)
                part[(*found)++] = list[k];
        if (*found > 0)
            w->run->send(w->on, to->data, part, (size_t)*found * sizeof *part);
    }
    return w->run->status(w->on);
}

/* Likewise, of a list for which room is made first. */
static int distribute_kept(struct world *w, const struct kept *list, int64_t n)
{
    struct kept *part = NULL;
    int status = kept_room(w, n, &part);
    if (status == DRAPE_OK)
        status = kept_spread(w, list, n, part);
    arena_give(w->arena, part);
    return status;
}

int kept_divide(struct world *w)
{
    struct kept *list = NULL;
    int64_t n = 0;
    if (!w->plan.solves)
        return DRAPE_OK;
    int status = kept_gather(w, &list, &n);
    if (status == DRAPE_OK)
        status = distribute_kept(w, list, n);
    arena_give(w->arena, list);
    return status;
}

/* The vertex of the new world that is v of the old one; -1: it is gone. */
static int32_t edited_of(const struct world *w, const struct edited *edited,
                         int32_t v)
{
    const struct world *old = edited->old;
    int bodies = w->def.n_cloths + w->def.n_obstacles, from = body_of(old, v);
    for (int k = 0; k < bodies; k++)
        if (edited->from[k] == from)
            return (int32_t)(v - state_first_vertex(old, from) +
                             state_first_vertex(w, k));
    return -1;
}

/* Both halves of a word are vertices. */
static bool rename_word(const struct world *w, const struct edited *edited,
                        uint64_t *word)
{
    int32_t a = edited_of(w, edited, (int32_t)(*word >> 32));
    int32_t b = edited_of(w, edited, (int32_t)(*word & UINT32_MAX));
    *word = (uint64_t)(uint32_t)a << 32 | (uint32_t)b;
    return a >= 0 && b >= 0;
}

int kept_inherit(struct world *w, const struct edited *edited)
{
    struct kept *list = NULL;
    int64_t n = 0, found = 0;
    if (!w->plan.solves || !edited->old->plan.solves)
        return DRAPE_OK;
    int status = kept_gather(edited->old, &list, &n);
    for (int64_t k = 0; k < n && status == DRAPE_OK; k++) {
        struct kept e = list[k];
        uint64_t kind = e.hi & EDGES;
        e.hi &= ~EDGES;
        bool stays = rename_word(w, edited, &e.hi);
        stays &= rename_word(w, edited, &e.lo);
        e.hi |= kind;
        if (stays)
            list[found++] = e;
    }
    if (status == DRAPE_OK)
        status = distribute_kept(w, list, found);
    arena_give(edited->old->arena, list);
    return status;
}

static bool is_number(real a)
{
    return a >= -REAL_BIG && a <= REAL_BIG;
}

bool kept_good(const struct world *w, const struct kept *k)
{
    uint64_t hi = k->hi & ~EDGES, n = (uint64_t)w->nv;
    return hi >> 32 < n && (hi & UINT32_MAX) < n && k->lo >> 32 < n &&
           (k->lo & UINT32_MAX) < n && k->lambda >= 0 && is_number(k->lambda) &&
           is_number(k->lambda_t.x) && is_number(k->lambda_t.y) &&
           is_number(k->lambda_t.z);
}
