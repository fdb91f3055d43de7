/* SPDX-License-Identifier: Apache-2.0 */
/* Generates queries for the narrow phase, by families. All tests of the narrow
 * phase and the fuzzer use this generator. spec/narrow/narrow.md §7 */
#include "tests/narrow/query.h"

static real power(int e)
{
    real r = 1;
    for (; e != 0; e += e < 0 ? 1 : -1)
        r *= e < 0 ? R(0.5) : R(2.0);
    return r;
}

/* Picks an integer within ±size. */
static real whole(struct bytes *b, int size)
{
    return (real)((int)pick(b, 2 * (uint32_t)size + 1) - size);
}

/* Picks an integer vec. Each choice has its own statement, as C leaves the
 * order within an expression open. */
static vec whole_vec(struct bytes *b, int size)
{
    real x = whole(b, size), y = whole(b, size);
    return vec_make(x, y, whole(b, size));
}

static vec pick_cube(struct bytes *b)
{
    real x = pick_uniform(b, -1, 1), y = pick_uniform(b, -1, 1);
    return vec_make(x, y, pick_uniform(b, -1, 1));
}

static void make_lattice(struct bytes *b, struct query *q)
{
    int size = 1 + (int)pick(b, 4);
    for (int i = 0; i < 8; i++)
        q->x[i / 4][i % 4] = whole_vec(b, size);
}

static void make_planar(struct bytes *b, struct query *q, int family)
{
    vec d = whole_vec(b, 2);
    for (int i = 0; i < 8; i++) {
        vec *x = &q->x[i / 4][i % 4];
        if (family == QUERY_PLANE)
            x->z = d.x;
        else if (family == QUERY_OBLIQUE)
            x->z = d.x * x->x + d.y * x->y;
        else
            *x = vec_scale(x->x, d);
    }
}

static void make_rigid(struct bytes *b, struct query *q, int family)
{
    vec d[2];
    d[0] = whole_vec(b, 3);
    d[1] = whole_vec(b, 3);
    for (int j = 0; j < 4; j++) {
        q->x[1][j] = q->x[0][j];
        if (family == QUERY_TRANSLATION)
            q->x[1][j] = vec_add(q->x[0][j], d[q->kind ? j / 2 : j > 0]);
    }
}

static void make_collapsed(struct bytes *b, struct query *q)
{
    uint32_t j = pick(b, 4), k = pick(b, 4);
    q->x[0][j] = q->x[0][k];
    if (pick(b, 3))
        q->x[1][j] = q->x[1][k];
}

/* Sets velocities along z that keep the point of contact in the face or on the
 * edge to first order, where the common plane is z = 0 at that time. */
static void graze(vec p[4], vec d[4], int kind, real u, real v)
{
    for (int j = 0; j < 4; j++)
        p[j].z = 0;
    for (int j = 1; j < 4; j++)
        d[j].z *= 4;
    if (kind == 0)
        d[0].z = ((4 - u - v) * d[1].z + u * d[2].z + v * d[3].z) / 4;
    else /* the middle of the other primitive */
        d[3].z = 2 * (d[0].z + u / 4 * (d[1].z - d[0].z)) - d[2].z;
}

/* Makes a contact at time r/s: a vertex in a face or edges that cross,
 * sometimes at a corner. */
