/* SPDX-License-Identifier: Apache-2.0 */
/* Stages carry and retain: generators and properties. spec/contact/carry.md */
#include "ref/contact/carry.h"

#include <stdlib.h>

#include "ref/base/wide.h"
#include "ref/contact/contacts.h"
#include "ref/contact/impulses.h"
#include "tests/base/choices.h"

const struct field fields_carry[] = {IN(carry, w, nv, 1),
                                     IN(carry, surfaces.of, nv, 1),
                                     IN(carry, surfaces.surface, surfaces.n, 1),
                                     IN(carry, kept, n_kept, 1),
                                     INOUT(carry, contact, n, 1),
                                     FIELD_END};

const struct field fields_retain[] = {
    IN(retain, w, nv, 1),      IN(retain, u, nv, 1),    IN(retain, v, nv, 1),
    IN(retain, contact, n, 1), OUT(retain, kept, n, 1), FIELD_END};

/* Stage contacts' generator; both stages take the same contacts. */
void gen_contacts(struct bytes *b, struct contacts *s);

static const double unit = REAL_BITS == 32 ? 0x1p-24 : 0x1p-53;
/* Of a few numbers that underflow. */
static const double least = REAL_BITS == 32 ? 0x1p-140 : 0x1p-1060;
/* Of vectors whose squares underflow. */
static const double short_ = REAL_BITS == 32 ? 0x1p-62 : 0x1p-510;

/* What a contact that was set up before has; carry gives none this value. */
static const real SET_UP = R(-0x1p-20);

static int by_key(const void *a, const void *b)
{
    const struct kept *x = a, *y = b;
    if (x->hi != y->hi)
        return x->hi < y->hi ? -1 : 1;
    return x->lo < y->lo ? -1 : x->lo > y->lo;
}

/* What may have been kept of some of the pairs, and of others, by key. */
static void pick_kept(struct bytes *b, struct carry *s)
{
    struct kept *kept = take(b, s->n, sizeof *kept);
    int64_t n = 0, found = 0;
    for (int64_t k = 0; k < s->n; k++) {
        const struct contact *c = &s->contact[k];
        int32_t v[4];
        memcpy(v, c->v, sizeof v);
        if (pick(b, 4) == 0) /* another pair */
            v[pick(b, 4)] = (int32_t)pick(b, (uint32_t)s->nv);
        if (pick(b, 3) == 0)
            continue;
        struct key key = impulses_key(v, c->kind, 0);
        kept[n].hi = key.hi;
        kept[n].lo = key.lo;
        kept[n].lambda = pick(b, 4) ? pick_uniform(b, 0, R(0.01)) : 0;
        kept[n].lambda_t = pick_vec(b, R(0.01));
        if (pick(b, 16) == 0)
            kept[n].lambda = pick(b, 2) ? R(1e6) : real_up(0);
        n++;
    }
    qsort(kept, (size_t)n, sizeof *kept, by_key);
    for (int64_t k = 0; k < n; k++)
        if (k == 0 || by_key(&kept[k], &kept[k - 1]))
            kept[found++] = kept[k];
    s->kept = kept;
    s->n_kept = found;
}

static void pick_surfaces(struct bytes *b, int64_t nv,
                          struct surfaces *surfaces)
{
    uint16_t *of = take(b, nv, sizeof *of);
    struct surface *surface = take(b, 3, sizeof *surface);
    surface[0] = (struct surface){R(0.01), R(0.1)};
    surface[1] = (struct surface){pick_uniform(b, 0, R(0.01)), R(0.5)};
    bool thick = pick(b, 2);
    for (int64_t i = 0; i < nv; i++)
        of[i] = (uint16_t)(thick ? pick(b, 3) : 2);
    *surfaces = (struct surfaces){3, of, surface};
}

void gen_carry(struct bytes *b, struct carry *s)
{
    struct contacts c = {0};
    gen_contacts(b, &c);
    s->nv = c.nv;
    s->n = c.n;
    s->w = c.w;
    s->contact = c.contact;
    s->dt = R(1.0) / (real)(30 << pick(b, 5));
    s->tau = pick(b, 2) ? s->dt : s->dt * R(2.0) / 3;
    s->stiffest = pick_uniform(b, R(0.01), 10);
    pick_surfaces(b, s->nv, &s->surfaces);
    bool prescribed = pick(b, 16) == 0; /* all vertices are */
    real *w = take(b, s->nv, sizeof *w);
    for (int64_t i = 0; i < s->nv; i++)
        w[i] = prescribed ? 0 : c.w[i];
    s->w = w;
    for (int64_t k = 0; k < s->n; k++) {
        struct contact *at = &s->contact[k];
        bool known = pick(b, 4) == 0;
        at->gap = pick(b, 8) ? pick_uniform(b, R(-0.01), R(0.02)) : 0;
        at->kappa = known ? pick_uniform(b, R(1e-6), 1) : 0;
        at->rise = known ? SET_UP : 0;
        at->lambda = known ? pick_uniform(b, 0, 1) : 0;
        at->load = known ? pick_uniform(b, 0, 1) : 0;
        at->lambda_t = known ? pick_vec(b, 1) : vec_make(0, 0, 0);
    }
    pick_kept(b, s);
}

