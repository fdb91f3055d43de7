/* SPDX-License-Identifier: Apache-2.0 */
/* Stage springs: generator and properties. spec/cloth/springs.md */
#include "ref/cloth/springs.h"

#include "ref/cloth/triple.h"
#include "tests/cloth/sheet.h"

const struct field fields_springs[] = {
    IN(springs, law, laws, 1),        IN(springs, piece, pieces, 1),
    IN(springs, springs, count, 1),   IN(springs, triple, triples, 1),
    IN(springs, beside, n_beside, 1), IN(springs, mass, count, 1),
    IN(springs, x, count, 1),         IN(springs, u, n_u, 1),
    IN(springs, v, n_v, 1),           IN(springs, wind, n_wind, 1),
    OUT(springs, force, count, 1),    FIELD_END};

void gen_springs(struct bytes *b, struct springs *s)
{
    struct grid g = pick_bent_grid(b);
    s->m = g.m;
    s->n = g.n;
    s->count = g.count;
    GIVE_GRID(s, &g);
    s->mass = g.mass;
    s->x = pick_state(b, &g);
    s->n_v = for_bench(b) || pick(b, 2) ? g.count : 0;
    s->v = pick_vecs(b, s->n_v, 10);
    s->n_wind = pick(b, 2) ? g.count : 0;
    s->wind = pick_vecs(b, s->n_wind, R(0.1));
    s->gravity = pick(b, 2) ? vec_make(0, 0, 0) : pick_vec(b, 10);
    s->n_u = for_bench(b) || pick(b, 3) ? 0 : g.count;
    s->u = pick_vecs(b, s->n_u, pick(b, 2) ? R(0.1) : 10);
    s->span = pick_uniform(b, R(1e-3), R(0.1));
}

/* §6: coordinate k of the way from where particle p is to where q is. */
static double way(const struct springs *s, int64_t p, int64_t q, int k)
{
    double d = (double)(&s->x[q].x)[k] - (double)(&s->x[p].x)[k];
    double u = 0;
    if (s->n_u)
        u = (double)(&s->u[q].x)[k] - (double)(&s->u[p].x)[k];
    return d + (double)s->span * u;
}

/* §6: the size of what the stage adds to get a difference of two places. */
static double terms_of(const struct springs *s, int64_t p, int64_t q)
{
    double size = 0;
    for (int k = 0; k < 3; k++) {
        size += fabs((double)(&s->x[q].x)[k] - (double)(&s->x[p].x)[k]);
        if (s->n_u)
            size += (double)s->span *
                    fabs((double)(&s->u[q].x)[k] - (double)(&s->u[p].x)[k]);
    }
    return size;
}

/* A particle's force in binary64, and a bound on the stage's error. */
struct exact {
    double f[3];
    double size;  /* Σ |pull| */
    double error; /* §3 */
    bool known;   /* §3 applies to all of its springs' lengths */
};

static void add_pull(const struct springs *s, const struct law *a, int64_t p,
                     int64_t q, double share, struct exact *e)
{
    double d[3], square = 0, rate = 0, speed = 0;
    for (int k = 0; k < 3; k++) {
        d[k] = way(s, p, q, k);
        square += d[k] * d[k];
    }
    double length = sqrt(square);
    if (length == 0)
        return;
    for (int k = 0; k < 3 && s->n_v; k++) {
        double w = (double)(&s->v[q].x)[k] - (double)(&s->v[p].x)[k];
        rate += w * d[k] / length;
        speed += fabs(w);
    }
    double tension = share * law_oracle(a, s->piece, length);
    double damped = share * (double)a->damp * rate;
    for (int k = 0; k < 3; k++)
        e->f[k] += (tension + damped) * d[k] / length;
    e->known &= length > 1e-15 && length < 1e15;
    e->size += fabs(tension + damped);
    e->error += 8 * REAL_U * (double)a->stiff * (length + (double)a->rest) +
                fabs(tension) * (LAW_ERROR + 50 * REAL_U) +
                60 * REAL_U * (double)a->damp * speed;
    if (!s->n_u)
        return;
    /* §6: the difference of places errs by four roundings of its terms, which
     * turns the spring and changes its length */
    double off = 4 * REAL_U * terms_of(s, p, q);
    e->known &= off < 0x1p-10 * length;
    e->error += off * ((double)a->stiff +
                       2 * (fabs(tension) + (double)a->damp * speed) / length);
}

