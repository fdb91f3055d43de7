/* SPDX-License-Identifier: Apache-2.0 */
/* Stage impulses: generator and properties. spec/contact/impulses.md */
#include "ref/contact/impulses.h"

#include "tests/base/choices.h"
#include "tests/contact/proximity.h"

const struct field fields_impulses[] = {
    IN(impulses, pair, n, 4),
    IN(impulses, kind, n, 1),
    IN(impulses, toi, n, 1),
    IN(impulses, w, nv, 1),
    IN(impulses, x0, nv, 1),
    IN(impulses, x1, nv, 1),
    IN(impulses, surfaces.of, nv, 1),
    IN(impulses, surfaces.surface, surfaces.n, 1),
    IN(impulses, one_rings.start, one_rings.n_start, 1),
    IN(impulses, one_rings.opposite, one_rings.n_opposite, 1),
    IN(impulses, active, n_active, 1),
    SCRATCH(impulses, key, n_all, 1),
    SCRATCH(impulses, spare, n_all, 1),
    SCRATCH(impulses, first, nv, 1),
    OUT_USED(impulses, contact, cap, 1, found),
    OUT_VALUE(impulses, found),
    FIELD_END};

/* Picks four of few vertices, so that pairs recur with their vertices in
 * another order. */
static void pick_names(struct bytes *b, int64_t nv, int32_t v[4])
{
    for (int j = 0; j < 4; j++)
        v[j] = (int32_t)pick(b, (uint32_t)nv);
}

static struct contact *pick_active(struct bytes *b, const struct impulses *s)
{
    struct contact *c = take(b, s->n_active, sizeof *c);
    for (int64_t k = 0; k < s->n_active; k++) {
        pick_names(b, s->nv, c[k].v);
        c[k].kind = pick(b, 2);
        c[k].gap = -(real)(k + 1); /* a value that no new contact has */
        c[k].lambda = pick_uniform(b, 0, 1);
        c[k].lambda_t = pick_vec(b, 1);
        c[k].load = pick_uniform(b, 0, 1);
        c[k].kappa = pick_uniform(b, 0, 1);
        c[k].rise = pick_uniform(b, -1, 1);
        c[k].impulse = real_max(pick_uniform(b, -1, 1), 0);
    }
    return c;
}

void gen_impulses(struct bytes *b, struct impulses *s)
{
    s->n = for_bench(b) ? 1 << 16 : pick_size(b);
    s->n_active = pick(b, 2) ? s->n / 2 : 0;
    s->n_all = s->n + s->n_active;
    s->nv = for_bench(b) ? s->n : 6 + pick(b, 30);
    s->surfaces.n = 1;
    s->dt = R(1.0) / 60;
    s->margin = R(0.25);
    s->stiffest = pick(b, 2) ? 0 : pick_uniform(b, 0, 50);
    int32_t *pair = take(b, 4 * s->n, sizeof *pair);
    uint8_t *kind = take(b, s->n, 1);
    uint32_t *toi = take(b, s->n, sizeof *toi);
    vec *x0 = take(b, s->nv, sizeof *x0), *x1 = take(b, s->nv, sizeof *x1);
    real *w = take(b, s->nv, sizeof *w);
    struct surface *surface = take(b, 1, sizeof *surface);
    surface[0] = (struct surface){R(0.01), R(0.1)};
    for (int64_t i = 0; i < s->nv; i++) {
        x0[i] = pick(b, 2) ? pick_vec(b, 4) : vec_make(0, 1, (real)pick(b, 4));
        x1[i] = pick(b, 3) ? pick_vec(b, 4) : x0[i];
        w[i] = (real)pick(b, 3);
    }
    for (int64_t k = 0; k < s->n; k++) {
        pick_names(b, s->nv, pair + 4 * k);
        kind[k] = (uint8_t)pick(b, 2);
        toi[k] = pick(b, 2) ? pick(b, 1u << 30) : pick(b, 2) << 30;
    }
    s->pair = pair;
    s->kind = kind;
    s->toi = toi;
    s->w = w;
    s->x0 = x0;
    s->x1 = x1;
    s->surfaces.of = take(b, s->nv, sizeof *s->surfaces.of);
    s->surfaces.surface = surface;
    s->active = pick_active(b, s);
    s->one_rings = pick_one_rings(b, s->nv, s->n, pair);
    s->cap = pick(b, 8) ? s->n_all : s->n_all / 8;
}

/* Whether a and b name the same pair, in any order of the vertices. */
static bool same_pair(const int32_t a[4], const int32_t b[4], int64_t kind)
{
    static const int vf[6][4] = {{0, 1, 2, 3}, {0, 1, 3, 2}, {0, 2, 1, 3},
                                 {0, 2, 3, 1}, {0, 3, 1, 2}, {0, 3, 2, 1}};
    static const int ee[8][4] = {{0, 1, 2, 3}, {1, 0, 2, 3}, {0, 1, 3, 2},
                                 {1, 0, 3, 2}, {2, 3, 0, 1}, {3, 2, 0, 1},
                                 {2, 3, 1, 0}, {3, 2, 1, 0}};
    for (int k = 0; k < (kind == CONTACT_VF ? 6 : 8); k++) {
        const int *p = kind == CONTACT_VF ? vf[k] : ee[k];
        if (a[0] == b[p[0]] && a[1] == b[p[1]] && a[2] == b[p[2]] &&
            a[3] == b[p[3]])
            return true;
    }
    return false;
}

