/* SPDX-License-Identifier: Apache-2.0 */
/* Mass splitting: what one thread does of a contact, or of a vertex.
 * spec/contact/contacts.md */
#ifndef GPU_CONTACTS_CUH
#define GPU_CONTACTS_CUH

#include "gpu/contact/contact.cuh"

extern "C" {
#include "ref/contact/contacts.h"
}

/* What contact k pushes vertex j by stands at slot[4 k + j] of `pushed`, where
 * all pushes of a vertex lie side by side: one reads them without a look at the
 * contacts. */
struct alignas(4 * sizeof(real)) pushed {
    vec push; /* c times it, N·s */
    real none;
};

struct mass_splitting {
    struct contacts s;
    const int32_t *slot;   /* [4 n] -1: it pushes nothing */
    struct pushed *pushed; /* [4 n] */
    int64_t *over;         /* 1 + the last iteration of §3 that was void */
};

/* ---- §1 What takes part ---- */

/* Of contacts, beside enum waking: what it pushed is not 0. */
enum { PUSHED = AWAKE + 1 };

/* Threads that wake the same one write the same; who reads it meanwhile finds
 * nothing to do in either case. */
static __device__ void wake(const struct contacts &s, int64_t k)
{
    const struct contact *c = &s.contact[k];
    s.awake[k] = AWAKE;
    for (int j = 0; j < 4; j++)
        if (!s.stirred[c->v[j]])
            s.stirred[c->v[j]] = AWAKE;
}

static __device__ void spread(const struct contacts &s, int32_t i)
{
    if (s.stirred[i] == SPREAD)
        return;
    s.stirred[i] = SPREAD;
    for (int32_t j = s.start[i]; j < s.start[i + 1]; j++)
        if (!s.awake[s.item[j] / 4])
            wake(s, s.item[j] / 4);
}

/* ---- What a thread does of contact k ---- */

static __device__ vec total(const struct contact *c)
{
    return axpy(c->tangent, c->impulse, c->n);
}

/* §3: into how many parts vertex i is split, if anything acts on it. */
static __device__ int32_t split(const struct contacts &s, int32_t i)
{
    int32_t acting = s.acting[i], d = s.parts[i];
    if (s.keep == 0 || (d > 0 && d < acting))
        return acting;
    return d == 0 ? acting + 1 : d; /* one may join */
}

/* §2: the mass that a contact moves when its vertices are split. */
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
        largest = most(w, largest);
    }
    sum = most(sum, R(0x1p-12) * largest);
    return sum > 0 ? 1 / sum : 0;
}

/* §3: it acts, so it counts for each of its vertices. True: that makes the
 * iteration void. */
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
    m.s.awake[k] = PUSHED;
}

/* Whether it acts; if not, it pushes nothing from here on. */
static __device__ bool acts(const struct mass_splitting &m, int64_t k)
{
    if (!m.s.awake[k] || m.s.lack[k] != 0 ||
        m.s.ahead[k] != m.s.contact[k].impulse)
        return m.s.awake[k];
    if (m.s.awake[k] == PUSHED) {
        give(m, k, make(0, 0, 0));
        m.s.awake[k] = AWAKE;
    }
    return false;
}

/* §3. Of its vertices' u. */
static __device__ real lack_of(const struct contacts &s, int64_t k)
{
    const struct contact *c = &s.contact[k];
    real lack = c->target - dot(c->n, weigh(c, s.u));
    return lack > 0 || s.ahead[k] > 0 ? lack : R(0.0);
}

/* Writes what it pushed before, ahead[k] and lack[k]. */
static __device__ void begin(const struct mass_splitting &m, int64_t k)
{
    const struct contacts &s = m.s;
    struct contact *c = &s.contact[k];
    if (!s.warm) {
        c->impulse = 0;
        c->tangent = make(0, 0, 0);
    }
    s.awake[k] = ASLEEP;
    s.before[k] = total(c);
    s.ahead[k] = c->impulse;
    s.lack[k] = lack_of(s, k);
    if (s.lack[k] != 0)
        wake(s, k);
}

/* §3, of iteration t. Reads u and d of its vertices, writes lack[k], adds to
 * what acts on them. */
static __device__ void find_lack(const struct mass_splitting &m, int64_t k,
                                 int t, real beta)
{
    if (!m.s.awake[k])
        return;
    m.s.lack[k] = lack_of(m.s, k);
    if (m.s.lack[k] != 0 && count(m, k, beta))
        *m.over = t + 1; /* whoever finds it writes the same */
}

