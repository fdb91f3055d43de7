/* SPDX-License-Identifier: Apache-2.0 */
/* A second implementation of stage contacts, which processes every contact in
 * every iteration and uses no lists. It shows that skipping sleeping contacts
 * changes nothing, and that the energy bound holds in every iteration.
 * spec/contact/contacts.md §1, §5.3 */
#include "ref/base/wide.h"
#include "tests/base/choices.h"
#include "tests/base/harness.h"
#include "tests/contact/contacts.h"

void gen_contacts(struct bytes *b, struct contacts *s);

/* The streams of the second implementation; its inputs are those of s. */
struct every {
    const struct contacts *s;
    struct contact *contact;
    vec *u, *v, *sum, *push, *before;
    real *lack, *lookahead, *change; /* change: Δ, λ minus the λ before */
    int *items, *acting, *parts;
    int voids;
    double slack; /* J, allowance for rounding */
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

/* Counts the contacts of each vertex, and the acting contacts among them. */
static void count(struct every *e)
{
    size_t bytes = (size_t)e->s->nv * sizeof *e->acting;
    memset(e->items, 0, bytes);
    memset(e->acting, 0, bytes);
    for (int64_t k = 0; k < 4 * e->s->n; k++)
        if (pushes(e->s, k / 4, k % 4)) {
            e->items[e->contact[k / 4].v[k % 4]]++;
            e->acting[e->contact[k / 4].v[k % 4]] += e->lack[k / 4] != 0;
        }
}

/* §3: whether the iteration is void: more than d / β² contacts act on a vertex.
 */
static bool exceeds(const struct every *e, real beta)
{
    for (int64_t i = 0; i < e->s->nv; i++)
        if (e->parts[i] > 0 &&
            beta * beta * (real)e->acting[i] > (real)e->parts[i])
            return true;
    return false;
}

/* Sets d of each vertex; in the last iteration, to the number of acting
 * contacts. */
static void split(struct every *e, bool last)
{
    for (int64_t i = 0; i < e->s->nv; i++) {
        int *d = &e->parts[i], acting = e->acting[i];
        if (last)
            *d = acting;
        else if (acting > 0 && *d == 0)
            *d = e->items[i] > 1 ? acting + 1 : 1;
        else if (acting > *d)
            *d = acting;
    }
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

/* Σ c · push of each vertex. */
static void add_up(struct every *e)
{
    const struct contacts *s = e->s;
    memset(e->sum, 0, (size_t)s->nv * sizeof *e->sum);
    for (int64_t k = 0; k < s->n; k++)
        for (int j = 0; j < 4; j++)
            if (pushes(s, k, j)) {
                vec *sum = &e->sum[e->contact[k].v[j]];
                *sum = vec_axpy(*sum, e->contact[k].c[j], e->push[k]);
            }
}

static void apply(struct every *e, vec *u)
{
    add_up(e);
    for (int64_t i = 0; i < e->s->nv; i++)
        if (e->s->w[i] > 0)
            u[i] = vec_axpy(u[i], e->s->w[i], e->sum[i]);
}

static void find_lack(struct every *e)
{
    for (int64_t k = 0; k < e->s->n; k++) {
        const struct contact *c = &e->contact[k];
        real lack = c->target - vec_dot(c->n, pair_sum(c->v, c->c, e->u));
        e->lack[k] = lack > 0 || e->lookahead[k] > 0 ? lack : 0;
    }
}

/* The target of contact k less the speed of its prescribed vertices. */
static double free_target(const struct every *e, int64_t k)
{
    const struct contact *c = &e->contact[k];
    double target = (double)c->target;
    for (int j = 0; j < 4; j++)
        if (!(e->s->w[c->v[j]] > 0))
            target -= (double)(c->c[j] * vec_dot(c->n, e->u[c->v[j]]));
    return target;
}

/* §5.3: V = E - λᵀb + ½ |change|² in the norm of diag(a), at λ (u is at y). */
static double bound(struct every *e)
{
    double sum = 0;
    for (int64_t k = 0; k < e->s->n; k++) {
        struct contact *c = &e->contact[k];
        double change = (double)e->change[k], m = (double)mass(e, k);
        sum -= (double)c->impulse * free_target(e, k);
        sum += m > 0 ? 0.5 * change * change / m : 0;
        e->push[k] = vec_scale(c->impulse - e->lookahead[k], c->n);
    }
    add_up(e);
    for (int64_t i = 0; i < e->s->nv; i++)
        if (e->s->w[i] > 0) {
            struct wide u = wide_axpy(wide_of(e->u[i]), (double)e->s->w[i],
                                      wide_of(e->sum[i]));
            sum += 0.5 * wide_dot(u, u) / (double)e->s->w[i];
        }
    return sum;
}

/* §3: the normal part: the new λ, and y = λ + keep · change, at least 0. over:
 * the iteration is void. */
static void normal(struct every *e, bool over, real keep)
{
    for (int64_t k = 0; k < e->s->n; k++) {
        struct contact *c = &e->contact[k];
        real y = e->lookahead[k], now = y;
        if (e->lack[k] != 0)
            now = real_max(y + mass(e, k) * e->lack[k], 0);
        if (!over) {
            e->change[k] = now - c->impulse;
            c->impulse = now;
            e->lookahead[k] = real_max(now + keep * e->change[k], 0);
        } else
            e->lookahead[k] = c->impulse + keep * (y - c->impulse);
        e->push[k] = vec_scale(e->lookahead[k] - y, c->n);
    }
}

/* The normal part, §3. False: the bound of §5.3 rose. */
static bool solve_normal(struct every *e)
{
    int last = e->s->iterations - 1;
    double least = bound(e);
    for (int t = 0, age = 0; t <= last; t++) {
        real beta = (real)age / ((real)age + 3);
        find_lack(e);
        count(e);
        bool over = exceeds(e, beta);
        e->voids += over;
        age = over ? age / 2 : age + 1;
        real keep = t < last ? (real)age / ((real)age + 3) : 0;
        if (!over)
            split(e, t == last);
        normal(e, over, over ? keep / beta : keep);
        apply(e, e->u);
        double now = over ? least : bound(e);
        if (!(now <= least + e->slack))
            return false;
        least = now;
    }
    return true;
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

static void begin(struct every *e)
{
    for (int64_t k = 0; k < e->s->n; k++) {
        struct contact *c = &e->contact[k];
        if (!e->s->warm) {
            c->impulse = 0;
            c->tangent = vec_make(0, 0, 0);
        }
        e->before[k] = total(c);
        e->lookahead[k] = c->impulse;
    }
}

/* Both parts, §3 and §4. False: the bound of §5.3 rose. */
static bool solve(struct every *e)
{
    begin(e);
    bool holds = solve_normal(e);
    for (int64_t k = 0; k < e->s->n; k++) {
        const struct contact *c = &e->contact[k];
        e->lack[k] = c->impulse > 0 || vec_dot(c->tangent, c->tangent) > 0;
    }
    count(e);
    split(e, true);
    for (int t = 0; t < e->s->iterations; t++)
        tangent(e);
    for (int64_t k = 0; k < e->s->n; k++)
        e->push[k] = vec_sub(total(&e->contact[k]), e->before[k]);
    apply(e, e->v);
    return holds;
}

/* Equal, except that zeros may differ in sign. */
static bool alike(vec a, vec b)
{
    return a.x == b.x && a.y == b.y && a.z == b.z;
}

static void take_plain(struct bytes *b, struct every *e)
{
    const struct contacts *s = e->s;
    e->contact = copy(b, s->contact, s->n, sizeof *s->contact);
    e->u = copy(b, s->u, s->nv, sizeof *s->u);
    e->v = copy(b, s->v, s->nv, sizeof *s->v);
    e->sum = take(b, s->nv, sizeof *e->sum);
    e->push = take(b, s->n, sizeof *e->push);
    e->before = take(b, s->n, sizeof *e->before);
    e->lack = take(b, s->n, sizeof *e->lack);
    e->lookahead = take(b, s->n, sizeof *e->lookahead);
    e->change = take(b, s->n, sizeof *e->change);
    e->items = take(b, s->nv, sizeof *e->items);
    e->acting = take(b, s->nv, sizeof *e->acting);
    e->parts = take(b, s->nv, sizeof *e->parts);
    double scale = 0;
    for (int64_t i = 0; i < s->nv; i++)
        if (s->w[i] > 0)
            scale += (double)(vec_dot(s->u[i], s->u[i]) / s->w[i]);
    e->slack = 1024 * (REAL_BITS == 32 ? 0x1p-24 : 0x1p-53) * scale;
}

/* Runs both implementations on the inputs of s: the second keeps the energy
 * bound, and both agree. */
static const char *compare(struct bytes *b, struct contacts *s, int *voids)
{
    struct every e = {.s = s};
    contacts_scratch(b, s);
    take_plain(b, &e);
    EXPECT(solve(&e));
    *voids += e.voids;
    EXPECT(ref_contacts(s) == DRAPE_OK);
    for (int64_t k = 0; k < s->n; k++) {
        EXPECT(s->contact[k].impulse == e.contact[k].impulse);
        EXPECT(alike(s->contact[k].tangent, e.contact[k].tangent));
    }
    for (int64_t i = 0; i < s->nv; i++)
        EXPECT(alike(s->u[i], e.u[i]) && alike(s->v[i], e.v[i]));
    return NULL;
}

const char *test_contacts_every(void)
{
    int64_t asleep = 0;
    int voids = 0;
    for (uint64_t k = 0; k < 400; k++) {
        struct bytes b = {.seed = k, .size = (int64_t)(k % 200)};
        struct contacts s = {0};
        gen_contacts(&b, &s);
        const char *failed = compare(&b, &s, &voids);
        for (int64_t j = 0; j < s.n; j++)
            asleep += !s.contact_awake[j];
        choices_free(&b);
        if (failed)
            return failed;
        ran(1);
    }
    EXPECT(asleep > 1000); /* the cases had sleeping contacts */
    EXPECT(voids > 10);    /* the cases had void iterations */
    return NULL;
}

/* A column falls on a prescribed vertex, below a lid. Only the overshoot of
 * momentum reaches the lid, whose many contacts then act all at once while
 * momentum is large: this makes an iteration void. */
static void make_column(struct bytes *b, struct contacts *s)
{
    enum { COLUMN = 8, LID = 200 };
    s->n = COLUMN + LID;
    s->nv = COLUMN + 2;
    s->nv1 = s->nv + 1;
    s->n4 = 4 * s->n;
    s->iterations = 64;
    real *w = take(b, s->nv, sizeof *w);
    s->u = take(b, s->nv, sizeof *s->u);
    s->v = take(b, s->nv, sizeof *s->v);
    s->contact = take(b, s->n, sizeof *s->contact);
    for (int32_t k = 0; k < COLUMN; k++) {
        s->contact[k] = (struct contact){
            .v = {k + 1, k, k, k}, .c = {1, -1, 0, 0}, .n = {0, 1, 0}};
        s->u[k + 1] = s->v[k + 1] = vec_make(0, -1, 0);
        w[k + 1] = 1;
    }
    for (int32_t k = COLUMN; k < s->n; k++)
        s->contact[k] = (struct contact){.v = {COLUMN, COLUMN + 1, 0, 0},
                                         .c = {1, -1, 0, 0},
                                         .n = {0, -1, 0},
                                         .target = R(-0.015625)};
    s->w = w;
}

/* §5.3: the bound of energy needs void iterations. */
const char *test_contacts_void(void)
{
    struct bytes b = {.seed = 1, .size = -1};
    struct contacts s = {0};
    int voids = 0;
    make_column(&b, &s);
    const char *failed = compare(&b, &s, &voids);
    choices_free(&b);
    EXPECT(failed || voids > 0);
    ran(1);
    return failed;
}
