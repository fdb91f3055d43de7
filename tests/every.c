/* SPDX-License-Identifier: Apache-2.0 */
/* Stage contacts once more, by all contacts in all iterations and without
 * lists: whom it leaves out had nothing to do. spec/34_contacts.md §1 */
#include "ref/contacts.h"
#include "tests/choices.h"
#include "tests/harness.h"

void gen_contacts(struct bytes *b, struct contacts *s);

/* Streams of the plain form, which has the inputs of s. */
struct every {
    const struct contacts *s;
    struct contact *contact;
    vec *u, *v, *sum, *push, *before;
    real *lack;
    int *parts;
};

static bool pushes(const struct contacts *s, int64_t k, int j)
{
    const struct contact *c = &s->contact[k];
    return c->c[j] != 0 && s->w[c->v[j]] > 0;
}

static void *copy(struct bytes *b, const void *from, int64_t n, size_t size)
{
    void *to = take(b, n, size);
    if (n > 0)
        memcpy(to, from, (size_t)n * size);
    return to;
}

static vec total(const struct contact *c)
{
    return vec_axpy(c->tangent, c->impulse, c->n);
}

/* d of each vertex, by who lacks something. */
static void split(struct every *e)
{
    memset(e->parts, 0, (size_t)e->s->nv * sizeof *e->parts);
    for (int64_t k = 0; k < e->s->n; k++)
        for (int j = 0; j < 4; j++)
            e->parts[e->contact[k].v[j]] +=
                pushes(e->s, k, j) && e->lack[k] != 0;
}

/* 1/a of contact k. */
static real mass(const struct every *e, int64_t k)
{
    const struct contact *c = &e->contact[k];
    real a = 0, most = 0;
    for (int j = 0; j < 4; j++) {
        if (!pushes(e->s, k, j))
            continue;
        real w = (real)e->parts[c->v[j]] * e->s->w[c->v[j]];
        a += c->c[j] * c->c[j] * w;
        most = real_max(most, w);
    }
    a = real_max(a, R(0x1p-12) * most);
    return a > 0 ? 1 / a : 0;
}

static void apply(struct every *e, vec *u)
{
    const struct contacts *s = e->s;
    memset(e->sum, 0, (size_t)s->nv * sizeof *e->sum);
    for (int64_t k = 0; k < s->n; k++)
        for (int j = 0; j < 4; j++)
            if (pushes(s, k, j)) {
                vec *sum = &e->sum[e->contact[k].v[j]];
                *sum = vec_axpy(*sum, e->contact[k].c[j], e->push[k]);
            }
    for (int64_t i = 0; i < s->nv; i++)
        if (s->w[i] > 0)
            u[i] = vec_axpy(u[i], s->w[i], e->sum[i]);
}

static void normal(struct every *e)
{
    for (int64_t k = 0; k < e->s->n; k++) {
        const struct contact *c = &e->contact[k];
        real lack = c->target - vec_dot(c->n, pair_sum(c->v, c->c, e->u));
        e->lack[k] = lack > 0 || c->impulse > 0 ? lack : 0;
    }
    split(e);
    for (int64_t k = 0; k < e->s->n; k++) {
        struct contact *c = &e->contact[k];
        real next = c->impulse;
        if (e->lack[k] != 0)
            next = real_max(next + mass(e, k) * e->lack[k], 0);
        e->push[k] = vec_scale(next - c->impulse, c->n);
        c->impulse = next;
    }
    apply(e, e->u);
}

static void tangent(struct every *e)
{
    for (int64_t k = 0; k < e->s->n; k++) {
        struct contact *c = &e->contact[k];
        e->push[k] = vec_make(0, 0, 0);
        if (e->lack[k] == 0)
            continue;
        vec slip = pair_sum(c->v, c->c, e->u);
        slip = vec_axpy(slip, -vec_dot(c->n, slip), c->n);
        vec next = vec_axpy(c->tangent, -mass(e, k), slip);
        real limit = c->friction * c->impulse, length = vec_length(next);
        if (length > limit)
            next = vec_scale(limit / length, next);
        e->push[k] = vec_sub(next, c->tangent);
        c->tangent = next;
    }
    apply(e, e->u);
}

static void solve(struct every *e)
{
    for (int64_t k = 0; k < e->s->n; k++) {
        struct contact *c = &e->contact[k];
        if (!e->s->warm) {
            c->impulse = 0;
            c->tangent = vec_make(0, 0, 0);
        }
        e->before[k] = total(c);
    }
    for (int t = 0; t < e->s->iterations; t++)
        normal(e);
    for (int64_t k = 0; k < e->s->n; k++) {
        const struct contact *c = &e->contact[k];
        e->lack[k] = c->impulse > 0 || vec_dot(c->tangent, c->tangent) > 0;
    }
    split(e);
    for (int t = 0; t < e->s->iterations; t++)
        tangent(e);
    for (int64_t k = 0; k < e->s->n; k++)
        e->push[k] = vec_sub(total(&e->contact[k]), e->before[k]);
    apply(e, e->v);
}

static void take_scratch(struct bytes *b, struct contacts *s)
{
    s->start = take(b, s->nv1, sizeof *s->start);
    s->item = take(b, s->n4, sizeof *s->item);
    s->parts = take(b, s->nv, sizeof *s->parts);
    s->lack = take(b, s->n, sizeof *s->lack);
    s->push = take(b, s->n, sizeof *s->push);
    s->before = take(b, s->n, sizeof *s->before);
    s->awake = take(b, s->n, sizeof *s->awake);
    s->stirred = take(b, s->nv, sizeof *s->stirred);
    s->vertex = take(b, s->n4, sizeof *s->vertex);
    s->moved = take(b, s->n4, sizeof *s->moved);
}

/* Equal but for the sign of zeros. */
static bool alike(vec a, vec b)
{
    return a.x == b.x && a.y == b.y && a.z == b.z;
}

static const char *compare(struct bytes *b, int64_t *asleep)
{
    struct contacts s = {0};
    gen_contacts(b, &s);
    take_scratch(b, &s);
    struct every e = {.s = &s};
    e.contact = copy(b, s.contact, s.n, sizeof *s.contact);
    e.u = copy(b, s.u, s.nv, sizeof *s.u);
    e.v = copy(b, s.v, s.nv, sizeof *s.v);
    e.sum = take(b, s.nv, sizeof *e.sum);
    e.push = take(b, s.n, sizeof *e.push);
    e.before = take(b, s.n, sizeof *e.before);
    e.lack = take(b, s.n, sizeof *e.lack);
    e.parts = take(b, s.nv, sizeof *e.parts);
    solve(&e);
    EXPECT(ref_contacts(&s) == DRAPE_OK);
    for (int64_t k = 0; k < s.n; k++) {
        EXPECT(s.contact[k].impulse == e.contact[k].impulse);
        EXPECT(alike(s.contact[k].tangent, e.contact[k].tangent));
        *asleep += !s.awake[k];
    }
    for (int64_t i = 0; i < s.nv; i++)
        EXPECT(alike(s.u[i], e.u[i]) && alike(s.v[i], e.v[i]));
    return NULL;
}

const char *test_contacts_every(void)
{
    int64_t asleep = 0;
    for (uint64_t k = 0; k < 400; k++) {
        struct bytes b = {.seed = k, .size = (int64_t)(k % 200)};
        const char *failed = compare(&b, &asleep);
        choices_free(&b);
        if (failed)
            return failed;
        ran(1);
    }
    EXPECT(asleep > 1000); /* or nothing was left out */
    return NULL;
}
