/* SPDX-License-Identifier: Apache-2.0 */
/* Tests decisions at their limits: two contacts in one cell of time, a patch as
 * narrow as cones allow, and the nearest of several ends. */
#include <stdlib.h>

#include "oracle/oracle.h"
#include "ref/broad/cones.h"
#include "ref/narrow/closest.h"
#include "ref/narrow/exact.h"
#include "ref/narrow/narrow.h"
#include "tests/narrow/query.h"

/* Two contacts in one cell of time, spec/narrow/narrow.md §6.2. */

static real two_to(int e)
{
    real r = 1;
    for (; e != 0; e += e < 0 ? 1 : -1)
        r *= e < 0 ? R(0.5) : R(2.0);
    return r;
}

/* Makes a query in which a vertex passes a corner of a face at time g / 2^k
 * exactly, while a side of the face there turns over within 2^-40 of that time:
 * V has a root on the grid of times and another root in the same cell. */
static struct query make_close(struct bytes *b)
{
    struct query q = {.kind = 0};
    int k = 1 + (int)pick(b, 6), g = 1 + (int)pick(b, (1u << k) - 1);
    real unit = two_to(-k), t = (real)g * unit;
    real tiny = two_to(-32 - (int)pick(b, 30)) * (pick(b, 2) ? 1 : -1);
    real slope = pick(b, 2) ? 1 : -1, turn = pick(b, 2) ? 1 : -1;
    for (int i = 0; i < 2; i++) {
        real at = (real)i - t; /* 0 at a time on the grid */
        q.x[i][1] = vec_make(0, tiny * turn, 0);
        q.x[i][0] = vec_make(-slope * at, tiny * turn, 1);
        q.x[i][2] = vec_make(4, turn * at, 0);
        q.x[i][3] = vec_make(0, tiny * turn, 4);
    }
    return q;
}

const char *test_narrow_close_roots(void)
{
    static _Thread_local uint32_t word[EXACT_WORDS];
    int64_t touching = 0;
    for (uint64_t seed = 0; seed < 400; seed++) {
        struct bytes b = {.seed = seed, .size = -1};
        struct query q = make_close(&b);
        choices_free(&b);
        double x[2][4][3];
        uint32_t exact, other, toi = query_toi(&q);
        query_double(&q, x);
        EXPECT(exact_first(x, q.kind, word, EXACT_WORDS, &exact) >= 0);
        EXPECT(exact == toi);
        const char *failed = query_symmetry(&q, toi);
        if (failed)
            return failed;
        if (!orc_present())
            continue;
        orc_ccd_gmp(q.kind, (const double(*)[3])x[0], (const double(*)[3])x[1],
                    &other);
        EXPECT(other == toi);
        touching += toi != NARROW_MISS;
    }
    EXPECT(touching > 0 || !orc_present());
    ran(400);
    return NULL;
}

/* A patch as narrow as cones allow, spec/broad/cones.md §1, §3. */

static vec pick_cube(struct bytes *b)
{
    real x = pick_uniform(b, -1, 1), y = pick_uniform(b, -1, 1);
    return vec_make(x, y, pick_uniform(b, -1, 1));
}

static vec unit(vec a)
{
    return vec_scale(1 / vec_length(a), a);
}

/* Makes tangents, within `spread` of u and v, of cells much narrower along one
 * diagonal than along the other. There points that are 1/√2 apart at rest come
 * nearest. */
static struct tangents make_narrow(struct bytes *b, vec *u, vec *v, real *most)
{
    real narrow = two_to(-(int)pick(b, 9)), spread = 0;
    if (pick(b, 2))
        spread = narrow * two_to(-2 - (int)pick(b, 12));
    vec p = unit(pick_cube(b)), q = vec_scale(narrow, unit(pick_cube(b)));
    if (pick(b, 2))
        q = vec_axpy(q, -vec_dot(p, q), p);
    *u = vec_scale(R(0.5), vec_add(p, q));
    *v = vec_scale(pick(b, 2) ? R(0.5) : R(-0.5), vec_sub(p, q));
    vec d = vec_make(spread, spread, spread);
    *most = R(0.75) * vec_length(q);
    return (struct tangents){vec_sub(*u, d), vec_add(*u, d), vec_sub(*v, d),
                             vec_add(*v, d)};
}

