/* SPDX-License-Identifier: Apache-2.0 */
/* Stage energy: generator and properties. spec/cloth/energy.md */
#include "ref/cloth/energy.h"

#include "ref/base/sum.h"
#include "ref/cloth/triple.h"
#include "tests/cloth/sheet.h"

const struct field fields_energy[] = {IN(energy, law, laws, 1),
                                      IN(energy, piece, pieces, 1),
                                      IN(energy, springs, count, 1),
                                      IN(energy, triple, triples, 1),
                                      IN(energy, beside, n_beside, 1),
                                      IN(energy, mass, count, 1),
                                      IN(energy, x, count, 1),
                                      IN(energy, v, count, 1),
                                      SCRATCH(energy, chunk, n_chunks, 3),
                                      OUT_VALUE(energy, value),
                                      FIELD_END};

void gen_energy(struct bytes *b, struct energy *s)
{
    struct grid g = pick_bent_grid(b);
    s->m = g.m;
    s->count = g.count;
    GIVE_GRID(s, &g);
    s->mass = g.mass;
    s->x = pick_state(b, &g);
    s->v = pick_vecs(b, g.count, 10);
    s->gravity = pick_vec(b, 10);
    s->n_chunks = sum_chunks(g.count);
}

/* A sum in binary64, the rounding errors of its additions (by Knuth's TwoSum;
 * without them the sum of many equal terms would be less accurate than the
 * stage's tree), and a bound on the stage's error. */
struct total {
    double sum, low, error;
};

static void add(struct total *t, double term, double size)
{
    double sum = t->sum + term, back = sum - t->sum;
    t->low += (t->sum - (sum - back)) + (term - back);
    t->sum = sum;
    t->error += 40 * REAL_U * size + 1e-35;
}

static bool agrees(real have, struct total t)
{
    return fabs((double)have - t.sum - t.low) <= t.error;
}

static void add_spring(const struct energy *s, int o, int64_t p, int64_t q,
                       struct total *t)
{
    const struct law *a = &s->law[o];
    double share = s->triples ? (double)spring_fraction(o, s->beside[p]) : 1;
    double x = (double)s->x[q].x - (double)s->x[p].x;
    double y = (double)s->x[q].y - (double)s->x[p].y;
    double z = (double)s->x[q].z - (double)s->x[p].z;
    double length = sqrt(x * x + y * y + z * z);
    double e = share * law_oracle_energy(a, s->piece, length);
    double f = share * fabs(law_oracle(a, s->piece, length));
    add(t, e, e + f * (length + (double)a->rest));
    t->error += LAW_ERROR * e + (LAW_ERROR + 40 * REAL_U) * (double)a->well;
    if (!(length < 1e15))
        t->error = 1e300; /* the stage may overflow, so §2 gives no bound */
}

/* §1: the energy of the triple of direction o with its middle at p. */
static void add_triple(const struct energy *s, int o, int64_t p,
                       struct total *t)
{
    double k = (double)triple_constant(s->triple, o, s->beside[p]);
    int64_t step = spring_step(s->m, o);
    for (int c = 0; c < 3 && k > 0; c++) {
        double x = (double)(&s->x[p].x)[c];
        double before = (double)(&s->x[p - step].x)[c] - x;
        double after = (double)(&s->x[p + step].x)[c] - x;
        double size = fabs(before) + fabs(after);
        add(t, k * (before + after) * (before + after) / 2, k * size * size);
        if (!(size < 1e15))
            t->error = 1e300;
    }
}

const char *prop_energy(const struct energy *s)
{
    struct total t[3] = {{0, 0, 0}};
    for (int64_t p = 0; p < s->count; p++) {
        const real *x = &s->x[p].x, *v = &s->v[p].x, *g = &s->gravity.x;
        double m = (double)s->mass[p];
        for (int k = 0; k < 3; k++) {
            double e = m * (double)v[k] * (double)v[k] / 2;
            double h = -m * (double)g[k] * (double)x[k];
            add(&t[0], e, e);
            add(&t[2], h, fabs(h));
        }
        for (int o = 0; o < (s->triples ? SPRINGS_SINGLE : SPRINGS); o++) {
            if (s->springs[p] >> o & 1)
                add_spring(s, o, p, p + spring_step(s->m, o), &t[1]);
            if (s->triples)
                add_triple(s, o, p, &t[1]);
        }
    }
    EXPECT(agrees(s->value[0], t[0]));
    EXPECT(t[1].error >= 1e300 || agrees(s->value[1], t[1]));
    EXPECT(agrees(s->value[2], t[2]));
    return NULL;
}
