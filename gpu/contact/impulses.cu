/* SPDX-License-Identifier: Apache-2.0 */
/* Makes a contact of each new impact and merges it into the active set.
 * spec/contact/impulses.md */
#include "gpu/base/cluster.cuh"
#include "gpu/base/compact.cuh"
#include "gpu/base/scan.cuh"
#include "gpu/contact/keys.cuh"
#include "gpu/contact/one_ring.cuh"

extern "C" {
#include "ref/contact/impulses.h"
}

/* Words of the device. TICKET: counts blocks for ends_last. */
enum { BAD, FOUND, TICKET, WORDS };

/* §5: the key of an impact that is left to a later round, and of none. */
static const uint64_t NONE = ~0ull;

/* §2: geometry */

struct impact {
    struct wide x[4];    /* m, at the impact, relative to x0[v[0]] */
    struct wide from[4]; /* m, at the start, likewise */
    struct wide way[4];  /* m, displacement over the step */
};

static __device__ void place_vertices(const struct impulses *s,
                                      const int32_t v[4], double t,
                                      struct impact *m)
{
    struct wide base = widen(s->x0[v[0]]);
    for (int k = 0; k < 4; k++) {
        struct wide a = widen(s->x0[v[k]]);
        m->way[k] = sub(widen(s->x1[v[k]]), a);
        m->from[k] = sub(a, base);
        m->x[k] = axpy(m->from[k], t, m->way[k]);
    }
}

static __device__ struct wide weighted_sum(const double c[4],
                                           const struct wide a[4])
{
    struct wide r = scale(c[0], a[0]);
    for (int k = 1; k < 4; k++)
        r = axpy(r, c[k], a[k]);
    return r;
}

/* The primitives' own normal, with the sign that opposes the approach; or
 * opposite to the approach where that normal is almost across it. */
static __device__ struct wide own_normal(const struct impact *m, int kind,
                                         const double c[4])
{
    struct wide way = weighted_sum(c, m->way), from = weighted_sum(c, m->from);
    struct wide back = unit(scale(-1, way), unit(from, wide3(1, 0, 0)));
    struct wide n = unit(nearest_normal(m->x, kind), back);
    double closing = dot(n, way);
    if (closing * closing <= 0x1p-32 * dot(way, way))
        return back;
    return closing > 0 ? scale(-1, n) : n;
}

/* §2.3: n, or where it is no normal of the prescribed side's surface, the
 * normal of the triangle there that it is most along. */
static __device__ struct wide surface_normal(const struct impulses *s,
                                             int64_t k, const int32_t v[4],
                                             const struct impact *m,
                                             const double c[4], struct wide n)
{
    int split = s->kind[k] == CONTACT_VF ? 1 : 2;
    bool prescribed[2];
    find_prescribed(s->w, split, v, prescribed);
    if (!prescribed[0] && !prescribed[1])
        return n;
    struct moving at = {s->x0, s->x1, (double)s->toi[k] * 0x1p-30};
    struct closest_point f = closest_point_find_at(
        split, !prescribed[0], v, m->x, c, prescribed[0] ? scale(-1, n) : n);
    struct wide t = f.p;
    if (closest_point_is_local(at, &s->one_rings, &f, CLOSEST_PRESCRIBED) ||
        !closest_point_normal(at, &s->one_rings, &f, 0, &t))
        return n;
    if (prescribed[0])
        t = scale(-1, t);
    bool good = dot(t, weighted_sum(c, m->way)) <= 0 &&
                dot(t, weighted_sum(c, m->from)) >= 0;
    return good ? t : n;
}

/* §2: the normal of impact k, of vertices v; c: the closest points' weights. */
static __device__ struct wide normal_of(const struct impulses *s, int64_t k,
                                        const int32_t v[4],
                                        const struct impact *m,
                                        const double c[4])
{
    return surface_normal(s, k, v, m, c, own_normal(m, s->kind[k], c));
}