/* The distances that such tangents must keep: from a vertex to the middle of
 * the diagonal that the vertex is not on, and between two vertices. */
static const char *check_apart(vec u, vec v, real r)
{
    real half = R(0.5);
    EXPECT(half * vec_length(vec_add(u, v)) > r);
    EXPECT(half * vec_length(vec_sub(u, v)) > r);
    EXPECT(vec_length(u) > r && vec_length(v) > r);
    return NULL;
}

static const char *check_narrow(struct bytes *b, int *apart)
{
    vec u, v;
    real most;
    struct tangents t = make_narrow(b, &u, &v, &most);
    real r = pick_uniform(b, 0, most);
    if (!cones_apart(&t, r))
        return NULL;
    const char *failed = check_apart(u, v, r);
    failed = failed ? failed : check_apart(t.ulo, t.vhi, r);
    failed = failed ? failed : check_apart(t.uhi, t.vlo, r);
    *apart += 1;
    return failed;
}

/* With two parallel tangents in its box a patch may fold, so the test must fail
 * whatever the rounding. */
static const char *check_folding(struct bytes *b)
{
    vec u = pick_cube(b), w = pick_cube(b);
    w = vec_axpy(w, -vec_dot(u, w) / vec_dot(u, u), u);
    vec v = vec_scale(two_to(-(int)pick(b, REAL_BITS == 32 ? 40 : 80)), u);
    if (pick(b, 2))
        v = vec_scale(-1, v);
    struct tangents t = {u, u, vec_min(v, w), vec_max(v, w)};
    EXPECT(!cones_apart(&t, 0));
    return NULL;
}

const char *test_cones_margin(void)
{
    struct bytes b = {.seed = 3, .size = -1};
    const char *failed = NULL;
    int apart = 0;
    for (int k = 0; k < 40000 && !failed; k++)
        failed = k % 2 ? check_narrow(&b, &apart) : check_folding(&b);
    choices_free(&b);
    EXPECT(failed || apart > 1000);
    ran(apart);
    return failed;
}

/* The nearest of several ends, spec/contact/proximity.md §1.2. */

/* Returns the squared distance of end k from its nearest point on the other
 * edge. */
static double from_end(const struct wide x[4], int k)
{
    struct wide a = x[k < 2 ? 2 : 0], d = wide_sub(x[k < 2 ? 3 : 1], a);
    struct wide q = wide_sub(x[k], a);
    double dd = wide_dot(d, d), s = dd > 0 ? wide_dot(q, d) / dd : 0;
    s = s < 0 ? 0 : s > 1 ? 1 : s;
    q = wide_axpy(q, -s, d);
    return wide_dot(q, q);
}

/* No end is nearer than the result by more than the error of the interior
 * point, 2^-44. */
const char *test_closest_least(void)
{
    struct bytes b = {.seed = 11, .size = -1};
    for (int k = 0; k < 20000; k++) {
        struct wide x[4];
        struct closest r;
        for (int i = 0; i < 4; i++)
            x[i] = wide_of(pick_cube(&b));
        double packed = (double)two_to(-(int)pick(&b, 40));
        x[3] = wide_axpy(wide_axpy(x[2], 1, wide_sub(x[1], x[0])), packed,
                         wide_sub(x[3], x[1]));
        if (pick(&b, 2)) /* one beyond the other */
            x[2] = wide_axpy(x[2], 2 * (double)pick(&b, 2) - 1,
                             wide_sub(x[1], x[0]));
        closest_ee(x, &r);
        for (int i = 0; i < 4; i++) {
            double d = from_end(x, i);
            EXPECT(sqrt(r.length2) <= sqrt(d) + 0x1p-44);
        }
        ran(1);
    }
    choices_free(&b);
    return NULL;
}
