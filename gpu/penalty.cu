/* SPDX-License-Identifier: Apache-2.0 */
/* Contacts as the implicit system feels them. spec/38_penalty.md */
#include "gpu/box.cuh"
#include "gpu/incidence.cuh"
#include "gpu/jacobi.cuh"
#include "ref/penalty.h"

/* What an item adds to its vertex, all 0 where the contact is not held: a sum
 * that begins with +0 is never -0, so that no 0 changes it. The matrix is
 * along·n nᵀ + across·I. */
struct alignas(16) term {
    vec push, n;
    real along, across;
};

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

/* §3. Thread k owns place k of all lists: reads its item's contact, writes
 * term[k], of friction too where that is known. */
static __global__ void __launch_bounds__(GPU_BLOCK)
    penalty_term_kernel(struct penalty s, struct term *term, bool rubbed,
                        const int64_t *words)
{
    ITEM(k, s.n4);
    if (words[INCIDENCE_BAD] || k >= s.start[s.nv])
        return;
    int32_t item = s.item[k], j = item % 4;
    const struct contact *c = &s.contact[item / 4];
    struct term t = {};
    if (c->held) {
        real part = s.share[item / 4] / side_of(&s, c, j) * magnitude(c->c[j]);
        real along = part * s.stiffness * s.tau * s.tau;
        vec rub = axpy(c->tangent, c->impulse, c->n);
        t.across = part * (rubbed ? c->slide : 0) * (s.tau / s.dt);
        t.along = along - t.across;
        t.n = c->n;
        t.push =
            rubbed ? scale(c->c[j], rub) : scale(c->c[j] * c->impulse, t.n);
    }
    put_as<word16>(&term[k], t);
}

static __device__ sym hold_of(const struct term &t)
{
    real a = t.along, b = t.across;
    vec n = t.n;
    return sym{a * n.x * n.x + b, a * n.x * n.y, a * n.x * n.z,
               a * n.y * n.y + b, a * n.y * n.z, a * n.z * n.z + b};
}

/* Adds vertex i's terms in their order. AHEAD are read before the first is
 * added, as a thread has nothing else to wait for. */
template <class HOLD>
static __device__ void gather(const struct penalty *s, const struct term *term,
                              int32_t i, vec *force, HOLD *hold)
{
    enum { AHEAD = 4 };
    int32_t end = s->start[i + 1];
    for (int32_t at = s->start[i]; at < end; at += AHEAD) {
        struct term t[AHEAD], none = {};
        UNROLL
        for (int k = 0; k < AHEAD; k++)
            t[k] = fetch_as<word16>(term + least(at + k, end - 1));
        UNROLL
        for (int k = 1; k < AHEAD; k++)
            t[k] = at + k < end ? t[k] : none; /* adding it changes nothing */
        UNROLL
        for (int k = 0; k < AHEAD; k++) {
            *force = add(*force, t[k].push);
            *hold = add(*hold, hold_of(t[k]));
        }
    }
}

/* §2.1. Thread k owns vertex[k]: reads its terms in their order, moves its
 * guess. */
static __global__ void __launch_bounds__(GPU_BLOCK)
    penalty_guess_kernel(struct penalty s, const struct term *term,
                         const int64_t *words)
{
    ITEM(k, s.n4);
    if (words[INCIDENCE_BAD] || k >= words[INCIDENCE_VERTICES])
        return;
    int32_t i = s.vertex[k];
    vec force = make(0, 0, 0);
    double mass = 1 / (double)s.w[i];
    struct wide_sym a = {{mass, 0, 0, mass, 0, mass}};
    gather(&s, term, i, &force, &a);
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
    enum { AHEAD = 8 };
    ITEM(k, s.n4);
    if (words[INCIDENCE_BAD] || k >= words[INCIDENCE_VERTICES])
        return;
    int32_t i = s.vertex[k], end = s.start[i + 1];
    real sum = 0;
    for (int32_t at = s.start[i]; at < end; at += AHEAD) {
        real part[AHEAD];
        UNROLL
        for (int k = 0; k < AHEAD; k++) {
            int32_t item = s.item[at + k < end ? at + k : at];
            part[k] =
                magnitude(s.contact[item / 4].c[item % 4]) * s.more[item / 4];
        }
        UNROLL
        for (int k = 0; k < AHEAD; k++)
            sum = at + k < end ? sum + part[k] : sum;
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
 * elsewhere, from its terms in their order. */
static __global__ void __launch_bounds__(GPU_BLOCK)
    penalty_gather_kernel(struct penalty s, const struct term *term,
                          const int64_t *words)
{
    ITEM(k, s.n4);
    if (words[INCIDENCE_BAD] || k >= words[INCIDENCE_VERTICES])
        return;
    int32_t i = s.vertex[k];
    vec force = make(0, 0, 0);
    sym hold = {0, 0, 0, 0, 0, 0};
    gather(&s, term, i, &force, &hold);
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
    struct term *term =
        (struct term *)gpu_scratch(g, SLOT_STAGE, s->n4, sizeof *term);
    int64_t touched = s->nv < s->n4 ? s->nv : s->n4;
    gpu_clear(g, s->force, (size_t)s->nv * sizeof *s->force);
    gpu_clear(g, s->hold, (size_t)s->nv * sizeof *s->hold);
    LAUNCH(g, s->nv, penalty_let_go_kernel, *s);
    LAUNCH(g, s->n, penalty_press_kernel, *s, words);
    LAUNCH(g, s->n4, penalty_term_kernel, *s, term, false, words);
    LAUNCH(g, touched, penalty_guess_kernel, *s, term, words);
    LAUNCH(g, s->n, penalty_load_kernel, *s, words);
    LAUNCH(g, touched, penalty_brake_kernel, *s, words);
    LAUNCH(g, s->n, penalty_rub_kernel, *s, words);
    LAUNCH(g, s->n4, penalty_term_kernel, *s, term, true, words);
    LAUNCH(g, touched, penalty_gather_kernel, *s, term, words);
    const int64_t *seen = gpu_read_words(g, INCIDENCE_WORDS);
    return seen[INCIDENCE_BAD] ? DRAPE_EARG : gpu_status(g);
}
