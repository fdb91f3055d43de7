/* SPDX-License-Identifier: Apache-2.0 */
/* Mass-splitting projected Jacobi. spec/34_contacts.md */
#include "gpu/incidence.cuh"

#include "ref/contacts.h"

/* Every kernel does nothing where a contact names no vertex. */
#define CONTACT(k)                                                             \
    ITEM(k, s.n);                                                              \
    if (words[INCIDENCE_BAD])                                                  \
    return

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

/* Thread k owns contact k: writes what it pushed before. */
static __global__ void __launch_bounds__(GPU_BLOCK)
    contacts_begin_kernel(struct contacts s, const int64_t *words)
{
    CONTACT(k);
    struct contact *c = &s.contact[k];
    if (!s.warm) {
        c->impulse = 0;
        c->tangent = make(0, 0, 0);
    }
    s.before[k] = total(c);
}

/* §2. Thread k owns vertex[k]: counts its contacts that act now. */
static __global__ void __launch_bounds__(GPU_BLOCK)
    contacts_split_kernel(struct contacts s, const int64_t *words)
{
    ITEM(k, s.n4);
    if (words[INCIDENCE_BAD] || k >= words[INCIDENCE_VERTICES])
        return;
    int32_t i = s.vertex[k], end = s.start[i + 1], parts = 0;
    for (int32_t j = s.start[i]; j < end; j++)
        parts += s.lack[s.item[j] / 4] != 0;
    s.parts[i] = parts;
}

/* §3. Thread k owns contact k: reads u of its vertices, writes lack[k]. */
static __global__ void __launch_bounds__(GPU_BLOCK)
    contacts_lack_kernel(struct contacts s, const int64_t *words)
{
    CONTACT(k);
    const struct contact *c = &s.contact[k];
    real lack = c->target - dot(c->n, weigh(c, s.u));
    s.lack[k] = lack > 0 || c->impulse > 0 ? lack : R(0.0);
}

/* §3. Thread k owns contact k: reads parts of its vertices, writes push[k] and
 * its impulse. */
static __global__ void __launch_bounds__(GPU_BLOCK)
    contacts_normal_kernel(struct contacts s, const int64_t *words)
{
    CONTACT(k);
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

/* §4. Thread k owns contact k: writes lack[k], not 0 if it can have friction.
 */
static __global__ void __launch_bounds__(GPU_BLOCK)
    contacts_friction_kernel(struct contacts s, const int64_t *words)
{
    CONTACT(k);
    const struct contact *c = &s.contact[k];
    s.lack[k] = c->impulse > 0 || dot(c->tangent, c->tangent) > 0;
}

/* §4. Thread k owns contact k: reads u and parts of its vertices, writes
 * push[k] and its tangent, within the cone. */
static __global__ void __launch_bounds__(GPU_BLOCK)
    contacts_tangent_kernel(struct contacts s, const int64_t *words)
{
    CONTACT(k);
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

/* Thread k owns contact k: push[k] is all that this call gave. */
static __global__ void __launch_bounds__(GPU_BLOCK)
    contacts_end_kernel(struct contacts s, const int64_t *words)
{
    CONTACT(k);
    s.push[k] = sub(total(&s.contact[k]), s.before[k]);
}

/* Thread k owns vertex[k]: adds w Σ c push of its items, in their order. */
static __global__ void __launch_bounds__(GPU_BLOCK)
    contacts_apply_kernel(struct contacts s, vec *u, const int64_t *words)
{
    enum { AHEAD = 8 }; /* items read before the first is added */
    ITEM(k, s.n4);
    if (words[INCIDENCE_BAD] || k >= words[INCIDENCE_VERTICES])
        return;
    int32_t i = s.vertex[k], end = s.start[i + 1];
    vec sum = make(0, 0, 0);
    for (int32_t j = s.start[i]; j < end; j += AHEAD) {
        real weight[AHEAD];
        vec push[AHEAD];
        UNROLL
        for (int a = 0; a < AHEAD; a++) {
            int32_t item = s.item[j + a < end ? j + a : j];
            weight[a] = s.contact[item / 4].c[item % 4];
            push[a] = s.push[item / 4];
        }
        UNROLL
        for (int a = 0; a < AHEAD; a++)
            sum = j + a < end ? axpy(sum, weight[a], push[a]) : sum;
    }
    u[i] = axpy(u[i], s.w[i], sum);
}

int gpu_contacts(struct gpu *g, struct contacts *s)
{
    if (s->iterations < 0 || s->nv1 != s->nv + 1 || s->n4 != 4 * s->n ||
        s->n4 > INT32_MAX)
        return DRAPE_EARG;
    struct incidence by = {s->nv,    s->n,    s->w,      s->contact,
                           s->start, s->item, s->vertex, 0};
    int64_t *words = gpu_words(g);
    int64_t touched = s->nv < s->n4 ? s->nv : s->n4;
    gpu_incidence(g, &by, words); /* §1 */
    LAUNCH(g, s->n, contacts_begin_kernel, *s, words);
    for (int t = 0; t < s->iterations; t++) {
        LAUNCH(g, s->n, contacts_lack_kernel, *s, words);
        LAUNCH(g, touched, contacts_split_kernel, *s, words);
        LAUNCH(g, s->n, contacts_normal_kernel, *s, words);
        LAUNCH(g, touched, contacts_apply_kernel, *s, s->u, words);
    }
    LAUNCH(g, s->n, contacts_friction_kernel, *s, words);
    LAUNCH(g, touched, contacts_split_kernel, *s, words);
    for (int t = 0; t < s->iterations; t++) {
        LAUNCH(g, s->n, contacts_tangent_kernel, *s, words);
        LAUNCH(g, touched, contacts_apply_kernel, *s, s->u, words);
    }
    LAUNCH(g, s->n, contacts_end_kernel, *s, words);
    LAUNCH(g, touched, contacts_apply_kernel, *s, s->v, words);

    const int64_t *seen = gpu_read_words(g, INCIDENCE_WORDS);
    s->vertices = seen[INCIDENCE_VERTICES];
    return seen[INCIDENCE_BAD] ? DRAPE_EARG : gpu_status(g);
}
