/* SPDX-License-Identifier: Apache-2.0 */
/* Stage coulomb renewed until nothing is left undone: single particles obey
 * Coulomb's law, the matrix is the derivative of the forces, and κ grows where
 * it is too small. spec/contact/coulomb.md */
#include "ref/base/wide.h"
#include "ref/contact/coulomb.h"
#include "ref/solve/jacobi.h"
#include "tests/base/choices.h"

static const double unit = REAL_BITS == 32 ? 0x1p-24 : 0x1p-53;

/* Vertices 0 … 3, of which w says which are free, and a contact of them. */
struct lone {
    struct coulomb law;
    struct contact c;
    vec u[4], force[4], rest[4], inner[4], outer[4], next;
    real w[4];
    sym single[4], bound[4];
    int32_t start[5], item[4], vertex[4];
};

/* Gives the stage its streams. */
static void open_lone(struct lone *s)
{
    s->law = (struct coulomb){.nv = 4, .nc = 4, .n = 1, .nv1 = 5, .n4 = 4};
    s->law.w = s->w;
    s->law.u = s->u;
    s->law.rest = s->rest;
    s->law.contact = &s->c;
    s->law.start = s->start;
    s->law.item = s->item;
    s->law.vertex = s->vertex;
    s->law.next = &s->next;
    s->law.force = s->force;
    s->law.inner = s->inner;
    s->law.outer = s->outer;
    s->law.single = s->single;
    s->law.bound = s->bound;
    s->law.lists = 1;
}

static vec unit_of(vec a)
{
    return vec_scale(1 / vec_length(a), a);
}

/* One particle, which reaches the contact with the speed of its free motion, or
 * leaves it. */
static void pick_lone(struct bytes *b, struct lone *s)
{
    memset(s, 0, sizeof *s);
    open_lone(s);
    s->law.dt = R(1.0) / (real)(30 << pick(b, 5));
    s->law.tau = pick(b, 2) ? s->law.dt : s->law.dt * R(2.0) / 3;
    s->w[0] = pick_uniform(b, 100, 10000);
    s->u[0] = pick_vec(b, pick(b, 2) ? 1 : R(0.01));
    real x = pick_uniform(b, -1, 1), y = pick_uniform(b, -1, 1);
    s->c = (struct contact){.v = {0, 1, 2, 3},
                            .c = {1, R(-0.25), R(-0.25), R(-0.5)},
                            .n = unit_of(vec_make(x, y, 1)),
                            .target = pick_uniform(b, -1, 1),
                            .friction = R(0.1) * (real)pick(b, 12)};
    s->c.kappa = 30 / s->w[0];
    s->law.stiffest = 100 * s->c.kappa;
    s->law.give = pick(b, 2) ? 1 / s->law.stiffest : 0;
    s->law.reach = R(0.002);
    s->c.gap = R(0.001);
}

/* Moves along dv by a part of it. Returns the slope of the potential there. */
static real shift(struct lone *s, vec dv, real part)
{
    s->u[0] = vec_axpy(s->u[0], part * (s->law.tau / s->law.dt), dv);
    s->rest[0] = vec_axpy(s->rest[0], -part / s->w[0], dv);
    ref_coulomb(&s->law);
    return -vec_dot(s->inner[0], dv);
}

/* The inner problem: Newton's method for the particle, whose matrix is its mass
 * and hold, with a line search where a step goes too far (lagrange.md §3.2). */
static void move(struct lone *s)
{
    struct wide_sym a = {{0}};
    a.a[0] = a.a[3] = a.a[5] = 1 / (double)s->w[0];
    sym factor = ref_factor(wide_sym_add(a, s->bound[0]));
    vec dv = factor_solve(factor, s->inner[0]);
    real first = vec_dot(s->inner[0], dv), low = 0, high = 1, at = 1;
    real slope = shift(s, dv, 1);
    for (int k = 0; k < 30 && real_abs(slope) > R(0.1) * first; k++) {
        if (slope < 0 && at == 1)
            return;
        *(slope > 0 ? &high : &low) = at;
        real next = (low + high) / 2;
        slope = shift(s, dv, next - at);
        at = next;
    }
}

/* Solves the particle's motion: renews the multipliers where the inner residual
 * is well below the outer one, as the loop does (lagrange.md §3.3). Returns how
 * often it renewed them; -1: a call failed. */
static int settle(struct lone *s, real tolerance)
{
    int renewed = 0;
    if (ref_coulomb(&s->law) != DRAPE_OK)
        return -1;
    s->law.lists = 0;
    for (int k = 0; k < 200; k++) {
        real outer = vec_length(s->outer[0]);
        if (outer <= tolerance)
            return renewed;
        if (vec_length(s->inner[0]) <= R(0.3) * outer) {
            s->law.renews = 1;
            renewed++;
            if (ref_coulomb(&s->law) != DRAPE_OK)
                return -1;
            s->law.renews = 0;
        }
        move(s);
    }
    return -1;
}

