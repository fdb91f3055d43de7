/* SPDX-License-Identifier: Apache-2.0 */
/* Stages coulomb and links: generators and properties. spec/contact/coulomb.md
 */
#include "ref/contact/coulomb.h"

#include <stdlib.h>

#include "ref/base/wide.h"
#include "ref/contact/contacts.h"
#include "ref/contact/incidence.h"
#include "tests/base/choices.h"

const struct field fields_coulomb[] = {
    IN(coulomb, w, nv, 1),           IN(coulomb, u, nv, 1),
    IN(coulomb, rest, nc, 1),        INOUT(coulomb, contact, n, 1),
    INOUT(coulomb, start, nv1, 1),   INOUT(coulomb, item, n4, 1),
    SCRATCH(coulomb, vertex, n4, 1), SCRATCH(coulomb, next, n, 1),
    OUT(coulomb, force, nv, 1),      OUT(coulomb, inner, nc, 1),
    OUT(coulomb, outer, nc, 1),      OUT(coulomb, single, nv, 1),
    OUT(coulomb, bound, nv, 1),      FIELD_END};

const struct field fields_links[] = {IN(links, contact, n, 1),
                                     IN(links, x, nv, 1),
                                     IN(links, start, nv1, 1),
                                     IN(links, item, n4, 1),
                                     SCRATCH(links, push, n, 1),
                                     INOUT(links, y, nv, 1),
                                     FIELD_END};

/* Stage contacts' generator; all three stages take the same contacts. */
void gen_contacts(struct bytes *b, struct contacts *s);

static const double unit = REAL_BITS == 32 ? 0x1p-24 : 0x1p-53;
/* Of a few numbers that underflow. */
static const double least = REAL_BITS == 32 ? 0x1p-140 : 0x1p-1060;
/* Of vectors whose squares underflow. */
static const double short_ = REAL_BITS == 32 ? 0x1p-62 : 0x1p-510;

/* A vector across n. */
static vec pick_across(struct bytes *b, vec n, real scale)
{
    vec a = pick_vec(b, scale);
    return vec_axpy(a, -vec_dot(n, a), n);
}

/* Weights that are no multiples of a power of two; a side adds to 1 or -1 up to
 * rounding. */
static void pick_weights(struct bytes *b, struct contact *c)
{
    real s = pick_uniform(b, 0, 1), t = pick_uniform(b, 0, 1);
    c->c[0] = c->kind ? 1 - s : 1;
    c->c[1] = c->kind ? s : -(1 - s) * (1 - t);
    c->c[2] = c->kind ? -(1 - t) : -s;
    c->c[3] = c->kind ? -t : -t * (1 - s);
}

/* What stage carry and calls before may have left in a contact. */
static void pick_state(struct bytes *b, struct coulomb *s, struct contact *c)
{
    real pushes = pick(b, 3) ? R(0.01) : pick(b, 8) ? R(1e-6) : R(1e3);
    bool presses = pick(b, 2);
    if (pick(b, 4) == 0)
        pick_weights(b, c);
    c->friction = pick(b, 8) ? c->friction : 0;
    c->gap = pick(b, 8) ? pick_uniform(b, R(-0.001), R(0.02)) : 0;
    c->kappa = pick(b, 8) ? pick_uniform(b, R(1e-4), 1) : R(1e4);
    c->kappa = pick(b, 16) ? c->kappa : 0; /* it moves nothing */
    c->lambda = presses ? pick_uniform(b, 0, pushes) : 0;
    c->load = pick(b, 2) ? c->lambda : pick_uniform(b, 0, pushes);
    c->lambda_t = presses ? pick_across(b, c->n, pushes) : vec_make(0, 0, 0);
    c->rise = pick(b, 2) ? pick_real(b, pushes) : 0;
    c->impulse = presses ? pick_uniform(b, 0, 2 * pushes) : 0;
    c->tangent = pick_across(b, c->n, c->friction * c->load);
    c->target *= pick(b, 8) ? 1 : R(1e6);
    c->coupling = (int32_t)pick(b, 3); /* of the call before */
    c->stiffness_n = c->stiffness_t = pick_uniform(b, 0, 1);
    c->way = pick_vec(b, 1);
    if (s->stiffest < c->kappa && pick(b, 2))
        c->kappa = s->stiffest;
}