/* §5: adds `times` the force that the triple of direction o with its middle at
 * (i, j) exerts on an end. */
static void add_triple(const struct springs *s, int o, int64_t i, int64_t j,
                       double times, struct exact *e)
{
    if (i < 0 || j < 0 || i >= s->m || j >= s->n)
        return;
    int64_t p = i + j * s->m, step = spring_step(s->m, o);
    double k = (double)triple_constant(s->triple, o, s->beside[p]);
    for (int c = 0; c < 3 && k > 0; c++) {
        double before = way(s, p, p - step, c);
        double after = way(s, p, p + step, c);
        e->f[c] -= times * k * (before + after);
        e->size += fabs(times) * k * (fabs(before) + fabs(after));
        e->error +=
            60 * REAL_U * fabs(times) * k * (fabs(before) + fabs(after));
        if (s->n_u)
            e->error += 8 * REAL_U * fabs(times) * k *
                        (terms_of(s, p, p - step) + terms_of(s, p, p + step));
        e->known &= fabs(before) + fabs(after) < 1e15;
    }
}

static struct exact force_of(const struct springs *s, int64_t p)
{
    struct exact e = {.known = true};
    int64_t i = p % s->m, j = p / s->m;
    for (int o = 0; o < (s->triples ? SPRINGS_SINGLE : SPRINGS); o++) {
        int64_t di = spring_di[o], dj = spring_dj[o], step = di + dj * s->m;
        double here = s->triples ? (double)spring_fraction(o, s->beside[p]) : 1;
        if (s->springs[p] >> o & 1)
            add_pull(s, &s->law[o], p, p + step, here, &e);
        if (i - di >= 0 && i - di < s->m && j >= dj &&
            s->springs[p - step] >> o & 1) {
            double there = s->triples
                               ? (double)spring_fraction(o, s->beside[p - step])
                               : 1;
            add_pull(s, &s->law[o], p, p - step, there, &e);
        }
        if (s->triples) {
            add_triple(s, o, i, j, -2, &e);
            add_triple(s, o, i + di, j + dj, 1, &e);
            add_triple(s, o, i - di, j - dj, 1, &e);
        }
    }
    for (int k = 0; k < 3; k++) {
        double w = s->n_wind ? (double)(&s->wind[p].x)[k] : 0;
        double g = (double)s->mass[p] * (double)(&s->gravity.x)[k];
        e.f[k] += w + g;
        e.error += 50 * REAL_U * (fabs(w) + fabs(g));
    }
    e.error += 1e-35;
    return e;
}

const char *prop_springs(const struct springs *s)
{
    double sum[3] = {0}, bound = 0;
    vec g = s->gravity;
    bool all = !s->n_wind && g.x == 0 && g.y == 0 && g.z == 0;
    for (int64_t p = 0; p < s->count; p++) {
        struct exact e = force_of(s, p);
        all &= e.known;
        bound += (s->triples ? 25 : 17) * REAL_U * e.size * (1 + 1e-5) + 1e-35;
        for (int k = 0; k < 3; k++) {
            double f = (double)(&s->force[p].x)[k];
            /* §3: the force follows the law, up to rounding. */
            EXPECT(!e.known || fabs(f - e.f[k]) <= e.error);
            sum[k] += f;
            bound += (double)s->count * 0x1p-53 * fabs(f);
        }
    }
    /* §4: the springs' forces add up to 0, up to rounding. */
    for (int k = 0; k < 3; k++)
        EXPECT(!all || fabs(sum[k]) <= bound);
    return NULL;
}
