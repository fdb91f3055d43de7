/* SPDX-License-Identifier: Apache-2.0 */
/* Stage contacts: generator and properties. spec/contact/contacts.md */
#include "tests/contact/contacts.h"

#include <stdlib.h>

#include "ref/base/wide.h"
#include "ref/contact/proximity.h"
#include "tests/base/choices.h"

const struct field fields_contacts[] = {
    IN(contacts, w, nv, 1),
    INOUT(contacts, contact, n, 1),
    INOUT(contacts, u, nv, 1),
    INOUT(contacts, v, nv, 1),
    SCRATCH(contacts, start, nv1, 1),
    SCRATCH(contacts, item, n4, 1),
    SCRATCH(contacts, acting, nv, 1),
    SCRATCH(contacts, parts, nv, 1),
    SCRATCH(contacts, lack, n, 1),
    SCRATCH(contacts, lookahead, n, 1),
    SCRATCH(contacts, push, n, 1),
    SCRATCH(contacts, before, n, 1),
    SCRATCH(contacts, contact_awake, n, 1),
    SCRATCH(contacts, vertex_awake, nv, 1),
    OUT_USED(contacts, vertex, n4, 1, vertices),
    OUT_USED(contacts, moved, n4, 1, vertices),
    OUT_VALUE(contacts, vertices),
    FIELD_END};

static void pick_contact(struct bytes *b, int64_t nv, struct contact *c)
{
    real s = R(0.25) * (real)pick(b, 5), t = R(0.25) * (real)pick(b, 5);
    c->kind = pick(b, 2);
    for (int j = 0; j < 4; j++)
        c->v[j] = (int32_t)pick(b, (uint32_t)nv);
    c->c[0] = c->kind ? 1 - s : 1;
    c->c[1] = c->kind ? s : -(1 - s) * (1 - t);
    c->c[2] = c->kind ? -(1 - t) : -s;
    c->c[3] = c->kind ? -t : -t * (1 - s);
    real x = pick_uniform(b, -1, 1), y = pick_uniform(b, -1, 1);
    vec n = vec_make(x, y, 1);
    c->n = vec_scale(1 / vec_length(n), n);
    c->gap = pick_uniform(b, 0, R(0.01));
    c->target = pick(b, 2) ? 0 : pick_uniform(b, -1, 1);
    c->friction = pick(b, 3) ? R(0.25) * (real)pick(b, 4) : 10;
    c->impulse = pick(b, 2) ? pick_uniform(b, 0, R(0.1)) : 0;
    c->stiffness_t = pick(b, 2) ? pick_uniform(b, 0, R(0.01)) : 0;
}

void gen_contacts(struct bytes *b, struct contacts *s)
{
    s->n = for_bench(b) ? 1 << 16 : pick_size(b);
    s->nv = for_bench(b) ? s->n : 4 + s->n / (1 + pick(b, 8));
    s->nv1 = s->nv + 1;
    s->n4 = 4 * s->n;
    s->iterations = (int)pick(b, for_bench(b) ? 9 : 65);
    s->warm = (int)pick(b, 2);
    real *w = take(b, s->nv, sizeof *w);
    struct contact *contact = take(b, s->n, sizeof *contact);
    vec *u = take(b, s->nv, sizeof *u), *v = take(b, s->nv, sizeof *v);
    for (int64_t i = 0; i < s->nv; i++) {
        w[i] = pick(b, 4) ? pick_uniform(b, R(0.1), 1000) : 0;
        u[i] = pick_vec(b, 10);
        v[i] = pick(b, 2) ? u[i] : pick_vec(b, 10);
    }
    bool rests = pick(b, 2);  /* most contacts act only if others push them */
    bool hub = s->n % 4 == 1; /* vertex 0 is in every third contact */
    if (hub)
        s->iterations %= 8;
    for (int64_t k = 0; k < s->n; k++) {
        pick_contact(b, s->nv, &contact[k]);
        if (hub && k % 3 == 0)
            contact[k].v[0] = 0;
        if (rests && pick(b, 8)) {
            contact[k].target = -pick_uniform(b, 1, 20);
            contact[k].impulse = 0;
        }
    }
    s->w = w;
    s->contact = contact;
    s->u = u;
    s->v = v;
}

static const double eps = REAL_BITS == 32 ? 0x1p-24 : 0x1p-53;

/* §4.1, of each vertex: how many items act on it, and how far friction can have
 * taken its velocity from where it ended, m/s. */
struct rub {
    int64_t acting;
    double way;
};