/* Lists that the stage shall use, or make anew. */
static void make_lists(struct bytes *b, struct coulomb *s)
{
    s->start = take(b, s->nv1, sizeof *s->start);
    s->item = take(b, s->n4, sizeof *s->item);
    int32_t *vertex = take(b, s->n4, sizeof *vertex);
    struct incidence by = {s->nv,    s->n,    s->w,   s->contact,
                           s->start, s->item, vertex, 0};
    if (!s->lists)
        ref_incidence(&by);
}

/* seam.md §6: contact c, a point of a seam, becomes a hinge. */
static void pick_hinge(struct bytes *b, struct contact *c)
{
    real part = pick_uniform(b, 0, 1);
    c->kind = CONTACT_EE;
    c->c[0] = part;
    c->c[1] = -1;
    c->c[2] = pick(b, 4) ? R(0.5) * (1 - part) : 0;
    c->c[3] = 1 - part - c->c[2];
    c->lambda_t = vec_make(0, 0, 0);
}

/* seam.md §2: the last contacts become points of seams, as stage coulomb may
 * have left them, and the last of these hinges. */
static void pick_seams(struct bytes *b, struct coulomb *s)
{
    s->seams =
        pick(b, 4) == 0 && !for_bench(b) ? pick(b, (uint32_t)s->n + 1) : 0;
    for (int64_t k = s->n - s->seams; k < s->n; k++) {
        struct contact *c = &s->contact[k];
        real part = pick(b, 4) ? pick_uniform(b, 0, R(0.5)) : 0;
        real kappa = c->kappa;
        int32_t coupling = c->coupling;
        contact_clear(c);
        c->kind = CONTACT_VF;
        c->c[0] = 1;
        c->c[1] = part - 1;
        c->c[2] = -part;
        c->c[3] = 0;
        c->n = pick_vec(b, pick(b, 4) ? R(0.01) : R(10.0));
        c->lambda_t = pick_vec(b, R(0.01));
        c->tangent = pick_vec(b, R(0.01));
        c->load = pick(b, 3) ? 0 : pick_uniform(b, 0, R(0.01));
        c->kappa = kappa;
        c->coupling = coupling;
    }
    s->hinges = pick(b, 2) ? 0 : pick(b, (uint32_t)s->seams + 1);
    for (int64_t k = s->n - s->hinges; k < s->n; k++)
        pick_hinge(b, &s->contact[k]);
}

/* The corners of contact c close fast along its normal and hardly slip. */
static void close_fast(struct bytes *b, const struct contact *c, vec *u)
{
    real speed = pick_uniform(b, 0, pick(b, 2) ? 10 : R(1e4));
    for (int j = 0; j < 4; j++)
        u[c->v[j]] = vec_axpy(pick_vec(b, speed * R(1e-7)),
                              c->c[j] > 0 ? -speed : speed, c->n);
}

void gen_coulomb(struct bytes *b, struct coulomb *s)
{
    struct contacts c = {0};
    gen_contacts(b, &c);
    s->nv = c.nv;
    s->n = c.n;
    s->nv1 = c.nv1;
    s->n4 = c.n4;
    s->contact = c.contact;
    s->nc = pick(b, 2) ? s->nv : s->nv / 2;
    s->dt = R(1.0) / (real)(30 << pick(b, 5));
    s->tau = pick(b, 2) ? s->dt : s->dt * R(2.0) / 3;
    s->stiffest = pick_uniform(b, R(0.1), 10);
    s->give = pick(b, 4) ? 10 / s->stiffest : 0;
    s->reach = R(0.01);
    s->renews = (int)pick(b, 2);
    s->closes = pick(b, 4) == 0;
    s->lists = (int)pick(b, 2);
    bool prescribed = pick(b, 16) == 0; /* all vertices are */
    real *w = take(b, s->nv, sizeof *w);
    vec *u = take(b, s->nv, sizeof *u), *rest = take(b, s->nc, sizeof *rest);
    for (int64_t i = 0; i < s->nv; i++) {
        w[i] = prescribed ? 0 : c.w[i];
        u[i] = pick(b, 64) ? vec_scale(R(0.1), c.u[i]) : pick_vec(b, R(1e8));
        if (i < s->nc && w[i] > 0)
            rest[i] = pick_vec(b, R(0.1));
    }
    s->w = w;
    s->u = u;
    s->rest = rest;
    for (int64_t k = 0; k < s->n; k++)
        pick_state(b, s, &s->contact[k]);
    pick_seams(b, s);
    make_lists(b, s);
    for (int64_t k = 0; k < s->n - s->seams; k++)
        if (pick(b, 8) == 1)
            close_fast(b, &s->contact[k], u);
}

