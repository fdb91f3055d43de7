/* SPDX-License-Identifier: Apache-2.0 */
/* Stages moments, islands and spin: generators and properties.
 * spec/momentum/momentum.md */
#include "ref/momentum/momentum.h"

#include <stdlib.h>

#include "ref/base/sum.h"
#include "ref/contact/contacts.h"
#include "tests/cloth/sheet.h"

const struct field fields_moments[] = {
    IN(moments, w, count, 1),  IN(moments, x, count, 1),
    IN(moments, v, count, 1),  SCRATCH(moments, chunk, n_chunks, MOMENTS),
    OUT_VALUE(moments, at),    OUT_VALUE(moments, speed),
    OUT_VALUE(moments, value), FIELD_END};
const struct field fields_islands[] = {
    IN(islands, body, nv, 1), IN(islands, contact, n, 1),
    OUT(islands, label, bodies, 1), FIELD_END};
const struct field fields_spin[] = {
    IN(spin, w, count, 1), IN(spin, x, count, 1), IN(spin, v, count, 1),
    OUT(spin, to, count, 1), FIELD_END};

static const real *pick_masses(struct bytes *b, int64_t n)
{
    real *w = take(b, n, sizeof *w);
    for (int64_t i = 0; i < n; i++)
        w[i] = pick(b, 8) ? pick_uniform(b, 1, 1000) : 0;
    return w;
}

void gen_moments(struct bytes *b, struct moments *s)
{
    s->count = for_bench(b) ? 1 << 20 : 1 + pick_size(b);
    s->n_chunks = sum_chunks(s->count);
    s->w = pick_masses(b, s->count);
    s->x = pick_vecs(b, s->count, 10);
    s->v = pick_vecs(b, s->count, 10);
}

/* A sum in binary64 with the rounding errors of its additions (by Knuth's
 * TwoSum: without them it would be less accurate than the stage's tree), and of
 * |terms|. */
struct total {
    double sum, low, size;
};

static void add(struct total *t, double a)
{
    double sum = t->sum + a, back = sum - t->sum;
    t->low += (t->sum - (sum - back)) + (a - back);
    t->sum = sum;
    t->size += fabs(a);
}

static void add_row(struct total *t, double m, double a, const double b[3],
                    int from)
{
    for (int i = from; i < 3; i++)
        add(&t[i - from], m * a * b[i]);
}

const char *prop_moments(const struct moments *s)
{
    struct total t[MOMENTS] = {{0, 0, 0}};
    vec at = s->x[s->count / 2], speed = s->v[s->count / 2];
    EXPECT(memcmp(&at, &s->at, sizeof at) == 0);
    EXPECT(memcmp(&speed, &s->speed, sizeof at) == 0);
    for (int64_t p = 0; p < s->count; p++) {
        double m = s->w[p] > 0 ? 1 / (double)s->w[p] : 0, d[3], e[3];
        for (int i = 0; i < 3; i++) {
            d[i] = (double)((&s->x[p].x)[i] - (&at.x)[i]);
            e[i] = (double)((&s->v[p].x)[i] - (&speed.x)[i]);
        }
        add(&t[MOMENT_MASS], m);
        add_row(t + MOMENT_PLACE, m, 1, d, 0);
        add_row(t + MOMENT_SPEED, m, 1, e, 0);
        for (int i = 0; i < 3; i++) {
            int j = (i + 1) % 3, k = (i + 2) % 3;
            add(&t[MOMENT_SQUARE], m * e[i] * e[i]);
            add(&t[MOMENT_SPIN + i], m * d[j] * e[k]);
            add(&t[MOMENT_SPIN + i], -m * d[k] * e[j]);
        }
        add_row(t + MOMENT_SPREAD, m, d[0], d, 0);
        add_row(t + MOMENT_SPREAD + 3, m, d[1], d, 1);
        add_row(t + MOMENT_SPREAD + 5, m, d[2], d, 2);
    }
    for (int e = 0; e < MOMENTS; e++)
        EXPECT(fabs((double)s->value[e] - t[e].sum - t[e].low) <=
               40 * REAL_U * t[e].size + 1e-35);
    return NULL;
}

/* Stage contacts' generator, which makes the contacts. */
void gen_contacts(struct bytes *b, struct contacts *s);

void gen_islands(struct bytes *b, struct islands *s)
{
    struct contacts c = {0};
    gen_contacts(b, &c);
    s->n = c.n;
    s->nv = c.nv;
    s->contact = c.contact;
    s->bodies = 1 + pick(b, 3 * (uint32_t)c.nv);
    uint16_t *body = take(b, c.nv, sizeof *body);
    int64_t all = s->bodies + pick(b, 3); /* with obstacles */
    bool run = pick(b, 2); /* a chain of bodies, in order or not */
    for (int64_t i = 0; i < c.nv; i++)
        body[i] = (uint16_t)(run ? i % all % UINT16_MAX
                                 : pick(b, (uint32_t)all) % UINT16_MAX);
    s->body = body;
}

const char *prop_islands(const struct islands *s)
{
    int32_t *near = calloc((size_t)s->bodies, sizeof *near);
    EXPECT(near);
    for (int32_t k = 0; k < s->bodies; k++)
        near[k] = k;
    for (bool changes = true; changes;) { /* by the definition */
        changes = false;
        for (int64_t k = 0; k < s->n; k++) {
            uint16_t of_a = s->body[s->contact[k].v[0]];
            uint16_t of_b = s->body[s->contact[k].v[3]];
            if (of_a >= s->bodies || of_b >= s->bodies)
                continue;
            int32_t *a = &near[of_a], *b = &near[of_b];
            changes |= *a != *b;
            *a = *b = *a < *b ? *a : *b;
        }
    }
    bool same = memcmp(near, s->label, (size_t)s->bodies * sizeof *near) == 0;
    free(near);
    EXPECT(same);
    return NULL;
}

void gen_spin(struct bytes *b, struct spin *s)
{
    s->count = for_bench(b) ? 1 << 20 : pick_size(b);
    s->w = pick_masses(b, s->count);
    s->x = pick_vecs(b, s->count, 10);
    s->v = pick_vecs(b, s->count, 10);
    s->keep = pick(b, 2) ? 1 : pick_uniform(b, 0, 1);
    s->centre = pick_vec(b, 10);
    s->dv = pick_vec(b, 1);
    s->dw = pick_vec(b, 1);
}

const char *prop_spin(const struct spin *s)
{
    const real *dw = &s->dw.x;
    for (int64_t p = 0; p < s->count; p++)
        for (int i = 0; i < 3; i++) {
            int j = (i + 1) % 3, k = (i + 2) % 3;
            const real *x = &s->x[p].x, *c = &s->centre.x;
            double a = (double)dw[j] * ((double)x[k] - (double)c[k]);
            double b = (double)dw[k] * ((double)x[j] - (double)c[j]);
            double moves = s->w[p] > 0 ? 1 : 0;
            double keep = moves > 0 ? (double)s->keep : 1;
            double v = keep * (double)(&s->v[p].x)[i];
            double dv = (double)(&s->dv.x)[i];
            double size = fabs(a) + fabs(b) + fabs(v) + fabs(dv);
            double error = (double)(&s->to[p].x)[i] - v - moves * (dv + a - b);
            EXPECT(fabs(error) <= 8 * REAL_U * moves * size + 1e-35);
        }
    return NULL;
}
