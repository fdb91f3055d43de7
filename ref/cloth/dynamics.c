/* SPDX-License-Identifier: Apache-2.0 */
/* One cloth's step without contact: each method as a sequence of stages.
 * spec/cloth/dynamics.md */
#include "ref/cloth/dynamics.h"

#include "ref/base/sum.h"
#include "ref/cloth/blocks.h"
#include "ref/cloth/bounded.h"
#include "ref/cloth/energy.h"
#include "ref/cloth/explicit.h"
#include "ref/cloth/force.h"
#include "ref/cloth/implicit.h"

static int go_implicit(struct dynamics *s)
{
    const struct cloth *c = s->cloth;
    int64_t past = s->method == DRAPE_CK && s->has_past ? c->count : 0;
    real tau = (real)(past ? s->dt * 2 / 3 : s->dt);
    vec *star = force_stream(s, 1), *back = past ? force_stream(s, 4) : NULL;
    vec *q = past ? force_stream(s, 5) : star;
    s->b = force_stream(s, 2);
    s->dv = force_stream(s, 3);
    s->substeps = 1;

    struct predict begin = {.count = c->count,
                            .fixed = c->fixed,
                            .x = s->x,
                            .v = s->v,
                            .n_past = past,
                            .xp = s->xp,
                            .vp = s->vp,
                            .to = s->to,
                            .tau = tau,
                            .star = star,
                            .back = back,
                            .q = q};
    ref_predict(&begin);
    force_trace(s, "predict", star);
    force_make(s, s->x, s->v, back);
    struct blocks blocks = {.count = c->count,
                            .m = c->m,
                            .laws = SPRINGS,
                            .law = c->law,
                            .springs = c->springs,
                            .triples = c->triples,
                            .triple = c->triple,
                            .n_beside = c->triples ? c->count : 0,
                            .beside = c->beside,
                            .x = s->x,
                            .tau = tau,
                            .block = s->block,
                            .n_thin = s->thin ? SPRINGS * c->count : 0,
                            .thin = s->thin};
    ref_blocks(&blocks);
    trace_stage(s->trace, "blocks", s->block,
                (size_t)(SPRINGS * c->count) * sizeof *s->block);
    struct rhs rhs = {.count = c->count,
                      .m = c->m,
                      .n = c->n,
                      .fixed = c->fixed,
                      .springs = c->springs,
                      .n_blocks = SPRINGS * c->count,
                      .block = s->block,
                      .force = force_stream(s, 0),
                      .n_press = s->press ? c->count : 0,
                      .press = s->press,
                      .q = q,
                      .tau = tau,
                      .b = s->b};
    ref_rhs(&rhs);
    force_trace(s, "rhs", s->b);
    int status = s->solve(s);
    force_trace(s, "pcg", s->dv);
    if (status != DRAPE_OK)
        return status;
    struct update end = {.count = c->count,
                         .fixed = c->fixed,
                         .x = s->x,
                         .n_past = past,
                         .xp = s->xp,
                         .to = s->to,
                         .star = star,
                         .dv = s->dv,
                         .tau = tau,
                         .dt = (real)s->dt,
                         .x1 = s->x1,
                         .v1 = s->v1};
    ref_update(&end);
    force_trace(s, "update", s->v1);
    return DRAPE_OK;
}

void dynamics_energy(const struct dynamics *s, const vec *x, const vec *v,
                     double value[3])
{
    const struct cloth *c = s->cloth;
    struct energy e = {.count = c->count,
                       .m = c->m,
                       .laws = SPRINGS,
                       .law = c->law,
                       .springs = c->springs,
                       .triples = c->triples,
                       .triple = c->triple,
                       .n_beside = c->triples ? c->count : 0,
                       .beside = c->beside,
                       .mass = c->mass,
                       .x = x,
                       .v = v,
                       .gravity = s->gravity,
                       .n_chunks = sum_chunks(c->count),
                       .chunk = s->chunk};
    ref_energy(&e);
    for (int k = 0; k < 3; k++)
        value[k] = (double)e.value[k];
}

static bool sane(const struct dynamics *s)
{
    for (int64_t p = 0; p < s->cloth->count; p++)
        if (!vec_sane(s->x1[p]) || !vec_sane(s->v1[p]))
            return false;
    return true;
}

/* The longest way of a pin, m. */
static double reach(const struct dynamics *s)
{
    const struct cloth *c = s->cloth;
    double most = 0;
    for (int64_t p = 0; p < c->count && c->n_pinned; p++) {
        double d = (double)vec_length(vec_sub(s->to[p], s->x[p]));
        if (c->fixed[p] == CLOTH_PINNED && d > most)
            most = d;
    }
    return most;
}

int ref_dynamics(struct dynamics *s)
{
    s->outcome = 0;
    s->iterations = 0;
    s->residual = 0;
    int status =
        dynamics_implicit(s->method) ? go_implicit(s) : explicit_steps(s);
    if (status != DRAPE_OK)
        return status;
    dynamics_energy(s, s->x, s->v, s->before);
    dynamics_energy(s, s->x1, s->v1, s->energy);
    if (!bounded_keeps(s, sane(s), reach(s)))
        force_copy(s, s->x, s->v);
    return DRAPE_OK;
}