/* What y of vertex i is before links adds to it. */
static vec before_links(int64_t i)
{
    int32_t k = (int32_t)(i % 97);
    return vec_make(R(0.125) * (real)(k % 7 - 3), (real)(k % 5 - 2) / 3,
                    (real)(k - 48));
}

/* A unit vector across n. */
static vec pick_way(struct bytes *b, vec n)
{
    real x = pick_uniform(b, -1, 1);
    vec a = vec_cross(n, vec_make(1, x, pick_uniform(b, -1, 1)));
    return vec_scale(1 / vec_length(a), a);
}

void gen_links(struct bytes *b, struct links *s)
{
    struct contacts c = {0};
    gen_contacts(b, &c);
    s->nv = c.nv;
    s->n = c.n;
    s->nv1 = c.nv1;
    s->n4 = c.n4;
    s->contact = c.contact;
    for (int64_t k = 0; k < s->n; k++) {
        struct contact *at = &c.contact[k];
        at->coupling = (int32_t)pick(b, 3);
        at->stiffness_n = pick(b, 8) ? pick_uniform(b, R(1e-4), 1) : 0;
        at->way = pick(b, 2) ? pick_way(b, at->n) : vec_make(0, 0, 0);
    }
    bool all = pick(b, 2); /* no vertex is prescribed */
    real *w = take(b, s->nv, sizeof *w);
    vec *x = take(b, s->nv, sizeof *x);
    s->y = take(b, s->nv, sizeof *s->y);
    for (int64_t i = 0; i < s->nv; i++) {
        w[i] = all ? 1 : c.w[i];
        x[i] = w[i] > 0 ? pick_vec(b, 10) : vec_make(0, 0, 0);
        s->y[i] = before_links(i);
    }
    s->x = x;
    int32_t *start = take(b, s->nv1, sizeof *start);
    int32_t *item = take(b, s->n4, sizeof *item);
    int32_t *vertex = take(b, s->n4, sizeof *vertex);
    struct incidence by = {s->nv, s->n, w, s->contact, start, item, vertex, 0};
    ref_incidence(&by);
    s->start = start;
    s->item = item;
}

static double length(struct wide a)
{
    return sqrt(wide_dot(a, a));
}

/* The number of vertices that contact c moves. */
static int moving(const struct coulomb *s, const struct contact *c)
{
    int n = 0;
    for (int j = 0; j < 4; j++)
        n += s->w[c->v[j]] > 0 && c->c[j] != 0;
    return n;
}

/* §1, §2: what contact c lacks of its velocities, by binary64. */
struct lack {
    double along;       /* a - s */
    struct wide across; /* t */
    double size;        /* of the terms of both */
};

static struct lack lack_of(const struct coulomb *s, const struct contact *c)
{
    struct wide v = {0, 0, 0}, n = wide_of(c->n);
    double span = (double)(s->dt / s->tau), size = fabs((double)c->target);
    for (int j = 0; j < 4; j++) {
        struct wide u = wide_of(s->u[c->v[j]]);
        v = wide_axpy(v, (double)c->c[j], u);
        size += fabs((double)c->c[j]) * length(u);
    }
    double along = wide_dot(n, v);
    return (struct lack){span * ((double)c->target - along),
                         wide_scale(span, wide_axpy(v, -along, n)),
                         span * size};
}

/* §1: 1 + κ c, c the compliance. */
static double yield_of(const struct coulomb *s, const struct contact *c)
{
    double gap = fmin(fmax((double)c->gap, 0), (double)s->reach);
    return 1 + (double)c->kappa * (double)s->give * gap;
}

