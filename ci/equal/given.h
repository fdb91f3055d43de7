/* SPDX-License-Identifier: Apache-2.0 */
/* What preconditions in ci/equal/twins.def are made of. They are executed
 * symbolically, as the functions are. */
#ifndef EQUAL_GIVEN_H
#define EQUAL_GIVEN_H

#include "ref/base/real.h"

/* What kernels take that only the device has. */
struct opening {
    const sym *factor;
    vec *y;
    real damping;
};

struct device_edges {
    int32_t m, n;
    const real *mass;
    const sym *extra, *excess, *block;
};

struct device_cut {
    int32_t strips, width, rows;
};

struct device_level {
    int32_t m, n, count;
    const real *mass;
    const sym *extra;
    const uint8_t *fixed;
    uint8_t *rule;
    sym *excess;
    const sym *block;
    const void *packed;
    const sym *factor;
    vec *b, *x, *y;
    const int32_t *go;
};

/* A cloth's grid in the cycle of sewn cloths. */
struct device_cloth {
    struct device_level l;
    real damping;
    real *item;
    int32_t awake;
};

/* Sources and ends of its products. */
struct device_plain {
    const vec *x;
};

struct device_raised {
    const vec *y, *coarse;
    int32_t m;
    const uint8_t *rule, *fixed;
};

struct device_end {
    vec *y;
};

struct device_left {
    const vec *b;
    const uint8_t *fixed;
    vec *to;
};

struct device_smoothing {
    const vec *b;
    const sym *factor;
    vec *to;
    real *item;
    real damping;
};

struct device_image {
    const uint8_t *fixed;
    vec *p, *q;
    real *item;
};

/* Its state of conjugate gradients, of which two searches know the first words.
 */
struct device_state {
    uint32_t ticket;
    int32_t phase, go, first, fresh, again, outcome, iterations, fell_back,
        waits;
    real late[7];
    real square, most, left, before, from, rho, alpha, beta, recurrence,
        residual;
};

struct device_mixed {
    const vec *s, *p;
    const struct device_state *c;
};

struct device_beginning {
    int32_t with_r, jacobi;
    struct opening opening;
    const sym *factor;
    vec *s;
    real *item;
};

struct device_solve {
    struct device_state *c;
    void *links;
    int64_t nc, n_chunks;
    vec *r, *p[2], *q, *dv;
    const vec *b;
    const real *w;
    const sym *bound, *single;
    real *item, *chunk;
    int32_t task, touch, epoch;
    struct device_beginning begin;
};

struct device_levels {
    int64_t at[17];
    int32_t count[17];
    int top;
};

struct device_mutual {
    int32_t contact;
    real c;
};

#ifdef REF_COULOMB_H
struct linked {
    struct links s;
    int32_t *end;
    struct device_mutual *item;
};
#endif

struct device_items {
    real *part;
    uint8_t *what;
};

struct device_lists {
    int64_t *word;
    int32_t *rank, *any;
};

struct device_grid {
    int32_t m, n;
};

/* Whether n numbers from a on are finite, or at most so large. */
static inline bool finite_doubles(const double *a, int n)
{
    bool good = true;
    for (int k = 0; k < n; k++)
        good = good & (fabs(a[k]) < INFINITY);
    return good;
}

static inline bool bounded_doubles(const double *a, int n, double most)
{
    bool good = true;
    for (int k = 0; k < n; k++)
        good = good & (fabs(a[k]) <= most);
    return good;
}

static inline bool finite_reals(const real *a, int n)
{
    bool good = true;
    for (int k = 0; k < n; k++)
        good = good & (real_abs(a[k]) < R(INFINITY));
    return good;
}

static inline bool bounded_reals(const real *a, int n)
{
    bool good = true;
    for (int k = 0; k < n; k++)
        good = good & (real_abs(a[k]) <= R(0x1p20));
    return good;
}

/* Whether two points differ along x, and by a number. */
static inline bool differ_along_x(const vec *a)
{
    real d = a[1].x - a[0].x;
    return (d != 0) & (real_abs(d) <= R(0x1p20));
}

