/* SPDX-License-Identifier: Apache-2.0 */
/* Stage advance: generator and properties. spec/cloth/advance.md */
#include "ref/cloth/advance.h"

#include "tests/cloth/sheet.h"

const struct field fields_advance[] = {IN(advance, fixed, count, 1),
                                       IN(advance, mass, count, 1),
                                       IN(advance, x, count, 1),
                                       IN(advance, v, count, 1),
                                       IN(advance, rate, count, 1),
                                       IN(advance, force, count, 1),
                                       IN(advance, from, count, 1),
                                       IN(advance, to, count, 1),
                                       OUT(advance, x1, count, 1),
                                       OUT(advance, v1, count, 1),
                                       FIELD_END};

void gen_advance(struct bytes *b, struct advance *s)
{
    struct grid g = pick_grid(b);
    s->count = g.count;
    s->fixed = g.fixed;
    s->mass = g.mass;
    s->x = pick_state(b, &g);
    s->v = pick_vecs(b, g.count, 10);
    s->rate = pick_vecs(b, g.count, 10);
    s->force = pick_vecs(b, g.count, 1);
    s->symplectic = (int)pick(b, 2);
    s->dt = pick_uniform(b, R(1e-3), R(0.1));
    s->a = pick(b, 4) ? pick_uniform(b, 0, s->dt) : 0;
    s->b = pick(b, 4) ? pick_uniform(b, 0, s->dt) : 0;
    s->from = pick_vecs(b, g.count, 1);
    s->to = pick_vecs(b, g.count, 1);
    s->at = pick(b, 2) ? 1 : pick_uniform(b, 0, 1);
}

static bool near(double have, double want, double size)
{
    return fabs(have - want) <= 8 * REAL_U * size + 1e-35;
}

/* Checks coordinate k of particle p. */
static const char *check(const struct advance *s, int64_t p, int k)
{
    double x = (double)(&s->x[p].x)[k], v = (double)(&s->v[p].x)[k];
    double x1 = (double)(&s->x1[p].x)[k], v1 = (double)(&s->v1[p].x)[k];
    double from = (double)(&s->from[p].x)[k], to = (double)(&s->to[p].x)[k];
    double a = (double)s->a, at = (double)s->at, dt = (double)s->dt;
    if (s->fixed[p] == CLOTH_ABSENT) {
        EXPECT(x1 == x && v1 == v);
    } else if (s->fixed[p] == CLOTH_PINNED) {
        /* §1: at the end of the step a pin is exactly at its target. */
        EXPECT(s->at < 1 || x1 == to);
        EXPECT(near(x1, from + at * (to - from), fabs(from) + fabs(to)));
        EXPECT(near(v1, (to - from) / dt, (fabs(from) + fabs(to)) / dt));
    } else {
        double f = (double)(&s->force[p].x)[k] / (double)s->mass[p];
        double kick = (double)s->b * f, rate = (double)(&s->rate[p].x)[k];
        EXPECT(near(v1, v + kick, fabs(v) + fabs(kick)));
        rate = s->symplectic ? v1 : rate;
        EXPECT(near(x1, x + a * rate, fabs(x) + fabs(a * rate)));
    }
    return NULL;
}

const char *prop_advance(const struct advance *s)
{
    const char *bad = NULL;
    for (int64_t k = 0; k < 3 * s->count && !bad; k++)
        bad = check(s, k / 3, (int)(k % 3));
    return bad;
}