/* §1: p = max(0, (λ + κ (a - s)) / (1 + κ c)). */
static const char *check_push(const struct coulomb *s, const struct contact *c)
{
    struct lack l = lack_of(s, c);
    double kappa = (double)c->kappa, give = yield_of(s, c);
    double push = ((double)c->lambda + kappa * l.along) / give;
    double size = ((double)c->lambda + kappa * l.size) / give;
    double error = 32 * unit * size + least;
    EXPECT(c->impulse >= 0);
    EXPECT(fabs((double)c->impulse - fmax(push, 0)) <= error);
    /* §1: nothing presses apart what parts by itself */
    bool parts = l.along < -16 * unit * l.size;
    EXPECT(c->lambda > 0 || !parts || c->impulse == 0);
    return NULL;
}

/* §2.4: a call that closes takes N of itself. */
static const char *check_closed(const struct coulomb *s,
                                const struct contact *c)
{
    EXPECT(!s->closes || c->load == c->impulse);
    return NULL;
}

/* §2: the friction is λt - κ t, cut to the length μ N. Cutting brings two
 * vectors no farther apart. */
static const char *check_drag(const struct coulomb *s, const struct contact *c)
{
    struct lack l = lack_of(s, c);
    double kappa = (double)c->kappa, most = (double)(c->friction * c->load);
    struct wide drag = wide_of(c->lambda_t);
    double size = length(drag) + kappa * l.size;
    drag = wide_axpy(drag, -kappa, l.across);
    drag = wide_axpy(drag, -wide_dot(wide_of(c->n), drag), wide_of(c->n));
    double whole = length(drag);
    if (whole > most)
        drag = wide_scale(most / whole, drag);
    struct wide off = wide_sub(wide_of(c->tangent), drag);
    EXPECT(length(off) <= 32 * unit * (size + most) + short_);
    EXPECT((double)vec_length(c->tangent) <= most * (1 + 8 * unit) + short_);
    return NULL;
}

/* §3.1: the matrix of a contact is that of a spring of κ along n where it
 * presses, and across n where it sticks; where it slides, of κ μ N / |z| across
 * n and across its way. */
static const char *check_matrix(const struct coulomb *s,
                                const struct contact *c)
{
    double kappa = (double)c->kappa, most = (double)(c->friction * c->load);
    double along = c->impulse > 0 ? kappa / yield_of(s, c) : 0;
    /* the product has 2 roundings, sum and quotient one each, here as there */
    EXPECT(fabs((double)c->stiffness_n - along) <= 8 * unit * along + least);
    EXPECT(c->stiffness_t >= 0 && c->stiffness_t <= c->kappa);
    EXPECT(most > 0 || c->stiffness_t == 0);
    double way = (double)vec_length(c->way);
    if (way == 0) { /* it sticks, or has no friction */
        EXPECT(c->stiffness_t == (most > 0 ? c->kappa : 0));
    } else {
        /* |z|; where stiffness_t is 0 nothing uses way */
        double z = kappa * most / (double)c->stiffness_t;
        double size = (double)vec_length(c->tangent);
        EXPECT(fabs(way - 1) <= 8 * unit || !(z > short_));
        EXPECT(fabs(size - most) <= 8 * unit * most + short_);
        double off =
            length(wide_axpy(wide_of(c->tangent), -size, wide_of(c->way)));
        EXPECT(off <= 16 * unit * most + short_);
        /* way is across n, up to the rounding of z before it was freed of its
         * part along n, which was rounding itself: 3 of n·z and 2 of its
         * removal, of way 2, and |n|² is 1 within 8 units */
        double parts =
            length(wide_of(c->lambda_t)) + kappa * lack_of(s, c).size;
        double leans = fabs(wide_dot(wide_of(c->n), wide_of(c->way)));
        EXPECT(!(z * leans > 16 * unit * (z + 16 * unit * parts) + short_));
    }
    bool acts = c->stiffness_n > 0 || c->stiffness_t > 0;
    EXPECT(c->coupling == (!acts               ? CONTACT_APART
                           : moving(s, c) == 1 ? CONTACT_SINGLE
                                               : CONTACT_MUTUAL));
    return NULL;
}

/* seam.md §2: the pull of a point is λ + κ (a - t), cut to its strength, and
 * its matrix is κ; where it gives way, κ F/|z| across its pull. */
