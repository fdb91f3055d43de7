/* SPDX-License-Identifier: Apache-2.0 */
/* Contacts as the implicit system feels them. spec/38_penalty.md */
#include "gpu/incidence.cuh"
#include "gpu/jacobi.cuh"
#include "ref/penalty.h"

/* §3: the weight of the side that vertex j of a contact is on. */
static __device__ real side_of(const struct penalty *s, const struct contact *c,
                               int j)
{
    int split = c->kind == CONTACT_VF ? 1 : 2;
    int from = j < split ? 0 : split, to = j < split ? split : 4;
    real least = 0;
    for (int i = from; i < to; i++) {
        real w = s->w[c->v[i]];
        if (w > 0 && (least == 0 || w < least))
            least = w;
    }
    return least;
}

/* §1: what the spring of a contact pushes with at velocities u, N·s. */
static __device__ real spring(const struct penalty *s, const struct contact *c,
                              const vec *u)
{
    real give = s->stiffness * s->dt * s->tau;
    return give * (c->target - dot(c->n, weigh(c, u)));
}

/* §1. Thread i owns vertex i: writes guess[i], and brake[i] as without
 * contacts. */
static __global__ void __launch_bounds__(GPU_BLOCK)
    penalty_let_go_kernel(struct penalty s)
{
    ITEM(i, s.nv);
    real w = s.w[i] * (s.tau / s.dt);
    s.guess[i] = w > 0 ? axpy(s.u[i], -w, s.g[i]) : s.u[i];
    s.brake[i] = 0;
}

/* §1. Thread k owns contact k: reads guess of its vertices, writes share[k],
 * its impulse and whether it is held. */
static __global__ void __launch_bounds__(GPU_BLOCK)
    penalty_press_kernel(struct penalty s, const int64_t *words)
{
    ITEM(k, s.n);
    if (words[INCIDENCE_BAD])
        return;
    struct contact *c = &s.contact[k];
    real impulse = most(spring(&s, c, s.guess), R(0.0));
    real share = 0;
    for (int j = 0; j < 4; j++)
        if (s.w[c->v[j]] > 0)
            share += magnitude(c->c[j]) * side_of(&s, c, j);
    c->impulse = impulse;
    c->held = impulse > 0 || spring(&s, c, s.u) > 0;
    s.share[k] = share;
}

/* §3: what contact k adds to the hold of its vertex j. */
static __device__ sym hold_of(const struct penalty *s, int32_t k, int j,
                              real slide)
{
    const struct contact *a = &s->contact[k];
    real part = s->share[k] / side_of(s, a, j) * magnitude(a->c[j]);
    real along = part * s->stiffness * s->tau * s->tau;
    real across = part * slide * (s->tau / s->dt);
    real d = along - across;
    vec n = a->n;
    return sym{d * n.x * n.x + across, d * n.x * n.y, d * n.x * n.z,
               d * n.y * n.y + across, d * n.y * n.z, d * n.z * n.z + across};
}

/* §2.1. Thread k owns vertex[k]: reads its items in their order, moves its
 * guess. */
static __global__ void __launch_bounds__(GPU_BLOCK)
    penalty_guess_kernel(struct penalty s, const int64_t *words)
{
    ITEM(k, s.n4);
    if (words[INCIDENCE_BAD] || k >= words[INCIDENCE_VERTICES])
        return;
    int32_t i = s.vertex[k], end = s.start[i + 1];
    vec force = make(0, 0, 0);
    double mass = 1 / (double)s.w[i];
    struct wide_sym a = {{mass, 0, 0, mass, 0, mass}};
    for (int32_t at = s.start[i]; at < end; at++) {
        int32_t item = s.item[at];
        const struct contact *c = &s.contact[item / 4];
        if (!c->held)
            continue;
        force = axpy(force, c->c[item % 4] * c->impulse, c->n);
        a = add(a, hold_of(&s, item / 4, item % 4, 0));
    }
    vec move = solved(factored(a), force);
    s.guess[i] = axpy(s.guess[i], s.tau / s.dt, move);
}

static __device__ vec across(const struct contact *c, const vec *u)
{
    vec v = weigh(c, u);
    return axpy(v, -dot(c->n, v), c->n);
}

/* §2.2. Thread k owns contact k: reads guess and u of its vertices, writes
 * most[k] and more[k]. */
