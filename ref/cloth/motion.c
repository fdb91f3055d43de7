/* SPDX-License-Identifier: Apache-2.0 */
/* One cloth's step without contact: each method as a sequence of stages.
 * spec/cloth/dynamics.md */
#include "ref/cloth/motion.h"

#include "ref/cloth/bounded.h"
#include "ref/cloth/energy.h"
#include "ref/cloth/explicit.h"
#include "ref/cloth/force.h"
#include "ref/cloth/newton.h"

/* Where the streams lie in work. */
static void lay_out(struct dynamics *s)
{
    s->law = s->cloth->law;
    s->piece = s->cloth->piece;
    s->triple = s->cloth->triple;
    s->force = force_stream(s, 0);
    if (!dynamics_implicit(s->method))
        return;
    s->star = force_stream(s, 1);
    s->b = force_stream(s, 2);
    s->dv = force_stream(s, 3);
    if (dynamics_second(s->method)) {
        s->back = force_stream(s, 4);
        s->q = force_stream(s, 5);
    }
}

int ref_motion_blocks(struct gpu *on, const struct dynamics *s,
                      struct blocks *b)
{
    (void)on;
    (void)s;
    return ref_blocks(b);
}

int ref_motion_solve(struct gpu *on, struct dynamics *s)
{
    (void)on;
    return s->solve(s);
}

void motion_energy(const struct dynamics *s, const vec *x, const vec *v,
                   double value[3])
{
    const struct cloth *c = s->cloth;
    struct energy e = {.count = c->count,
                       .m = c->m,
                       .laws = SPRINGS,
                       .law = c->law,
                       .pieces = c->pieces,
                       .piece = c->piece,
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
    if (c->panel)
        e.value[1] += panel_energy(c->panel, &e);
    for (int k = 0; k < 3; k++)
        value[k] = (double)e.value[k];
}

static bool is_motion_sane(const struct dynamics *s)
{
    for (int64_t p = 0; p < s->cloth->count; p++)
        if (!vec_sane(s->x1[p]) || !vec_sane(s->v1[p]))
            return false;
    return true;
}

/* The longest way of a pin, m. */
static double longest_pin_way(const struct dynamics *s)
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

static void begin_motion(struct dynamics *s)
{
    s->outcome = 0;
    s->iterations = 0;
    s->residual = 0;
    lay_out(s);
}

/* dynamics.md §3: checks the motion, and undoes it if it went wrong. */
static int finish_motion(struct dynamics *s, int status)
{
    if (status != DRAPE_OK)
        return status;
    motion_energy(s, s->x, s->v, s->before);
    motion_energy(s, s->x1, s->v1, s->energy);
    if (!bounded_keeps(s, is_motion_sane(s), longest_pin_way(s)))
        force_copy(s, s->x, s->v);
    return DRAPE_OK;
}

int motion_run(struct dynamics *s)
{
    begin_motion(s);
    return finish_motion(s, dynamics_implicit(s->method)
                                ? newton_move(s, &backend_ref, NULL)
                                : explicit_steps(s));
}

int motion_run_part(struct dynamics *s, enum motion_part part)
{
    switch (part) {
    case MOTION_OPEN:
        begin_motion(s);
        return newton_open(s, &backend_ref, NULL);
    case MOTION_PLACE:
        return newton_place(s, &backend_ref, NULL);
    case MOTION_BALANCE:
        return newton_balance(s, &backend_ref, NULL);
    case MOTION_LINEARISE:
        return newton_linearise(s, &backend_ref, NULL);
    case MOTION_END:
        return finish_motion(s, DRAPE_OK);
    }
    return DRAPE_EARG;
}