static const char *check_seam(const struct coulomb *s, const struct contact *c)
{
    struct wide a = wide_of(c->n);
    double span = (double)(s->dt / s->tau), kappa = (double)c->kappa;
    double size = length(a);
    for (int j = 0; j < 4; j++) {
        struct wide u = wide_of(s->u[c->v[j]]);
        a = wide_axpy(a, -(double)c->c[j], u);
        size += fabs((double)c->c[j]) * length(u);
    }
    struct wide pull = wide_axpy(wide_of(c->lambda_t), kappa * span, a);
    size = kappa * span * size + length(wide_of(c->lambda_t));
    double way = (double)vec_length(c->way), most = (double)c->load;
    double long_ = length(pull), cut = way > 0 ? most / long_ : 1;
    struct wide off = wide_axpy(wide_of(c->tangent), -cut, pull);
    EXPECT(length(off) <= 64 * unit * cut * size + least);
    EXPECT(c->impulse == 0 && c->stiffness_n == c->stiffness_t);
    if (way > 0) {
        EXPECT(most > 0 && long_ > most - 32 * unit * size);
        off = wide_axpy(wide_of(c->way), -1 / long_, pull);
        EXPECT(length(off) <= 64 * unit * size / long_ + 8 * unit);
        EXPECT(fabs((double)c->stiffness_t - kappa * cut) <=
               64 * unit * kappa * cut * (1 + size / long_) + least);
    } else {
        EXPECT(c->stiffness_t == c->kappa);
        EXPECT(most == 0 || long_ <= most + 32 * unit * size);
    }
    EXPECT(c->coupling == (!(c->kappa > 0)     ? CONTACT_APART
                           : moving(s, c) == 1 ? CONTACT_SINGLE
                                               : CONTACT_MUTUAL));
    return NULL;
}

/* The impulse of contact c on side A. */
static struct wide push_of(const struct contact *c)
{
    return wide_axpy(wide_of(c->tangent), (double)c->impulse, wide_of(c->n));
}

/* §3: the forces are Σ c (p n + pt) where vertices are free, of all contacts
 * but the points of seams. sum, size: [nv], 0. */
static const char *check_forces(const struct coulomb *s, struct wide *sum,
                                double *size)
{
    struct wide total = {0, 0, 0};
    double all = 0, skew = 0;
    bool free_all = true;
    for (int64_t k = 0; k < s->n - s->seams; k++) {
        const struct contact *c = &s->contact[k];
        struct wide push = push_of(c);
        double one = (double)c->impulse + length(wide_of(c->tangent));
        double weights = 0;
        for (int j = 0; j < 4; j++) {
            int32_t i = c->v[j];
            double part = (double)c->c[j];
            weights += part;
            free_all &= part == 0 || s->w[i] > 0;
            if (!(s->w[i] > 0))
                continue;
            sum[i] = wide_axpy(sum[i], part, push);
            size[i] += fabs(part) * one;
        }
        skew += fabs(weights) * one;
    }
    for (int64_t i = 0; i < s->nv; i++) {
        int32_t d = s->start[i + 1] - s->start[i];
        struct wide f = wide_of(s->force[i]);
        double bound = (d + 8) * unit * size[i] + (d + 8) * least;
        EXPECT(d > 0 || (f.x == 0 && f.y == 0 && f.z == 0));
        EXPECT(length(wide_sub(f, sum[i])) <= 2 * bound);
        total = wide_axpy(total, 1, f);
        all += 2 * bound;
    }
    /* momentum: the forces of free sides cancel, as weights do */
    EXPECT(!free_all || length(total) <= all + 2 * skew);
    return NULL;
}

/* §2.2: what is not in balance, of the particles of cloths that are free. */
static const char *check_residual(const struct coulomb *s)
{
    for (int64_t i = 0; i < s->nc; i++) {
        vec r = s->inner[i], o = s->outer[i];
        vec sum = s->force[i];
        for (int32_t k = s->start[i]; k < s->start[i + 1]; k++)
            if (s->item[k] / 4 >= s->n - s->seams)
                sum =
                    vec_axpy(sum, s->contact[s->item[k] / 4].c[s->item[k] % 4],
                             s->contact[s->item[k] / 4].tangent);
        sum = vec_add(s->rest[i], sum);
        EXPECT(s->w[i] > 0 ? r.x == sum.x && r.y == sum.y && r.z == sum.z
                           : r.x == 0 && r.y == 0 && r.z == 0);
        EXPECT(s->w[i] > 0 || (o.x == 0 && o.y == 0 && o.z == 0));
    }
    return NULL;
}

