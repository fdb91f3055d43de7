/* SPDX-License-Identifier: Apache-2.0 */
/* Collision response as a whole, on small tangled scenes.
 * spec/contact/response.md */
#include "ref/contact/response.h"

#include "ref/contact/zones.h"
#include "tests/base/choices.h"
#include "tests/contact/tangle.h"

static const vec none = {0, 0, 0};

static vec pick_box(struct bytes *b, real lo, real hi)
{
    real x = pick_uniform(b, lo, hi), y = pick_uniform(b, lo, hi);
    return vec_make(x, y, pick_uniform(b, lo, hi));
}

static double kinetic(const struct tangle *t)
{
    double e = 0;
    for (int64_t i = 0; i < t->nv; i++)
        if (t->w[i] > 0)
            e += 0.5 * (double)vec_dot(t->v[i], t->v[i]) / (double)t->w[i];
    return e;
}

/* §1, §5, §6: in a step that starts with x1 = x0 + dt v this still holds at the
 * end: impulses change u and v alike, zones set v = u, and rollback stops a
 * vertex. Rounding is far below 2^-12 of the speed. */
static const char *check_motion(const struct tangle *t, real most)
{
    for (int64_t i = 0; i < t->nv; i++) {
        vec way = vec_sub(t->x1[i], t->x0[i]);
        vec off = vec_axpy(way, -t->r.dt, t->v[i]);
        EXPECT(vec_length(off) <= R(0x1p-12) * t->r.dt * most);
    }
    return NULL;
}

static real fastest(const struct tangle *t)
{
    real most = 1;
    for (int64_t i = 0; i < t->nv; i++)
        most = real_max(most, vec_length(t->v[i]));
    return most;
}

/* §7.3: after a step that is not TRAPPED nothing touches, whatever the settings
 * are. */
static const char *check_step(struct tangle *t, vec a)
{
    int64_t rounds = t->r.max_rounds + t->r.zone_rounds + t->r.roll_rounds;
    real most = fastest(t);
    EXPECT(tangle_step(t, a) == DRAPE_OK);
    EXPECT(t->r.rounds <= rounds + 2); /* §7.2 */
    int64_t touching = tangle_touching(t);
    EXPECT((touching > 0) == !!(t->r.outcome & DRAPE_TRAPPED));
    for (int64_t i = 0; i < t->nv; i++)
        EXPECT(vec_sane(t->x1[i]) && vec_sane(t->v[i]));
    EXPECT((t->r.zone_vertices > 0) == !!(t->r.outcome & DRAPE_ZONES));
    EXPECT((t->r.rolled_back > 0) == !!(t->r.outcome & DRAPE_ROLLBACK));
    ran(1);
    return check_motion(t, real_max(most, fastest(t)));
}

void tangle_soup(struct tangle *t, struct bytes *b, int side, bool packed)
{
    tangle_make(t, 3 * side * side * side, side * side * side);
    for (int64_t k = 0; k < t->nt; k++) {
        vec at = vec_make((real)(k % side), (real)(k / side % side),
                          (real)(k / side / side));
        vec v = pick_box(b, -30, 30);
        uint32_t collapsed = packed ? pick(b, 4) : 0;
        for (int j = 0; j < 3; j++) {
            int64_t i = 3 * k + j;
            t->tri[k][j] = (int32_t)i;
            t->w[i] = pick_uniform(b, R(0.5), 2);
            t->x0[i] = vec_add(at, pick_box(b, 0, R(0.9)));
            t->v[i] = vec_add(v, pick_box(b, -9, 9));
            if (j && collapsed == 1)
                t->x0[i] = t->x0[i - 1];
            if (j == 2 && collapsed == 2)
                t->x0[i] =
                    vec_scale(R(0.5), vec_add(t->x0[i - 1], t->x0[i - 2]));
            if (j && collapsed)
                t->v[i] = t->v[i - 1];
        }
    }
    tangle_edges(t);
}