/* Whether n indices are of items 0 … most - 1. */
static inline bool indices_in(const int32_t *v, int n, int64_t most)
{
    bool good = true;
    for (int k = 0; k < n; k++)
        good = good & (v[k] >= 0) & (v[k] < most);
    return good;
}

/* Whether the row and the column of item k are within a grid of m by n items,
 * as they are where k < m n. */
static inline bool in_grid(int32_t m, int32_t n, int64_t k)
{
    int32_t j = (int32_t)k / m, i = (int32_t)k - j * m;
    return (m > 0) & (i >= 0) & (i < m) & (j >= 0) & (j < n);
}

/* Whether an item's three coordinates are among those of n items. */
#define COORDINATES(k, n)                                                      \
    (((k) < (n)) & (3 * (k) < 3 * (n)) & (3 * (k) + 1 < 3 * (n)) &             \
     (3 * (k) + 2 < 3 * (n)))

/* Whether none of four vertices is led. */
static inline bool all_free(const real *w, const int32_t *v)
{
    bool good = true;
    for (int k = 0; k < 4; k++)
        good = good & (w[v[k]] > 0);
    return good;
}

/* Whether two triangles share no vertex. */
static inline bool share_none(const int32_t *f, const int32_t *g)
{
    bool good = true;
    for (int k = 0; k < 9; k++)
        good = good & (f[k / 3] != g[k % 3]);
    return good;
}

/* Whether the vertices of contact k keep the number of parts that they have:
 * ref/contact/contacts.c finds it before it pushes, the device when it does. */
#define PART_STANDS(s, i)                                                      \
    (((s)->parts[i] > 0) & ((s)->parts[i] >= (s)->acting[i]))
#define PARTS_STAND(s, k)                                                      \
    (!((s)->keep == 0) & PART_STANDS(s, (s)->contact[k].v[0]) &                \
     PART_STANDS(s, (s)->contact[k].v[1]) &                                    \
     PART_STANDS(s, (s)->contact[k].v[2]) &                                    \
     PART_STANDS(s, (s)->contact[k].v[3]))

/* Whether c is the layout of compressed diagonals for a grid of m by n. */
#define LAID_OUT(c, m, n)                                                      \
    (memcmp(c, &(struct cdf[]){ref_cdf(m, n)}, sizeof(struct cdf)) == 0)

/* Whether the rules of 5 by 5 particles are these, of which some are cut off
 * along i or j on either side, or both. */
#define SOME_RULES(rule)                                                       \
    (memcmp(rule, "\0\1\0\2\0\4\5\0\12\10\0\0\0\1\0\10\0\4\6\0\0\2\0\1",       \
            24) == 0 &&                                                        \
     (rule)[24] == 0)

/* Whether the springs of 3 by 3 particles are these: all that the grid has room
 * for, but for four. */
#define SOME_SPRINGS(springs)                                                  \
    (memcmp(springs, "\166\57\242\7\13\12\21\1", 8) == 0 && (springs)[8] == 0)

/* Whether all springs of 5 by 5 particles are live but one. */
#define ALL_LIVE(live)                                                         \
    (memcmp(live,                                                              \
            "\377\377\377\377\377\377\377\377\377\377\377\377"                 \
            "\377\377\377\377\377\377\375\377\377\377\377\377",                \
            24) == 0 &&                                                        \
     (live)[24] == 0)

/* Whether no law of springs is of pieces. */
#define NO_PIECES(law)                                                         \
    ((law)[0].pieces == 0 && (law)[1].pieces == 0 && (law)[2].pieces == 0 &&   \
     (law)[3].pieces == 0 && (law)[4].pieces == 0 && (law)[5].pieces == 0 &&   \
     (law)[6].pieces == 0 && (law)[7].pieces == 0)

/* Whether none of n vertices is free. */
static inline bool none_free(const real *w, const int32_t *v, int n)
{
    bool none = true;
    for (int k = 0; k < n; k++)
        none = none & !(w[v[k]] > 0);
    return none;
}