/* §3.2: x·block·x minus x·(contacts' own matrix)·x for one arbitrary vector x
 * that is 0 where vertices are prescribed. Of all contacts and hold, or of
 * walls and wall. Rounding scales with *size. */
static double slack(const struct coulomb *s, bool walls, double *size)
{
    const sym *block = walls ? s->single : s->bound;
    double own = 0, sums = 0;
    *size = 0;
    for (int64_t k = 0; k < s->n; k++) {
        const struct contact *c = &s->contact[k];
        struct wide sum = {0, 0, 0}, n = wide_of(c->n), z = wide_of(c->way);
        if (c->coupling == CONTACT_APART ||
            (walls && c->coupling != CONTACT_SINGLE))
            continue;
        for (int j = 0; j < 4; j++) {
            int32_t i = c->v[j];
            struct wide x = {1 + i % 3, 1 - i % 5, 2 - i % 7};
            if (s->w[i] > 0)
                sum = wide_axpy(sum, (double)c->c[j], x);
        }
        double along = wide_dot(n, sum), way = wide_dot(z, sum);
        if (k >= s->n - s->seams) {
            own += (double)c->stiffness_t * (wide_dot(sum, sum) - way * way);
            continue;
        }
        own += (double)c->stiffness_n * along * along;
        own += (double)c->stiffness_t *
               (wide_dot(sum, sum) - along * along - way * way);
    }
    for (int64_t i = 0; i < s->nv; i++) {
        vec x =
            vec_make((real)(1 + i % 3), (real)(1 - i % 5), (real)(2 - i % 7));
        struct wide a = wide_of(x), b = wide_of(sym_apply(block[i], x));
        sums += wide_dot(a, b);
        *size += wide_dot(a, a) *
                 (double)(s->bound[i].xx + s->bound[i].yy + s->bound[i].zz);
    }
    return sums - own;
}

/* A copy of s with outputs of its own, in one piece of memory: the caller frees
 * contact. NULL: there is none. */
static struct contact *copy_of(const struct coulomb *s, struct coulomb *copy)
{
    size_t n = (size_t)s->n + 1, nv = (size_t)s->nv + 1;
    size_t bytes = n * (sizeof *s->contact + sizeof *s->next) +
                   nv * (3 * sizeof *s->force + 2 * sizeof *s->bound);
    *copy = *s;
    copy->contact = calloc(1, bytes);
    if (!copy->contact)
        return NULL;
    copy->next = (vec *)(void *)(copy->contact + n);
    copy->force = copy->next + n;
    copy->inner = copy->force + nv;
    copy->outer = copy->inner + nv;
    copy->single = (sym *)(void *)(copy->outer + nv);
    copy->bound = copy->single + nv;
    if (s->n > 0)
        memcpy(copy->contact, s->contact, (size_t)s->n * sizeof *copy->contact);
    copy->renews = copy->lists = 0;
    return copy->contact;
}

/* §2.3: multipliers become what was found; κ grows where λ rises steadily, and
 * else stays. */
static const char *check_renewal(const struct coulomb *s,
                                 const struct contact *was,
                                 const struct contact *is)
{
    real rise = was->impulse - was->lambda;
    bool steady = was->lambda > 0 && was->rise > 0 &&
                  rise > R(0.9) * was->rise && was->kappa < s->stiffest;
    real more = real_min(R(3.0) * was->kappa, s->stiffest);
    EXPECT(is->kappa == (steady ? more : was->kappa));
    EXPECT(is->lambda == was->impulse && is->load == was->impulse);
    EXPECT(is->rise == rise);
    double most = (double)(was->friction * was->impulse);
    double size = (double)vec_length(was->tangent);
    struct wide cut = wide_of(was->tangent);
    if (size > most)
        cut = wide_scale(most / size, cut);
    struct wide off = wide_sub(wide_of(is->lambda_t), cut);
    EXPECT(length(off) <= 8 * unit * fmin(size, most) + short_);
    return NULL;
}

