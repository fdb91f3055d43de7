/* SPDX-License-Identifier: Apache-2.0 */
/* Tests the exact orientation predicates and the triangle-triangle test.
 * spec/narrow/audit.md §1, §2 */
#include "ref/narrow/tritri.h"

#include "oracle/oracle.h"
#include "tests/base/choices.h"

static double power(int e)
{
    double r = 1;
    for (; e != 0; e += e < 0 ? 1 : -1)
        r *= e < 0 ? 0.5 : 2.0;
    return r;
}

static void coordinates(struct bytes *b, double *p, int n)
{
    uint32_t kind = pick(b, 3);
    for (int k = 0; k < n; k++)
        p[k] = kind == 0   ? (double)pick_real(b, 1)
               : kind == 1 ? (double)pick_real(b, REAL_BIG)
                           : (double)pick(b, 3) / 8 + (double)pick_real(b, 1);
}

/* Makes d = a + (b - a)·i/4 + (c - a)·j/4, rounded, which is near the plane of
 * a b c, and within the predicates' range. */
static void near_plane(struct bytes *b, double p[4][3])
{
    double i = (double)pick(b, 5) / 4, j = (double)pick(b, 5) / 4;
    for (int k = 0; k < 3; k++) {
        double d = p[0][k] + (p[1][k] - p[0][k]) * i + (p[2][k] - p[0][k]) * j;
        p[3][k] = fmax(-0x1p60, fmin(d, 0x1p60));
    }
}

/* §2: the predicates with and without the filter, and CGAL's, agree. Swapping
 * two points negates the sign; a cyclic shift keeps it. */
const char *test_audit_signs(void)
{
    for (int k = 0; k < 5000; k++) {
        struct bytes b = {.seed = (uint64_t)k, .size = 0};
        double p[4][3];
        coordinates(&b, p[0], 12);
        if (k % 2)
            near_plane(&b, p);
        choices_free(&b);
        int s = ref_orient3(p[0], p[1], p[2], p[3]);
        EXPECT(s == ref_orient3_integer(p[0], p[1], p[2], p[3]));
        EXPECT(s == -ref_orient3_integer(p[1], p[0], p[2], p[3]));
        EXPECT(s == -ref_orient3(p[0], p[2], p[1], p[3]));
        EXPECT(s == ref_orient3(p[1], p[0], p[3], p[2]));
        EXPECT(!orc_present() || s == orc_orient3(p[0], p[1], p[2], p[3]));
        for (int i = 0; i < 3; i++) {
            int u = (i + 1) % 3, v = (i + 2) % 3;
            int t = ref_orient2(p[0], p[1], p[2], u, v);
            EXPECT(t == ref_orient2_integer(p[0], p[1], p[2], u, v));
            EXPECT(t == -ref_orient2(p[0], p[1], p[2], v, u));
            EXPECT(t == ref_orient2_integer(p[1], p[2], p[0], u, v));
        }
        ran(1);
    }
    return NULL;
}

static bool meet(const struct face *t, const struct face *s)
{
    struct plane of_t = ref_plane(t);
    return ref_tritri(t, &of_t, s);
}

/* Picks two triangles on a lattice that share the corners with equal
 * numbers. */
static bool pick_two(struct bytes *b, struct face f[2])
{
    double place[6][3];
    uint32_t side = 2 + pick(b, 4);
    for (int k = 0; k < 18; k++)
        place[k / 3][k % 3] = (double)pick(b, side);
    for (int k = 0; k < 6; k++) {
        int32_t v = (int32_t)(k < 3 ? (uint32_t)k : pick(b, 6));
        f[k / 3].v[k % 3] = v;
        memcpy(f[k / 3].p[k % 3], place[v], sizeof place[v]);
    }
    return !ref_collinear(&f[0]) && !ref_collinear(&f[1]);
}

/* Changes the order of the corners, and moves and scales the points. */
static void change(struct bytes *b, struct face *f, double by, double scale,
                   const double move[3])
{
    int turn = (int)pick(b, 3), flip = (int)pick(b, 2);
    struct face from = *f;
    for (int k = 0; k < 3; k++) {
        int j = (flip ? 2 - k + turn : k + turn) % 3;
        f->v[k] = from.v[j];
        for (int i = 0; i < 3; i++)
            f->p[k][i] = by * (scale * from.p[j][i] + move[i]);
    }
}

/* §1: the result does not depend on the order of triangles or corners, nor on a
 * reflection, a scaling by a power of two or an exact translation. */