static int64_t find(const struct impulses *s, const int32_t v[4], int64_t kind)
{
    int64_t at = -1;
    for (int64_t k = 0; k < s->found; k++)
        if (s->contact[k].kind == kind && same_pair(s->contact[k].v, v, kind)) {
            if (at >= 0)
                return -1; /* §1: never twice */
            at = k;
        }
    return at;
}

/* §2: the normal opposes the approach of the weighted points. §3: the target
 * leaves the margin of the thickness, whatever an older contact of the same
 * pair asked for. */
static const char *check_new(const struct impulses *s, const struct contact *c)
{
    vec way = vec_make(0, 0, 0);
    real sum = 0, size = 0;
    for (int k = 0; k < 4; k++) {
        vec d = vec_sub(s->x1[c->v[k]], s->x0[c->v[k]]);
        way = vec_axpy(way, c->c[k], d);
        size += vec_length(d) + vec_length(s->x0[c->v[k]]);
        sum += c->c[k];
    }
    EXPECT(vec_sane(c->n) && real_sane(c->gap) && real_sane(c->target));
    EXPECT(sum == 0);
    EXPECT(real_abs(vec_length(c->n) - 1) < R(0x1p-20));
    EXPECT(vec_dot(c->n, way) <= R(0x1p-19) * size);
    real keep = s->margin * surfaces_pair(&s->surfaces, c->v).thickness;
    EXPECT(c->target == (keep - c->gap) / s->dt && c->stiffness_t == 0);
    return NULL;
}

static bool are_different(const int32_t v[4])
{
    for (int j = 0; j < 4; j++)
        for (int k = 0; k < j; k++)
            if (v[j] == v[k])
                return false;
    return true;
}

/* The active contact of the pair of c; NULL if there is none. *others: how
 * often the pair is named in all. */
static const struct contact *find_old(const struct impulses *s,
                                      const struct contact *c, int *others)
{
    const struct contact *old = NULL;
    *others = 0;
    for (int64_t k = 0; k < s->n_active; k++)
        if (s->active[k].kind == c->kind &&
            same_pair(s->active[k].v, c->v, c->kind)) {
            old = &s->active[k];
            ++*others;
        }
    for (int64_t k = 0; k < s->n; k++)
        *others +=
            s->kind[k] == c->kind && same_pair(s->pair + 4 * k, c->v, c->kind);
    return old;
}

/* §1: a contact that takes the place of an active one goes on with its
 * multipliers, on its own side A and across its own normal, and with a larger κ
 * if the old one pushed. */
static const char *check_edited(const struct impulses *s,
                                const struct contact *c)
{
    int others;
    const struct contact *old = find_old(s, c, &others);
    if (!old) {
        EXPECT(c->lambda == 0 && c->load == 0 && c->kappa == 0);
        EXPECT(c->rise == 0 && vec_length(c->lambda_t) == 0);
    }
    if (!old || others != 2 || !are_different(c->v))
        return NULL;
    EXPECT(c->lambda == old->lambda && c->load == old->load);
    EXPECT(c->rise == old->rise);
    real more = real_min(old->kappa / CONTACT_GIVE, s->stiffest);
    bool grows = old->impulse > 0 && more > old->kappa;
    EXPECT(c->kappa == (grows ? more : old->kappa));
    bool a = c->v[0] == old->v[0] || c->v[0] == old->v[1];
    vec t = vec_scale(c->kind == CONTACT_VF || a ? 1 : -1, old->lambda_t);
    vec off = vec_sub(vec_axpy(t, -vec_dot(c->n, t), c->n), c->lambda_t);
    EXPECT(vec_length(off) <= R(0x1p-20) * vec_length(t));
    return NULL;
}

/* The contact of impact k if it were the only one. */
static struct contact alone(const struct impulses *s, int64_t k)
{
    struct contact c;
    struct key key, spare;
    struct impulses one = *s;
    one.n = one.n_all = one.cap = 1;
    one.n_active = 0;
    one.pair += 4 * k;
    one.kind += k;
    one.toi += k;
    one.key = &key;
    one.spare = &spare;
    one.contact = &c;
    ref_impulses(&one);
    return c;
}

/* The push of a contact on vertex i, which is one of its four. */
static vec push_on(const struct contact *c, int32_t i)
{
    bool a = c->v[0] == i || (c->kind == CONTACT_EE && c->v[1] == i);
    return vec_scale(a ? 1 : -1, c->n);
}