static const char *run_soup(struct tangle *t, int steps, bool lossy)
{
    for (int step = 0; step < steps; step++) {
        double before = kinetic(t);
        const char *failed = check_step(t, none);
        if (failed)
            return failed;
        EXPECT(!(t->r.outcome & DRAPE_TRAPPED)); /* no prescribed vertex */
        /* contacts.md §5.3, up to rounding in all iterations of all rounds */
        EXPECT(!lossy || kinetic(t) <= before * (1 + 0x1p-16));
        tangle_next(t);
    }
    return NULL;
}

const char *test_tangle_soup(void)
{
    static const int rounds[][2] = {{16, 8}, {0, 8}, {0, 0}, {2, 2}, {1, 0}};
    const char *failed = NULL;
    for (int k = 0; k < 15 && !failed; k++) {
        struct bytes b = {.seed = (uint64_t)k, .size = -1};
        struct tangle t;
        tangle_soup(&t, &b, 3 + k % 2, k >= 10);
        t.r.max_rounds = rounds[k % 5][0];
        t.r.zone_rounds = rounds[k % 5][1];
        failed = run_soup(&t, 5, false);
        tangle_free(&t);
        choices_free(&b);
    }
    return failed;
}

/* contacts.md §5.3: without repulsion and margin no impulse adds energy. */
const char *test_tangle_energy(void)
{
    const char *failed = NULL;
    for (int k = 0; k < 6 && !failed; k++) {
        struct bytes b = {.seed = 100 + (uint64_t)k, .size = -1};
        struct tangle t;
        tangle_soup(&t, &b, 3, false);
        t.r.stiffness = 0;
        t.r.margin = 0;
        t.surface.friction = R(0.5) * (real)(k % 3);
        failed = run_soup(&t, 6, true);
        tangle_free(&t);
        choices_free(&b);
    }
    return failed;
}

/* Adds a square plate of side 2 r with centre c: four prescribed vertices from
 * index `at` on. */
static void make_plate(struct tangle *t, int64_t at, int64_t tri, vec c, real r)
{
    for (int k = 0; k < 4; k++) {
        real x = k & 1 ? r : -r, z = k & 2 ? r : -r;
        t->x0[at + k] = vec_add(c, vec_make(x, 0, z));
    }
    int32_t a = (int32_t)at;
    int32_t two[2][3] = {{a, a + 1, a + 3}, {a, a + 3, a + 2}};
    memcpy(t->tri[tri], two, sizeof two);
}

/* An m × m sheet of side 1 in the plane y = 0, with a little noise. */
static void make_sheet(struct tangle *t, struct bytes *b, int m)
{
    for (int k = 0; k < m * m; k++) {
        vec x = vec_make((real)(k % m) / (real)(m - 1) - R(0.5), 0,
                         (real)(k / m) / (real)(m - 1) - R(0.5));
        t->x0[k] = vec_add(x, pick_box(b, R(-0.005), R(0.005)));
        t->v[k] = pick_box(b, -1, 1);
        t->w[k] = 10;
    }
    int64_t at = 0;
    for (int k = 0; k < (m - 1) * (m - 1); k++) {
        int32_t a = k % (m - 1) + m * (k / (m - 1));
        int32_t two[2][3] = {{a, a + 1, a + m + 1}, {a, a + m + 1, a + m}};
        memcpy(t->tri[at], two, sizeof two);
        at += 2;
    }
}

void tangle_press(struct tangle *t, struct bytes *b, real lo, real hi)
{
    enum { M = 6 };
    int64_t cloth = 2 * (M - 1) * (M - 1);
    tangle_make(t, M * M + 8, cloth + 4);
    make_sheet(t, b, M);
    make_plate(t, M * M, cloth, vec_make(0, R(-0.1), 0), 1);
    make_plate(t, M * M + 4, cloth + 2, vec_make(0, R(0.1), 0), 1);
    for (int k = 0; k < 4; k++) {
        t->v[M * M + k] = vec_make(0, lo, 0);
        t->v[M * M + 4 + k] = vec_make(0, hi, 0);
    }
    tangle_edges(t);
}

