/* SPDX-License-Identifier: Apache-2.0 */
/* Finds the candidates that are close and makes them contacts: a first kernel
 * leaves out what is surely far, a second one measures the rest, a third one
 * emits. spec/contact/proximity.md */
#include "gpu/base/cluster.cuh"
#include "gpu/base/compact.cuh"
#include "gpu/base/scan.cuh"
#include "gpu/contact/far.cuh"
#include "gpu/contact/one_ring.cuh"

extern "C" {
#include "ref/contact/proximity.h"
}

enum { BAD_PAIR = 1, BAD_PLACE = 2 };

/* Words of the device: the status of bad input, the number of contacts, and the
 * ticket of ends_last. */
enum { WORD_BAD, WORD_FOUND, WORD_TICKET, WORDS };

/* Limits of groups_of: groups for each multiprocessor where there are enough
 * candidates, and tiles of COMPACT_BLOCK candidates in a group. */
#ifdef __CUDACC__
enum { GROUPS_EACH = 4, MOST_TILES = 8 };
#else
enum { GROUPS_EACH = 1, MOST_TILES = 3 };
#endif

static __device__ struct closest measure_pair(const struct proximity *s,
                                              int kind, const int32_t v[4],
                                              struct wide x[4])
{
    for (int j = 0; j < 4; j++)
        x[j] = widen(s->x[v[j]]);
    return nearest(x, kind);
}

/* §3.3: whether the distance of a pair of free sides is the least around. A
 * vertex's own side is not asked. */
static __device__ bool is_least(const struct proximity *s, int split,
                                const int32_t v[4], const struct wide x[4],
                                const struct closest *r)
{
    struct still at = {s->x};
    struct closest_point f =
        closest_point_find_at(split, true, v, x, r->c, r->p);
    if (!closest_point_is_local(at, &s->one_rings, &f, CLOSEST_FREE))
        return false;
    if (split == 1)
        return true;
    f = closest_point_find_at(split, false, v, x, r->c, scale(-1, r->p));
    return closest_point_is_local(at, &s->one_rings, &f, CLOSEST_FREE);
}

/* §3: the normal: along p, or the primitives' own normal where p is too short
 * to have a direction, or the prescribed surface's where p is none of its
 * normals. False if the pair is no contact. */
static __device__ bool find_normal(const struct proximity *s, int kind,
                                   const int32_t v[4], const struct wide x[4],
                                   const struct closest *r, struct wide *n)
{
    struct wide p = unit(r->p, wide3(1, 0, 0));
    bool along = r->length2 > 0x1p-80 * r->size2, prescribed[2];
    int split = kind == CONTACT_VF ? 1 : 2;
    *n = along ? p : unit(nearest_normal(x, kind), p);
    if (along) {
        find_prescribed(s->w, split, v, prescribed);
        if (!prescribed[0] && !prescribed[1])
            return is_least(s, split, v, x, r);
        struct still at = {s->x};
        struct closest_point f =
            closest_point_find_at(split, !prescribed[0], v, x, r->c,
                                  prescribed[0] ? scale(-1, r->p) : r->p);
        if (closest_point_is_local(at, &s->one_rings, &f, CLOSEST_PRESCRIBED))
            return true;
        if (!closest_point_normal(at, &s->one_rings, &f, 0.25, n))
            return false;
    }
    if (dot(*n, r->p) < 0)
        *n = scale(-1, *n);
    return true;
}

/* The distance within which a pair of these vertices is a contact. */
static __device__ real reach_of(const struct proximity *s, const int32_t v[4])
{
    return (s->n_from ? R(1.0) : s->range) *
           surface_of(&s->surfaces, v).thickness;
}

/* §6: whether candidate k must be measured: it is not surely far. Bad input is
 * known and is not measured. */
static __device__ bool is_open(const struct proximity *s, int64_t k, int *bad)
{
    int32_t v[4];
    vec x[4];
    int kind = s->kind[k];
    load_pair(s->pair, k, v);
    if (!in_range(v, s->nv) || kind > CONTACT_EE) {
        atomicOr(bad, (int)BAD_PAIR);
        return false;
    }
    for (int j = 0; j < 4; j++)
        x[j] = s->x[v[j]];
    bool good = sane(x[0]) && sane(x[1]) && sane(x[2]) && sane(x[3]);
    for (int j = 0; j < 4 && s->n_from; j++)
        good = good && sane(s->from[v[j]]);
    if (!good) {
        atomicOr(bad, (int)BAD_PLACE);
        return false;
    }
    return !surely_far(x, kind, reach_of(s, v));
}

