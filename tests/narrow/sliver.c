/* SPDX-License-Identifier: Apache-2.0 */
/* Tests scene starts with degenerate triangles: a start in which such a
 * triangle touches something is refused with a message that names both, any
 * other start is accepted. spec/narrow/audit.md §5 */
#include "ref/narrow/sliver.h"

#include <stdio.h>

#include "tests/base/choices.h"
#include "tests/world/slab.h"

/* Picks two faces on a lattice, the first degenerate. They share vertices by
 * chance. */
static void pick_faces(struct bytes *b, struct face f[2])
{
    double place[6][3];
    for (int k = 0; k < 18; k++)
        place[k / 3][k % 3] = (double)pick(b, 4) - 1;
    for (int k = 0; k < 2; k++)
        for (int i = 0; i < 3; i++)
            do
                f[k].v[i] = (int32_t)pick(b, 6);
            while ((i > 0 && f[k].v[i] == f[k].v[0]) ||
                   (i > 1 && f[k].v[i] == f[k].v[1]));
    const double *p = place[f[0].v[0]], *q = place[f[0].v[1]];
    double where = (double)pick(b, 4) - 1; /* on the line, maybe beyond its
                                              ends */
    for (int i = 0; i < 3; i++)
        place[f[0].v[2]][i] = p[i] + where * (q[i] - p[i]);
    for (int k = 0; k < 6; k++)
        memcpy(f[k / 3].p[k % 3], place[f[k / 3].v[k % 3]], sizeof place[0]);
}

/* Decides contact of four vertices by the narrow phase, which shares no code
 * with the audit. */
static bool touch(const struct face *const f[4], const int k[4], int kind)
{
    double x[4][3], toi;
    for (int i = 0; i < 4; i++)
        for (int j = 0; j < i; j++)
            if (f[i]->v[k[i]] == f[j]->v[k[j]])
                return false;
    for (int i = 0; i < 4; i++)
        memcpy(x[i], f[i]->p[k[i]], sizeof x[i]);
    const double(*at)[3] = (const double(*)[3])x;
    return drape_ccd(kind, at, at, &toi) == 1;
}

static bool all_same(int a, int b, int c)
{
    return a != 0 && a == b && b == c;
}

/* Whether an edge of t passes through the inside of s, which has area. */
static bool pierces(const struct face *t, const struct face *s)
{
    for (int k = 0; k < 3; k++) {
        const double *p = t->p[k], *q = t->p[(k + 1) % 3];
        if (ref_orient3(s->p[0], s->p[1], s->p[2], p) *
                    ref_orient3(s->p[0], s->p[1], s->p[2], q) <
                0 &&
            all_same(ref_orient3(p, q, s->p[0], s->p[1]),
                     ref_orient3(p, q, s->p[1], s->p[2]),
                     ref_orient3(p, q, s->p[2], s->p[0])))
            return true;
    }
    return false;
}

static bool meet(const struct face *t, const struct face *s)
{
    bool hit = pierces(t, s);
    for (int k = 0; k < 3; k++) {
        const struct face *const vf[4] = {t, s, s, s}, *const fv[4] = {s, t, t,
                                                                       t};
        hit = hit || touch(vf, (const int[4]){k, 0, 1, 2}, 0) ||
              touch(fv, (const int[4]){k, 0, 1, 2}, 0);
    }
    for (int k = 0; k < 9; k++) {
        const struct face *const ee[4] = {t, t, s, s};
        int i = k / 3, j = k % 3;
        hit =
            hit || touch(ee, (const int[4]){i, (i + 1) % 3, j, (j + 1) % 3}, 1);
    }
    return hit;
}

/* ref_sliver finds exactly these contacts: a corner on a face, edges that meet,
 * an edge through a face. */
const char *test_sliver_pairs(void)
{
    int64_t found = 0;
    for (uint64_t seed = 1; seed <= 20000; seed++) {
        struct bytes b = {.seed = seed, .size = 0};
        struct face f[2];
        pick_faces(&b, f);
        choices_free(&b);
        bool hit = meet(&f[0], &f[1]);
        EXPECT(ref_collinear(&f[0]));
        EXPECT(ref_sliver(&f[0], &f[1]) == hit);
        EXPECT(ref_sliver(&f[1], &f[0]) == hit);
        found += hit;
        ran(1);
    }
    EXPECT(found > 1000 && found < 19000);
    return NULL;
}

enum { SIDE = 5, PARTICLES = SIDE * SIDE };