static const char *run_press(struct tangle *t, int steps, bool *trapped)
{
    *trapped = false;
    for (int step = 0; step < steps; step++) {
        int64_t nv = t->nv;
        const char *failed = check_step(t, vec_make(0, -10, 0));
        if (failed)
            return failed;
        for (int64_t i = nv - 8; i < nv;
             i++) /* prescribed vertices are not changed */
            EXPECT(t->x1[i].y == t->x0[i].y + t->r.dt * t->v[i].y);
        *trapped |= (t->r.outcome & DRAPE_TRAPPED) != 0;
        tangle_next(t);
    }
    return NULL;
}

const char *test_tangle_plates(void)
{
    static const struct {
        real lo, hi; /* m/s */
        int steps, rounds[2];
        bool room;
    } row[] = {
        {R(0.9), R(-0.9), 10, {16, 8}, true},  /* plates stop 2 cm apart */
        {R(0.9), R(-0.9), 10, {0, 16}, true},  /* the same by zones alone */
        {R(40.0), R(40.0), 10, {16, 8}, true}, /* both rise 40 cm a step */
        {R(40.0), R(40.0), 10, {0, 16}, true}, /* the same by zones alone */
        {R(-5.0), R(8.0), 10, {4, 4}, true},   /* plates move apart */
        {R(2.0), R(-2.0), 10, {4, 4}, false},  /* plates pass each other */
        {R(20.0), R(-20.0), 5, {2, 2}, false}, /* and do so in one step */
        {R(2.0), R(-2.0), 10, {0, 0}, false},  /* rollback alone */
    };
    const char *failed = NULL;
    for (size_t k = 0; k < sizeof row / sizeof *row && !failed; k++) {
        struct bytes b = {.seed = k, .size = -1};
        struct tangle t;
        bool trapped;
        tangle_press(&t, &b, row[k].lo, row[k].hi);
        t.r.max_rounds = row[k].rounds[0];
        t.r.zone_rounds = row[k].rounds[1];
        failed = run_press(&t, row[k].steps, &trapped);
        if (!failed && trapped == row[k].room)
            failed = row[k].room ? "§6: trapped where there is room"
                                 : "§6: clean where there is no room";
        tangle_free(&t);
        choices_free(&b);
    }
    return failed;
}

/* The pairs of all rounds of zones in the step so far, as a backend that
 * listens has heard them. */
static struct {
    const struct response *r;
    int32_t pair[4 * 4096];
    int64_t n, hits; /* pairs; pairs that touched at their round */
    int rounds, wrong;
} zoned;

static int hear_zones(struct gpu *on, struct zones *z)
{
    size_t bytes = 4 * sizeof *zoned.pair;
    const int32_t *hit = zoned.r->hit.data;
    zoned.hits += zoned.r->hits;
    zoned.rounds++;
    if (z->n > 4096)
        return DRAPE_ENOMEM;
    zoned.wrong +=
        z->n != zoned.n + zoned.r->hits ||
        memcmp(z->pair, zoned.pair, (size_t)zoned.n * bytes) != 0 ||
        memcmp(z->pair + 4 * zoned.n, hit, (size_t)zoned.r->hits * bytes) != 0;
    zoned.n = z->n;
    memcpy(zoned.pair, z->pair, (size_t)z->n * bytes);
    return backend_ref.zones(on, z);
}

/* §5: a round of zones is given the pairs of all rounds of zones before it, and
 * then those that touch now. */
const char *test_tangle_zones(void)
{
    static struct backend ear;
    int again = 0;
    ear = backend_ref;
    ear.zones = hear_zones;
    for (int k = 0; k < 6; k++) {
        struct bytes b = {.seed = (uint64_t)k, .size = -1};
        struct tangle t;
        tangle_press(&t, &b, (real)(8 + 4 * k), -20);
        t.r.run = &ear;
        t.r.max_rounds = k / 2;
        zoned.r = &t.r;
        zoned.n = zoned.hits = zoned.rounds = zoned.wrong = 0;
        EXPECT(tangle_step(&t, none) == DRAPE_OK);
        EXPECT(zoned.wrong == 0 && zoned.n == zoned.hits);
        again += zoned.rounds > 1;
        ran(1);
        tangle_free(&t);
        choices_free(&b);
    }
    EXPECT(again > 3);
    return NULL;
}
