/* SPDX-License-Identifier: Apache-2.0 */
/* Mass splitting: what one thread does of a contact, or of a vertex.
 * spec/34_contacts.md */
#ifndef GPU_CONTACTS_CUH
#define GPU_CONTACTS_CUH

#include "gpu/contact.cuh"

#include "ref/contacts.h"

/* §2: the mass that a contact moves when its vertices are split. */
static __device__ real effective_mass(const struct contacts *s,
                                      const struct contact *c)
{
    real sum = 0, largest = 0;
    for (int k = 0; k < 4; k++) {
        int32_t i = c->v[k];
        if (c->c[k] == 0 || !(s->w[i] > 0))
            continue;
        real w = (real)s->parts[i] * s->w[i];
        sum += c->c[k] * c->c[k] * w;
        largest = most(w, largest);
    }
    sum = most(sum, R(0x1p-12) * largest);
    return sum > 0 ? 1 / sum : 0;
}

static __device__ vec total(const struct contact *c)
{
    return axpy(c->tangent, c->impulse, c->n);
}

/* ---- §1 What takes part ---- */

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

/* §3. Of its vertices' u. */
static __device__ real lack_of(const struct contacts &s,
                               const struct contact *c)
{
    real lack = c->target - dot(c->n, weigh(c, s.u));
    return lack > 0 || c->impulse > 0 ? lack : R(0.0);
}

/* Writes what it pushed before, lack[k] and push[k]. */
static __device__ void begin(const struct contacts &s, int64_t k)
{
    struct contact *c = &s.contact[k];
    if (!s.warm) {
        c->impulse = 0;
        c->tangent = make(0, 0, 0);
    }
    s.awake[k] = ASLEEP;
    s.before[k] = total(c);
    s.push[k] = make(0, 0, 0);
    s.lack[k] = lack_of(s, c);
    if (s.lack[k] != 0)
        wake(s, k);
}

/* §3. Reads u of its vertices, writes lack[k]. */
static __device__ void find_lack(const struct contacts &s, int64_t k)
{
    if (s.awake[k])
        s.lack[k] = lack_of(s, &s.contact[k]);
}

/* §3. Reads parts of its vertices, writes push[k] and its impulse. */
static __device__ void push_normal(const struct contacts &s, int64_t k)
{
    if (!s.awake[k])
        return;
    struct contact *c = &s.contact[k];
    real lack = s.lack[k], now = c->impulse;
    vec push = make(0, 0, 0);
    if (lack != 0) {
        real next = most(now + effective_mass(&s, c) * lack, R(0.0));
        push = scale(next - now, c->n);
        c->impulse = next;
    }
    s.push[k] = push;
}

/* §4. Writes lack[k], not 0 if it can have friction. */
static __device__ void find_friction(const struct contacts &s, int64_t k)
{
    const struct contact *c = &s.contact[k];
    s.lack[k] = c->impulse > 0 || dot(c->tangent, c->tangent) > 0;
    if (s.lack[k] != 0)
        wake(s, k);
}

/* §4. Reads u and parts of its vertices, writes push[k] and its tangent, within
 * the cone. */
static __device__ void push_tangent(const struct contacts &s, int64_t k)
{
    if (!s.awake[k])
        return;
    struct contact *c = &s.contact[k];
    if (s.lack[k] == 0) {
        s.push[k] = make(0, 0, 0);
        return;
    }
    vec u = weigh(c, s.u);
    u = axpy(u, -dot(c->n, u), c->n);
    vec next = axpy(c->tangent, -effective_mass(&s, c), u);
    real limit = c->friction * c->impulse, l = length(next);
    if (l > limit)
        next = scale(limit / l, next);
    s.push[k] = sub(next, c->tangent);
    c->tangent = next;
}

/* push[k] is all that this call gave. */
static __device__ void end(const struct contacts &s, int64_t k)
{
    if (s.awake[k])
        s.push[k] = sub(total(&s.contact[k]), s.before[k]);
}

/* ---- What a thread does of vertex[k]; AHEAD items are read at a time ---- */

enum { AHEAD = 8 };

static __device__ void stay(const struct contacts &s, int64_t k)
{
    s.moved[k] = 0;
}

/* §2. Counts its contacts that act now. */
static __device__ void split(const struct contacts &s, int64_t k)
{
    int32_t i = s.vertex[k];
    if (!s.stirred[i])
        return;
    int32_t last = s.start[i + 1], parts = 0;
    for (int32_t j = s.start[i]; j < last; j += AHEAD) {
        bool acts[AHEAD];
        UNROLL
        for (int a = 0; a < AHEAD; a++)
            acts[a] = s.lack[s.item[j + a < last ? j + a : j] / 4] != 0;
        UNROLL
        for (int a = 0; a < AHEAD; a++)
            parts += j + a < last && acts[a];
    }
    s.parts[i] = parts;
}

/* Σ c push of the items of vertex i, in their order. */
static __device__ vec gather(const struct contacts &s, int32_t i)
{
    int32_t last = s.start[i + 1];
    vec sum = make(0, 0, 0);
    for (int32_t j = s.start[i]; j < last; j += AHEAD) {
        real weight[AHEAD];
        vec push[AHEAD];
        UNROLL
        for (int a = 0; a < AHEAD; a++) {
            int32_t item = s.item[j + a < last ? j + a : j];
            weight[a] = s.contact[item / 4].c[item % 4];
            push[a] = s.push[item / 4];
        }
        UNROLL
        for (int a = 0; a < AHEAD; a++)
            sum = j + a < last ? axpy(sum, weight[a], push[a]) : sum;
    }
    return sum;
}

/* Adds w Σ c push to u or v. False: nothing pushes it. */
static __device__ bool apply(const struct contacts &s, vec *u, int64_t k)
{
    int32_t i = s.vertex[k];
    if (!s.stirred[i])
        return false;
    vec sum = gather(s, i);
    bool pushed = sum.x != 0 || sum.y != 0 || sum.z != 0;
    if (pushed) {
        u[i] = axpy(u[i], s.w[i], sum);
        s.moved[k] = 1;
    }
    return pushed;
}

static __device__ void apply_normal(const struct contacts &s, int64_t k)
{
    if (apply(s, s.u, k))
        spread(s, s.vertex[k]);
}

static __device__ void apply_tangent(const struct contacts &s, int64_t k)
{
    apply(s, s.u, k);
}

static __device__ void apply_all(const struct contacts &s, int64_t k)
{
    apply(s, s.v, k);
}

#endif
