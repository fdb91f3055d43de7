/* SPDX-License-Identifier: Apache-2.0 */
/* The force on a cloth, which all methods need: wind, then springs.
 * spec/cloth/dynamics.md */
#include "ref/cloth/force.h"

void force_wind(const struct dynamics *s, const vec *x, const vec *v, real tau,
                struct wind *w)
{
    const struct cloth *c = s->cloth;
    bool implicit = dynamics_implicit(s->method);
    *w = (struct wind){.m = c->m,
                       .n = c->n,
                       .count = c->count,
                       .cell = c->cell,
                       .x = x,
                       .v = v,
                       .air = s->air,
                       .drag = s->drag,
                       .lift = s->lift,
                       .tau = tau,
                       .n_inertia = implicit ? c->count : 0,
                       .mass = c->mass,
                       .part = s->gust,
                       .rate = s->resist,
                       .force = s->wind,
                       .inertia = s->inertia};
}

void force_springs(const struct dynamics *s, const vec *x, const vec *damping,
                   struct springs *f)
{
    const struct cloth *c = s->cloth;
    *f = (struct springs){.m = c->m,
                          .n = c->n,
                          .count = c->count,
                          .laws = SPRINGS,
                          .law = s->law,
                          .pieces = c->pieces,
                          .piece = s->piece,
                          .springs = c->springs,
                          .triples = c->triples,
                          .triple = s->triple,
                          .n_beside = c->triples ? c->count : 0,
                          .beside = c->beside,
                          .mass = c->mass,
                          .x = x,
                          .n_v = damping && c->beta > 0 ? c->count : 0,
                          .v = damping,
                          .n_wind = s->windy ? c->count : 0,
                          .wind = s->windy ? s->wind : NULL,
                          .gravity = s->gravity,
                          .force = s->force};
}

void force_make(struct dynamics *s, const vec *x, const vec *v,
                const vec *damping)
{
    struct wind w;
    struct springs f;
    if (s->windy) {
        force_wind(s, x, v, 0, &w);
        ref_wind(&w);
        force_trace(s, "wind", w.force);
    }
    force_springs(s, x, damping, &f);
    ref_springs(&f);
    force_trace(s, "springs", f.force);
}

void force_copy(struct dynamics *s, const vec *x, const vec *v)
{
    size_t bytes = (size_t)s->cloth->count * sizeof *x;
    if (x != s->x1)
        memcpy(s->x1, x, bytes);
    if (v != s->v1)
        memcpy(s->v1, v, bytes);
}
