/* SPDX-License-Identifier: Apache-2.0 */
/* Mass splitting: the work of one thread for one contact or for one vertex.
 * spec/contact/contacts.md */
#ifndef GPU_CONTACTS_CUH
#define GPU_CONTACTS_CUH

#include "gpu/contact/contact.cuh"
#include "gpu/contact/lists.cuh"

extern "C" {
#include "ref/contact/contacts.h"
}

/* The push of contact k on its vertex j is stored at index slot[4 k + j] of
 * `pushed`. All pushes of a vertex lie side by side there, so a vertex sums
 * them without reading the contacts. */
struct alignas(4 * sizeof(real)) pushed {
    vec push; /* N·s, c times the contact's push */
    real none;
};

struct mass_splitting {
    struct contacts s;
    const int32_t *slot;   /* [4 n] -1: the item does not count */
    struct pushed *pushed; /* [4 n] */
    int64_t *over;         /* 1 + the last iteration of §3 that was void */
    int32_t *longer;       /* [n_longer] k of each vertex[k] with a long list */
    unsigned long long *n_longer;
    vec *row; /* [WARP] in shared memory, of this warp: sum_by_warp */
};

/* §1: waking */

/* State of an awake contact, beside enum waking: its last push is not 0. */
enum { PUSHED = AWAKE + 1 };

/* Wakes contact k and its vertices. Threads that wake the same contact write
 * the same values. A thread that reads the state meanwhile finds no work in
 * either state. */
static __device__ void wake(const struct contacts &s, int64_t k)
{
    const struct contact *c = &s.contact[k];
    s.contact_awake[k] = AWAKE;
    for (int j = 0; j < 4; j++)
        if (!s.vertex_awake[c->v[j]])
            s.vertex_awake[c->v[j]] = AWAKE;
}

/* Wakes the contacts of vertex i; a lane of several takes its share of them. */
static __device__ void spread(const struct contacts &s, int32_t i, int lane,
                              int lanes)
{
    s.vertex_awake[i] = SPREAD;
    for (int32_t j = s.start[i] + lane; j < s.start[i + 1]; j += lanes)
        if (!s.contact_awake[s.item[j] / 4])
            wake(s, s.item[j] / 4);
}

/* Work of a thread for contact k */

static __device__ vec total(const struct contact *c)
{
    return axpy(c->tangent, c->impulse, c->n);
}

/* §3: the number d of parts of vertex i, given the contacts that act on it. */
static __device__ int32_t split(const struct contacts &s, int32_t i)
{
    int32_t acting = s.acting[i], d = s.parts[i];
    if (s.keep == 0 || (d > 0 && d < acting))
        return acting;
    return d == 0 ? acting + 1 : d; /* a further contact may begin to act */
}

/* §2: the mass that contact c feels: 1/a, of its vertices' parts. */
static __device__ real effective_mass(const struct contacts &s,
                                      const struct contact *c)
{
    real sum = 0, largest = 0;
    for (int k = 0; k < 4; k++) {
        int32_t i = c->v[k];
        if (c->c[k] == 0 || !(s.w[i] > 0))
            continue;
        real w = (real)split(s, i) * s.w[i];
        sum += c->c[k] * c->c[k] * w;
        largest = max_of(w, largest);
    }
    sum = max_of(sum, R(0x1p-12) * largest);
    return sum > 0 ? 1 / sum : 0;
}

/* §3: counts contact k, which acts, for each of its vertices. True: the counts
 * make the iteration void. */
static __device__ bool count(const struct mass_splitting &m, int64_t k,
                             real beta)
{
    bool over = false;
    for (int j = 0; j < 4; j++) {
        int32_t i = m.s.contact[k].v[j];
        if (m.slot[4 * k + j] < 0)
            continue;
        real acting = (real)(atomicAdd(&m.s.acting[i], 1) + 1);
        real d = (real)m.s.parts[i];
        over |= d > 0 && beta * beta * acting > d;
    }
    return over;
}

