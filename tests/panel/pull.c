/* SPDX-License-Identifier: Apache-2.0 */
/* Stage pull: generator and properties. spec/panel/pull.md */
#include "ref/panel/pull.h"

#include "tests/base/choices.h"
#include "tests/panel/odd.h"

const struct field fields_pull[] = {
    IN(pull, law, laws, 1),       IN(pull, piece, pieces, 1),
    IN(pull, corner, n_cells, 1), IN(pull, fibre, n_cells, 1),
    IN(pull, bend, n_pairs, 1),   IN(pull, part, n_parts, 1),
    IN(pull, push, n_parts, 1),   IN(pull, tie, n_parts, 1),
    IN(pull, x, count, 1),        IN(pull, u, n_u, 1),
    IN(pull, v, n_v, 1),          SCRATCH(pull, pushes, n_pushes, 1),
    INOUT(pull, force, count, 1), FIELD_END};

static vec before(int64_t p)
{
    return vec_make(odd_before(3 * p), odd_before(3 * p + 1),
                    odd_before(3 * p + 2));
}

void gen_pull(struct bytes *b, struct pull *s)
{
    struct odd a = pick_odd(b);
    GIVE_ODD(s, &a);
    s->m = a.grid.m;
    s->n_pairs = a.panel.n_pairs;
    s->bend = a.panel.bend;
    s->n_parts = a.panel.n_parts;
    s->part = a.panel.part;
    s->push = (const int32_t(*)[4])a.panel.push;
    s->tie = (const int32_t(*)[16])a.panel.tie;
    s->n_v = for_bench(b) || pick(b, 2) ? s->count : 0;
    s->v = pick_vecs(b, s->n_v, 10);
    s->n_u = for_bench(b) || pick(b, 3) ? 0 : s->count;
    s->u = pick_vecs(b, s->n_u, pick(b, 2) ? R(0.1) : 10);
    s->span = pick_uniform(b, R(1e-3), R(0.1));
    s->n_pushes = CORNERS * s->n_cells;
    s->force = take(b, s->count, sizeof *s->force);
    for (int64_t p = 0; p < s->count; p++)
        s->force[p] = before(p);
}

/* The force on a particle in binary64, what its terms add up to in size, and a
 * bound on the stage's error, unless a length is out of range. */
struct exact {
    double f[3], size, error;
    bool known;
};

/* Adds the pull of a fibre to the forces on the corners of its cell. */
static void add_fibre(const struct pull *s, int64_t k, int f, struct exact *e)
{
    const struct fibre *a = &s->fibre[k][f];
    const struct law *law = &s->law[fibre_law[f]];
    const int32_t *at = s->corner[k];
    double d[3], u[3] = {0}, v[3] = {0}, size, more = 0, speed = 0;
    if (!(a->weight > 0))
        return;
    odd_form(a, at, s->x, d, &size);
    if (s->n_u)
        odd_form(a, at, s->u, u, &more);
    if (s->n_v)
        odd_form(a, at, s->v, v, &speed);
    double square = 0, rate = 0;
    for (int i = 0; i < 3; i++) {
        d[i] += (double)s->span * u[i];
        square += d[i] * d[i];
    }
    double length = sqrt(square), off = 12 * REAL_U;
    off *= size + (double)s->span * more;
    for (int i = 0; i < 3 && length > 0; i++)
        rate += v[i] * d[i] / length;
    double damp = (double)law->damp, weight = (double)a->weight;
    double tension = law_oracle(law, s->piece, length), t = tension;
    t += s->n_v ? damp * rate : 0;
    double error =
        8 * REAL_U * (double)law->stiff * (length + (double)law->rest);
    error +=
        fabs(tension) * (LAW_ERROR + 50 * REAL_U) + 80 * REAL_U * damp * speed;
    error += off *
             ((double)law->stiff + 2 * (fabs(tension) + damp * speed) / length);
    bool known = length > 1e-15 && length < 1e12 && off < 0x1p-10 * length;
    double c[CORNERS] = {0, (double)a->c[0], (double)a->c[1], (double)a->c[2]};
    c[0] = -(c[1] + c[2] + c[3]);
    for (int q = 0; q < CORNERS; q++) {
        struct exact *to = &e[at[q]];
        double most = q ? fabs(c[q]) : fabs(c[1]) + fabs(c[2]) + fabs(c[3]);
        to->known &= known;
        for (int i = 0; i < 3 && known; i++)
            to->f[i] -= weight * c[q] * t * d[i] / length;
        to->size += most * weight * fabs(t);
        to->error += most * weight * error;
    }
}

/* Adds the pull between the particles of a pair that stars join. */
static void add_tie(const struct pull *s, int64_t p, int64_t q, real bend,
                    struct exact *e)
{
    for (int i = 0; i < 3; i++) {
        double way = (double)(&s->x[q].x)[i] - (double)(&s->x[p].x)[i],
               more = 0;
        if (s->n_u)
            more = (double)s->span *
                   ((double)(&s->u[q].x)[i] - (double)(&s->u[p].x)[i]);
        e->f[i] += (double)bend * (way + more);
        e->size += fabs((double)bend) * (fabs(way) + fabs(more));
        e->known &= fabs(way) + fabs(more) < 1e12;
    }
}

static const char *compare(const struct pull *s, const struct exact *e)
{
    for (int64_t p = 0; p < s->count; p++) {
        vec start = before(p);
        double error = e[p].error + 60 * REAL_U * (e[p].size + 1);
        for (int i = 0; i < 3 && e[p].known; i++) {
            double f = (double)(&start.x)[i] + e[p].f[i];
            EXPECT(fabs((double)(&s->force[p].x)[i] - f) <= error);
        }
        if (e[p].size == 0 && e[p].known)
            EXPECT(!memcmp(&s->force[p], &start, sizeof start));
    }
    return NULL;
}

/* §1, §2: the force against its definition, cell by cell and tie by tie. */
const char *prop_pull(const struct pull *s)
{
    struct bytes b = {0};
    struct exact *e = take(&b, s->count, sizeof *e);
    for (int64_t p = 0; p < s->count; p++)
        e[p].known = true;
    for (int64_t k = 0; k < s->n_cells; k++)
        for (int f = 0; f < FIBRES; f++)
            add_fibre(s, k, f, e);
    for (int64_t k = 0; k < s->n_parts; k++)
        for (int o = 0; o < 2 * SPRINGS; o++) {
            int32_t p = s->part[k], pair = s->tie[k][o];
            int64_t step = spring_step(s->m, o / 2);
            if (pair >= 0)
                add_tie(s, p, o % 2 ? p - step : p + step, s->bend[pair],
                        &e[p]);
        }
    const char *failed = compare(s, e);
    choices_free(&b);
    return failed;
}
