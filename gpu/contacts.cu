/* SPDX-License-Identifier: Apache-2.0 */
/* Mass-splitting projected Jacobi. spec/34_contacts.md */
#include "gpu/incidence.cuh"
#include "gpu/team.cuh"

#include "ref/contacts.h"

/* Below so many contacts one team makes all passes, as launches would take
 * longer; TEAM_BLOCK: the threads of a rank. */
#ifdef __CUDACC__
enum { TEAM_CONTACTS = 1 << 16, TEAM_BLOCK = 1024 };
#else
enum { TEAM_CONTACTS = 40, TEAM_BLOCK = 64 };
#endif

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

/* ---- What a thread does of contact k ---- */

/* Writes what it pushed before. */
static __device__ void begin(const struct contacts &s, int64_t k)
{
    struct contact *c = &s.contact[k];
    if (!s.warm) {
        c->impulse = 0;
        c->tangent = make(0, 0, 0);
    }
    s.before[k] = total(c);
}

/* §3. Reads u of its vertices, writes lack[k]. */
static __device__ void find_lack(const struct contacts &s, int64_t k)
{
    const struct contact *c = &s.contact[k];
    real lack = c->target - dot(c->n, weigh(c, s.u));
    s.lack[k] = lack > 0 || c->impulse > 0 ? lack : R(0.0);
}

/* §3. Reads parts of its vertices, writes push[k] and its impulse. */
static __device__ void push_normal(const struct contacts &s, int64_t k)
{
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
}

/* §4. Reads u and parts of its vertices, writes push[k] and its tangent, within
 * the cone. */
static __device__ void push_tangent(const struct contacts &s, int64_t k)
{
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
    s.push[k] = sub(total(&s.contact[k]), s.before[k]);
}

/* ---- What a thread does of vertex[k]; AHEAD items are read at a time ---- */

enum { AHEAD = 8 };

/* §2. Counts its contacts that act now. */
static __device__ void split(const struct contacts &s, int64_t k)
{
    int32_t i = s.vertex[k], last = s.start[i + 1], parts = 0;
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

/* Adds w Σ c push of its items, in their order. */
static __device__ void apply(const struct contacts &s, vec *u, int64_t k)
{
    int32_t i = s.vertex[k], last = s.start[i + 1];
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
    u[i] = axpy(u[i], s.w[i], sum);
}

static __device__ void apply_u(const struct contacts &s, int64_t k)
{
    apply(s, s.u, k);
}

static __device__ void apply_v(const struct contacts &s, int64_t k)
{
    apply(s, s.v, k);
}

/* ---- One launch a pass ---- */

/* Thread k owns contact k. Nothing where a contact names no vertex. */
template <void ACT(const struct contacts &, int64_t)>
static __global__ void __launch_bounds__(GPU_BLOCK)
    contacts_each_kernel(struct contacts s, const int64_t *words)
{
    ITEM(k, s.n);
    if (!words[INCIDENCE_BAD])
        ACT(s, k);
}

/* Thread k owns vertex[k]. */
template <void ACT(const struct contacts &, int64_t)>
static __global__ void __launch_bounds__(GPU_BLOCK)
    contacts_vertex_kernel(struct contacts s, const int64_t *words)
{
    ITEM(k, s.n4);
    if (!words[INCIDENCE_BAD] && k < words[INCIDENCE_VERTICES])
        ACT(s, k);
}

static void launch(struct gpu *g, const struct contacts *s,
                   const int64_t *words)
{
    int64_t n = s->n, touched = s->nv < s->n4 ? s->nv : s->n4;
    LAUNCH(g, n, contacts_each_kernel<begin>, *s, words);
    for (int t = 0; t < s->iterations; t++) {
        LAUNCH(g, n, contacts_each_kernel<find_lack>, *s, words);
        LAUNCH(g, touched, contacts_vertex_kernel<split>, *s, words);
        LAUNCH(g, n, contacts_each_kernel<push_normal>, *s, words);
        LAUNCH(g, touched, contacts_vertex_kernel<apply_u>, *s, words);
    }
    LAUNCH(g, n, contacts_each_kernel<find_friction>, *s, words);
    LAUNCH(g, touched, contacts_vertex_kernel<split>, *s, words);
    for (int t = 0; t < s->iterations; t++) {
        LAUNCH(g, n, contacts_each_kernel<push_tangent>, *s, words);
        LAUNCH(g, touched, contacts_vertex_kernel<apply_u>, *s, words);
    }
    LAUNCH(g, n, contacts_each_kernel<end>, *s, words);
    LAUNCH(g, touched, contacts_vertex_kernel<apply_v>, *s, words);
}

/* ---- All passes by one team ---- */

/* A pass, and a barrier after it. */
template <void ACT(const struct contacts &, int64_t)>
static __device__ void pass(const struct contacts &s, int64_t n)
{
    EACH_OF_TEAM(k, n)
    ACT(s, k);
    team_sync(false);
}

/* The passes of launch(). */
static __global__ void __launch_bounds__(TEAM_BLOCK)
    contacts_team_kernel(struct contacts s, const int64_t *words)
{
    int64_t n = words[INCIDENCE_BAD] ? 0 : s.n;
    int64_t touched = words[INCIDENCE_BAD] ? 0 : words[INCIDENCE_VERTICES];
    pass<begin>(s, n);
    for (int t = 0; t < s.iterations; t++) {
        pass<find_lack>(s, n);
        pass<split>(s, touched);
        pass<push_normal>(s, n);
        pass<apply_u>(s, touched);
    }
    pass<find_friction>(s, n);
    pass<split>(s, touched);
    for (int t = 0; t < s.iterations; t++) {
        pass<push_tangent>(s, n);
        pass<apply_u>(s, touched);
    }
    pass<end>(s, n);
    pass<apply_v>(s, touched);
}

int gpu_contacts(struct gpu *g, struct contacts *s)
{
    if (s->iterations < 0 || s->nv1 != s->nv + 1 || s->n4 != 4 * s->n ||
        s->n4 > INT32_MAX)
        return DRAPE_EARG;
    struct incidence by = {s->nv,    s->n,    s->w,      s->contact,
                           s->start, s->item, s->vertex, 0};
    int64_t *words = gpu_words(g);
    gpu_incidence(g, &by, words); /* §1 */
    if (s->n < TEAM_CONTACTS)
        LAUNCH_TEAM(g, TEAM_BLOCK, 0, contacts_team_kernel, *s, words);
    else
        launch(g, s, words);
    const int64_t *seen = gpu_read_words(g, INCIDENCE_WORDS);
    s->vertices = seen[INCIDENCE_VERTICES];
    return seen[INCIDENCE_BAD] ? DRAPE_EARG : gpu_status(g);
}
