/* SPDX-License-Identifier: Apache-2.0 */
/* Stages penalty and links: generators and properties. spec/contact/penalty.md
 */
#include "ref/contact/penalty.h"

#include <stdlib.h>

#include "ref/base/wide.h"
#include "ref/contact/contacts.h"
#include "ref/contact/incidence.h"
#include "ref/solve/jacobi.h"
#include "tests/base/choices.h"

const struct field fields_penalty[] = {
    IN(penalty, w, nv, 1),          IN(penalty, u, nv, 1),
    IN(penalty, g, nv, 1),          IN(penalty, dv, n_dv, 1),
    INOUT(penalty, contact, n, 1),  SCRATCH(penalty, start, nv1, 1),
    SCRATCH(penalty, item, n4, 1),  SCRATCH(penalty, vertex, n4, 1),
    SCRATCH(penalty, share, n, 1),  OUT(penalty, gave, n, 1),
    SCRATCH(penalty, rub, n4, 1),   SCRATCH(penalty, more, nv, 1),
    SCRATCH(penalty, guess, nv, 1), SCRATCH(penalty, parts, nv, 1),
    OUT(penalty, force, nv, 1),     OUT(penalty, wall, nv, 1),
    INOUT(penalty, hold, nv, 1),    FIELD_END};

const struct field fields_links[] = {IN(links, contact, n, 1),
                                     IN(links, x, nv, 1),
                                     IN(links, start, nv1, 1),
                                     IN(links, item, n4, 1),
                                     SCRATCH(links, push, n, 1),
                                     INOUT(links, y, nv, 1),
                                     FIELD_END};

/* Stage contacts' generator; all three stages take the same contacts. */
void gen_contacts(struct bytes *b, struct contacts *s);

/* The number of vertices that contact c moves. */
static int moving(const struct penalty *s, const struct contact *c)
{
    int n = 0;
    for (int j = 0; j < 4; j++)
        n += s->w[c->v[j]] > 0 && c->c[j] != 0;
    return n;
}

/* Whether all vertices of contact c that have a weight are free. */
static bool is_free(const struct penalty *s, const struct contact *c)
{
    bool moves = true;
    for (int j = 0; j < 4; j++)
        moves &= c->c[j] == 0 || s->w[c->v[j]] > 0;
    return moves;
}

/* §2.5: along of contacts that go on, in the cases of gen_penalty; what the
 * stage computes is no such number. */
static const real GOES_ON = R(0.75);

/* §2.5: what the call before and perhaps a solve left: some contacts stick,
 * others slide, and others are new or apart. */
static void gen_follow(struct bytes *b, struct penalty *s)
{
    s->follows = !s->first && pick(b, 2);
    s->joins = s->follows && pick(b, 2);
    s->n_dv = s->follows && pick(b, 4) ? s->nv : 0;
    vec *dv = take(b, s->nv, sizeof *dv);
    s->dv = dv;
    for (int64_t i = 0; i < s->n_dv; i++)
        dv[i] = s->w[i] > 0 ? pick_vec(b, R(0.1)) : vec_make(0, 0, 0);
    for (int64_t k = 0; k < s->n && s->follows; k++) {
        struct contact *c = &s->contact[k];
        int moves = moving(s, c);
        bool held = moves && c->held;
        c->held = !held        ? CONTACT_APART
                  : moves == 1 ? CONTACT_WALL
                               : CONTACT_MUTUAL;
        c->along = held ? GOES_ON : 0;
        c->impulse = held ? pick_uniform(b, 0, R(0.01)) : 0;
        c->tangent = held ? pick_vec(b, R(0.001)) : vec_make(0, 0, 0);
        c->slide = held && pick(b, 2) ? pick_uniform(b, 0, R(0.1)) : 0;
    }
}