/* §1, §2: what Coulomb's law gives the particle, N·s, by its free motion. */
static struct wide expected(const struct lone *s, bool *slides)
{
    double span = (double)(s->law.dt / s->law.tau), w = (double)s->w[0];
    struct wide n = wide_of(s->c.n), v = wide_scale(span, wide_of(s->u[0]));
    double along = wide_dot(n, v);
    double lack = (double)s->c.target * span - along;
    double push = fmax(lack / (w + (double)(s->law.give * s->c.gap)), 0);
    struct wide drag = wide_scale(-1 / w, wide_axpy(v, -along, n));
    double size = sqrt(wide_dot(drag, drag));
    double most = (double)s->c.friction * push;
    *slides = size > most;
    return wide_axpy(*slides ? wide_scale(most / size, drag) : drag, push, n);
}

/* §1, §2: a particle that meets a plane comes to rest, slides or bounces off,
 * as Coulomb's law says, after few renewals: each leaves 1/31 of what κ, which
 * is 30 times its mass, was short of. */
const char *test_coulomb_particle(void)
{
    const int most = REAL_BITS == 32 ? 6 : 12;
    int slid = 0, stuck = 0, left = 0;
    for (int k = 0; k < 4000; k++) {
        struct bytes b = {.seed = (uint64_t)k, .size = -1};
        struct lone s;
        bool slides;
        pick_lone(&b, &s);
        struct wide want = expected(&s, &slides);
        double speed =
            (double)(s.law.dt / s.law.tau) * (1 + (double)vec_length(s.u[0]));
        double size = speed / (double)s.w[0]; /* N·s, what could be pushed */
        double bound = 1024 * unit * size * (1 + (double)s.c.friction);
        int renewed = settle(&s, (real)(256 * unit * size));
        EXPECT(renewed >= 0 && renewed <= most);

        struct wide off = wide_sub(wide_of(s.force[0]), want);
        EXPECT(sqrt(wide_dot(off, off)) <= bound);
        bool pressed = wide_dot(want, want) > bound * bound;
        slid += slides && pressed && s.c.friction > 0;
        stuck += !slides && pressed;
        left += !pressed;
        choices_free(&b);
        ran(1);
    }
    EXPECT(slid > 100 && stuck > 100 && left > 100);
    return NULL;
}

/* Four free vertices in a contact that presses, and slides or sticks. */
static void pick_four_free(struct bytes *b, struct lone *s)
{
    memset(s, 0, sizeof *s);
    open_lone(s);
    s->law.dt = R(0.01);
    s->law.tau = pick(b, 2) ? R(0.01) : R(0.02) / 3;
    s->law.stiffest = 1;
    s->law.give = pick(b, 2) ? 100 : 0;
    s->law.reach = R(0.001);
    real c = pick_uniform(b, 0, 1), d = pick_uniform(b, 0, 1);
    real x = pick_uniform(b, -1, 1), y = pick_uniform(b, -1, 1);
    s->c = (struct contact){.v = {0, 1, 2, 3},
                            .kind = CONTACT_EE,
                            .c = {c, 1 - c, -d, d - 1},
                            .n = unit_of(vec_make(x, y, 1)),
                            .target = pick_uniform(b, -1, 1),
                            .friction = R(0.1) * (real)(1 + pick(b, 12)),
                            .gap = R(0.001),
                            .lambda = pick_uniform(b, 0, R(0.1)),
                            .load = pick_uniform(b, 0, R(0.1)),
                            .kappa = pick_uniform(b, R(0.01), 1)};
    vec t = pick_vec(b, R(0.1));
    s->c.lambda_t = vec_axpy(t, -vec_dot(s->c.n, t), s->c.n);
    for (int i = 0; i < 4; i++) {
        s->w[i] = pick(b, 8) ? pick_uniform(b, 100, 10000) : 0;
        s->u[i] = s->w[i] > 0 ? pick_vec(b, 1) : vec_make(0, 0, 0);
    }
}

/* What the matrix times d is: of links, or of the wall's block. */
static void multiply(struct lone *s, const vec d[4], vec y[4])
{
    vec push;
    struct links l = {.nv = 4,
                      .n = 1,
                      .contact = &s->c,
                      .x = d,
                      .nv1 = 5,
                      .n4 = 4,
                      .start = s->start,
                      .item = s->item,
                      .push = &push,
                      .y = y};
    for (int i = 0; i < 4; i++)
        y[i] = sym_apply(s->single[i], d[i]);
    ref_links(&l);
}

/* Moves s a small way along d: the forces change by the matrix times it, but
 * for its second order, where the contact goes on pressing, sticking or
 * sliding. *held: whether it did. */
