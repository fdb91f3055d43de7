/* SPDX-License-Identifier: Apache-2.0 */
/* The force on a cloth, which all methods need: wind, then springs.
 * spec/cloth/dynamics.md */
#include "ref/cloth/force.h"

#include "ref/cloth/springs.h"
#include "ref/cloth/wind.h"

/* The wind's three streams are the last. */
void force_make(struct dynamics *s, const vec *x, const vec *v,
                const vec *damping)
{
    const struct cloth *c = s->cloth;
    int last = (int)dynamics_vecs(s->method, s->windy);
    vec *wind = s->windy ? force_stream(s, last - 1) : NULL;
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
                         .part = force_stream(s, last - 3),
                         .force = wind};
        ref_wind(&w);
        force_trace(s, "wind", wind);
    }
    struct springs f = {.m = c->m,
                        .n = c->n,
                        .count = c->count,
                        .laws = SPRINGS,
                        .law = c->law,
                        .springs = c->springs,
                        .triples = c->triples,
                        .triple = c->triple,
                        .n_beside = c->triples ? c->count : 0,
                        .beside = c->beside,
                        .mass = c->mass,
                        .x = x,
                        .n_v = damping && c->beta > 0 ? c->count : 0,
                        .v = damping,
                        .n_wind = wind ? c->count : 0,
                        .wind = wind,
                        .gravity = s->gravity,
                        .force = force_stream(s, 0)};
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