void gen_penalty(struct bytes *b, struct penalty *s)
{
    struct contacts c = {0};
    gen_contacts(b, &c);
    s->nv = c.nv;
    s->n = c.n;
    s->nv1 = c.nv1;
    s->n4 = c.n4;
    s->w = c.w;
    s->u = c.u;
    s->contact = c.contact;
    s->stiffness = R(100.0) * (real)(1 + pick(b, 8));
    s->give = R(1e-5) * (real)(1 + pick(b, 100));
    s->dt = R(1.0) / (real)(30 << pick(b, 5));
    s->tau = pick(b, 2) ? s->dt : s->dt * R(2.0) / 3;
    s->slip = R(0.001) * (real)(1 + pick(b, 5));
    s->far = pick(b, 2) ? 1 : R(0.001) * (real)(1 + pick(b, 50));
    vec *g = take(b, s->nv, sizeof *g);
    bool begun = pick(b, 2);
    for (int64_t i = 0; i < s->nv && begun; i++)
        g[i] = pick_vec(b, R(0.01));
    s->g = g;
    s->first = pick(b, 2);
    s->hold = take(b, s->nv, sizeof *s->hold);
    for (int64_t i = 0; i < s->nv; i++) {
        real a = pick_uniform(b, R(1e-4), 1), d = pick_uniform(b, 0, a / 2);
        s->hold[i] = (sym){a, d, -d, a, d, a};
    }
    for (int64_t k = 0; k < s->n; k++) {
        s->contact[k].held = !s->first && pick(b, 2);
        s->contact[k].along =
            s->contact[k].held ? pick_uniform(b, R(1e-4), 1) : 0;
    }
    gen_follow(b, s);
}

/* What y of vertex i is before links adds to it. */
static vec before_links(int64_t i)
{
    int32_t k = (int32_t)(i % 97);
    return vec_make(R(0.125) * (real)(k % 7 - 3), (real)(k % 5 - 2) / 3,
                    (real)(k - 48));
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
        c.contact[k].held = (int32_t)pick(b, 3);
        c.contact[k].along = pick(b, 8) ? pick_uniform(b, R(1e-4), 1) : 0;
    }
    s->across = pick(b, 2) ? 1 : R(2.0) / 3;
    bool all = pick(b, 2); /* no vertex is led */
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

static double dot(vec a, vec b)
{
    return (double)a.x * (double)b.x + (double)a.y * (double)b.y +
           (double)a.z * (double)b.z;
}

/* §3: a·block·a minus a·(contacts' own matrix)·a over the free vertices, for
 * one arbitrary vector a. Of all contacts and hold, or of walls and wall.
 * Rounding scales with *size. */
static double slack(const struct penalty *s, bool walls, double *size)
{
    const sym *block = walls ? s->wall : s->hold;
    double own = 0, sums = 0;
    *size = 0;
    for (int64_t k = 0; k < s->n; k++) {
        const struct contact *c = &s->contact[k];
        double sum[3] = {0, 0, 0};
        if (c->held == CONTACT_APART || (walls && c->held != CONTACT_WALL))
            continue;
        for (int j = 0; j < 4; j++) {
            int32_t i = c->v[j];
            double a[3] = {1 + i % 3, 1 - i % 5, 2 - i % 7};
            for (int d = 0; d < 3 && s->w[i] > 0; d++)
                sum[d] += (double)c->c[j] * a[d];
        }
        double n[3] = {(double)c->n.x, (double)c->n.y, (double)c->n.z};
        double along = sum[0] * n[0] + sum[1] * n[1] + sum[2] * n[2];
        double all = sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2];
        own += (double)c->along * along * along;
        own += (double)(c->slide * s->tau / s->dt) * (all - along * along);
    }
    for (int64_t i = 0; i < s->nv; i++) {
        vec a =
            vec_make((real)(1 + i % 3), (real)(1 - i % 5), (real)(2 - i % 7));
        sums += dot(a, sym_apply(block[i], a));
        *size +=
            dot(a, a) * (double)(s->hold[i].xx + s->hold[i].yy + s->hold[i].zz);
    }
    return sums - own;
}

/* §1: a - s at velocities u, m/s. */
static real excess_at(const struct contact *c, const vec *u)
{
    return c->target - vec_dot(c->n, pair_sum(c->v, c->c, u));
}

/* §1: the impulse p of the spring at u, N·s. */
static real approach(const struct penalty *s, const struct contact *c)
{
    return c->along * (s->dt / s->tau) * excess_at(c, s->u);
}