static __device__ struct contact contact_of(const struct impulses *s, int64_t k)
{
    struct impact m;
    struct contact c;
    int32_t v[4];
    load_pair(s->pair, k, v);
    int kind = s->kind[k];
    place_vertices(s, v, (double)s->toi[k] * 0x1p-30, &m);
    struct closest r = nearest(m.x, kind);
    struct wide n = normal_of(s, k, v, &m, r.c);
    struct surface surface = surface_of(&s->surfaces, v);
    for (int j = 0; j < 4; j++)
        c.v[j] = v[j];
    c.kind = kind;
    nearest_weights(&r, kind, c.c);
    c.n = narrowed(n);
    c.gap = (real)dot(n, weighted_sum(r.c, m.from));
    c.target = (s->margin * surface.thickness - c.gap) / s->dt;
    c.friction = surface.friction;
    clear_contact(&c);
    return c;
}

/* §5: the first impact of each vertex */

/* Whether impact j is one; its vertices are then in v. */
static __device__ bool is_sound(const struct impulses *s, int64_t j,
                                int32_t v[4])
{
    load_pair(s->pair, j, v);
    return in_range(v, s->nv) && s->kind[j] <= CONTACT_EE;
}

/* Thread j owns impact j: writes NONE to its vertices; all threads that write
 * to a vertex write the same. */
KERNEL impulses_clear_kernel(const struct impulses &s)
{
    ITEM(j, s.n);
    int32_t v[4];
    if (!is_sound(&s, j, v))
        return;
    for (int k = 0; k < 4; k++)
        s.first[v[k]] = NONE;
}

/* Thread j owns impact j: lowers the first of its free vertices to its time.
 * The minimum does not depend on the order. */
KERNEL impulses_first_kernel(const struct impulses &s)
{
    ITEM(j, s.n);
    int32_t v[4];
    if (!is_sound(&s, j, v))
        return;
    unsigned long long time = key_join((int32_t)s.toi[j], j);
    for (int k = 0; k < 4; k++)
        if (s.w[v[k]] > 0)
            atomicMin((unsigned long long *)&s.first[v[k]], time);
}

/* The direction in which impact j, of vertices v, pushes its side A. */
static __device__ struct wide aim_of(const struct impulses *s, int64_t j,
                                     const int32_t v[4])
{
    struct impact m;
    place_vertices(s, v, (double)s->toi[j] * 0x1p-30, &m);
    struct closest r = nearest(m.x, s->kind[j]);
    return normal_of(s, j, v, &m, r.c);
}

/* Whether vertex i, one of v, is on side A. */
static __device__ bool on_side_a(const int32_t v[4], int kind, int32_t i)
{
    return v[0] == i || (kind == CONTACT_EE && v[1] == i);
}

/* Whether impact j, of vertices v, pushes a free vertex of its against what
 * this vertex met before. */
static __device__ bool is_shadowed(const struct impulses *s, int64_t j,
                                   const int32_t v[4])
{
    struct wide aim = aim_of(s, j, v);
    for (int k = 0; k < 4; k++) {
        uint64_t first = s->first[v[k]];
        if (!(s->w[v[k]] > 0) || first >> 32 >= s->toi[j])
            continue;
        int64_t before = (int64_t)(first & 0xffffffffu);
        int32_t other[4];
        load_pair(s->pair, before, other);
        double along = dot(aim, aim_of(s, before, other));
        if (on_side_a(v, s->kind[j], v[k]) !=
            on_side_a(other, s->kind[before], v[k]))
            along = -along;
        if (along < 0)
            return true;
    }
    return false;
}

/* Thread k owns key k: of active contact k, or of impact k - n_active. */
KERNEL impulses_key_kernel(const struct impulses &s, int64_t *words)
{
    ITEM(k, s.n_all);
    int64_t j = k - s.n_active;
    if (j < 0) {
        struct contact c = s.active[k];
        s.key[k] = pair_key(c.v, c.kind, k);
        return;
    }
    int32_t v[4];
    struct key late = {NONE, NONE, k};
    if (!is_sound(&s, j, v)) {
        words[BAD] = 1;
        s.key[k] = late;
    } else
        s.key[k] = is_shadowed(&s, j, v) ? late : pair_key(v, s.kind[j], k);
}

static __device__ bool is_same_key(struct key a, struct key b)
{
    return a.hi == b.hi && a.lo == b.lo;
}

