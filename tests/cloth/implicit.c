/* SPDX-License-Identifier: Apache-2.0 */
/* Stages predict, rhs, update, imbalance and history: generators and
 * properties.
 * spec/cloth/implicit.md */
#include "ref/cloth/implicit.h"

#include "tests/cloth/sheet.h"

const struct field fields_predict[] = {
    IN(predict, fixed, count, 1), IN(predict, x, count, 1),
    IN(predict, v, count, 1),     IN(predict, xp, n_past, 1),
    IN(predict, vp, n_past, 1),   IN(predict, to, count, 1),
    OUT(predict, star, count, 1), OUT(predict, back, n_past, 1),
    OUT(predict, q, n_past, 1),   FIELD_END};

const struct field fields_rhs[] = {IN(rhs, fixed, count, 1),
                                   IN(rhs, springs, count, 1),
                                   IN(rhs, block, n_blocks, 1),
                                   IN(rhs, force, count, 1),
                                   IN(rhs, q, count, 1),
                                   OUT(rhs, b, count, 1),
                                   FIELD_END};

const struct field fields_update[] = {IN(update, fixed, count, 1),
                                      IN(update, x, count, 1),
                                      IN(update, xp, n_past, 1),
                                      IN(update, to, count, 1),
                                      IN(update, star, count, 1),
                                      IN(update, dv, count, 1),
                                      OUT(update, x1, count, 1),
                                      OUT(update, v1, count, 1),
                                      FIELD_END};

const struct field fields_imbalance[] = {IN(imbalance, fixed, count, 1),
                                         IN(imbalance, mass, count, 1),
                                         IN(imbalance, force, count, 1),
                                         IN(imbalance, v, count, 1),
                                         IN(imbalance, star, count, 1),
                                         OUT(imbalance, b, count, 1),
                                         FIELD_END};

const struct field fields_history[] = {
    IN(history, x0, count, 1),    IN(history, v0, count, 1),
    IN(history, x1, count, 1),    IN(history, v1, count, 1),
    IN(history, x, count, 1),     IN(history, v, count, 1),
    IN(history, jump, n_jump, 1), OUT(history, xp, count, 1),
    OUT(history, vp, count, 1),   FIELD_END};

void gen_predict(struct bytes *b, struct predict *s)
{
    struct grid g = pick_grid(b);
    s->count = g.count;
    s->fixed = g.fixed;
    s->x = pick_vecs(b, g.count, 1);
    s->v = pick_vecs(b, g.count, 10);
    s->n_past = pick(b, 2) ? g.count : 0;
    s->xp = pick_vecs(b, s->n_past, 1);
    s->vp = pick_vecs(b, s->n_past, 10);
    s->to = pick_vecs(b, g.count, 1);
    s->tau = pick_uniform(b, R(1e-3), R(0.1));
}

void gen_rhs(struct bytes *b, struct rhs *s)
{
    struct grid g = pick_grid(b);
    s->m = g.m;
    s->n = g.n;
    s->count = g.count;
    s->fixed = g.fixed;
    s->springs = g.springs;
    s->n_blocks = SPRINGS * g.count;
    sym *block = take(b, s->n_blocks, sizeof *block);
    for (int64_t k = 0; k < s->n_blocks; k++)
        for (int e = 0; e < 6; e++)
            if (g.springs[k % g.count] >> k / g.count & 1)
                (&block[k].xx)[e] = pick_uniform(b, -1, 1);
    s->block = block;
    s->force = pick_vecs(b, g.count, 10);
    s->q = pick_vecs(b, g.count, 10);
    s->tau = pick_uniform(b, R(1e-3), R(0.1));
}

