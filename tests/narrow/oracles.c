/* SPDX-License-Identifier: Apache-2.0 */
/* Tests the oracles against known answers and against each other.
 * oracle/README.md */
#include "oracle/oracle.h"

#include "tests/base/choices.h"

/* A query: positions at t = 0 and 1. */
struct query {
    double x[2][4][3];
};

/* Queries with known answers: a vertex against the face (0,0,0) (4,0,0)
 * (0,4,0), which stands still; an edge along x through the origin against an
 * edge from (1,-1,z) to (1,1,z). */
const char *test_oracle_known(void)
{
    static const struct {
        double from[3], to[3];
        uint32_t toi;
    } vf[] = {{{1, 1, 1}, {1, 1, -1}, 1u << 29}, /* half way */
              {{1, 1, 1}, {1, 1, 0}, 1u << 30},  /* at the very end */
              {{1, 1, 0}, {1, 1, 1}, 0},         /* at the start */
              {{1, 1, 2}, {1, 1, -1}, 715827882},
              {{2, 2, 1}, {2, 2, -1}, 1u << 29}, /* on an edge */
              {{2, 2 + 0x1p-50, 1}, {2, 2, -1}, ORC_NEVER},
              {{0, 0, 1}, {0, 0, -3}, 1u << 28}, /* on a corner */
              {{9, 1, 0}, {1, 1, 0}, 805306368}, /* in the plane: at (3,1) */
              {{9, 1, 0x1p-60}, {1, 1, 0x1p-60}, ORC_NEVER},
              {{1, 1, 1}, {1, 1, 0x1p-1074}, ORC_NEVER}};
    static const struct {
        double from, to;
        uint32_t toi;
    } ee[] = {{1, -1, 1u << 29}, {0, 0, 0}, {1, 2, ORC_NEVER}};
    if (!orc_present())
        return skip(NO_ORACLES);
    for (size_t k = 0; k < sizeof vf / sizeof *vf; k++) {
        double x[2][4][3] = {{{0}, {0}, {4, 0, 0}, {0, 4, 0}},
                             {{0}, {0}, {4, 0, 0}, {0, 4, 0}}};
        memcpy(x[0][0], vf[k].from, sizeof vf[k].from);
        memcpy(x[1][0], vf[k].to, sizeof vf[k].to);
        uint32_t a, b;
        const double(*x0)[3] = (const double(*)[3])x[0];
        const double(*x1)[3] = (const double(*)[3])x[1];
        bool hit = vf[k].toi != ORC_NEVER;
        EXPECT(orc_ccd_gmp(0, x0, x1, &a) == hit && a == vf[k].toi);
        EXPECT(orc_ccd_cgal(0, x0, x1, &b) == hit && b == vf[k].toi);
        ran(1);
    }
    for (size_t k = 0; k < sizeof ee / sizeof *ee; k++) {
        double x[2][4][3];
        for (int i = 0; i < 2; i++) {
            double z = i ? ee[k].to : ee[k].from;
            double p[4][3] = {{0}, {4, 0, 0}, {1, -1, z}, {1, 1, z}};
            memcpy(x[i], p, sizeof p);
        }
        uint32_t a, b;
        const double(*x0)[3] = (const double(*)[3])x[0];
        const double(*x1)[3] = (const double(*)[3])x[1];
        bool hit = ee[k].toi != ORC_NEVER;
        EXPECT(orc_ccd_gmp(1, x0, x1, &a) == hit && a == ee[k].toi);
        EXPECT(orc_ccd_cgal(1, x0, x1, &b) == hit && b == ee[k].toi);
        ran(1);
    }
    return NULL;
}

/* Picks a query: on a small lattice, collinear, in one plane, a translation, or
 * nearly so. */
static struct query pick_query(struct bytes *b)
{
    struct query q;
    uint32_t family = pick(b, 7), side = 2 + pick(b, 4);
    for (int k = 0; k < 24; k++) {
        double x = (double)pick(b, side);
        if (family == 0)
            x += 0x1p-40 * ((double)pick(b, 3) - 1);
        if (family == 1)
            x = (double)pick(b, UINT32_MAX) * 0x1p-32;
        if (family == 2 && pick(b, 5) == 0)
            x = 0x1p-1074 * ((double)pick(b, 3) - 1);
        q.x[k / 12][k / 3 % 4][k % 3] = x;
    }
    for (int k = 0; k < 8; k++) {
        double *p = q.x[k / 4][k % 4];
        if (family == 3)
            p[2] = p[0] + 2 * p[1];
        if (family == 4)
            p[1] = p[2] = 0;
        for (int c = 0; c < 3 && family == 5 && k >= 4; c++)
            p[c] = q.x[0][k % 4][c] + (c == 0);
    }
    if (pick(b, 8) == 0) /* collapsed at the end, or all the time */
        for (uint32_t k = pick(b, 2); k < 2; k++)
            memcpy(q.x[k][1], q.x[k][2], sizeof q.x[k][1]);
    return q;
}

/* Two independent oracles give the same decision and the same time. */
const char *test_oracle_agreement(void)
{
    if (!orc_present())
        return skip(NO_ORACLES);
    /* The oracles take binary64, so either build tests half of the queries. */
    for (int k = REAL_BITS == 32 ? 0 : 100, end = k + 100; k < end; k++) {
        struct bytes b = {.seed = (uint64_t)k, .size = 0};
        struct query q = pick_query(&b);
        choices_free(&b);
        const double(*x0)[3] = (const double(*)[3])q.x[0];
        const double(*x1)[3] = (const double(*)[3])q.x[1];
        uint32_t first, again;
        int hit = orc_ccd_gmp(k % 2, x0, x1, &first);
        EXPECT(hit == orc_ccd_cgal(k % 2, x0, x1, &again));
        EXPECT(first == again && hit == (first != ORC_NEVER));
        ran(1);
    }
    return NULL;
}