static void make_contact(struct bytes *b, struct query *q, int family)
{
    real s = (real)(1 + pick(b, 7)), r = (real)pick(b, (uint32_t)s + 1);
    real u = (real)pick(b, 5), v = (real)pick(b, 5 - (uint32_t)u);
    vec p[4], d[4];
    if (family == QUERY_END)
        r = pick(b, 2) ? s : 0;
    for (int j = 0; j < 4; j++) {
        p[j] = vec_scale(4, whole_vec(b, 3));
        d[j] = whole_vec(b, 3);
    }
    if (family == QUERY_GRAZING)
        graze(p, d, q->kind, u, v);
    if (q->kind == 0) {
        vec a = vec_sub(p[2], p[1]), c = vec_sub(p[3], p[1]);
        p[0] = vec_axpy(vec_axpy(p[1], u / 4, a), v / 4, c);
    } else {
        vec a = vec_axpy(p[0], u / 4, vec_sub(p[1], p[0]));
        bool end = family != QUERY_GRAZING && pick(b, 2);
        p[3] = end ? a : vec_sub(vec_scale(2, a), p[2]);
    }
    for (int j = 0; j < 4; j++) {
        q->x[0][j] = vec_axpy(p[j], -r, d[j]);
        q->x[1][j] = vec_axpy(p[j], s - r, d[j]);
    }
}

/* Makes a vertex that meets only the line of an edge, also at irrational
 * times. */
static void make_edge_on(struct bytes *b, struct query *q)
{
    int a = 1 + (int)pick(b, 3);
    for (int t = 0; t < 2; t++)
        if (q->kind)
            q->x[t][0].z = q->x[t][2].z = q->x[t][3].z = 0;
        else
            q->x[t][0].z = q->x[t][a].z = q->x[t][a % 3 + 1].z = 0;
}

/* Makes f, g, h with a triangular matrix, so that V is the product of three
 * linear functions, two or three of which share a root r/s; then shears
 * them. */
static void make_roots(struct bytes *b, struct query *q, int family)
{
    real s = (real)(1 + pick(b, 6)), r = (real)pick(b, (uint32_t)s + 1);
    real k[3], low[2][3], c = whole(b, 2);
    for (int i = 0; i < 3; i++)
        k[i] = whole(b, 2);
    for (int i = 0; i < 6; i++)
        low[i / 3][i % 3] = whole(b, 3);
    uint32_t odd = family == QUERY_DOUBLE ? pick(b, 3) : 3;
    real other = whole(b, 3);
    bool inside = pick(b, 4) > 0;
    for (int t = 0; t < 2; t++) {
        real d[3];
        for (uint32_t i = 0; i < 3; i++)
            d[i] = k[i] * (s * (real)t - (i == odd ? other : r));
        vec a = vec_make(d[0], 0, 0), e = vec_make(low[t][0], d[1], 0);
        vec m = vec_make(low[t][1], low[t][2], d[2]);
        vec f = a, g = e, h = m;
        if (inside && q->kind) { /* the lines meet in both middles */
            f = vec_sub(vec_add(a, e), m);
            g = vec_add(e, e);
            h = vec_add(m, m);
        } else if (inside) { /* the face's middle is met */
            f = vec_add(a, e);
            g = vec_add(a, m);
            h = vec_sub(vec_sub(a, e), m);
        }
        vec *x = q->x[t];
        x[1] = vec_add(x[0], q->kind ? g : f);
        x[2] = vec_add(x[0], q->kind ? f : g);
        x[3] = vec_add(q->kind ? x[2] : x[0], h);
        for (int j = 0; j < 4; j++)
            x[j].z += c * x[j].x - x[j].y;
    }
}

static void make_smooth(struct bytes *b, struct query *q, real scale)
{
    vec drop = vec_scale(scale, pick_vec(b, 1));
    for (int i = 0; i < 4; i++) {
        q->x[0][i] = vec_scale(scale, pick_cube(b));
        q->x[1][i] =
            vec_axpy(vec_add(q->x[0][i], drop), scale / 4, pick_cube(b));
    }
}

/* Moves a number by one ulp; seldom from 0, because exact arithmetic with
 * subnormals is slow. */
static void nudge(struct bytes *b, real *a)
{
    if (*a == 0 && pick(b, 32))
        *a = R(0x1p-40);
    *a = pick(b, 2) ? real_up(*a) : real_down(*a);
}