void gen_retain(struct bytes *b, struct retain *s)
{
    struct contacts c = {0};
    gen_contacts(b, &c);
    s->nv = c.nv;
    s->n = c.n;
    s->w = c.w;
    s->u = c.u;
    s->v = c.v;
    s->contact = c.contact;
    s->most = pick(b, 4) ? pick_uniform(b, 0, 10) : 0;
    for (int64_t k = 0; k < s->n; k++) {
        vec t = pick_vec(b, R(0.01)), n = c.contact[k].n;
        c.contact[k].tangent = vec_axpy(t, -vec_dot(n, t), n);
    }
}

static double length(struct wide a)
{
    return sqrt(wide_dot(a, a));
}

/* Whether the pair has four different vertices. */
static bool are_different(const int32_t v[4])
{
    for (int j = 0; j < 4; j++)
        for (int k = 0; k < j; k++)
            if (v[j] == v[k])
                return false;
    return true;
}

/* What was kept of the pair of contact c, by comparing vertices, and by how its
 * multiplier is turned: 1; -1 where side A as it was kept is side B here. */
static const struct kept *find(const struct carry *s, const struct contact *c,
                               int *sign)
{
    struct key key = impulses_key(c->v, c->kind, 0);
    for (int64_t k = 0; k < s->n_kept; k++) {
        const struct kept *e = &s->kept[k];
        if (e->hi != key.hi || e->lo != key.lo)
            continue;
        uint64_t edge = e->hi & ~(UINT64_C(1) << 63);
        int32_t least = (int32_t)(edge >> 32), most = (int32_t)edge;
        bool named = (c->v[0] == least && c->v[1] == most) ||
                     (c->v[0] == most && c->v[1] == least);
        *sign = c->kind == CONTACT_VF || named ? 1 : -1;
        return e;
    }
    return NULL;
}

/* §1.1: a tenth of an overlap goes in a slice, and nothing comes nearer than
 * the thickness. */
static const char *check_target(const struct carry *s, const struct contact *c)
{
    double overlap =
        (double)(surfaces_pair(&s->surfaces, c->v).thickness - c->gap);
    double way = overlap > 0 ? 0.1 * overlap : overlap;
    way /= (double)s->dt;
    EXPECT(fabs((double)c->target - way) <= 8 * unit * fabs(way));
    return NULL;
}

/* §1: a new contact has what was kept of its pair, whatever names it. */
static const char *check_taken(const struct carry *s, const struct contact *c)
{
    int sign = 1;
    const struct kept *e = find(s, c, &sign);
    struct wide n = wide_of(c->n), t = {0, 0, 0};
    if (e)
        t = wide_scale(sign, wide_of(e->lambda_t));
    double size = length(t);
    t = wide_axpy(t, -wide_dot(n, t), n);
    struct wide off = wide_sub(wide_of(c->lambda_t), t);
    EXPECT(c->lambda == (e ? e->lambda : 0) && c->load == c->lambda);
    EXPECT(length(off) <= 16 * unit * size + short_);
    EXPECT(fabs(wide_dot(n, wide_of(c->lambda_t))) <=
           16 * unit * size + short_);
    return NULL;
}

/* §1.2: κ is 30 times the mass that the contact moves, at least, and as much as
 * its load asks for, but no more than that or the stiffest. */
static const char *check_kappa(const struct carry *s, const struct contact *c)
{
    double yield = 0, lambda = (double)c->lambda;
    double thickness = (double)surfaces_pair(&s->surfaces, c->v).thickness;
    for (int j = 0; j < 4; j++)
        yield += (double)c->c[j] * (double)c->c[j] * (double)s->w[c->v[j]];
    if (yield == 0) {
        EXPECT(c->kappa == 0);
        return NULL;
    }
    double kappa = (double)c->kappa, first = 30 / yield;
    double wanted =
        fmin(lambda * (double)s->tau / (0.03 * thickness), (double)s->stiffest);
    wanted = lambda > 0 ? fmax(first, wanted) : first;
    EXPECT(fabs(kappa - wanted) <= 16 * unit * wanted);
    return NULL;
}