/* §2.3: where no κ grows the residual by renewed multipliers is what a call
 * that renews them finds. grown: [nv] contacts whose κ grows. */
static const char *check_renewed(const struct coulomb *s, int32_t *grown)
{
    struct coulomb again;
    const char *failed = NULL;
    if (!copy_of(s, &again))
        return "no memory";
    again.renews = 1;
    again.closes = 0;
    int status = ref_coulomb(&again);
    for (int64_t k = 0; k < s->n && !failed; k++) {
        const struct contact *was = &s->contact[k], *is = &again.contact[k];
        if (k < s->n - s->seams)
            failed = check_renewal(s, was, is);
        else if (memcmp(&is->lambda_t,
                        k < s->n - s->hinges ? &was->tangent : &was->lambda_t,
                        sizeof was->tangent))
            failed = "coulomb: a renewed multiplier is not the pull";
        else if (was->load > 0 &&
                 length(wide_of(was->tangent)) > (1 + 1e-6) * (double)was->load)
            failed = "coulomb: a point pulls by more than its strength";
        for (int j = 0; j < 4; j++)
            grown[was->v[j]] += was->kappa != is->kappa;
    }
    for (int64_t i = 0; i < s->nc && !failed; i++)
        if (!grown[i] &&
            memcmp(&again.inner[i], &s->outer[i], sizeof *s->outer))
            failed = "coulomb: outer is not the inner of renewed multipliers";
    free(again.contact);
    EXPECT(status == DRAPE_OK);
    return failed;
}

static bool refuses(const struct coulomb *s, real dt, real tau, real give,
                    real reach, real stiffest)
{
    struct coulomb wrong = *s;
    wrong.dt = dt;
    wrong.tau = tau;
    wrong.give = give;
    wrong.reach = reach;
    wrong.stiffest = stiffest;
    return ref_coulomb(&wrong) == DRAPE_EARG;
}

static const char *check_refusals(const struct coulomb *s)
{
    const real bad[] = {0, -1, (real)NAN};
    for (int k = 0; k < 3; k++) {
        real one = s->reach, most = s->stiffest;
        EXPECT(refuses(s, bad[k], s->tau, s->give, one, most));
        EXPECT(refuses(s, s->dt, bad[k], s->give, one, most));
        EXPECT(k == 0 || refuses(s, s->dt, s->tau, bad[k], one, most));
        EXPECT(k == 0 || refuses(s, s->dt, s->tau, s->give, bad[k], most));
        EXPECT(refuses(s, s->dt, s->tau, s->give, one, bad[k]));
    }
    struct coulomb wrong = *s;
    wrong.nc = s->nv + 1;
    EXPECT(ref_coulomb(&wrong) == DRAPE_EARG);
    wrong = *s;
    wrong.seams = s->n + 1;
    EXPECT(ref_coulomb(&wrong) == DRAPE_EARG);
    wrong = *s;
    wrong.hinges = s->seams + 1;
    EXPECT(ref_coulomb(&wrong) == DRAPE_EARG);
    return NULL;
}

/* sum, size, grown: [nv], 0. */
static const char *check_all(const struct coulomb *s, struct wide *sum,
                             double *size, int32_t *grown)
{
    const char *failed = check_refusals(s);
    for (int64_t k = s->n - s->seams; k < s->n && !failed; k++)
        failed = check_seam(s, &s->contact[k]);
    for (int64_t k = 0; k < s->n - s->seams && !failed; k++) {
        failed = check_push(s, &s->contact[k]);
        failed = failed ? failed : check_closed(s, &s->contact[k]);
        failed = failed ? failed : check_drag(s, &s->contact[k]);
        failed = failed ? failed : check_matrix(s, &s->contact[k]);
    }
    failed = failed ? failed : check_forces(s, sum, size);
    failed = failed ? failed : check_residual(s);
    failed = failed ? failed : check_renewed(s, grown);
    if (failed)
        return failed;
    /* §3.2: hold bounds the contacts' matrix, and wall is that of walls. */
    double most, left = slack(s, false, &most);
    double rounding = 32 * ((double)s->n + 8) * unit * most;
    EXPECT(left >= -rounding);
    EXPECT(fabs(slack(s, true, &most)) <= rounding);
    return NULL;
}