void gen_update(struct bytes *b, struct update *s)
{
    struct grid g = pick_grid(b);
    s->count = g.count;
    s->fixed = g.fixed;
    s->x = pick_vecs(b, g.count, 1);
    s->n_past = pick(b, 2) ? g.count : 0;
    s->xp = pick_vecs(b, s->n_past, 1);
    s->to = pick_vecs(b, g.count, 1);
    s->star = pick_vecs(b, g.count, 10);
    s->dv = pick_vecs(b, g.count, 10);
    s->dt = pick_uniform(b, R(1e-3), R(0.1));
    s->tau = s->n_past ? s->dt * R(2.0 / 3) : s->dt;
    s->part = pick(b, 2) ? 1 : pick_uniform(b, 0, 1);
}

void gen_imbalance(struct bytes *b, struct imbalance *s)
{
    struct grid g = pick_grid(b);
    s->count = g.count;
    s->fixed = g.fixed;
    s->mass = g.mass;
    s->force = pick_vecs(b, g.count, 10);
    s->v = pick_vecs(b, g.count, 10);
    s->star = pick_vecs(b, g.count, 10);
    s->tau = pick_uniform(b, R(1e-3), R(0.1));
}

void gen_history(struct bytes *b, struct history *s)
{
    struct grid g = pick_grid(b);
    s->count = g.count;
    s->x0 = pick_vecs(b, g.count, 1);
    s->v0 = pick_vecs(b, g.count, 10);
    s->x1 = pick_vecs(b, g.count, 1);
    s->v1 = pick_vecs(b, g.count, 10);
    vec *x = pick_vecs(b, g.count, 1), *v = pick_vecs(b, g.count, 10);
    for (int64_t p = 0; p < g.count; p++) {
        int kind = (int)pick(b, 4);
        x[p] = kind & 1 ? s->x1[p] : x[p];
        v[p] = kind & 2 ? s->v1[p] : v[p];
    }
    s->x = x;
    s->v = v;
    s->n_jump = pick(b, 2) ? g.count : 0;
    s->jump = pick_vecs(b, s->n_jump, 1);
    s->part = pick(b, 2) ? 1 : R(2.0) / 3;
    s->dt = pick_uniform(b, R(1e-3), R(0.1));
}

static bool near(double have, double want, double size)
{
    return fabs(have - want) <= 16 * REAL_U * size + 1e-35;
}

static double at(const vec *a, int64_t k)
{
    return (double)(&a[k / 3].x)[k % 3];
}

const char *prop_predict(const struct predict *s)
{
    for (int64_t k = 0; k < 3 * s->count; k++) {
        double x = at(s->x, k), v = at(s->v, k), tau = (double)s->tau;
        double xp = s->n_past ? at(s->xp, k) : x;
        double vp = s->n_past ? at(s->vp, k) : v;
        double move = (x - xp) / 3, star = v + (v - vp) / 3;
        double size = fabs(v) + fabs(vp);
        if (s->fixed[k / 3] == CLOTH_PINNED) {
            star = (at(s->to, k) - x - move) / tau;
            size = (fabs(at(s->to, k)) + 2 * fabs(x) + fabs(xp)) / tau;
        }
        EXPECT(near(at(s->star, k), star, size));
        if (!s->n_past)
            continue;
        size += (fabs(x) + fabs(xp)) / tau;
        EXPECT(near(at(s->back, k), -move / tau, size));
        EXPECT(near(at(s->q, k), star + move / tau, size));
    }
    return NULL;
}

/* Adds block·(q_p - q_q) to row[0 … 2], and the sizes of its terms to row[3 …
 * 5]. */
static void add_block(const struct rhs *s, int64_t block, int64_t p, int64_t q,
                      double row[6])
{
    static const int entry[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};
    const real *a = &s->block[block].xx;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            double e = (double)a[entry[i][j]];
            double here = at(s->q, 3 * p + j), there = at(s->q, 3 * q + j);
            row[i] += e * (here - there);
            row[3 + i] += fabs(e) * (fabs(here) + fabs(there));
        }
}