static __device__ void give(const struct mass_splitting &m, int64_t k, vec push)
{
    for (int j = 0; j < 4; j++) {
        int32_t at = m.slot[4 * k + j];
        if (at >= 0)
            m.pushed[at] = {scale(m.s.contact[k].c[j], push), 0};
    }
    m.s.contact_awake[k] = PUSHED;
}

/* Whether contact k acts; if it does not, its pushes are set to 0. */
static __device__ bool acts(const struct mass_splitting &m, int64_t k)
{
    if (!m.s.contact_awake[k] || m.s.lack[k] != 0 ||
        m.s.lookahead[k] != m.s.contact[k].impulse)
        return m.s.contact_awake[k];
    if (m.s.contact_awake[k] == PUSHED) {
        give(m, k, make(0, 0, 0));
        m.s.contact_awake[k] = AWAKE;
    }
    return false;
}

/* §3: lack of contact k at its vertices' u. */
static __device__ real lack_of(const struct contacts &s, int64_t k)
{
    const struct contact *c = &s.contact[k];
    real lack = c->target - dot(c->n, pair_sum(c, s.u));
    return lack > 0 || s.lookahead[k] > 0 ? lack : R(0.0);
}

/* Writes before[k], ahead[k] and lack[k]. */
static __device__ void begin(const struct mass_splitting &m, int64_t k)
{
    const struct contacts &s = m.s;
    struct contact *c = &s.contact[k];
    if (!s.warm) {
        c->impulse = 0;
        c->tangent = make(0, 0, 0);
    }
    s.contact_awake[k] = ASLEEP;
    s.before[k] = total(c);
    s.lookahead[k] = c->impulse;
    s.lack[k] = lack_of(s, k);
    if (s.lack[k] != 0)
        wake(s, k);
}

/* §3: iteration t. Reads u and d of its vertices, writes lack[k], and adds the
 * contact to the acting counts of its vertices. */
static __device__ void find_lack(const struct mass_splitting &m, int64_t k,
                                 int t, real beta)
{
    if (!m.s.contact_awake[k])
        return;
    m.s.lack[k] = lack_of(m.s, k);
    if (m.s.lack[k] != 0 && count(m, k, beta))
        *m.over = t + 1; /* all threads that write here write the same */
}

/* §3: changes y of contact k, and records the push that takes u along. */
static __device__ void set_lookahead(const struct mass_splitting &m, int64_t k,
                                     real y)
{
    give(m, k, scale(y - m.s.lookahead[k], m.s.contact[k].n));
    m.s.lookahead[k] = y;
}

/* §3: the normal part of one iteration. Reads d of its vertices; writes its
 * impulse, y and push. */
static __device__ void push_normal(const struct mass_splitting &m, int64_t k)
{
    const struct contacts &s = m.s;
    if (!acts(m, k))
        return;
    struct contact *c = &s.contact[k];
    real y = s.lookahead[k], was = c->impulse, now = y;
    if (s.lack[k] != 0)
        now = max_of(y + effective_mass(s, c) * s.lack[k], R(0.0));
    c->impulse = now;
    set_lookahead(m, k, max_of(now + s.keep * (now - was), R(0.0)));
}

/* §3: a void iteration: y is moved back towards λ. */
static __device__ void shrink_lookahead(const struct mass_splitting &m,
                                        int64_t k)
{
    real now = m.s.contact[k].impulse;
    if (acts(m, k))
        set_lookahead(m, k, now + m.s.keep * (m.s.lookahead[k] - now));
}

/* §4: writes lack[k], not 0 if the contact can have friction, and adds such a
 * contact to the acting counts of its vertices. */
static __device__ void find_friction(const struct mass_splitting &m, int64_t k)
{
    const struct contact *c = &m.s.contact[k];
    m.s.lack[k] = c->impulse > 0 || dot(c->tangent, c->tangent) > 0;
    if (m.s.lack[k] == 0)
        return;
    if (!m.s.contact_awake[k])
        wake(m.s, k);
    count(m, k, R(0.0));
}