static vec slip_of(const struct contact *c, const vec *u)
{
    vec v = pair_sum(c->v, c->c, u);
    return vec_axpy(v, -vec_dot(c->n, v), c->n);
}

/* §2.1: μ N of held contact k in binary64, and a bound of the rounding in the
 * stage: its sums of four, and a few operations with what they give. */
static double expected_friction(const struct penalty *s, int64_t k,
                                double *bound)
{
    const struct contact *c = &s->contact[k];
    double unit = REAL_BITS == 32 ? 0x1p-24 : 0x1p-53, yield = 0;
    double gave = (double)s->gave[k], push = (double)c->target;
    double most = fabs(push), along = (double)c->along;
    for (int j = 0; j < 4; j++) {
        double part = (double)c->c[j];
        int32_t i = c->v[j];
        push -= part * dot(c->n, s->guess[i]);
        most += fabs(part) * sqrt(dot(s->guess[i], s->guess[i]));
        yield += part * part * (double)s->parts[i] * (double)s->w[i];
    }
    push *= along * (double)(s->dt / s->tau);
    most *= along * (double)(s->dt / s->tau);
    push += gave * (1 - along / (double)(s->stiffness * s->tau * s->tau));
    push = s->first ? push : fmax(push, -gave);
    double share = 1 / (1 + along * yield);
    *bound =
        64 * unit * (double)c->friction * (gave + (most + 2 * gave) * share);
    *bound += REAL_BITS == 32 ? 0x1p-140 : 0x1p-1060; /* underflow */
    return (double)c->friction * fmax(gave + (push - gave) * share, 0);
}

/* §2.2, §2.3: a contact that sticks has the damper of μ N, or a lighter one
 * that it had before; one that slides has the impulse μ N, or less where it
 * slips slower than `slip`. */
static const char *check_friction(const struct penalty *s, int64_t k)
{
    const struct contact *c = &s->contact[k];
    double bound, most = expected_friction(s, k, &bound);
    double slip = (double)vec_length(slip_of(c, s->u)), low = (double)s->slip;
    double rub = (double)vec_length(c->tangent);
    if (c->slide > 0) {
        EXPECT((double)c->slide * low <= most + bound);
        EXPECT(!s->first || (double)c->slide * low >= most - bound);
        /* what slips farther does not stick in a first turn */
        double way = slip * (double)s->dt;
        EXPECT(!s->first || way <= (double)s->far * (1 + 0x1p-20));
    } else
        EXPECT(fabs(rub * fmax(slip, low) - most * slip) <=
               bound * (slip + low));
    return NULL;
}

/* §2.5: what was cut is on the cone of the load that it follows, and nothing is
 * beyond it. */
static const char *check_follow(const struct penalty *s, int64_t k)
{
    const struct contact *c = &s->contact[k];
    double unit = REAL_BITS == 32 ? 0x1p-24 : 0x1p-53;
    double least = REAL_BITS == 32 ? 0x1p-62 : 0x1p-510; /* squares underflow */
    double most = (double)c->friction * (double)s->gave[k];
    EXPECT(s->gave[k] >= 0 && c->slide >= 0);
    EXPECT((double)vec_length(c->tangent) <= most * (1 + 16 * unit) + least);
    return NULL;
}