/* Whether n items are of contacts 0 … n - 1. */
static inline bool in_turn(const struct device_mutual *m, int n)
{
    bool good = true;
    for (int k = 0; k < n; k++)
        good = good & (m[k].contact == k);
    return good;
}

/* Whether of the grids number 1 of two cloths the first sleeps, and the second
 * is of 5 by 5 particles, with a grid of 3 by 3 below. */
#define ONE_AWAKE(cloth)                                                       \
    (CLOTH_AT(cloth, 3) != 0 && CLOTH_AT(cloth, 2)->awake == 0 &&              \
     CLOTH_AT(cloth, 3)->awake == 1 && CLOTH_AT(cloth, 3)->l.m == 5 &&         \
     CLOTH_AT(cloth, 3)->l.n == 5 && CLOTH_AT(cloth, 3)->l.count == 25 &&      \
     CLOTH_AT(cloth, 5)->l.m == 3 && CLOTH_AT(cloth, 5)->l.n == 3 &&           \
     CLOTH_AT(cloth, 5)->l.count == 9 &&                                       \
     SOME_RULES(CLOTH_AT(cloth, 3)->l.rule))
#define CLOTH_AT(cloth, k) ((const struct device_cloth *)(cloth) + (k))

/* Whether there is one vertex, free, which is all four of the only contact. */
#define ONE_VERTEX(s)                                                          \
    ((s)->n == 1 && (s)->nv == 1 && (s)->contact[0].v[0] == 0 &&               \
     (s)->contact[0].v[1] == 0 && (s)->contact[0].v[2] == 0 &&                 \
     (s)->contact[0].v[3] == 0 && (s)->w[0] > 0 &&                             \
     (s)->contact[0].c[0] != 0 && (s)->contact[0].c[1] != 0 &&                 \
     (s)->contact[0].c[2] != 0 && (s)->contact[0].c[3] != 0)

/* The positions of four vertices at both ends of a step, as filter.c takes
 * them. */
static inline void widen_points(const vec *x, double y[2][4][3])
{
    for (int k = 0; k < 8; k++) {
        y[k / 4][k % 4][0] = (double)x[k].x;
        y[k / 4][k % 4][1] = (double)x[k].y;
        y[k / 4][k % 4][2] = (double)x[k].z;
    }
}

#ifdef ERROR_FORM
/* Whether the forms of two edges that ref/narrow/filter.c makes of f, g and h
 * are finite, as they are within its RANGE. */
static inline bool finite_forms(const double *f)
{
    struct motion m;
    struct forms s;
    memcpy(m.f, f, sizeof m.f);
    m.count = 4;
    for (int k = 0; k < 3; k++)
        cross_forms(&m.f[1], &m.f[2], k, s.q[0][k]);
    make_forms(&m, &s);
    return finite_doubles(&s.q[0][0][0], 36);
}
#endif

#ifdef VISIT_LIMIT
/* Whether 12 forms, or a cubic, are finite on [a, b]. */
static inline bool finite_on(const double *q, double a, double b)
{
    bool good = true;
    for (int k = 0; k < 12; k++) {
        double c[3];
        restrict_form(q + 3 * k, a, b, c);
        good = good & finite_doubles(c, 3);
    }
    return good;
}

static inline bool finite_cubic(const double *v, double a, double b)
{
    double c[4];
    restrict_cubic(v, a, b, c);
    return finite_doubles(c, 4);
}
#endif

/* The block of the edge that starts at column x and row y of tile o of
 * those at t, as gpu/solve/tile.cuh lays a tile out. */
static inline sym tile_block(const real *t, int o, int x, int y)
{
    enum {
        WIDE = 35,
        HIGH = REAL_BITS == 32 ? 19 : 11,
        PLANE = 2 * WIDE * HIGH
    };
    const real *a = t + 6 * PLANE * o + WIDE * (2 * y + x % 2) + x / 2;
    return (sym){a[0],         a[PLANE],     a[2 * PLANE],
                 a[3 * PLANE], a[4 * PLANE], a[5 * PLANE]};
}

#endif
