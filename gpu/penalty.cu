/* SPDX-License-Identifier: Apache-2.0 */
/* Contacts as the implicit system feels them. spec/38_penalty.md */
#include "gpu/incidence.cuh"

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

/* §1, §2. Thread k owns contact k: reads u of its vertices, writes its
 * impulse and tangent, slide[k] and share[k]. */
static __global__ void __launch_bounds__(GPU_BLOCK)
    penalty_press_kernel(struct penalty s, const int64_t *words)
{
    ITEM(k, s.n);
    if (words[INCIDENCE_BAD])
        return;
    struct contact *c = &s.contact[k];
    vec u = weigh(c, s.u);
    real vn = dot(c->n, u);
    vec across = axpy(u, -vn, c->n);
    real give = s.stiffness * s.dt * s.tau;
    real impulse = most(give * (c->target - vn), R(0.0));
    real slide = c->friction * impulse / most(length(across), s.slip);
    real share = 0;
    for (int j = 0; j < 4; j++)
        if (s.w[c->v[j]] > 0)
            share += magnitude(c->c[j]) * side_of(&s, c, j);
    c->impulse = impulse;
    c->tangent = scale(-slide, across);
    s.slide[k] = slide;
    s.share[k] = share;
}

/* §3: what contact k adds to the hold of its vertex j. */
static __device__ sym hold_of(const struct penalty *s, int32_t k, int j)
{
    const struct contact *a = &s->contact[k];
    real part = s->share[k] / side_of(s, a, j) * magnitude(a->c[j]);
    real along = a->impulse > 0 ? part * s->stiffness * s->tau * s->tau : 0;
    real across = part * s->slide[k] * (s->tau / s->dt);
    real d = along - across;
    vec n = a->n;
    return sym{d * n.x * n.x + across, d * n.x * n.y, d * n.x * n.z,
               d * n.y * n.y + across, d * n.y * n.z, d * n.z * n.z + across};
}

/* Thread k owns vertex[k]: writes its force and hold, which are 0 elsewhere,
 * from its items in their order. */
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
        real weight = c->c[s.item[j] % 4];
        force = axpy(force, weight, axpy(c->tangent, c->impulse, c->n));
        hold = add(hold, hold_of(&s, at, s.item[j] % 4));
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
    LAUNCH(g, s->n, penalty_press_kernel, *s, words);
    LAUNCH(g, s->n4, penalty_gather_kernel, *s, words);
    const int64_t *seen = gpu_read_words(g, INCIDENCE_WORDS);
    return seen[INCIDENCE_BAD] ? DRAPE_EARG : gpu_status(g);
}