const char *prop_penalty(const struct penalty *s)
{
    double total[3] = {0, 0, 0}, size = 0;
    double unit = REAL_BITS == 32 ? 0x1p-24 : 0x1p-53;
    bool free_all = true;
    for (int64_t k = 0; k < s->n; k++) {
        const struct contact *c = &s->contact[k];
        real length = vec_length(c->tangent);
        /* §1: a contact that approaches is held; §2: friction opposes slip */
        EXPECT(c->held == CONTACT_APART ||
               c->held == (moving(s, c) == 1 ? CONTACT_WALL : CONTACT_MUTUAL));
        free_all &= is_free(s, c);
        EXPECT(c->held || (c->impulse == 0 && length == 0 && c->slide == 0));
        EXPECT((c->held != 0) == (c->along > 0));
        EXPECT(c->slide >= 0);
        size += (double)(real_abs(c->impulse) + length);
        if (s->follows && (!s->joins || c->along == GOES_ON)) {
            const char *wrong = check_follow(s, k);
            if (wrong)
                return wrong;
            continue;
        }
        /* §1.3: in the first turn what is beyond its target pulls */
        EXPECT(c->impulse >= 0 || !s->first || excess_at(c, s->u) < 0);
        EXPECT(c->held || !(excess_at(c, s->u) > 0));
        EXPECT(vec_dot(c->tangent, slip_of(c, s->u)) <= 0);
        /* §2.1: in the first turn friction is estimated from at most the
         * impulse that stops this contact alone */
        double alone = 0, lack = (double)c->target;
        lack -= (double)vec_dot(c->n, pair_sum(c->v, c->c, s->guess));
        for (int j = 0; j < 4; j++)
            alone += (double)(c->c[j] * c->c[j] * s->w[c->v[j]]);
        double stop = (double)c->friction * fmax(lack, 0);
        double rub = (double)(c->slide > 0 ? c->slide * s->slip : length);
        double most = rub * (double)(s->tau / s->dt) * alone;
        EXPECT(!s->first || most <= stop * (1 + 64 * unit));
        const char *wrong = c->held ? check_friction(s, k) : NULL;
        if (wrong)
            return wrong;
    }
    for (int64_t i = 0; i < s->nv; i++) {
        vec f = s->force[i];
        EXPECT(s->w[i] > 0 || (f.x == 0 && f.y == 0 && f.z == 0));
        total[0] += (double)f.x;
        total[1] += (double)f.y;
        total[2] += (double)f.z;
    }
    /* Weights sum to 0, so the forces of a contact's two sides cancel. Each
     * term is rounded at most n + 8 times. */
    double bound = 8 * ((double)s->n + 8) * unit * size;
    for (int d = 0; d < 3 && free_all; d++)
        EXPECT(fabs(total[d]) <= bound);
    /* §3.3: hold bounds the contacts' matrix. §3.2: wall is that of walls. */
    double most, left = slack(s, false, &most);
    double rounding = 16 * ((double)s->n + 8) * unit * most;
    EXPECT(left >= -rounding);
    EXPECT(fabs(slack(s, true, &most)) <= rounding);
    return NULL;
}

/* §3, of one contact: adds its block of corners j and k times x of corner k to
 * sum of corner j, for all j and k; and to size of corner j: |c| times a bound
 * of the push, 2 (a + b) Σ |c| |x|₁. */
static void add_blocks(const struct links *s, const struct contact *c,
                       struct wide *sum, double *size)
{
    struct wide n = wide_of(c->n);
    double a = (double)c->along;
    double b = (double)c->slide * (double)s->across;
    for (int j = 0; j < 4; j++)
        for (int k = 0; k < 4; k++) {
            struct wide x = wide_of(s->x[c->v[k]]);
            double both = (double)c->c[j] * (double)c->c[k];
            double one = fabs(x.x) + fabs(x.y) + fabs(x.z);
            struct wide *to = &sum[c->v[j]];
            *to = wide_axpy(*to, both * b, x);
            *to = wide_axpy(*to, both * (a - b) * wide_dot(n, x), n);
            size[c->v[j]] += 2 * (a + b) * fabs(both) * one;
        }
}

/* §3: y gained the contacts' matrix times x, which is symmetric, positive
 * semidefinite and 0 on a motion of all vertices alike. A push has at most 12
 * roundings (pair_sum 4, n·v 3, a - b 2, and 3 more) and with |n| ≤ 1 is below
 * the bound of add_blocks; a vertex of d items adds d + 1 roundings, and the
 * sums here as many as in all binary64. */
