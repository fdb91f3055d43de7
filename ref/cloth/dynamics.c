/* SPDX-License-Identifier: Apache-2.0 */
/* One cloth's step without contact: each method as a sequence of stages.
 * spec/cloth/dynamics.md */
#include "ref/cloth/dynamics.h"

#include "ref/base/sum.h"
#include "ref/cloth/blocks.h"
#include "ref/cloth/energy.h"
#include "ref/cloth/explicit.h"
#include "ref/cloth/implicit.h"
#include "ref/cloth/springs.h"
#include "ref/cloth/wind.h"

static vec *stream(const struct dynamics *s, int k)
{
    return s->work + k * s->cloth->count;
}

static void trace_vecs(const struct dynamics *s, const char *stage,
                       const vec *out)
{
    trace_stage(s->trace, stage, out, (size_t)s->cloth->count * sizeof *out);
}

/* The wind's three streams are the last. */
void dynamics_force(struct dynamics *s, const vec *x, const vec *v,
                    const vec *damping)
{
    const struct cloth *c = s->cloth;
    int last = (int)dynamics_vecs(s->method, s->windy);
    vec *wind = s->windy ? stream(s, last - 1) : NULL;
    if (s->windy) {
        struct wind w = {.m = c->m,
                         .n = c->n,
                         .count = c->count,
                         .cell = c->cell,
                         .x = x,
                         .v = v,
                         .air = s->air,
                         .drag = s->drag,
                         .lift = s->lift,
                         .part = stream(s, last - 3),
                         .force = wind};
        ref_wind(&w);
        trace_vecs(s, "wind", wind);
    }
    struct springs f = {.m = c->m,
                        .n = c->n,
                        .count = c->count,
                        .laws = SPRINGS,
                        .law = c->law,
                        .springs = c->springs,
                        .mass = c->mass,
                        .x = x,
                        .n_v = damping && c->beta > 0 ? c->count : 0,
                        .v = damping,
                        .n_wind = wind ? c->count : 0,
                        .wind = wind,
                        .gravity = s->gravity,
                        .force = stream(s, 0)};
    ref_springs(&f);
    trace_vecs(s, "springs", f.force);
}

void dynamics_copy(struct dynamics *s, const vec *x, const vec *v)
{
    size_t bytes = (size_t)s->cloth->count * sizeof *x;
    if (x != s->x1)
        memcpy(s->x1, x, bytes);
    if (v != s->v1)
        memcpy(s->v1, v, bytes);
}

static int go_implicit(struct dynamics *s)
{
    const struct cloth *c = s->cloth;
    int64_t past = s->method == DRAPE_CK && s->has_past ? c->count : 0;
    real tau = (real)(past ? s->dt * 2 / 3 : s->dt);
    vec *star = stream(s, 1), *back = past ? stream(s, 4) : NULL;
    vec *q = past ? stream(s, 5) : star;
    s->b = stream(s, 2);
    s->dv = stream(s, 3);
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
    trace_vecs(s, "predict", star);
    dynamics_force(s, s->x, s->v, back);
    struct blocks blocks = {.count = c->count,
                            .m = c->m,
                            .laws = SPRINGS,
                            .law = c->law,
                            .springs = c->springs,
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
                      .force = stream(s, 0),
                      .n_press = s->press ? c->count : 0,
                      .press = s->press,
                      .q = q,
                      .tau = tau,
                      .b = s->b};
    ref_rhs(&rhs);
    trace_vecs(s, "rhs", s->b);
    int status = s->solve(s);
    trace_vecs(s, "pcg", s->dv);
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
    trace_vecs(s, "update", s->v1);
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

/* §3: what wind and moving pins may have put in, J, at most. */
static double allowance(const struct dynamics *s, double elastic)
{
    const struct cloth *c = s->cloth;
    double mass = (double)c->cell_mass * (double)(c->n_triangles / 2);
    double reach = 0, k = 0, pins = (double)c->n_pinned;
    for (int64_t p = 0; p < c->count && c->n_pinned; p++) {
        double d = (double)vec_length(vec_sub(s->to[p], s->x[p]));
        if (c->fixed[p] == CLOTH_PINNED && d > reach)
            reach = d;
    }
    for (int o = 0; o < SPRINGS; o++)
        k = (double)c->law[o].stiff > k ? (double)c->law[o].stiff : k;
    double speed = reach / s->dt,
           wind = s->windy ? (double)vec_length(s->air) : 0;
    return 2 * mass * (speed * speed + wind * wind) +
           reach * (2 * sqrt(32 * pins * k * elastic) + 16 * pins * k * reach);
}

/* §3: the energy of a strain of 2^-10 in every spring. */
static double least_energy(const struct cloth *c)
{
    double e = 0;
    for (int o = 0; o < SPRINGS; o++)
        e += (double)c->law[o].k * (double)c->law[o].rest *
             (double)c->law[o].rest;
    return 0x1p-20 * e * (double)c->count;
}

/* §3: false where the energy has grown without a cause, or is no number. */
static bool bounded(struct dynamics *s, const double before[3])
{
    const double *after = s->energy;
    double own = after[0] + after[1], least = least_energy(s->cloth);
    double gain = (after[0] - before[0]) + (after[1] - before[1]) +
                  (after[2] - before[2]) - allowance(s, before[1]);
    double surplus = s->surplus + gain;
    if (!(own >= 0 && own <= 0x1p120) || !(surplus <= 0x1p120))
        return false;
    s->surplus = surplus > 0 ? surplus : 0;
    if (s->surplus <= own / 2 && own > s->reference)
        s->reference = own;
    double reference = s->reference > least ? s->reference : least;
    return s->surplus <= 1024 * reference;
}

int ref_dynamics(struct dynamics *s)
{
    s->outcome = 0;
    s->iterations = 0;
    s->residual = 0;
    double reference = s->reference, surplus = s->surplus;
    int status =
        dynamics_implicit(s->method) ? go_implicit(s) : dynamics_explicit(s);
    if (status != DRAPE_OK)
        return status;
    dynamics_energy(s, s->x, s->v, s->before);
    dynamics_energy(s, s->x1, s->v1, s->energy);
    if (sane(s) && bounded(s, s->before))
        return DRAPE_OK;
    s->outcome |= DRAPE_DIVERGED;
    s->reference = reference;
    s->surplus = surplus;
    memcpy(s->energy, s->before, sizeof s->energy);
    dynamics_copy(s, s->x, s->v);
    return DRAPE_OK;
}