/* §1: of equal keys the newest, which is the last, stays. */
static __device__ bool is_last(const struct key *key, int64_t n, int64_t k)
{
    return k < n && key[k].hi != NONE &&
           (k + 1 == n || !is_same_key(key[k], key[k + 1]));
}

/* §1: κ of a pair that touches again. */
static __device__ real kappa_again(const struct impulses *s,
                                   const struct contact *c)
{
    bool yields = c->impulse > 0 && c->kappa < s->stiffest;
    return yields ? min_of(c->kappa / CONTACT_GIVE, s->stiffest) : c->kappa;
}

/* §1: the contact of a pair that the active set has as well goes on with its
 * multipliers. */
static __device__ void inherit_multipliers(const struct impulses *s,
                                           const struct contact *from,
                                           struct contact *c)
{
    bool swapped =
        c->kind != CONTACT_VF && from->v[0] != c->v[0] && from->v[0] != c->v[1];
    vec t = scale(swapped ? R(-1.0) : R(1.0), from->lambda_t);
    c->lambda = from->lambda;
    c->lambda_t = axpy(t, -dot(c->n, t), c->n);
    c->load = from->load;
    c->kappa = kappa_again(s, from);
    c->rise = from->rise;
}

/* The contact of key k, which stays. The key before it is the same if the
 * active set has the pair, too. */
static __device__ struct contact join_words(const struct impulses *s,
                                            const struct key *key, int64_t k)
{
    int64_t item = key[k].item;
    if (item < s->n_active)
        return s->active[item];
    struct contact c = contact_of(s, item - s->n_active);
    bool again = k > 0 && is_same_key(key[k - 1], key[k]);
    if (again && key[k - 1].item < s->n_active)
        inherit_multipliers(s, &s->active[key[k - 1].item], &c);
    return c;
}

/* A block owns COMPACT_BLOCK sorted keys: counts those that stay. The block
 * that ends last scans the counts into the place of each block's first contact.
 */
KERNEL impulses_count_kernel(const struct key *key, int64_t n, int64_t *first,
                             int64_t *words)
{
    int count;
    block_compact(is_last(key, n, compact_item()), &count);
    if (threadIdx.x == 0) {
        first[blockIdx.x] = count;
        count_up(&words[FOUND], count);
    }
    if (ends_last((unsigned *)&words[TICKET], compact_blocks(n)))
        scan_blocks(first, compact_blocks(n));
}

/* A block owns COMPACT_BLOCK sorted keys: writes the contacts of those that
 * stay to their places. */
KERNEL impulses_emit_kernel(const struct impulses &s, const struct key *key,
                            const int64_t *first)
{
    int64_t k = compact_item();
    bool stay = is_last(key, s.n_all, k);
    int count;
    int64_t at = block_compact(stay, &count) + first[blockIdx.x];
    if (stay)
        s.contact[at] = join_words(&s, key, k);
}

int gpu_impulses(struct gpu *g, struct impulses *s)
{
    if (!(s->dt > 0 && s->dt <= REAL_BIG && s->margin >= 0) ||
        s->n_all != s->n + s->n_active || s->n_all > INT32_MAX / 4)
        return DRAPE_EARG;
    int64_t blocks = compact_blocks(s->n_all);
    int64_t *words = gpu_words(g);
    int64_t *first =
        (int64_t *)gpu_scratch(g, SLOT_STAGE, blocks, sizeof *first);
    LAUNCH(g, s->n, impulses_clear_kernel, *s);
    LAUNCH(g, s->n, impulses_first_kernel, *s);
    LAUNCH(g, s->n_all, impulses_key_kernel, *s, words);
    struct key *key = gpu_sort(g, s->n_all, s->key, s->spare);
    LAUNCH_PARTS(g, blocks, COMPACT_BLOCK, 1, impulses_count_kernel, key,
                 s->n_all, first, words);
    const int64_t *seen = gpu_read_back(g, WORDS);
    if (seen[BAD])
        return DRAPE_EARG;
    s->found = seen[FOUND];
    if (s->found > s->cap)
        return DRAPE_EFULL;
    LAUNCH_PARTS(g, blocks, COMPACT_BLOCK, 1, impulses_emit_kernel, *s, key,
                 first);
    return gpu_status(g);
}