const char *test_audit_invariance(void)
{
    for (int k = 0; k < 20000; k++) {
        struct bytes b = {.seed = (uint64_t)k, .size = 0};
        struct face f[2];
        if (pick_two(&b, f)) {
            bool hit = meet(&f[0], &f[1]);
            EXPECT(hit == meet(&f[1], &f[0]));
            double move[3], by = pick(&b, 2) ? -1 : 1, scale;
            scale = power((int)pick(&b, 101) - 61); /* all within 2^60 */
            for (int i = 0; i < 3; i++)
                move[i] = scale * ((double)pick(&b, 1 << 20) - (1 << 19));
            change(&b, &f[0], by, scale, move);
            change(&b, &f[1], by, scale, move);
            EXPECT(hit == meet(&f[0], &f[1]));
            EXPECT(hit == meet(&f[1], &f[0]));
            ran(1);
        }
        choices_free(&b);
    }
    return NULL;
}

/* Cases by hand: the positions of vertices 0 … 5, and the triangle that is
 * tested with triangle 0 1 2. */
static const struct {
    double p[6][3];
    int32_t v[3];
    bool hit;
} known[] = {
    /* corner on the face, on an edge, on a corner; and just beside */
    {{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {1, 1, 0}, {1, 1, 1}, {2, 1, 1}},
     {3, 4, 5},
     true},
    {{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {2, 2, 0}, {1, 1, 1}, {2, 1, 1}},
     {3, 4, 5},
     true},
    {{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {4, 0, 0}, {5, 1, 1}, {5, 2, 1}},
     {3, 4, 5},
     true},
    {{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {2, 2, 0x1p-60}, {1, 1, 1}, {2, 1, 1}},
     {3, 4, 5},
     false},
    {{{0, 0, 0},
      {4, 0, 0},
      {0, 4, 0},
      {2, 2 + 0x1p-51, 0},
      {3, 3, 1},
      {3, 4, -1}},
     {3, 4, 5},
     false},
    /* through; in one plane: inside, crossing, apart, edge on edge */
    {{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {1, 1, -1}, {1, 1, 1}, {9, 9, 1}},
     {3, 4, 5},
     true},
    {{{0, 0, 0}, {9, 0, 0}, {0, 9, 0}, {1, 1, 0}, {2, 1, 0}, {1, 2, 0}},
     {3, 4, 5},
     true},
    {{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {-1, 1, 0}, {9, 1, 0}, {9, 2, 0}},
     {3, 4, 5},
     true},
    {{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {3, 2, 0}, {9, 1, 0}, {9, 2, 0}},
     {3, 4, 5},
     false},
    {{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {4, 0, 0}, {8, 0, 0}, {8, -1, 0}},
     {3, 4, 5},
     true},
    /* one shared: apart, through the face, above it, along its edge */
    {{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {0}, {-1, 0, 1}, {-1, 1, 1}},
     {0, 4, 5},
     false},
    {{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {0}, {1, 1, 1}, {1, 1, -1}},
     {0, 4, 5},
     true},
    {{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {0}, {1, 1, 0}, {2, 1, 0}},
     {0, 4, 5},
     true},
    {{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {0}, {1, 0, 0}, {1, -1, 1}},
     {0, 4, 5},
     true},
    {{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {0}, {-1, 1, 0}, {-1, -1, 0}},
     {0, 4, 5},
     false},
    /* two shared: flat, bent, folded flat; three: the same triangle */
    {{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {0}, {0}, {1, -1, 0}}, {0, 1, 5}, false},
    {{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {0}, {0}, {0, 1, 0x1p-60}},
     {1, 0, 5},
     false},
    {{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {0}, {0}, {9, 1, 0}}, {5, 1, 0}, true},
    {{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {0}, {0}, {0}}, {2, 1, 0}, true},
};

/* §1.2 */
const char *test_audit_known(void)
{
    for (size_t k = 0; k < sizeof known / sizeof *known; k++) {
        struct face f[2];
        for (int j = 0; j < 6; j++) {
            int32_t v = j < 3 ? j : known[k].v[j - 3];
            f[j / 3].v[j % 3] = v;
            memcpy(f[j / 3].p[j % 3], known[k].p[v], sizeof(point));
        }
        EXPECT(meet(&f[0], &f[1]) == known[k].hit);
        EXPECT(meet(&f[1], &f[0]) == known[k].hit);
        ran(1);
    }
    return NULL;
}