static const char *check_way(struct lone *s, const vec d[4], bool *held)
{
    const double step = REAL_BITS == 32 ? 0x1p-11 : 0x1p-26;
    struct contact was = s->c;
    vec before[4], y[4];
    double size = 0, speed = 0;
    multiply(s, d, y);
    memcpy(before, s->force, sizeof before);
    for (int i = 0; i < 4; i++) {
        s->u[i] =
            vec_axpy(s->u[i], (real)step * (s->law.tau / s->law.dt), d[i]);
        speed += (double)vec_length(s->u[i]);
        size += (double)vec_length(d[i]);
    }
    EXPECT(ref_coulomb(&s->law) == DRAPE_OK);
    bool slides = vec_length(was.way) > 0, slid = vec_length(s->c.way) > 0;
    *held = slides == slid && (was.stiffness_n > 0) == (s->c.stiffness_n > 0);
    /* rounding of the forces; and their second derivative along a slip, which
     * is at most 2 κ μ N / |z| · κ / |z|, with μ N ≤ |z| */
    double kappa = (double)was.kappa;
    double terms = kappa * 2 * (speed + 1) + (double)was.lambda +
                   (double)vec_length(was.lambda_t);
    double z = slides ? kappa * (double)vec_length(was.tangent) /
                            ((double)was.stiffness_t + 1e-30)
                      : 1;
    double bend = slides ? 2 * kappa * kappa * size * size / z : 0;
    double bound =
        32 * unit * terms / step + bend * step + 64 * unit * kappa * size;
    for (int i = 0; i < 4 && *held; i++) {
        struct wide a = wide_of(vec_sub(before[i], s->force[i]));
        a = wide_axpy(wide_scale(1 / step, a), -1, wide_of(y[i]));
        EXPECT(sqrt(wide_dot(a, a)) <= bound);
    }
    return NULL;
}

/* §3.1: the matrix is minus the derivative of the forces. */
const char *test_coulomb_slope(void)
{
    const char *failed = NULL;
    int slid = 0, stuck = 0, apart = 0, lone = 0;
    for (int k = 0; k < 4000 && !failed; k++) {
        struct bytes b = {.seed = (uint64_t)k, .size = -1};
        struct lone s;
        vec d[4];
        bool held;
        pick_four_free(&b, &s);
        for (int i = 0; i < 4; i++)
            d[i] = s.w[i] > 0 ? pick_vec(&b, 1) : vec_make(0, 0, 0);
        EXPECT(ref_coulomb(&s.law) == DRAPE_OK);
        bool slides = vec_length(s.c.way) > 0, presses = s.c.stiffness_n > 0;
        bool single = s.c.coupling == CONTACT_SINGLE;
        failed = check_way(&s, d, &held);
        slid += held && slides;
        stuck += held && !slides;
        apart += held && !presses;
        lone += held && single;
        choices_free(&b);
        ran(1);
    }
    EXPECT(failed || (slid > 100 && stuck > 100 && apart > 100 && lone > 10));
    return failed;
}

/* How often κ grows while a particle that would sink by 1 m/s is pressed by a
 * spring of κ = `part` of its mass, renewed some times; -1: it fell, grew by
 * another factor or beyond the stiffest. */
static int grow(double part, double stiffest, real *kappa)
{
    struct lone s;
    struct bytes b = {.seed = 1, .size = -1};
    int grown = 0;
    pick_lone(&b, &s);
    choices_free(&b);
    s.u[0] = vec_scale(-1, s.c.n);
    s.c.target = s.c.friction = 0;
    s.law.dt = s.law.tau;
    s.law.give = 0;
    s.law.stiffest = (real)stiffest / s.w[0];
    s.c.kappa = (real)part / s.w[0];
    if (ref_coulomb(&s.law) != DRAPE_OK)
        return -1;
    s.law.lists = 0;
    for (int k = 0; k < 30; k++) {
        real before = s.c.kappa;
        s.law.renews = 1;
        ref_coulomb(&s.law);
        s.law.renews = 0;
        if (s.c.kappa < before ||
            s.c.kappa > real_max(before, s.law.stiffest) ||
            s.c.kappa > R(10.0) * before)
            return -1;
        grown += s.c.kappa > before;
        move(&s);
    }
    *kappa = s.c.kappa * s.w[0];
    return grown;
}

/* §2.3: κ grows threefold where λ rises by nearly as much as before, to the
 * stiffest at most, until each rise is at most nine tenths of the one before: a
 * rise is 1/(1 + κ/m) of it, so κ is a ninth of the mass at least. κ of 30
 * masses does not grow: each rise is 1/31 of the one before. */
const char *test_coulomb_grows(void)
{
    real kappa;
    EXPECT(grow(30, 1000, &kappa) == 0);
    EXPECT(grow(0.2, 1000, &kappa) == 0); /* rises fall to 1/1.2 each time */
    EXPECT(grow(0.01, 1000, &kappa) > 0 && kappa > R(1.0) / 9);
    EXPECT(grow(0.01, 0.03, &kappa) == 1 &&
           real_abs(kappa - R(0.03)) < R(1e-6));
    EXPECT(grow(0.01, 0.001, &kappa) == 0 && kappa > R(0.0099));
    ran(5);
    return NULL;
}
