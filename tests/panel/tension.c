/* SPDX-License-Identifier: Apache-2.0 */
/* Stage tension: generator and properties. spec/panel/tension.md */
#include "ref/panel/tension.h"

#include "ref/base/sum.h"
#include "tests/panel/odd.h"

const struct field fields_tension[] = {IN(tension, law, laws, 1),
                                       IN(tension, piece, pieces, 1),
                                       IN(tension, corner, n_cells, 1),
                                       IN(tension, fibre, n_cells, 1),
                                       IN(tension, star, n_stars, 1),
                                       IN(tension, x, count, 1),
                                       SCRATCH(tension, chunk, n_chunks, 1),
                                       OUT_VALUE(tension, value),
                                       FIELD_END};

void gen_tension(struct bytes *b, struct tension *s)
{
    struct odd a = pick_odd(b);
    GIVE_ODD(s, &a);
    s->n_stars = a.panel.n_stars;
    s->star = a.panel.star;
    s->n_chunks = sum_chunks(s->n_cells + s->n_stars);
}

/* A sum in binary64 and a bound on the stage's error. */
struct total {
    double sum, error;
};

static void add_fibre(const struct tension *s, int64_t k, int f,
                      struct total *t)
{
    const struct fibre *a = &s->fibre[k][f];
    const struct law *law = &s->law[fibre_law[f]];
    double d[3], size;
    if (!(a->weight > 0))
        return;
    odd_form(a, s->corner[k], s->x, d, &size);
    double length = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
    double off = 12 * REAL_U * size, weight = (double)a->weight;
    double e = law_oracle_energy(law, s->piece, length);
    double pull = fabs(law_oracle(law, s->piece, length));
    t->sum += weight * e;
    t->error += weight * (LAW_ERROR * e + 60 * REAL_U * e +
                          60 * REAL_U * pull * (length + (double)law->rest) +
                          off * (pull + off * (double)law->stiff) +
                          (LAW_ERROR + 40 * REAL_U) * (double)law->well);
    t->error += 1e-35;
    if (!(length < 1e12))
        t->error = INFINITY;
}

static void add_star(const struct tension *s, int64_t k, struct total *t)
{
    const struct star *a = &s->star[k];
    for (int i = 0; i < 3; i++) {
        double sum = 0, size = 0, half = (double)a->k / 2;
        for (int q = 0; q < 4; q++) {
            double d = (double)a->c[q] * ((double)(&s->x[a->at[q + 1]].x)[i] -
                                          (double)(&s->x[a->at[0]].x)[i]);
            sum += d;
            size += fabs(d);
        }
        t->sum += half * sum * sum;
        t->error += 60 * REAL_U * half * size * size + 1e-35;
        if (!(size < 1e12))
            t->error = INFINITY;
    }
}

/* §1: the energy against its definition. */
const char *prop_tension(const struct tension *s)
{
    struct total t = {0, 0};
    for (int64_t k = 0; k < s->n_cells; k++)
        for (int f = 0; f < FIBRES; f++)
            add_fibre(s, k, f, &t);
    for (int64_t k = 0; k < s->n_stars; k++)
        add_star(s, k, &t);
    t.error += 60 * REAL_U * t.sum;
    EXPECT(!(t.error < INFINITY) || fabs((double)s->value - t.sum) <= t.error);
    return NULL;
}