static void find_rubs(const struct contacts *s, struct rub *rub)
{
    for (int64_t k = 0; k < s->n4; k++) {
        const struct contact *c = &s->contact[k / 4];
        double most = (double)c->friction * (double)c->impulse;
        struct rub *r = &rub[c->v[k % 4]];
        double part = (double)real_abs(c->c[k % 4]);
        r->acting += c->impulse > 0 && part > 0;
        r->way += 2 * (double)s->w[c->v[k % 4]] * part * most;
    }
}

/* §4.1: the greatest n·τ of contact c that rounding can leave, N·s. */
static double along_most(const struct contacts *s, const struct contact *c,
                         const struct rub *rub)
{
    double speed = 0, a = 0, widest = 0;
    for (int j = 0; j < 4; j++) {
        int32_t i = c->v[j];
        double part = (double)real_abs(c->c[j]);
        double w = (double)s->w[i] * (double)rub[i].acting;
        speed += part * ((double)vec_length(s->u[i]) + rub[i].way);
        a += part * part * w;
        widest = part > 0 && w > widest ? w : widest;
    }
    a = a > 0x1p-12 * widest ? a : 0x1p-12 * widest;
    if (!(a > 0))
        return 0;
    struct wide n = wide_of(c->n);
    double most = (double)c->friction * (double)c->impulse;
    double each = (fabs(1 - wide_dot(n, n)) + 8 * eps) * speed / a;
    return 2 * s->iterations * (each + 3 * eps * most);
}

/* §4: impulses in the friction cone, and across n up to rounding. */
static const char *check_friction(const struct contacts *s,
                                  const struct rub *rub)
{
    /* §4: the square of a component below 2^-62 (2^-510) underflows, so a
     * computed length may lose such a component. */
    const real lost = REAL_BITS == 32 ? R(0x1p-61) : (real)0x1p-509;
    for (int64_t k = 0; k < s->n; k++) {
        const struct contact *c = &s->contact[k];
        real most = c->friction * c->impulse;
        /* up to rounding of the length and the scale */
        EXPECT(c->impulse >= 0);
        EXPECT(vec_length(c->tangent) <= most * (1 + R(0x1p-20)) + lost);
        double along = wide_dot(wide_of(c->tangent), wide_of(c->n));
        EXPECT(fabs(along) <=
               along_most(s, c, rub) + 4 * eps * (double)most + (double)lost);
    }
    return NULL;
}

const char *prop_contacts(const struct contacts *s)
{
    struct rub *rub = calloc((size_t)s->nv + 1, sizeof *rub);
    EXPECT(rub);
    find_rubs(s, rub);
    const char *failed = check_friction(s, rub);
    free(rub);
    if (failed)
        return failed;
    int64_t at = 0;
    for (int64_t i = 0; i < s->nv; i++) {
        bool in = false;
        for (int64_t k = 0; k < s->n4 && s->n <= 300; k++)
            in |= s->contact[k / 4].v[k % 4] == i && s->w[i] > 0 &&
                  s->contact[k / 4].c[k % 4] != 0;
        bool listed = at < s->vertices && s->vertex[at] == i;
        EXPECT(s->n > 300 || in == listed); /* §1 */
        EXPECT(!listed || s->w[i] > 0);
        EXPECT(vec_sane(s->u[i]) && vec_sane(s->v[i]));
        at += listed;
    }
    EXPECT(at == s->vertices);
    return NULL;
}

/* §5: conservation of momentum and bound of energy */

struct sums {
    struct wide p, l; /* linear and angular momentum */
    double e;         /* kinetic energy */
    double scale;     /* Σ m |v| */
};

static struct sums add_up(const struct contacts *s, const vec *x, const vec *v)
{
    struct sums r = {{0, 0, 0}, {0, 0, 0}, 0, 0};
    for (int64_t i = 0; i < s->nv; i++) {
        if (!(s->w[i] > 0))
            continue;
        double m = 1 / (double)s->w[i];
        struct wide a = wide_of(v[i]);
        r.p = wide_axpy(r.p, m, a);
        r.l = wide_axpy(r.l, m, wide_cross(wide_of(x[i]), a));
        r.e += 0.5 * m * wide_dot(a, a);
        r.scale += m * sqrt(wide_dot(a, a));
    }
    return r;
}

/* §5.1: by how much rounding may change the momentum: each vertex of d contacts
 * errs by (d + 3) eps of its impulses and by eps of its velocity. */
static double rounding(const struct contacts *s, const vec *v)
{
    double bound = 0;
    for (int64_t k = 0; k < s->n4; k++) {
        const struct contact *c = &s->contact[k / 4];
        int32_t i = c->v[k % 4];
        double push = (double)vec_length(c->tangent) + (double)c->impulse;
        double d = s->start[i + 1] - s->start[i];
        bound += (d + 3) * eps * (double)real_abs(c->c[k % 4]) * push;
    }
    for (int64_t i = 0; i < s->nv; i++)
        bound += eps * (double)vec_length(v[i]) / (double)s->w[i];
    return 2 * bound;
}

