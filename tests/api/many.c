/* SPDX-License-Identifier: Apache-2.0 */
/* Queries with more candidates or more pairs than the library takes at once.
 * spec/drape.h */
#include "tests/base/harness.h"

enum { GROUPS = 20, EACH = 32, N = GROUPS * EACH, RUN = 1 << 20 };

static double x0[3 * N][3], x1[3 * N][3];
static int32_t tri[N][3];

/* The pairs that touched: how many of a kind, and a sum over their vertices
 * that does not depend on the order of pairs. */
struct touched {
    int64_t n[2];
    uint64_t sum;
    int32_t first; /* vertex of all triangles that is number 0 here */
};

static int add_touch(void *user, int kind, const int32_t v[4], double toi)
{
    struct touched *t = user;
    uint64_t vertices = 0;
    (void)toi;
    for (int k = 0; k < 4; k++) {
        int32_t whole = v[k] + t->first;
        vertices += hash_bytes(HASH_START, &whole, sizeof whole);
    }
    t->n[kind]++;
    t->sum += hash_bytes(HASH_START + (uint64_t)kind, &vertices, 8);
    return 0;
}

/* Makes a stack of parallel triangles, whose boxes all overlap. A corner of the
 * middle triangle of each group moves up, through the inside of the next three
 * triangles or, in every other group, outside, so that an edge passes theirs.
 */
static void make_stack(void)
{
    static const double corner[3][3] = {{0, .5, 1}, {.5, 1, 0}, {1, 0, .5}};
    static const double from[2][3] = {{.5, .5, .5}, {.2, .8, .5}};
    for (int k = 0; k < 3 * N; k++) {
        bool passes = k / 3 % EACH == EACH / 2 && k % 3 == 0;
        tri[k / 3][k % 3] = k;
        for (int i = 0; i < 3; i++) {
            x0[k][i] = corner[k % 3][i] + 1e-3 * (k / 3);
            if (passes)
                x0[k][i] = from[k / 3 / EACH % 2][i] + 1e-3 * (k / 3);
            x1[k][i] = x0[k][i] + (passes ? 3.5e-3 : 0);
        }
    }
}

/* Asks for n triangles from `first` on, and adds the pairs that touch. */
static int ask(int first, int n, struct touched *t, int64_t candidates[2])
{
    drape_mesh mesh = {.nv = 3 * n,
                       .nt = n,
                       .x = (const double(*)[3])x0 + 3 * first,
                       .tri = (const int32_t(*)[3])tri};
    t->first = 3 * first;
    return drape_ccd_frames(&mesh, (const double(*)[3])x1 + 3 * first,
                            add_touch, t, candidates);
}

/* What touches among all triangles is what touches within the groups: only
 * triangles of a group come near each other. */
const char *test_frames_many(void)
{
    struct touched all = {0}, parts = {0};
    int64_t candidates[2];
    if (REAL_BITS == 32)
        return skip("the query has one precision");
    make_stack();
    EXPECT(ask(0, N, &all, candidates) == DRAPE_OK);
    EXPECT(candidates[0] + candidates[1] > RUN + RUN / 16);
    for (int g = 0; g < GROUPS; g++) {
        EXPECT(ask(g * EACH, EACH, &parts, NULL) == DRAPE_OK);
        ran(1);
    }
    EXPECT(all.n[0] >= 3 * GROUPS / 2 && all.n[1] >= 3 * GROUPS / 2);
    EXPECT(all.n[0] == parts.n[0] && all.n[1] == parts.n[1]);
    EXPECT(all.sum == parts.sum);
    return NULL;
}

/* 40 triangles across each of 40 others: all 1600 pairs are found in order, and
 * as many of them are given as fit. */
const char *test_audit_many(void)
{
    enum { M = 40, PAIRS = M * M };
    static int32_t pair[PAIRS + 1][2];
    static const int64_t room[] = {0, 1, 1024, 1025, PAIRS - 1, PAIRS + 1};
    drape_mesh mesh = {.nv = 6 * M,
                       .nt = 2 * M,
                       .x = (const double(*)[3])x0,
                       .tri = (const int32_t(*)[3])tri};
    for (int k = 0; k < 6 * M; k++) {
        bool across = k >= 3 * M;
        int axis = across ? 0 : 2;
        tri[k / 3][k % 3] = k;
        x0[k][axis] = 1 + k / 3 % M;
        x0[k][2 - axis] = k % 3 == 1 ? 2 * M + 10 : -10;
        x0[k][1] = k % 3 == 2 ? 100 : -1;
    }
    for (int k = 0; k < 6; k++) {
        int64_t found, flat;
        memset(pair, 0xff, sizeof pair);
        EXPECT(drape_audit(&mesh, room[k], pair, &found, &flat) == DRAPE_OK);
        EXPECT(found == PAIRS && flat == 0);
        for (int p = 0; p <= PAIRS; p++) {
            bool given = p < room[k] && p < PAIRS;
            EXPECT(pair[p][0] == (given ? p / M : -1));
            EXPECT(pair[p][1] == (given ? M + p % M : -1));
        }
        ran(1);
    }
    return NULL;
}