/* §3.4: whether a pair stands for its closest points. Where these are on an
 * edge or at a vertex they are those of other pairs, too. */
static __device__ bool stands_for_points(const struct proximity *s, int kind,
                                         const int32_t v[4],
                                         const struct wide x[4],
                                         const struct closest *r)
{
    if (kind == CONTACT_EE)
        return r->c[0] != 0 && r->c[1] != 0 && r->c[2] != 0 && r->c[3] != 0;
    struct closest_point f = closest_point_find_at(1, true, v, x, r->c, r->p);
    return closest_point_is_first_at(&s->one_rings, &f, v + 1, v[0]);
}

/* §3, §3.5: Σ c x at the start of the slice. */
static __device__ struct wide start_vector(const struct proximity *s,
                                           const int32_t v[4],
                                           const struct closest *r)
{
    if (!s->n_from)
        return r->p;
    struct wide first = widen(s->from[v[0]]), p = wide3(0, 0, 0);
    for (int j = 0; j < 4; j++)
        p = axpy(p, r->c[j], sub(widen(s->from[v[j]]), first));
    return p;
}

/* §3.5: whether the pair comes nearer, from beyond the range and from the side
 * on which it ends. */
static __device__ bool arrives(const struct proximity *s, const int32_t v[4],
                               struct wide n, const struct closest *r)
{
    if (!s->n_from)
        return true;
    struct wide p = start_vector(s, v, r);
    double gap = dot(n, p);
    real least = s->range * surface_of(&s->surfaces, v).thickness;
    return gap >= 0 && gap > dot(n, r->p) && sqrt(dot(p, p)) >= (double)least;
}

static __device__ bool is_close(const struct proximity *s, int64_t k)
{
    int32_t v[4];
    struct wide x[4], n;
    int kind = s->kind[k];
    load_pair(s->pair, k, v);
    struct closest r = measure_pair(s, kind, v, x);
    return sqrt(r.length2) < (double)reach_of(s, v) &&
           stands_for_points(s, kind, v, x, &r) &&
           find_normal(s, kind, v, x, &r, &n) && arrives(s, v, n, &r);
}

/* §4: the target velocity, which the overlap and the repulsion spring give. */
static __device__ real push_target(const struct proximity *s,
                                   const struct contact *c, real overlap)
{
    real w = 0;
    for (int j = 0; j < 4; j++)
        w += (c->c[j] * c->c[j]) * s->w[c->v[j]];
    real spring = ((s->dt * s->stiffness) * overlap) * w;
    return min_of(spring, (R(0.1) * overlap) / s->dt);
}

static __device__ void emit_contact(const struct proximity *s, int64_t k,
                                    struct contact *to)
{
    struct wide x[4], n;
    struct contact c;
    int kind = s->kind[k];
    load_pair(s->pair, k, c.v);
    c.kind = kind;
    struct surface surface = surface_of(&s->surfaces, c.v);
    struct closest r = measure_pair(s, kind, c.v, x);
    nearest_weights(&r, kind, c.c);
    find_normal(s, kind, c.v, x, &r, &n);
    c.n = narrowed(n);
    c.gap = (real)dot(n, start_vector(s, c.v, &r));
    c.friction = surface.friction;
    c.target = push_target(s, &c, max_of(surface.thickness - c.gap, R(0)));
    clear_contact(&c);
    *to = c;
}

/* §6. A group is the candidates of one block: `tiles` times COMPACT_BLOCK. Its
 * part of `at` lists first the candidates that are open, then its contacts; in
 * its place of base there is their number. */
struct groups {
    int tiles;
    int64_t n;     /* groups */
    int64_t *base; /* [n + 1] */
};

static __device__ int64_t group_first(const struct groups *g)
{
    return (int64_t)blockIdx.x * g->tiles * COMPACT_BLOCK;
}