/* The impact that vertex i meets first, by comparing all. */
static int64_t first_of(const struct impulses *s, int32_t i)
{
    int64_t first = -1;
    for (int64_t k = 0; k < s->n; k++)
        for (int j = 0; j < 4; j++)
            if (s->pair[4 * k + j] == i &&
                (first < 0 || s->toi[k] < s->toi[first]))
                first = k;
    return first;
}

/* §5: whether impact k is left to a later round: yes, no, or too close to call
 * with rounded normals. */
enum answer { NO, YES, UNSURE };

static enum answer waits(const struct impulses *s, int64_t k)
{
    struct contact c = alone(s, k);
    enum answer r = NO;
    for (int j = 0; j < 4; j++) {
        int32_t i = c.v[j];
        int64_t first = first_of(s, i);
        if (!(s->w[i] > 0) || s->toi[first] >= s->toi[k])
            continue;
        struct contact before = alone(s, first);
        real along = vec_dot(push_on(&c, i), push_on(&before, i));
        if (along < R(-0x1p-20))
            return YES;
        if (along < R(0x1p-20))
            r = UNSURE;
    }
    return r;
}

/* Whether a pair of impact k is named by an active contact, or by an impact
 * that does not surely wait. */
static bool is_named(const struct impulses *s, int64_t k)
{
    const int32_t *v = s->pair + 4 * k;
    for (int64_t j = 0; j < s->n_active; j++)
        if (s->active[j].kind == s->kind[k] &&
            same_pair(s->active[j].v, v, s->kind[k]))
            return true;
    for (int64_t j = 0; j < s->n; j++)
        if (s->kind[j] == s->kind[k] &&
            same_pair(s->pair + 4 * j, v, s->kind[k]) && waits(s, j) != YES)
            return true;
    return false;
}

const char *prop_impulses(const struct impulses *s)
{
    if (s->n > 300)
        return NULL;
    for (int64_t k = 0; k < s->n; k++) {
        int64_t at = find(s, s->pair + 4 * k, s->kind[k]);
        enum answer late = waits(s, k);
        if (late == YES)
            EXPECT(at < 0 || is_named(s, k));
        if (late != NO)
            continue;
        EXPECT(at >= 0);
        EXPECT(s->contact[at].impulse == 0 && s->contact[at].friction > 0);
        const char *failed = check_new(s, &s->contact[at]);
        failed = failed ? failed : check_edited(s, &s->contact[at]);
        if (failed)
            return failed;
    }
    for (int64_t k = 0; k < s->n_active; k++)
        EXPECT(find(s, s->active[k].v, s->active[k].kind) >= 0);
    return NULL;
}

/* §2.3: the normal of a free edge that falls askew on the common side of two
 * prescribed triangles. Their other corners are `sink` lower than it. */
static vec meet(real sink, bool known)
{
    vec x0[6] = {
        {-1, R(0.25), R(-0.125)}, {1, R(0.75), R(0.125)}, {0, 0, -1}, {0, 0, 1},
        {-1, -sink, 0},           {1, -sink, 0}};
    vec x1[6];
    for (int i = 0; i < 6; i++)
        x1[i] = vec_axpy(x0[i], i < 2 ? -1 : 0, vec_make(0, 1, 0));
    const real w[6] = {1, 1, 0, 0, 0, 0};
    const int32_t pair[4] = {0, 1, 2, 3}, start[7] = {0, 0, 0, 2, 4, 5, 6};
    const int32_t opposite[6][2] = {{3, 4}, {5, 3}, {4, 2},
                                    {2, 5}, {2, 3}, {3, 2}};
    const uint8_t kind = CONTACT_EE;
    const uint32_t toi = 1u << 29;
    const uint16_t of[6] = {0};
    const struct surface surface = {R(0.01), R(0.1)};
    struct key key, spare;
    uint64_t first[6];
    struct contact c = {.n = {0, 0, 0}};
    struct impulses s = {
        .nv = 6,
        .n = 1,
        .pair = pair,
        .kind = &kind,
        .toi = &toi,
        .w = w,
        .x0 = x0,
        .x1 = x1,
        .surfaces = {1, of, &surface},
        .one_rings = {known ? 7 : 0, known ? 6 : 0, start, opposite},
        .dt = R(0.5),
        .n_all = 1,
        .key = &key,
        .spare = &spare,
        .first = first,
        .cap = 1,
        .contact = &c};
    return ref_impulses(&s) == DRAPE_OK ? c.n : vec_make(0, 0, 0);
}

/* §2.3: on a plane an edge meets the plane's normal, on a ridge its own. */
const char *test_impulses_led(void)
{
    vec plane = meet(0, true), askew = meet(0, false), ridge = meet(1, true);
    EXPECT(plane.y > 1 - R(0x1p-20));
    EXPECT(askew.y < R(0.99));
    EXPECT(ridge.y == askew.y && ridge.x == askew.x && ridge.z == askew.z);
    ran(3);
    return NULL;
}