static const char *check_links(const struct links *s, struct wide *sum,
                               double *size)
{
    double unit = REAL_BITS == 32 ? 0x1p-24 : 0x1p-53;
    double least = REAL_BITS == 32 ? 0x1p-140 : 0x1p-1060; /* underflow */
    double energy = 0, error = 0, total[3] = {0, 0, 0}, all = 0;
    int64_t items = 0;
    for (int64_t k = 0; k < s->n; k++) {
        if (s->contact[k].held == CONTACT_MUTUAL)
            add_blocks(s, &s->contact[k], sum, size);
        for (int j = 0; j < 4; j++)
            items += s->contact[k].c[j] != 0;
    }
    for (int64_t i = 0; i < s->nv; i++) {
        int32_t d = s->start[i + 1] - s->start[i];
        struct wide x = wide_of(s->x[i]), y = wide_of(s->y[i]);
        struct wide old = wide_of(before_links(i)), gain = wide_sub(y, old);
        double part = fabs(old.x) + fabs(old.y) + fabs(old.z) + size[i];
        double bound = 2 * (d + 16) * (unit * part + least);
        if (d == 0) { /* a led vertex, or one without contact */
            EXPECT(y.x == old.x && y.y == old.y && y.z == old.z);
            continue;
        }
        EXPECT(fabs(gain.x - sum[i].x) <= bound);
        EXPECT(fabs(gain.y - sum[i].y) <= bound);
        EXPECT(fabs(gain.z - sum[i].z) <= bound);
        energy += wide_dot(x, gain);
        error += (fabs(x.x) + fabs(x.y) + fabs(x.z)) * bound;
        total[0] += gain.x;
        total[1] += gain.y;
        total[2] += gain.z;
        all += bound;
    }
    EXPECT(energy >= -error);
    /* momentum, where no corner is led */
    for (int k = 0; k < 3 && items == s->start[s->nv]; k++)
        EXPECT(fabs(total[k]) <= all);
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

/* §2: one particle that meets a wall */
struct lone {
    struct penalty p;
    struct contact c;
    vec u[4], g[4], dv[4], force[4], guess[4];
    real w[4], share, gave, rub[4], more[4], parts[4];
    sym hold[4], wall[4];
    int32_t start[5], item[4], vertex[4];
};

/* Zeros all, and gives the stage its streams. */
static void clear_lone(struct lone *s)
{
    memset(s, 0, sizeof *s);
    struct penalty p = {.nv = 4, .n = 1, .nv1 = 5, .n4 = 4};
    p.w = s->w;
    p.u = s->u;
    p.g = s->g;
    p.dv = s->dv;
    p.first = 1;
    p.contact = &s->c;
    p.start = s->start;
    p.item = s->item;
    p.vertex = s->vertex;
    p.share = &s->share;
    p.gave = &s->gave;
    p.rub = s->rub;
    p.more = s->more;
    p.guess = s->guess;
    p.parts = s->parts;
    p.force = s->force;
    p.hold = s->hold;
    p.wall = s->wall;
    p.slip = R(1e-3);
    p.far = 1;
    s->p = p;
}

static void make_lone(struct bytes *b, struct lone *s)
{
    clear_lone(s);
    struct penalty *p = &s->p;
    p->stiffness = pick_uniform(b, 10, 1000);
    p->give = pick_uniform(b, R(1e-6), R(1e-3));
    p->dt = R(1.0) / (real)(30 << pick(b, 5));
    p->tau = pick(b, 2) ? p->dt : p->dt * R(2.0) / 3;
    s->w[0] = pick_uniform(b, 100, 10000);
    s->u[0] = pick_vec(b, 1);
    vec n = vec_make(pick_uniform(b, -1, 1), pick_uniform(b, -1, 1), 1);
    struct contact c = {.v = {0, 1, 2, 3},
                        .c = {1, R(-0.25), R(-0.25), R(-0.5)},
                        .n = vec_scale(1 / vec_length(n), n),
                        .target = pick_uniform(b, -1, 1),
                        .friction = R(0.1) * (real)pick(b, 12)};
    s->c = c;
}

/* One turn of penalty.md §4 for the single particle: A is its mass. */
static int turn(struct lone *s)
{
    int status = ref_penalty(&s->p);
    struct wide_sym a = {{0}};
    a.a[0] = a.a[3] = a.a[5] = 1 / (double)s->w[0];
    sym factor = ref_factor(wide_sym_add(a, s->hold[0]));
    vec r = vec_sub(s->force[0], s->g[0]), dv = factor_solve(factor, r);
    s->g[0] = vec_add(s->g[0], vec_sub(r, sym_apply(s->hold[0], dv)));
    s->u[0] = vec_axpy(s->u[0], s->p.tau / s->p.dt, dv);
    s->dv[0] = dv;
    s->p.first = 0;
    return status;
}

/* §2: a single particle obeys Coulomb's law after one turn. Friction is within
 * the cone, and on the cone where the particle slips faster than the viscous
 * part of the law; a second turn only takes back what the spring was short. The
 * normal force is a difference of velocities times the spring's κ·dt·tau, so
 * its error is a few roundings of the velocities times the ratio of that factor
 * to the mass. */
const char *test_penalty_cone(void)
{
    double unit = REAL_BITS == 32 ? 0x1p-24 : 0x1p-53;
    int slips = 0, sticks = 0, kept = 0;
    for (int k = 0; k < 2000; k++) {
        struct bytes b = {.seed = (uint64_t)k, .size = -1};
        struct lone s;
        make_lone(&b, &s);
        EXPECT(turn(&s) == DRAPE_OK);
        double give = (double)(s.c.along * (s.p.dt / s.p.tau));
        double tau2 = (double)(s.p.tau * s.p.tau);
        vec u = s.u[0];
        double normal = fmax((double)approach(&s.p, &s.c), 0);
        double slip = (double)vec_length(slip_of(&s.c, s.u));
        double rub = (double)vec_length(s.c.tangent),
               most = normal * s.c.friction;
        if (s.c.slide > 0)
            rub = (double)s.c.slide * slip;
        double room = 64 * unit * give * (1 + (double)s.c.friction);
        EXPECT(rub <= most + room);
        if (slip > 2e-3) {
            EXPECT(rub >= most - room);
            slips += most > 0;
        } else
            sticks += most > 0;
        double was = (double)s.c.slide, bound;
        EXPECT(turn(&s) == DRAPE_OK);
        /* §2.3: a contact that goes on sticking gets no heavier damper */
        double due = expected_friction(&s.p, 0, &bound) / (double)s.p.slip;
        if (was > 0 && s.c.slide > 0) {
            EXPECT(fabs((double)s.c.slide - fmin(was, due)) <=
                   bound / (double)s.p.slip);
            kept += due > 1.001 * was;
        }
        /* what the spring was short it pushes in addition */
        double part = (double)(s.c.along / s.p.stiffness) / tau2;
        double w = (double)s.w[0], more = (1 - part) * normal * w;
        more *= (1 + (double)s.c.friction) / (1 + (double)s.c.along * w);
        EXPECT((double)vec_length(vec_sub(s.u[0], u)) <=
               more * tau2 / (double)(s.p.tau * s.p.dt) + w * 8 * room +
                   64 * unit);
        choices_free(&b);
        ran(1);
    }
    EXPECT(slips > 100 && sticks > 100 && kept > 100);
    return NULL;
}

/* §2.5: after a turn of a single particle the impulses are those of its spring
 * and its damper where it is now, but for friction beyond the cone of what the
 * particle got along n, or short of it while it slides. */
const char *test_penalty_follow(void)
{
    double unit = REAL_BITS == 32 ? 0x1p-24 : 0x1p-53;
    int slides = 0, sticks = 0, less = 0;
    for (int k = 0; k < 4000; k++) {
        struct bytes b = {.seed = (uint64_t)k, .size = -1};
        struct lone s;
        make_lone(&b, &s);
        EXPECT(turn(&s) == DRAPE_OK);
        if (pick(&b, 2)) /* the load is another one than the turn took it for */
            s.g[0] =
                vec_axpy(s.g[0], pick_uniform(&b, R(-1e-4), R(1e-4)), s.c.n);
        vec slip = slip_of(&s.c, s.u), was = s.c.tangent;
        double slid = (double)vec_length(was), slide = (double)s.c.slide;
        double got = fmax((double)vec_dot(s.c.n, s.g[0]), 0);
        double give = (double)(s.c.along * (s.p.dt / s.p.tau));
        double friction = (double)s.c.friction, most = friction * got;
        double room = 64 * unit * ((give + got) * (1 + friction) + slide);
        slid = slide > 0 ? slide * (double)vec_length(slip) : slid;
        bool moves = slide == 0 && vec_dot(slip, was) < 0;
        s.p.follows = 1;
        s.p.n_dv = s.p.nv;
        EXPECT(ref_penalty(&s.p) == DRAPE_OK);
        double rub = (double)vec_length(s.c.tangent);
        EXPECT(fabs((double)(s.c.impulse - approach(&s.p, &s.c))) <= room);
        EXPECT(fabs(rub - (moves ? most : fmin(most, slid))) <= room);
        EXPECT(vec_dot(s.c.tangent, slip) <= (real)room);
        vec before = s.c.tangent;
        real impulse = s.c.impulse;
        s.p.n_dv = 0; /* nothing was solved since */
        EXPECT(ref_penalty(&s.p) == DRAPE_OK && s.c.impulse == impulse);
        EXPECT((double)vec_length(vec_sub(s.c.tangent, before)) <= room);
        slides += moves && most > 0;
        sticks += s.c.slide > 0 && rub > 0;
        less += slide > 0 && s.c.slide == 0 && most > 0;
        choices_free(&b);
        ran(1);
    }
    EXPECT(slides > 100 && sticks > 100 && less > 10);
    return NULL;
}

/* §1: vertex 0 still approaches contact 0, which presses it down, and separates
 * from contact 1 on the same side at `speed`. Returns both contacts and their
 * gave after a turn. */
static int part_from(bool first, bool held, real speed, struct contact c[2],
                     real gave[2])
{
    enum { NV = 7, N = 2 };
    real w[NV] = {R(5e5)}, share[N], rub[4 * N], parts[NV], more[NV];
    vec u[NV] = {{0, -speed, 0}}, g[NV] = {{0, R(-2.6e-3), 0}};
    vec guess[NV], force[NV];
    sym wall[NV];
    sym hold[NV] = {{R(0.02), 0, 0, R(0.02), 0, R(0.02)}};
    int32_t start[NV + 1], item[4 * N], vertex[4 * N];
    struct contact down = {.v = {0, 1, 2, 3},
                           .held = !first,
                           .target = 1,
                           .c = {1, R(-0.25), R(-0.25), R(-0.5)},
                           .n = {0, -1, 0},
                           .along = first ? 0 : R(0.02)};
    c[0] = c[1] = down;
    memcpy(c[1].v, (int32_t[]){0, 4, 5, 6}, sizeof c[1].v);
    c[1].held = held;
    c[1].along = held ? R(0.02) : 0;
    c[1].target = 0;
    struct penalty s = {.nv = NV,
                        .n = N,
                        .w = w,
                        .u = u,
                        .g = g,
                        .first = first,
                        .stiffness = 1000,
                        .give = R(1e-5),
                        .dt = R(1.0) / 240,
                        .tau = R(1.0) / 240,
                        .slip = R(1e-3),
                        .contact = c,
                        .nv1 = NV + 1,
                        .n4 = 4 * N,
                        .start = start,
                        .item = item,
                        .vertex = vertex,
                        .share = share,
                        .gave = gave,
                        .rub = rub,
                        .far = 1,
                        .more = more,
                        .guess = guess,
                        .parts = parts,
                        .force = force,
                        .wall = wall,
                        .hold = hold};
    return ref_penalty(&s);
}

/* §1: a contact that gave nothing is not held because its neighbour gave
 * something. One that pulls, takes back no
 * more than it gave, and is let go where it pulls 4 times as much. In the first
 * turn the push may be either contact's, so both are held. */
const char *test_penalty_parts(void)
{
    struct contact c[2];
    real gave[2];
    EXPECT(part_from(false, false, R(0.3), c, gave) == DRAPE_OK);
    EXPECT(c[0].held && gave[0] > 0 && c[0].impulse > 0);
    EXPECT(!c[1].held && gave[1] == 0 && c[1].impulse == 0);
    EXPECT(part_from(false, true, R(0.5), c, gave) == DRAPE_OK);
    EXPECT(c[1].held && gave[1] > 0 && c[1].impulse == -gave[1]);
    EXPECT(part_from(false, true, R(0.55), c, gave) == DRAPE_OK);
    EXPECT(!c[1].held && gave[1] == 0 && c[1].impulse == 0);
    /* it gives what the other one gave, too, which was as much */
    EXPECT(real_abs(gave[0] - R(5.2e-3)) < R(1e-8));
    EXPECT(part_from(true, false, R(0.3), c, gave) == DRAPE_OK);
    EXPECT(c[1].held && c[1].impulse < 0); /* its spring ends at its target */
    ran(4);
    return NULL;
}

/* The tangential force, N·s, on vertices 0 and 1 of two free ones that slide on
 * a led edge and bear `load` of the contact's 1/100 N·s. */
static int rub_from(bool first, real slide, bool pinned, const real load[2],
                    real rub[2])
{
    struct lone s;
    clear_lone(&s);
    s.p.first = first;
    s.p.stiffness = 1000;
    s.p.give = R(1e-5);
    s.p.dt = s.p.tau = R(1.0) / 64;
    s.c = (struct contact){.v = {0, 1, 2, 3},
                           .kind = CONTACT_EE,
                           .held = CONTACT_MUTUAL,
                           .c = {R(0.25), R(0.75), R(-0.5), R(-0.5)},
                           .n = {0, 1, 0},
                           .friction = R(0.5),
                           .along = R(0.5),
                           .slide = slide,
                           .tangent = {slide > 0 ? 0 : R(-1.0), 0, 0}};
    for (int i = 0; i < 2; i++) {
        s.w[i] = i == 0 && pinned ? 0 : 100;
        s.u[i] = vec_make(R(0.5), 0, 0);
        s.g[i] = vec_make(0, load[i] / 100, 0);
        /* the contact's own share of its hold: it alone bears the load */
        real part = 100 * (s.c.c[0] + s.c.c[1]) / 100 * s.c.c[i];
        s.hold[i].yy = part * s.c.along;
    }
    int status = ref_penalty(&s.p);
    for (int i = 0; i < 2; i++)
        rub[i] = s.force[i].x;
    return status;
}

/* §2.4: friction goes to the vertices that bear the load, in proportion; by the
 * weights in a first turn, where the contact sticks, where one of them is
 * pinned, and where none bears anything. */
const char *test_penalty_rub(void)
{
    const real loads[3][2] = {{R(0.5), R(0.5)}, {R(0.875), R(0.125)}, {1, -1}};
    const real none[2] = {0, 0};
    real r[2];
    for (int k = 0; k < 3; k++) {
        double part = k < 2 ? (double)loads[k][0] : 1;
        EXPECT(rub_from(false, 0, false, loads[k], r) == DRAPE_OK);
        double all = (double)r[0] + (double)r[1];
        EXPECT(k == 2 || (all < -0.4 / 100 && all >= -0.5 / 100));
        EXPECT(k == 2 || fabs((double)r[0] - part * all) <= 1e-6 * fabs(all));
        EXPECT(k < 2 || all == 0 || fabs((double)r[1]) <= 1e-6 * fabs(all));
        ran(1);
    }
    const real odd[2] = {R(0.875), R(0.125)};
    EXPECT(rub_from(true, 0, false, odd, r) == DRAPE_OK);
    EXPECT(fabs((double)r[1] - 3 * (double)r[0]) <= 1e-6 * fabs((double)r[1]));
    EXPECT(rub_from(false, R(1e-4), false, odd, r) == DRAPE_OK && r[0] < 0);
    EXPECT(fabs((double)r[1] - 3 * (double)r[0]) <= 1e-6 * fabs((double)r[1]));
    EXPECT(rub_from(false, 0, true, odd, r) == DRAPE_OK && r[0] == 0);
    EXPECT(rub_from(false, 0, false, none, r) == DRAPE_OK);
    EXPECT(fabs((double)r[1] - 3 * (double)r[0]) <= 1e-6 * fabs((double)r[1]));
    ran(4);
    return NULL;
}