/* Lists the group's open candidates. */
KERNEL far_kernel(const struct proximity &s, struct groups g, int64_t *word)
{
    int64_t first = group_first(&g);
    int listed = 0, total;
    for (int j = 0; j < g.tiles; j++) {
        int64_t k = first + j * COMPACT_BLOCK + threadIdx.x;
        bool open = k < s.n && is_open(&s, k, (int *)&word[WORD_BAD]);
        int place = block_compact(open, &total);
        if (open)
            s.at[first + listed + place] = (int32_t)k;
        listed += total;
    }
    if (threadIdx.x == 0)
        g.base[blockIdx.x] = listed;
}

/* Measures the group's open candidates and lists its contacts, in a part of
 * `at` that was read before. The block that ends last scans base into the place
 * of each group's first contact. */
KERNEL close_kernel(const struct proximity &s, struct groups g, int64_t *word)
{
    int64_t first = group_first(&g);
    int open = (int)g.base[blockIdx.x], listed = 0, total;
    for (int from = 0; from < open; from += COMPACT_BLOCK) {
        int i = from + (int)threadIdx.x;
        int32_t k = i < open ? s.at[first + i] : 0;
        bool close = i < open && is_close(&s, k);
        int place = block_compact(close, &total);
        if (close)
            s.at[first + listed + place] = k;
        listed += total;
    }
    if (threadIdx.x == 0)
        g.base[blockIdx.x] = listed;
    __syncthreads(); /* other threads may still read block_compact's words */
    if (!ends_last((unsigned *)&word[WORD_TICKET], g.n))
        return;
    if (threadIdx.x == 0)
        g.base[g.n] = 0;
    __syncthreads();
    scan_blocks(g.base, g.n + 1);
    __syncthreads();
    if (threadIdx.x == 0)
        word[WORD_FOUND] = g.base[g.n];
}

/* Writes the group's contacts, a thread one contact at a time. */
KERNEL emit_kernel(const struct proximity &s, struct groups g)
{
    int64_t first = group_first(&g), to = g.base[blockIdx.x];
    int found = (int)(g.base[blockIdx.x + 1] - to);
    for (int i = (int)threadIdx.x; i < found; i += COMPACT_BLOCK)
        emit_contact(&s, s.at[first + i], &s.contact[to + i]);
}

/* Few candidates are spread over all multiprocessors. Of many, a group has so
 * many that its open ones fill most of a block. */
static struct groups groups_of(const struct gpu *g, int64_t n)
{
    int64_t blocks = compact_blocks(n), most = MOST_TILES;
    int64_t tiles = blocks / (GROUPS_EACH * g->multiprocessors);
    tiles = tiles < 1 ? 1 : tiles > most ? most : tiles;
    return {(int)tiles, (blocks + tiles - 1) / tiles, NULL};
}

int gpu_proximity(struct gpu *g, struct proximity *s)
{
    if (!(s->dt > 0 && s->dt <= REAL_BIG && s->stiffness >= 0) ||
        !(s->range > 0 && s->range <= REAL_BIG) ||
        (s->n_from && s->n_from != s->nv))
        return DRAPE_EARG;
    struct groups of = groups_of(g, s->n);
    of.base = (int64_t *)gpu_scratch(g, SLOT_STAGE, of.n + 1, sizeof *of.base);
    int64_t *word = gpu_words(g);
    LAUNCH_PARTS(g, of.n, COMPACT_BLOCK, 1, far_kernel, *s, of, word);
    LAUNCH_PARTS(g, of.n, COMPACT_BLOCK, 2, close_kernel, *s, of, word);
    const int64_t *seen = gpu_read_back(g, WORDS);
    int status = gpu_status(g);
    if (status != DRAPE_OK)
        return status;
    if (seen[WORD_BAD])
        return seen[WORD_BAD] & BAD_PAIR ? DRAPE_EARG : DRAPE_EDATA;
    s->found = seen[WORD_FOUND];
    if (s->found > s->cap)
        return DRAPE_EFULL;
    if (s->found)
        LAUNCH_PARTS(g, of.n, COMPACT_BLOCK, 2, emit_kernel, *s, of);
    return gpu_status(g);
}