/* §3: to the next y. u follows. */
static __device__ void go_to(const struct mass_splitting &m, int64_t k, real y)
{
    give(m, k, scale(y - m.s.ahead[k], m.s.contact[k].n));
    m.s.ahead[k] = y;
}

/* §3. Reads what splits its vertices, writes its impulse, where it goes and
 * what it pushes for that. */
static __device__ void push_normal(const struct mass_splitting &m, int64_t k)
{
    const struct contacts &s = m.s;
    if (!acts(m, k))
        return;
    struct contact *c = &s.contact[k];
    real y = s.ahead[k], was = c->impulse, now = y;
    if (s.lack[k] != 0)
        now = most(y + effective_mass(s, c) * s.lack[k], R(0.0));
    c->impulse = now;
    go_to(m, k, most(now + s.keep * (now - was), R(0.0)));
}

/* §3: what a void iteration does instead. */
static __device__ void go_back(const struct mass_splitting &m, int64_t k)
{
    real now = m.s.contact[k].impulse;
    if (acts(m, k))
        go_to(m, k, now + m.s.keep * (m.s.ahead[k] - now));
}

/* §4. Writes lack[k], not 0 if it can have friction, and adds to what acts. */
static __device__ void find_friction(const struct mass_splitting &m, int64_t k)
{
    const struct contact *c = &m.s.contact[k];
    m.s.lack[k] = c->impulse > 0 || dot(c->tangent, c->tangent) > 0;
    if (m.s.lack[k] == 0)
        return;
    if (!m.s.awake[k])
        wake(m.s, k);
    count(m, k, R(0.0));
}

/* §4. Reads u of its vertices and what splits them, writes what it pushes and
 * its tangent, within the cone. */
static __device__ void push_tangent(const struct mass_splitting &m, int64_t k)
{
    const struct contacts &s = m.s;
    if (!acts(m, k))
        return;
    struct contact *c = &s.contact[k];
    vec u = weigh(c, s.u);
    u = axpy(u, -dot(c->n, u), c->n);
    vec next = axpy(c->tangent, -effective_mass(s, c), u);
    real limit = c->friction * c->impulse, l = length(next);
    if (l > limit)
        next = scale(limit / l, next);
    vec push = sub(next, c->tangent);
    c->tangent = next;
    give(m, k, push);
}

/* It pushes all that this call gave. */
static __device__ void end(const struct mass_splitting &m, int64_t k)
{
    if (m.s.awake[k])
        give(m, k, sub(total(&m.s.contact[k]), m.s.before[k]));
}

/* ---- What a thread does of vertex[k] ---- */

/* §3: where nothing acts yet; a single contact is never more. */
static __device__ void stay(const struct mass_splitting &m, int64_t k)
{
    int32_t i = m.s.vertex[k];
    m.s.moved[k] = 0;
    m.s.acting[i] = 0;
    m.s.parts[i] = m.s.start[i + 1] - m.s.start[i] == 1;
}

/* Adds w Σ c push to u or v. False: nothing pushes it. */
static __device__ bool apply(const struct mass_splitting &m, vec *u, int64_t k)
{
    int32_t i = m.s.vertex[k];
    if (!m.s.stirred[i])
        return false;
    vec sum = make(0, 0, 0);
    int32_t last = m.s.start[i + 1];
    UNROLL_8
    for (int32_t j = m.s.start[i]; j < last; j++) {
        struct pushed p = m.pushed[j];
        sum = add(sum, p.push);
    }
    bool any = sum.x != 0 || sum.y != 0 || sum.z != 0;
    if (any) {
        u[i] = axpy(u[i], m.s.w[i], sum);
        m.s.moved[k] = 1;
    }
    return any;
}

/* Leaves nothing that acts, for the next iteration. */
static __device__ void apply_normal(const struct mass_splitting &m, int64_t k,
                                    bool over)
{
    int32_t i = m.s.vertex[k];
    if (apply(m, m.s.u, k))
        spread(m.s, i);
    if (m.s.acting[i] > 0 && !over)
        m.s.parts[i] = split(m.s, i);
    m.s.acting[i] = 0;
}

static __device__ void apply_tangent(const struct mass_splitting &m, int64_t k)
{
    apply(m, m.s.u, k);
}

static __device__ void apply_all(const struct mass_splitting &m, int64_t k)
{
    apply(m, m.s.v, k);
}

#endif