/* §1: a pair named in another order gets the same multipliers, seen from its
 * own side A. */
static const char *check_names(const struct carry *s, const struct contact *c)
{
    struct contact other = *c;
    struct carry one = *s;
    bool edges = c->kind == CONTACT_EE;
    if (!are_different(c->v))
        return NULL;
    for (int j = 0; j < 4; j++) { /* B, then A; or another corner first */
        int from = edges ? (j + 2) % 4 : j == 0 ? 0 : 1 + j % 3;
        other.v[j] = c->v[from];
        other.c[j] = edges ? -c->c[from] : c->c[from];
    }
    other.n = edges ? vec_scale(-1, c->n) : c->n;
    other.kappa = 0;
    one.n = 1;
    one.contact = &other;
    EXPECT(ref_carry(&one) == DRAPE_OK);
    vec t = edges ? vec_scale(-1, other.lambda_t) : other.lambda_t;
    EXPECT(other.lambda == c->lambda && other.target == c->target);
    EXPECT((double)vec_length(vec_sub(t, c->lambda_t)) <= short_);
    EXPECT(fabs((double)(other.kappa - c->kappa)) <=
           8 * unit * (double)c->kappa);
    return NULL;
}

/* §1: contacts that are set up stay as they are. */
static const char *check_again(const struct carry *s)
{
    size_t bytes = (size_t)s->n * sizeof *s->contact;
    struct carry again = *s;
    again.contact = malloc(bytes + 1);
    if (!again.contact)
        return "no memory";
    memcpy(again.contact, s->contact, bytes);
    int status = ref_carry(&again);
    bool same = memcmp(again.contact, s->contact, bytes) == 0;
    free(again.contact);
    EXPECT(status == DRAPE_OK && same);
    return NULL;
}

static bool refuses(const struct carry *s, real dt, real tau, real stiffest)
{
    struct carry wrong = *s;
    wrong.dt = dt;
    wrong.tau = tau;
    wrong.stiffest = stiffest;
    return ref_carry(&wrong) == DRAPE_EARG;
}

const char *prop_carry(const struct carry *s)
{
    const char *failed = check_again(s);
    for (int64_t k = 0; k < s->n && !failed; k++) {
        const struct contact *c = &s->contact[k];
        failed = check_target(s, c);
        if (failed || c->rise == SET_UP)
            continue;
        failed = check_taken(s, c);
        failed = failed ? failed : check_kappa(s, c);
        failed = failed ? failed : check_names(s, c);
    }
    if (failed)
        return failed;
    EXPECT(refuses(s, 0, s->tau, s->stiffest));
    EXPECT(refuses(s, s->dt, (real)NAN, s->stiffest));
    EXPECT(refuses(s, s->dt, s->tau, -1));
    return NULL;
}

/* §2: by how much contact c changed the velocity of a side along n, at most;
 * *size: of the terms. */
static double jump_of(const struct retain *s, const struct contact *c,
                      double *size)
{
    int split = side_start((int)c->kind, SIDE_B);
    double most = 0;
    *size = 0;
    for (int side = 0; side < 2; side++) {
        double sum = 0, all = 0;
        bool moves = false;
        for (int j = side ? split : 0; j < (side ? 4 : split); j++) {
            int32_t i = c->v[j];
            struct wide gain = wide_sub(wide_of(s->u[i]), wide_of(s->v[i]));
            sum += (double)c->c[j] * wide_dot(wide_of(c->n), gain);
            all += fabs((double)c->c[j]) *
                   (length(wide_of(s->u[i])) + length(wide_of(s->v[i])));
            moves |= s->w[i] > 0;
        }
        most = moves ? fmax(most, fabs(sum)) : most;
        *size = moves ? fmax(*size, all) : *size;
    }
    return most;
}

/* §2: a contact that presses and struck nothing keeps its impulses, on side A
 * as the key orders the sides; another keeps none. */
static const char *check_kept(const struct retain *s, int64_t k)
{
    const struct contact *c = &s->contact[k];
    const struct kept *e = &s->kept[k];
    struct key key = impulses_key(c->v, c->kind, 0);
    double size, jump = jump_of(s, c, &size), most = (double)s->most;
    double room = 16 * unit * size + least;
    EXPECT(e->hi == key.hi && e->lo == key.lo && e->lambda >= 0);
    vec t = e->lambda_t;
    if (e->lambda == 0) {
        EXPECT(c->impulse == 0 || jump > most - room);
        EXPECT(t.x == 0 && t.y == 0 && t.z == 0);
        return NULL;
    }
    EXPECT(jump <= most + room);
    EXPECT(e->lambda == c->impulse);
    struct carry back = {.n_kept = 1, .kept = e};
    int sign = 1;
    EXPECT(find(&back, c, &sign) == e);
    vec off = vec_sub(vec_scale((real)sign, t), c->tangent);
    EXPECT(off.x == 0 && off.y == 0 && off.z == 0);
    return NULL;
}