void contacts_scratch(struct bytes *b, struct contacts *s)
{
    s->start = take(b, s->nv1, sizeof *s->start);
    s->item = take(b, s->n4, sizeof *s->item);
    s->acting = take(b, s->nv, sizeof *s->acting);
    s->parts = take(b, s->nv, sizeof *s->parts);
    s->lack = take(b, s->n, sizeof *s->lack);
    s->lookahead = take(b, s->n, sizeof *s->lookahead);
    s->push = take(b, s->n, sizeof *s->push);
    s->before = take(b, s->n, sizeof *s->before);
    s->vertex = take(b, s->n4, sizeof *s->vertex);
    s->moved = take(b, s->n4, sizeof *s->moved);
    s->contact_awake = take(b, s->n, sizeof *s->contact_awake);
    s->vertex_awake = take(b, s->nv, sizeof *s->vertex_awake);
}

/* Allocates the streams of n contacts between nv free vertices, with random
 * positions *x and velocities. */
static void take_free(struct bytes *b, struct contacts *s, vec **x)
{
    s->n = 1 + pick(b, 200);
    s->nv = 4 + pick(b, 300);
    s->nv1 = s->nv + 1;
    s->n4 = 4 * s->n;
    s->iterations = (int)pick(b, 20);
    real *w = take(b, s->nv, sizeof *w);
    *x = take(b, s->nv, sizeof **x);
    s->u = take(b, s->nv, sizeof *s->u);
    s->v = take(b, s->nv, sizeof *s->v);
    for (int64_t i = 0; i < s->nv; i++) {
        w[i] = pick_uniform(b, R(0.5), 50);
        (*x)[i] = pick_vec(b, 1);
        s->u[i] = s->v[i] = pick_vec(b, 3);
    }
    s->w = w;
    contacts_scratch(b, s);
}

/* Makes the contacts of random pairs by proximity. */
static int meet(struct bytes *b, struct contacts *s, const vec *x)
{
    struct surface surface = {10, R(0.25) * (real)pick(b, 4)};
    int32_t *pair = take(b, s->n4, sizeof *pair);
    uint8_t *kind = take(b, s->n, 1);
    for (int64_t k = 0; k < s->n && s->nv > 0; k++) {
        kind[k] = (uint8_t)pick(b, 2);
        int32_t at = (int32_t)pick(b, (uint32_t)s->nv);
        for (int j = 0; j < 4; j++) /* four different vertices */
            pair[4 * k + j] = (int32_t)((at + j * (s->nv / 4)) % s->nv);
    }
    struct proximity p = {.range = 1,
                          .nv = s->nv,
                          .n = s->n,
                          .pair = pair,
                          .kind = kind,
                          .x = x,
                          .w = s->w,
                          .dt = R(0.01),
                          .stiffness = pick(b, 2) ? 0 : 1,
                          .cap = s->n};
    p.surfaces = (struct surfaces){1, take(b, s->nv, 2), &surface};
    p.at = take(b, s->n, sizeof *p.at);
    p.contact = take(b, s->n, sizeof *p.contact);
    s->contact = p.contact;
    return ref_proximity(&p);
}

static double distance(struct wide a, struct wide b)
{
    struct wide d = wide_sub(a, b);
    return sqrt(wide_dot(d, d));
}

static const char *conserve(struct bytes *b)
{
    struct contacts s = {0};
    vec *x;
    take_free(b, &s, &x);
    EXPECT(meet(b, &s, x) == DRAPE_OK);
    struct sums before = add_up(&s, x, s.v);
    EXPECT(ref_contacts(&s) == DRAPE_OK);
    struct sums after = add_up(&s, x, s.v), other = add_up(&s, x, s.u);
    double bound = rounding(&s, s.v), torque = 0, work = 0;
    for (int64_t k = 0; k < s.n; k++) {
        const struct contact *c = &s.contact[k];
        double push = (double)vec_length(c->tangent) + (double)c->impulse;
        torque +=
            (double)c->gap * (double)vec_length(c->tangent) + 64 * eps * push;
        work += (double)(real_max(c->target, 0) * c->impulse);
    }
    EXPECT(distance(after.p, before.p) <= bound);
    /* §5.2: |x| ≤ √3 */
    EXPECT(distance(after.l, before.l) <= 2 * bound + torque);
    /* §5.3, with the rounding of up to twenty iterations in u or v */
    double slack = 256 * eps * (before.e + after.e + work);
    EXPECT(after.e <= before.e + work + slack);
    EXPECT(other.e <= before.e + work + slack);
    EXPECT(distance(other.p, before.p) <= 40 * bound + 40 * eps * after.scale);
    return NULL;
}