/* §4: the tangential part of one iteration. Reads u and d of its vertices;
 * writes its push and its tangent, within the friction cone. */
static __device__ void push_tangent(const struct mass_splitting &m, int64_t k)
{
    const struct contacts &s = m.s;
    if (!acts(m, k))
        return;
    struct contact *c = &s.contact[k];
    vec u = pair_sum(c, s.u);
    u = axpy(u, -dot(c->n, u), c->n);
    vec next = axpy(c->tangent, -effective_mass(s, c), u);
    real limit = c->friction * c->impulse, l = length(next);
    if (l > limit)
        next = scale(limit / l, next);
    vec push = sub(next, c->tangent);
    c->tangent = next;
    give(m, k, push);
}

/* §4: the push of this whole call, for v. */
static __device__ void find_total(const struct mass_splitting &m, int64_t k)
{
    if (m.s.contact_awake[k])
        give(m, k, sub(total(&m.s.contact[k]), m.s.before[k]));
}

/* Work of a thread for vertex[k] */

static __device__ bool is_long(const struct contacts &s, int32_t i)
{
    return s.start[i + 1] - s.start[i] > LIST_SHORT;
}

/* §3: the first d: 0, as no contact acts yet; 1 for a vertex of one contact.
 * Vertices with long lists are listed, in any order. */
static __device__ void first_parts(const struct mass_splitting &m, int64_t k)
{
    int32_t i = m.s.vertex[k];
    m.s.moved[k] = 0;
    m.s.acting[i] = 0;
    m.s.parts[i] = m.s.start[i + 1] - m.s.start[i] == 1;
    if (is_long(m.s, i))
        m.longer[atomicAdd(m.n_longer, 1ull)] = (int32_t)k;
}

/* The pushes on a vertex. */
struct contacts_list {
    const struct pushed *pushed;
    __device__ vec value(int32_t at) const
    {
        struct pushed p = pushed[at];
        return p.push;
    }
};

/* A vertex in contact, for a thread or for a lane of a warp: vertex[k], whether
 * its contacts may have pushes, whether they are all awake, and the sum of the
 * pushes. */
struct pushed_vertex {
    int64_t k;
    int32_t i;
    bool awake, spread;
    vec sum;
    int lane, lanes;
};

template <bool BY_WARP>
static __device__ struct pushed_vertex
find_pushed(const struct mass_splitting &m, int64_t k)
{
    int32_t i = m.s.vertex[k], from = m.s.start[i], end = m.s.start[i + 1];
    struct contacts_list list = {m.pushed};
    int awake = m.s.vertex_awake[i];
    struct pushed_vertex p = {
        k, i, awake != ASLEEP, awake == SPREAD, make(0, 0, 0), 0, 1};
    if (BY_WARP) {
        p.lane = (int)threadIdx.x % WARP;
        p.lanes = WARP;
        p.sum = sum_by_warp(list, from, end, p.sum, m.row);
    } else if (p.awake) {
        p.sum = sum_by_thread(list, from, end, p.sum);
    }
    return p;
}

/* Adds w Σ c push to velocities u. False: the vertex is not pushed. */
static __device__ bool apply(const struct mass_splitting &m, vec *u,
                             struct pushed_vertex p)
{
    bool any = p.awake && (p.sum.x != 0 || p.sum.y != 0 || p.sum.z != 0);
    if (any && p.lane == 0) {
        u[p.i] = axpy(u[p.i], m.s.w[p.i], p.sum);
        m.s.moved[p.k] = 1;
    }
    return any;
}

/* §3: moves the vertex; keeps the new d unless the iteration was void; clears
 * the acting count for the next iteration. */
static __device__ void apply_normal(const struct mass_splitting &m,
                                    struct pushed_vertex p, bool over)
{
    if (apply(m, m.s.u, p) && !p.spread)
        spread(m.s, p.i, p.lane, p.lanes);
    if (p.lane)
        return;
    if (m.s.acting[p.i] > 0 && !over)
        m.s.parts[p.i] = split(m.s, p.i);
    m.s.acting[p.i] = 0;
}

#endif