const char *prop_retain(const struct retain *s)
{
    const char *failed = NULL;
    for (int64_t k = 0; k < s->n && !failed; k++)
        failed = check_kept(s, k);
    struct retain wrong = *s;
    wrong.most = (real)NAN;
    EXPECT(failed || ref_retain(&wrong) == DRAPE_EARG);
    wrong.most = -1;
    EXPECT(failed || ref_retain(&wrong) == DRAPE_EARG);
    return failed;
}

/* Gives each contact its own pair, so that no key comes twice. */
static void part_pairs(struct contact *c, int64_t n)
{
    for (int64_t k = 0; k < n; k++)
        for (int j = 0; j < 4; j++)
            c[k].v[j] = (int32_t)(4 * k + (j + k) % 4);
}

static int by_pair(const void *a, const void *b)
{
    const struct contact *x = a, *y = b;
    struct key i = impulses_key(x->v, x->kind, 0);
    struct key j = impulses_key(y->v, y->kind, 0);
    return i.hi < j.hi ? -1 : i.hi > j.hi;
}

/* A pair with its sides, or corners, in another order. */
static void rename_pair(struct contact *c)
{
    struct contact was = *c;
    for (int j = 0; j < 4; j++) {
        int from = c->kind == CONTACT_EE ? 3 - j : j == 0 ? 0 : 4 - j;
        c->v[j] = was.v[from];
        c->c[j] = c->kind == CONTACT_EE ? -was.c[from] : was.c[from];
    }
    if (c->kind == CONTACT_EE)
        c->n = vec_scale(-1, c->n);
}

/* What a slice leaves the next one takes up again: multipliers are the impulses
 * of contacts that struck nothing, whatever names their pairs. */
static const char *round_trip(struct bytes *b)
{
    enum { N = 32, NV = 4 * N };
    static struct contact was[N], is[N];
    static struct kept kept[N];
    static vec u[NV], v[NV];
    real w[NV];
    struct retain r = {NV, N, w, u, v, R(0.5), was, kept};
    struct carry c = {.nv = NV, .n = N, .n_kept = N, .w = w};
    pick_surfaces(b, NV, &c.surfaces);
    c.dt = c.tau = R(0.01);
    c.stiffest = 1;
    c.kept = kept;
    c.contact = is;
    struct contacts any = {0};
    b->size = N;
    gen_contacts(b, &any);
    memcpy(was, any.contact, sizeof was);
    part_pairs(was, N);
    qsort(was, N, sizeof *was, by_pair);
    for (int64_t i = 0; i < NV; i++) {
        w[i] = pick(b, 4) ? 1 : 0;
        v[i] = pick_vec(b, 1);
        u[i] = pick(b, 2) ? v[i] : pick_vec(b, 1);
    }
    for (int64_t k = 0; k < N; k++) {
        vec t = pick_vec(b, 1), n = was[k].n;
        was[k].tangent = vec_axpy(t, -vec_dot(n, t), n);
        is[k] = was[k];
        if (pick(b, 2))
            rename_pair(&is[k]);
        contact_clear(&is[k]);
    }
    EXPECT(ref_retain(&r) == DRAPE_OK && ref_carry(&c) == DRAPE_OK);
    for (int64_t k = 0; k < N; k++) {
        bool goes = was[k].impulse > 0 && !carry_struck(&r, &was[k]);
        vec t = was[k].n.z == is[k].n.z ? is[k].lambda_t
                                        : vec_scale(-1, is[k].lambda_t);
        vec want = goes ? was[k].tangent : vec_make(0, 0, 0);
        EXPECT(is[k].lambda == (goes ? was[k].impulse : 0));
        EXPECT((double)vec_length(vec_sub(t, want)) <= 16 * unit + short_);
        ran(1);
    }
    return NULL;
}

const char *test_carry_on(void)
{
    const char *failed = NULL;
    for (int k = 0; k < 50 && !failed; k++) {
        struct bytes b = {.seed = (uint64_t)k, .size = -1};
        failed = round_trip(&b);
        choices_free(&b);
    }
    return failed;
}
