/* SPDX-License-Identifier: Apache-2.0 */
/* Runs the exact predicates on the hardest inputs that theory gives, whose
 * answers tests/narrow/hardest.py derives. spec/narrow/audit.md §2,
 * spec/narrow/narrow.md §3 */
#include "oracle/oracle.h"
#include "ref/narrow/narrow.h"
#include "ref/narrow/predicates.h"
#include "tests/narrow/query.h"

#define ORIENT2(...)
#define ORIENT3(...)
#define PASS(...)

#undef ORIENT2
#define ORIENT2(sign, ...) {sign, {__VA_ARGS__}},
static const struct {
    int sign;
    double p[6];
} planes[] = {
#include "tests/narrow/hardest.def"
};
#undef ORIENT2
#define ORIENT2(...)

#undef ORIENT3
#define ORIENT3(sign, ...) {sign, {__VA_ARGS__}},
static const struct {
    int sign;
    double p[12];
} spaces[] = {
#include "tests/narrow/hardest.def"
};
#undef ORIENT3
#define ORIENT3(...)

#undef PASS
#define PASS(bits, kind, toi, ...) {bits, kind, toi, {__VA_ARGS__}},
static const struct {
    int bits, kind;
    uint32_t toi;
    double x[24];
} passes[] = {
#include "tests/narrow/hardest.def"
};

enum { COUNT2 = sizeof planes / sizeof *planes };
enum { COUNT3 = sizeof spaces / sizeof *spaces };
enum { PASSES = sizeof passes / sizeof *passes };

/* A sign of points and of their other orders, with the filter and without. */
static bool is_right2(const double *p, int sign)
{
    point a = {p[0], p[1], 0}, b = {p[2], p[3], 0}, c = {p[4], p[5], 0};
    return ref_orient2(a, b, c, 0, 1) == sign &&
           ref_orient2_integer(a, b, c, 0, 1) == sign &&
           ref_orient2(b, c, a, 0, 1) == sign &&
           ref_orient2(b, a, c, 0, 1) == -sign &&
           ref_orient2_integer(c, b, a, 0, 1) == -sign;
}

static bool is_right3(const double *p, int sign)
{
    const double *a = p, *b = p + 3, *c = p + 6, *d = p + 9;
    return ref_orient3(a, b, c, d) == sign &&
           ref_orient3_integer(a, b, c, d) == sign &&
           ref_orient3(b, a, d, c) == sign &&
           ref_orient3(a, c, b, d) == -sign &&
           ref_orient3_integer(d, b, c, a) == -sign &&
           (!orc_present() || orc_orient3(a, b, c, d) == sign);
}

const char *test_hardest_signs(void)
{
    for (int k = 0; k < COUNT2; k++)
        EXPECT(is_right2(planes[k].p, planes[k].sign));
    for (int k = 0; k < COUNT3; k++)
        EXPECT(is_right3(spaces[k].p, spaces[k].sign));
    ran(COUNT2 + COUNT3);
    return NULL;
}

/* Each pass has its time, whatever the order of its vertices and axes. */
const char *test_hardest_passes(void)
{
    for (int k = 0; k < PASSES; k++) {
        struct query q = {.kind = passes[k].kind};
        if (passes[k].bits > (REAL_BITS == 32 ? 24 : 53))
            continue;
        for (int i = 0; i < 24; i++)
            *query_at(&q, i) = (real)passes[k].x[i];
        EXPECT(query_toi(&q) == passes[k].toi);
        EXPECT(query_symmetry(&q, passes[k].toi) == NULL);
        ran(1);
    }
    return NULL;
}
