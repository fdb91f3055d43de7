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
        real w = (real)(s->start[i + 1] - s->start[i]) * s->w[i];
        sum += c->c[k] * c->c[k] * w;
        largest = most(c->c[k] != 0 ? w : 0, largest);
    }
    sum = most(sum, R(0x1p-12) * largest);
    return sum > 0 ? 1 / sum : 0;
}

static __device__ vec total(const struct contact *c)
{
    return axpy(c->tangent, c->impulse, c->n);
}

/* Thread k owns contact k: writes its mass and what it pushed before. */
static __global__ void __launch_bounds__(GPU_BLOCK)
    contacts_begin_kernel(struct contacts s, const int64_t *words)
{
    CONTACT(k);
    struct contact *c = &s.contact[k];
    s.mass[k] = effective_mass(&s, c);
    if (s.warm) {
        s.before[k] = total(c);
        return;
    }
    c->impulse = 0;
    c->tangent = s.before[k] = make(0, 0, 0);
}

/* §3. Thread k owns contact k: reads u of its vertices, writes push[k] and
 * its impulse. */
static __global__ void __launch_bounds__(GPU_BLOCK)
    contacts_normal_kernel(struct contacts s, const int64_t *words)
{
    CONTACT(k);
    struct contact *c = &s.contact[k];
    real vn = dot(c->n, weigh(c, s.u));
    real now = c->impulse;
    real next = most(now + s.mass[k] * (c->target - vn), R(0.0));
    s.push[k] = scale(next - now, c->n);
    c->impulse = next;
}

/* §4. Thread k owns contact k: reads u of its vertices, writes push[k] and
 * its tangent, within the cone. */
static __global__ void __launch_bounds__(GPU_BLOCK)
    contacts_tangent_kernel(struct contacts s, const int64_t *words)
{
    CONTACT(k);
    struct contact *c = &s.contact[k];
    vec u = weigh(c, s.u);
    u = axpy(u, -dot(c->n, u), c->n);
    vec next = axpy(c->tangent, -s.mass[k], u);
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
        LAUNCH(g, s->n, contacts_normal_kernel, *s, words);
        LAUNCH(g, touched, contacts_apply_kernel, *s, s->u, words);
    }
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