static __global__ void __launch_bounds__(GPU_BLOCK)
    penalty_load_kernel(struct penalty s, const int64_t *words)
{
    ITEM(k, s.n);
    if (words[INCIDENCE_BAD])
        return;
    const struct contact *c = &s.contact[k];
    real limit = 0;
    if (c->held)
        limit = c->friction * most(spring(&s, c, s.guess), R(0.0));
    s.most[k] = limit;
    s.more[k] = limit - c->slide * length(across(c, s.u));
}

/* §2.3. Thread k owns vertex[k]: reads its items in their order, writes its
 * brake. */
static __global__ void __launch_bounds__(GPU_BLOCK)
    penalty_brake_kernel(struct penalty s, const int64_t *words)
{
    ITEM(k, s.n4);
    if (words[INCIDENCE_BAD] || k >= words[INCIDENCE_VERTICES])
        return;
    int32_t i = s.vertex[k], end = s.start[i + 1];
    real sum = 0;
    for (int32_t at = s.start[i]; at < end; at++) {
        int32_t item = s.item[at];
        sum += magnitude(s.contact[item / 4].c[item % 4]) * s.more[item / 4];
    }
    s.brake[i] = sum * s.w[i] * (s.tau / s.dt);
}

/* §2.4. Thread k owns contact k: reads brake and u of its vertices, writes its
 * slide, impulse and tangent. */
static __global__ void __launch_bounds__(GPU_BLOCK)
    penalty_rub_kernel(struct penalty s, const int64_t *words)
{
    ITEM(k, s.n);
    if (words[INCIDENCE_BAD])
        return;
    struct contact *c = &s.contact[k];
    vec slip = across(c, s.u);
    real speed = length(slip);
    for (int j = 0; j < 4; j++)
        speed -= magnitude(c->c[j]) * s.brake[c->v[j]];
    real slide = s.most[k] / most(speed, s.slip);
    c->slide = slide;
    c->impulse = c->held ? spring(&s, c, s.u) : R(0.0);
    c->tangent = scale(-slide, slip);
}

/* §3. Thread k owns vertex[k]: writes its force and hold, which are 0
 * elsewhere, from its items in their order. */
static __global__ void __launch_bounds__(GPU_BLOCK)
    penalty_gather_kernel(struct penalty s, const int64_t *words)
{
    ITEM(k, s.n4);
    if (words[INCIDENCE_BAD] || k >= words[INCIDENCE_VERTICES])
        return;
    int32_t i = s.vertex[k], end = s.start[i + 1];
    vec force = make(0, 0, 0);
    sym hold = {0, 0, 0, 0, 0, 0};
    for (int32_t j = s.start[i]; j < end; j++) {
        int32_t at = s.item[j] / 4;
        const struct contact *c = &s.contact[at];
        if (!c->held)
            continue;
        real weight = c->c[s.item[j] % 4];
        force = axpy(force, weight, axpy(c->tangent, c->impulse, c->n));
        hold = add(hold, hold_of(&s, at, s.item[j] % 4, c->slide));
    }
    s.force[i] = force;
    s.hold[i] = hold;
}

int gpu_penalty(struct gpu *g, struct penalty *s)
{
    if (!(s->dt > 0 && s->tau > 0 && s->stiffness > 0 && s->slip > 0) ||
        s->nv1 != s->nv + 1 || s->n4 != 4 * s->n || s->n4 > INT32_MAX)
        return DRAPE_EARG;
    struct incidence by = {s->nv,    s->n,    s->w,      s->contact,
                           s->start, s->item, s->vertex, 0};
    int64_t *words = gpu_words(g);
    gpu_incidence(g, &by, words);
    gpu_clear(g, s->force, (size_t)s->nv * sizeof *s->force);
    gpu_clear(g, s->hold, (size_t)s->nv * sizeof *s->hold);
    LAUNCH(g, s->nv, penalty_let_go_kernel, *s);
    LAUNCH(g, s->n, penalty_press_kernel, *s, words);
    LAUNCH(g, s->n4, penalty_guess_kernel, *s, words);
    LAUNCH(g, s->n, penalty_load_kernel, *s, words);
    LAUNCH(g, s->n4, penalty_brake_kernel, *s, words);
    LAUNCH(g, s->n, penalty_rub_kernel, *s, words);
    LAUNCH(g, s->n4, penalty_gather_kernel, *s, words);
    const int64_t *seen = gpu_read_words(g, INCIDENCE_WORDS);
    return seen[INCIDENCE_BAD] ? DRAPE_EARG : gpu_status(g);
}