const char *test_contacts_conserve(void)
{
    for (uint64_t k = 0; k < 400; k++) {
        struct bytes b = {.seed = k, .size = -1};
        const char *failed = conserve(&b);
        choices_free(&b);
        if (failed)
            return failed;
        ran(1);
    }
    return NULL;
}

/* §3: contacts at rest do not split a vertex. One vertex has 40 contacts with a
 * prescribed face and violates one of them: the impulse is the same as if that
 * contact were alone. Another vertex has a contact at rest and keeps its bits.
 */
const char *test_contacts_rest(void)
{
    enum { N = 41, NV = 5 };
    static const real w[NV] = {1, 0, 0, 0, 1};
    vec u[NV] = {[0] = {0, -1, 0}, [4] = {R(-0.0), 0, 0}};
    vec v[NV] = {[0] = {0, -1, 0}, [4] = {R(-0.0), 0, 0}}, push[N], before[N];
    uint8_t moved[4 * N], contact_awake[N], vertex_awake[NV];
    int32_t start[NV + 1], item[4 * N], vertex[4 * N], acting[NV], parts[NV];
    real lack[N], lookahead[N];
    struct contact contact[N];
    for (int k = 0; k < N; k++) {
        struct contact one = {.v = {k > 0 ? 0 : 4, 1, 2, 3},
                              .kind = CONTACT_VF,
                              .c = {1, R(-0.5), R(-0.25), R(-0.25)},
                              .n = {0, 1, 0},
                              .target = k == N / 2 ? R(-0.5) : -2};
        contact[k] = one;
    }
    struct contacts s = {.nv = NV,
                         .n = N,
                         .w = w,
                         .iterations = 1,
                         .contact = contact,
                         .u = u,
                         .v = v,
                         .nv1 = NV + 1,
                         .n4 = 4 * N,
                         .start = start,
                         .item = item,
                         .acting = acting,
                         .parts = parts,
                         .lack = lack,
                         .lookahead = lookahead,
                         .push = push,
                         .before = before,
                         .contact_awake = contact_awake,
                         .vertex_awake = vertex_awake,
                         .vertex = vertex,
                         .moved = moved};
    EXPECT(ref_contacts(&s) == DRAPE_OK);
    for (int k = 0; k < N; k++)
        EXPECT(contact[k].impulse == (k == N / 2 ? R(0.5) : 0));
    EXPECT(u[0].y == R(-0.5) && v[0].y == R(-0.5));
    EXPECT(s.vertices == 2 && moved[0] && !moved[1]);
    EXPECT(signbit(u[4].x) && signbit(v[4].x));
    ran(1);
    return NULL;
}

/* A column of COLUMN vertices falls on a prescribed vertex. Returns the sum of
 * the lacks of its contacts after `calls` calls of `iterations` iterations
 * each, m/s; every call but the first is warm. */
static double fall_column(struct bytes *b, int calls, int iterations)
{
    enum { COLUMN = 20 };
    struct contacts s = {.n = COLUMN,
                         .nv = COLUMN + 1,
                         .nv1 = COLUMN + 2,
                         .n4 = 4 * COLUMN,
                         .iterations = iterations};
    real *w = take(b, s.nv, sizeof *w);
    s.u = take(b, s.nv, sizeof *s.u);
    s.v = take(b, s.nv, sizeof *s.v);
    s.contact = take(b, s.n, sizeof *s.contact);
    for (int32_t k = 0; k < COLUMN; k++) {
        s.contact[k] = (struct contact){
            .v = {k + 1, k, k, k}, .c = {1, -1, 0, 0}, .n = {0, 1, 0}};
        s.u[k + 1] = s.v[k + 1] = vec_make(0, -1, 0);
        w[k + 1] = 1;
    }
    s.w = w;
    contacts_scratch(b, &s);
    for (int k = 0; k < calls; k++) {
        s.warm = k > 0;
        if (ref_contacts(&s) != DRAPE_OK)
            return NAN;
    }
    double sum = 0;
    for (int k = 0; k < COLUMN; k++)
        sum += (double)real_max(s.u[k].y - s.u[k + 1].y, 0);
    return sum;
}

/* §3: momentum converges faster: one call of 256 iterations has momentum, 256
 * calls of one iteration have none. */
const char *test_contacts_momentum(void)
{
    struct bytes b = {.seed = 1, .size = -1};
    double slow = fall_column(&b, 256, 1), fast = fall_column(&b, 1, 256);
    choices_free(&b);
    EXPECT(slow > 0.1 && fast < slow / 16);
    ran(1);
    return NULL;
}