/* Makes one to three changes to a query of a real scene. */
static void make_real(struct bytes *b, struct query *q)
{
    int kind = q->kind, times = (int)pick(b, 4);
    for (int tries = 0; tries < 8; tries++) {
        *q = query_real(choose(b));
        if (q->kind == kind)
            break;
    }
    q->kind = kind; /* may pair the same vertices anew */
    for (; times > 0; times--) {
        real *a = query_at(q, (int)pick(b, 24));
        vec *x = &q->x[pick(b, 2)][pick(b, 4)];
        uint32_t t = pick(b, 2), j = pick(b, 4);
        switch (pick(b, 6)) {
        case 0:
            nudge(b, a);
            break;
        case 1:
            *a = *query_at(q, (int)pick(b, 24));
            break;
        case 2:
            *x = q->x[t][j];
            break;
        case 3:
            q->x[1][j] = q->x[0][j];
            break;
        case 4: /* fewer bits make coincidences likely */
            *a = (*a + R(64.0)) - R(64.0);
            break;
        default:
            *x = vec_axpy(q->x[0][j], R(0.5), vec_sub(q->x[1][j], q->x[0][j]));
        }
    }
}

static void make_wild(struct bytes *b, struct query *q)
{
    int reach = REAL_BITS == 32 ? 120 : 900;
    for (int i = 0; i < 24; i++) {
        real a = power((int)pick(b, 2 * (uint32_t)reach) - reach);
        *query_at(q, i) = a * pick_real(b, 2);
    }
}

/* Applies offsets, ulps and a scale to all 24 coordinates. */
static void transform(struct bytes *b, struct query *q, int family)
{
    int e = (int)pick(b, 121) - 60;
    bool scaled = family == QUERY_SCALED || pick(b, 4) == 0;
    if (family == QUERY_WILD) /* an offset would overflow */
        return;
    vec o = {0, 0, 0};
    if (family == QUERY_OFFSET) {
        o.x = power((int)pick(b, 21));
        o.y = -power((int)pick(b, 21));
        o.z = power((int)pick(b, 21));
    }
    for (int i = 0; i < 8; i++)
        q->x[i / 4][i % 4] = vec_add(q->x[i / 4][i % 4], o);
    for (int i = 0; i < 24; i++) {
        real *a = query_at(q, i);
        if (family == QUERY_NUDGED && pick(b, 4) == 0)
            nudge(b, a);
        if (scaled)
            *a *= power(e);
    }
}

struct query query_pick(struct bytes *b, int kind, int family)
{
    struct query q = {.kind = kind};
    bool touch = family == QUERY_CONTACT || family == QUERY_END ||
                 family == QUERY_GRAZING || family == QUERY_NUDGED;
    make_lattice(b, &q);
    if (family == QUERY_OFFSET || family == QUERY_SCALED)
        touch = pick(b, 2);
    if (touch)
        make_contact(b, &q, family);
    if (family == QUERY_PLANE || family == QUERY_OBLIQUE ||
        family == QUERY_LINE)
        make_planar(b, &q, family);
    if (family == QUERY_TRANSLATION || family == QUERY_STILL)
        make_rigid(b, &q, family);
    if (family == QUERY_COLLAPSED)
        make_collapsed(b, &q);
    if (family == QUERY_EDGE_ON)
        make_edge_on(b, &q);
    if (family == QUERY_DOUBLE || family == QUERY_TRIPLE)
        make_roots(b, &q, family);
    if (family == QUERY_CLOTH || family == QUERY_SMOOTH)
        make_smooth(b, &q, family == QUERY_CLOTH ? R(0.001) : 1);
    if (family == QUERY_REAL)
        make_real(b, &q);
    if (family == QUERY_WILD)
        make_wild(b, &q);
    transform(b, &q, family);
    return q;
}

struct query query_typical(struct bytes *b, int kind)
{
    struct query q = {.kind = kind};
    make_smooth(b, &q, R(0.001));
    return q;
}