const char *prop_coulomb(const struct coulomb *s)
{
    size_t nv = (size_t)s->nv + 1;
    struct wide *sum = calloc(nv, sizeof *sum);
    double *size = calloc(nv, sizeof *size);
    int32_t *grown = calloc(nv, sizeof *grown);
    const char *failed = "no memory";
    if (sum && size && grown)
        failed = check_all(s, sum, size, grown);
    free(sum);
    free(size);
    free(grown);
    return failed;
}

/* §3.1, of one contact: adds its block of corners j and k times x of corner k
 * to sum of corner j, for all j and k; and to size of corner j: |c| times a
 * bound of the push, 4 (a + b) Σ |c| |x|₁. */
static void add_blocks(const struct links *s, const struct contact *c,
                       struct wide *sum, double *size)
{
    struct wide n = wide_of(c->n), z = wide_of(c->way);
    double a = (double)c->stiffness_n, b = (double)c->stiffness_t;
    for (int j = 0; j < 4; j++)
        for (int k = 0; k < 4; k++) {
            struct wide x = wide_of(s->x[c->v[k]]);
            double both = (double)c->c[j] * (double)c->c[k];
            double one = fabs(x.x) + fabs(x.y) + fabs(x.z);
            struct wide *to = &sum[c->v[j]];
            *to = wide_axpy(*to, both * b, x);
            *to = wide_axpy(*to, both * (a - b) * wide_dot(n, x), n);
            *to = wide_axpy(*to, -both * b * wide_dot(z, x), z);
            size[c->v[j]] += 4 * (a + b) * fabs(both) * one;
        }
}

/* §3.1: y gained the contacts' matrix times x, which is symmetric, positive
 * semidefinite and 0 on a motion of all vertices alike. A push has at most 18
 * roundings (pair_sum 4, n·v 3, a - b 2, z·v 3, and 6 more) and with |n|, |z| ≤
 * 1 is below the bound of add_blocks; a vertex of d items adds d + 1 roundings,
 * and the sums here as many as in all binary64. */
static const char *check_links(const struct links *s, struct wide *sum,
                               double *size)
{
    double energy = 0, error = 0, all = 0;
    struct wide total = {0, 0, 0};
    int64_t items = 0;
    for (int64_t k = 0; k < s->n; k++) {
        if (s->contact[k].coupling == CONTACT_MUTUAL)
            add_blocks(s, &s->contact[k], sum, size);
        for (int j = 0; j < 4; j++)
            items += s->contact[k].c[j] != 0;
    }
    for (int64_t i = 0; i < s->nv; i++) {
        int32_t d = s->start[i + 1] - s->start[i];
        struct wide x = wide_of(s->x[i]), y = wide_of(s->y[i]);
        struct wide old = wide_of(before_links(i)), gain = wide_sub(y, old);
        double part = fabs(old.x) + fabs(old.y) + fabs(old.z) + size[i];
        double bound = 2 * (d + 22) * (unit * part + least);
        if (d == 0) { /* a prescribed vertex, or one without contact */
            EXPECT(y.x == old.x && y.y == old.y && y.z == old.z);
            continue;
        }
        EXPECT(fabs(gain.x - sum[i].x) <= bound);
        EXPECT(fabs(gain.y - sum[i].y) <= bound);
        EXPECT(fabs(gain.z - sum[i].z) <= bound);
        energy += wide_dot(x, gain);
        error += (fabs(x.x) + fabs(x.y) + fabs(x.z)) * bound;
        total = wide_axpy(total, 1, gain);
        all += 2 * bound;
    }
    EXPECT(energy >= -error);
    /* momentum, where no corner is prescribed */
    EXPECT(items != s->start[s->nv] || length(total) <= all);
    return NULL;
}

const char *prop_links(const struct links *s)
{
    struct wide *sum = calloc((size_t)s->nv + 1, sizeof *sum);
    double *size = calloc((size_t)s->nv + 1, sizeof *size);
    const char *failed = "no memory";
    if (sum && size)
        failed = check_links(s, sum, size);
    free(sum);
    free(size);
    struct links wrong = *s;
    wrong.nv1 = s->nv;
    EXPECT(failed || ref_links(&wrong) == DRAPE_EARG);
    return failed;
}