/* Lays a sheet in the plane y = 1, far above the plate, or as `how` says. */
static void lay(double x[PARTICLES][3], int how)
{
    for (int k = 0; k < PARTICLES; k++) {
        x[k][0] = how > 0 ? k % SIDE * 0.25 : 0.5;
        x[k][1] = 1;
        x[k][2] = how > 1 ? k / SIDE * 0.25 : 0.5;
    }
    if (how == 2) /* puts the last row onto the row before */
        for (int i = 0; i < SIDE; i++)
            x[SIDE * (SIDE - 1) + i][2] = x[SIDE * (SIDE - 2) + i][2];
}

struct start {
    drape_def def;
    drape_cloth cloth;
    drape_obstacle thing;
    double x[PARTICLES][3], thing_x[6][3];
    int32_t tri[2][3];
};

/* Makes a start. For `how` see lay; the obstacle's degenerate triangle spans a
 * to b in y. */
static void start_make(struct start *s, int how, double a, double b)
{
    const double thing_x[6][3] = {{0.55, a, 0.6}, {0.55, b, 0.6}, {0.55, a, .6},
                                  {5, 0, 5},      {6, 0, 5},      {5, 0, 6}};
    const int32_t tri[2][3] = {{3, 4, 5}, {0, 1, 2}};
    drape_default(&s->def);
    drape_default_cloth(&s->cloth);
    drape_default_obstacle(&s->thing);
    lay(s->x, how);
    memcpy(s->thing_x, thing_x, sizeof thing_x);
    memcpy(s->tri, tri, sizeof tri);
    s->cloth.m = s->cloth.n = SIDE;
    s->cloth.x = (const double(*)[3])s->x;
    s->thing.n_vertices = 6;
    s->thing.n_triangles = 2;
    s->thing.x = (const double(*)[3])s->thing_x;
    s->thing.tri = (const int32_t(*)[3])s->tri;
    s->def.cloths = &s->cloth;
    s->def.n_cloths = s->def.n_obstacles = 1;
    s->def.obstacles = &s->thing;
    s->def.precision = REAL_BITS;
}

/* Creates a world. `want` is the beginning of the message of refusal, or NULL
 * if the start must be accepted. */
static const char *try_start(const struct start *s, const char *want)
{
    drape_world *world;
    drape_error e;
    int status = drape_create(&s->def, &world, &e);
    drape_destroy(world);
    if (want && strcmp(e.text, want))
        printf("%s\n", e.text);
    EXPECT(status == (want ? DRAPE_ESTART : DRAPE_OK));
    EXPECT(!want || !strcmp(e.text, want));
    ran(1);
    return NULL;
}

#define TRY(want)                                                              \
    do {                                                                       \
        const char *what_ = try_start(&s, want);                               \
        if (what_)                                                             \
            return what_;                                                      \
    } while (0)
#define START "the start state is intersecting: "

const char *test_sliver_starts(void)
{
    struct start s;
    start_make(&s, 3, 2, 3); /* a degenerate triangle away from the cloth is
                                accepted */
    TRY(NULL);
    start_make(&s, 3, 0.5, 1.5);
    TRY(START "cloth 0 triangle 21 and obstacle 0 triangle 1, "
              "one of them without area");
    start_make(&s, 3, 1, 3); /* touches only just */
    TRY(START "cloth 0 triangle 21 and obstacle 0 triangle 1, "
              "one of them without area");
    start_make(&s, 3, 1, 1); /* a triangle that is a point */
    TRY(START "cloth 0 triangle 21 and obstacle 0 triangle 1, "
              "one of them without area");
    s.def.allow_intersecting = 1;
    TRY(NULL);
    for (int how = 0; how < 3; how++) {
        start_make(&s, how, 2, 3);
        TRY(how < 2 ? START "cloth 0 triangle 0 and cloth 0 triangle 1, "
                            "one of them without area"
                    : START "cloth 0 triangle 16 and cloth 0 triangle 24, "
                            "one of them without area");
        s.def.self_collision = 0;
        TRY(NULL);
    }
    start_make(&s, 3, 2, 3); /* with area: the message also gives the number
                                of pairs */
    for (int k = 0; k < 3; k++) {
        s.thing_x[3 + k][0] = 0.55 + (k == 1);
        s.thing_x[3 + k][1] = 0.5 + k;
        s.thing_x[3 + k][2] = 0.6;
    }
    TRY(START "cloth 0 triangle 20 and obstacle 0 triangle 0 "
              "(first of 4 pairs)");
    return NULL;
}