const char *prop_rhs(const struct rhs *s)
{
    for (int64_t p = 0; p < s->count; p++) {
        double row[6] = {0};
        int64_t i = p % s->m, j = p / s->m;
        for (int64_t o = 0; o < SPRINGS; o++) {
            int64_t di = spring_di[o], dj = spring_dj[o];
            int64_t step = di + dj * s->m, back = p - step;
            if (i + di >= 0 && i + di < s->m && j + dj < s->n)
                add_block(s, o * s->count + p, p, p + step, row);
            if (i - di >= 0 && i - di < s->m && j >= dj)
                add_block(s, o * s->count + back, p, back, row);
        }
        for (int k = 0; k < 3; k++) {
            double f = (double)s->tau * at(s->force, 3 * p + k);
            double b = at(s->b, 3 * p + k);
            double size = fabs(f) + 2 * row[3 + k];
            EXPECT(s->fixed[p] ? b == 0 : near(b, f - row[k], size));
        }
    }
    return NULL;
}

const char *prop_update(const struct update *s)
{
    for (int64_t k = 0; k < 3 * s->count; k++) {
        double x = at(s->x, k), to = at(s->to, k), tau = (double)s->tau;
        double x1 = at(s->x1, k), v1 = at(s->v1, k), dt = (double)s->dt;
        double xp = s->n_past ? at(s->xp, k) : x, star = at(s->star, k);
        double dv = (double)s->part * at(s->dv, k);
        double size = fabs(star) + fabs(dv);
        switch (s->fixed[k / 3]) {
        case CLOTH_ABSENT:
            EXPECT(x1 == x && v1 == 0);
            break;
        case CLOTH_PINNED:
            EXPECT(x1 == to);
            EXPECT(near(v1, (to - x) / dt, (fabs(to) + fabs(x)) / dt));
            break;
        default:
            EXPECT(near(v1, star + dv, size));
            EXPECT(near(x1, x + (x - xp) / 3 + tau * (star + dv),
                        2 * fabs(x) + fabs(xp) + tau * size));
        }
    }
    return NULL;
}

const char *prop_imbalance(const struct imbalance *s)
{
    for (int64_t k = 0; k < 3 * s->count; k++) {
        double tau = (double)s->tau, mass = (double)s->mass[k / 3];
        double f = tau * at(s->force, k), v = mass * at(s->v, k);
        double star = mass * at(s->star, k), b = at(s->b, k);
        double size = fabs(f) + fabs(v) + fabs(star);
        EXPECT(s->fixed[k / 3] ? b == 0 : near(b, f - (v - star), size));
    }
    return NULL;
}

const char *prop_history(const struct history *s)
{
    for (int64_t p = 0; p < s->count; p++) {
        bool touched = memcmp(&s->x[p], &s->x1[p], sizeof *s->x) ||
                       memcmp(&s->v[p], &s->v1[p], sizeof *s->v);
        for (int64_t k = 3 * p; k < 3 * p + 3; k++) {
            double v = at(s->v, k), v0 = at(s->v0, k), v1 = at(s->v1, k);
            double jump = s->n_jump ? (double)s->part * at(s->jump, k) : 0;
            double old = v0 + jump, vp = old + v - v1;
            double half = (double)s->dt / 2;
            double size = fabs(v) + fabs(v0) + fabs(v1) + fabs(jump);
            double xp = at(s->x, k) - half * (v + vp);
            if (!touched) {
                EXPECT(at(s->xp, k) == at(s->x0, k));
                EXPECT(jump == 0 ? at(s->vp, k) == v0
                                 : near(at(s->vp, k), old, size));
                continue;
            }
            /* +0 and -0 are equal: such a difference is not a contact. */
            bool same = at(s->x, 3 * p) == at(s->x1, 3 * p) &&
                        at(s->xp, k) == at(s->x0, k) &&
                        near(at(s->vp, k), old, size);
            EXPECT(same || near(at(s->vp, k), vp, size));
            EXPECT(same ||
                   near(at(s->xp, k), xp, fabs(at(s->x, k)) + 2 * half * size));
        }
    }
    return NULL;
}
