/* SPDX-License-Identifier: Apache-2.0 */
/* Stage proximity: generator and properties. Distances are checked against
 * independent methods and rational arithmetic. spec/contact/proximity.md */
#include "tests/contact/proximity.h"

#include "oracle/oracle.h"
#include "oracle/rational.h"
#include "tests/base/choices.h"

const struct field fields_proximity[] = {
    IN(proximity, pair, n, 4),
    IN(proximity, kind, n, 1),
    IN(proximity, x, nv, 1),
    IN(proximity, from, n_from, 1),
    IN(proximity, w, nv, 1),
    IN(proximity, surfaces.of, nv, 1),
    IN(proximity, surfaces.surface, surfaces.n, 1),
    IN(proximity, one_rings.start, one_rings.n_start, 1),
    IN(proximity, one_rings.opposite, one_rings.n_opposite, 1),
    SCRATCH(proximity, at, n, 1),
    OUT_USED(proximity, contact, cap, 1, found),
    OUT_VALUE(proximity, found),
    FIELD_END};

/* Picks a point of a coarse grid. The picks are statements, since C leaves the
 * order of a call's arguments to the compiler. */
static vec pick_grid(struct bytes *b)
{
    real x = (real)pick(b, 4), y = (real)pick(b, 4);
    return vec_make(x, y, (real)pick(b, 4));
}

static struct wide pick_cube(struct bytes *b)
{
    real x = pick_uniform(b, -1, 1), y = pick_uniform(b, -1, 1);
    return wide_of(vec_make(x, y, pick_uniform(b, -1, 1)));
}

/* Picks a position on a coarse grid, or any position; flat: at y = 0. */
static vec pick_place(struct bytes *b, real scale, bool flat)
{
    vec x = pick_vec(b, scale);
    if (pick(b, 2))
        x = pick_grid(b);
    if (flat)
        x.y = 0;
    return x;
}

struct one_rings pick_one_rings(struct bytes *b, int64_t nv, int64_t n,
                                const int32_t *pair)
{
    struct one_rings one_rings = {.n_start = nv + 1, .n_opposite = 2 * nv};
    int32_t *start = take(b, one_rings.n_start, sizeof *start);
    int32_t(*opposite)[2] = take(b, one_rings.n_opposite, sizeof *opposite);
    for (int64_t i = 0; i <= nv; i++)
        start[i] = (int32_t)(2 * i);
    for (int64_t i = 0; i < one_rings.n_opposite; i++) {
        opposite[i][0] = (int32_t)pick(b, (uint64_t)nv);
        opposite[i][1] = (int32_t)pick(b, (uint64_t)nv);
    }
    for (int64_t k = 0; k < 4 * n; k++) {
        int64_t at = 2 * (int64_t)pair[k] + (int64_t)pick(b, 2);
        opposite[at][pick(b, 2)] = pair[k ^ (1 + (int64_t)pick(b, 3))];
    }
    one_rings.start = start;
    one_rings.opposite = (const int32_t(*)[2])opposite;
    return one_rings;
}

void gen_proximity(struct bytes *b, struct proximity *s)
{
    s->n = for_bench(b) ? 1 << 18 : pick_size(b);
    s->nv = 4 + s->n / 2;
    s->surfaces.n = 2;
    s->dt = R(1.0) / 60;
    s->stiffness = pick(b, 2) ? 0 : 100;
    s->range = pick(b, 2) ? 1 : R(1.25);
    int32_t *pair = take(b, 4 * s->n, sizeof *pair);
    uint8_t *kind = take(b, s->n, 1);
    vec *x = take(b, s->nv, sizeof *x);
    vec *from = take(b, s->nv, sizeof *from);
    real *w = take(b, s->nv, sizeof *w);
    uint16_t *of = take(b, s->nv, sizeof *of);
    struct surface *surface = take(b, 2, sizeof *surface);
    surface[0] = (struct surface){R(0.5), R(0.1)};
    surface[1] = (struct surface){R(1.0), R(0.0)};
    bool flat = pick(b, 4) == 0;
    for (int64_t i = 0; i < s->nv; i++) {
        x[i] = pick_place(b, for_bench(b) ? 10 : 2, flat);
        w[i] = pick(b, 4) ? real_abs(pick_real(b, 1000)) : 0;
        of[i] = (uint16_t)pick(b, 2);
    }
    for (int64_t k = 0; k < s->n; k++) {
        kind[k] = (uint8_t)pick(b, 2);
        pick_four(b, s->nv, pair + 4 * k);
    }
    s->n_from = pick(b, 2) ? s->nv : 0;
    for (int64_t i = 0; i < s->n_from; i++)
        from[i] = pick(b, 4) ? vec_add(x[i], pick_vec(b, R(0.5))) : x[i];
    s->pair = pair;
    s->kind = kind;
    s->x = x;
    s->from = from;
    s->w = w;
    s->surfaces.of = of;
    s->surfaces.surface = surface;
    s->one_rings = pick_one_rings(b, s->nv, s->n, pair);
    s->cap = pick(b, 8) ? s->n : s->n / 16;
}

/* Distances by other methods: regions of the plane, and clamping. The size L of
 * a pair is that of proximity.md §1. */

/* Where the sine of an angle is at most this, the pair is a needle: a normal of
 * its two directions may be mere rounding (it errs by some 2^-50 / sine), and
 * its edges and ends alone give the distance. They are too far by 2^-24 L at
 * most, which is within the bound beside the 2^-23 L of §2.1. Other pairs err
 * by some 2^-25 L. */
static const double needle = 0x1p-25;

static double clamp(double a)
{
    return a < 0 ? 0 : a > 1 ? 1 : a;
}

/* Of vectors whose squares underflow too. */
static double length(struct wide a)
{
    if (wide_dot(a, a) >= 0x1p-900)
        return sqrt(wide_dot(a, a));
    a = wide_scale(0x1p600, a);
    return 0x1p-600 * sqrt(wide_dot(a, a));
}

static double to_segment(struct wide p, struct wide a, struct wide b)
{
    struct wide d = wide_sub(b, a), q = wide_sub(p, a);
    double dd = wide_dot(d, d);
    double t = dd > 0 ? clamp(wide_dot(q, d) / dd) : 0;
    return length(wide_axpy(q, -t, d));
}

/* Distance of x[0] to the triangle: to its plane where x[0] projects into the
 * triangle (left of all three edges), else to the nearest edge. All points of a
 * needle are within its height of the longest edge, which is 2 L at most. */
static double to_triangle(const struct wide x[4])
{
    struct wide n = wide_cross(wide_sub(x[2], x[1]), wide_sub(x[3], x[1]));
    double least = HUGE_VAL, longest = 0;
    bool over = wide_dot(n, n) > 0;
    for (int k = 1; k < 4; k++) {
        struct wide a = x[k], b = x[k % 3 + 1];
        double d = to_segment(x[0], a, b);
        least = d < least ? d : least;
        longest = fmax(longest, length(wide_sub(b, a)));
        struct wide inward = wide_cross(n, wide_sub(b, a));
        over = over && wide_dot(inward, wide_sub(x[0], a)) >= 0;
    }
    if (!over || !(length(n) > needle * longest * longest))
        return least;
    double d = wide_dot(n, wide_sub(x[0], x[1])) / length(n);
    return d < 0 ? -d : d;
}

/* Whether p and q lie on different sides of the plane through a with normal m.
 */
static bool apart(struct wide p, struct wide q, struct wide a, struct wide m)
{
    double i = wide_dot(m, wide_sub(p, a)), j = wide_dot(m, wide_sub(q, a));
    return (i >= 0 && j <= 0) || (i <= 0 && j >= 0);
}

/* Distance of two edges: of their lines where the edges cross when seen along
 * the common normal, else the smallest distance of an end to the other edge.
 * Edges of a needle are nearly parallel: one that is followed from the closest
 * points to an end leaves the other by its length times the sine at most. */
static double to_edge(const struct wide x[4])
{
    struct wide d = wide_sub(x[1], x[0]), e = wide_sub(x[3], x[2]);
    struct wide n = wide_cross(d, e);
    double least = HUGE_VAL;
    for (int k = 0; k < 4; k++) {
        int a = k < 2 ? 2 : 0;
        double l = to_segment(x[k], x[a], x[a + 1]);
        least = l < least ? l : least;
    }
    if (!(wide_dot(n, n) > 0 && length(n) > needle * length(d) * length(e)) ||
        !apart(x[0], x[1], x[2], wide_cross(n, e)) ||
        !apart(x[2], x[3], x[0], wide_cross(n, d)))
        return least;
    double l = wide_dot(n, wide_sub(x[2], x[0])) / length(n);
    return l < 0 ? -l : l;
}

double pair_distance(const struct wide x[4], int kind)
{
    return kind == CONTACT_VF ? to_triangle(x) : to_edge(x);
}

static double size_of(const struct wide x[4])
{
    double size = 0;
    for (int k = 1; k < 4; k++) {
        double l = length(wide_sub(x[k], x[0]));
        size = l > size ? l : size;
    }
    return size;
}

/* §2.4: by how much underflow may change a distance, m. */
static const double lost = REAL_BITS == 32 ? 0x1p-150 : 0x1p-260;

static bool finite_contact(const struct contact *c)
{
    return vec_sane(c->n) && real_sane(c->gap) && real_sane(c->target);
}

static const char *check_contact(const struct contact *c,
                                 const struct wide x[4])
{
    double size = size_of(x), p = 0;
    real sum = 0;
    for (int k = 0; k < 4; k++) {
        sum += c->c[k];
        p += (double)c->c[k] * wide_dot(wide_of(c->n), wide_sub(x[k], x[0]));
        bool side_b = k >= (c->kind == CONTACT_VF ? 1 : 2);
        EXPECT(side_b ? c->c[k] <= 0 : c->c[k] >= 0);
    }
    EXPECT(finite_contact(c));
    EXPECT(sum == 0); /* §2.3, exactly */
    double unit = (double)vec_length(c->n);
    EXPECT(unit > 1 - 0x1p-20 && unit < 1 + 0x1p-20);
    /* §3: n·Σ c x is the gap */
    p -= (double)c->gap;
    EXPECT(fabs(p) <= 0x1p-19 * size + lost);
    return NULL;
}

/* §2.1: whether the true distance, in rational arithmetic, is r within the
 * bound. */
static bool is_distance(const struct wide x[4], int kind, double r,
                        double bound)
{
    double p[4][3];
    for (int k = 0; k < 4; k++) {
        p[k][0] = x[k].x;
        p[k][1] = x[k].y;
        p[k][2] = x[k].z;
    }
    const double(*q)[3] = (const double(*)[3])p;
    return orc_distance(kind, q, r - bound) >= 0 &&
           orc_distance(kind, q, r + bound) <= 0;
}

/* The place in the pair where side B begins. */
static int split_of(const struct proximity *s, int64_t k)
{
    return s->kind[k] == CONTACT_VF ? 1 : 2;
}

/* §3.2: the prescribed side of the pair, A (0) before B (1); -1 if both have
 * free vertices. */
static int prescribed_of(const struct proximity *s, int64_t k)
{
    const int32_t *v = s->pair + 4 * k;
    int prescribed[2] = {1, 1};
    for (int j = 0; j < 4; j++)
        prescribed[j >= split_of(s, k)] &= !(s->w[v[j]] > 0);
    return prescribed[0] ? 0 : prescribed[1] ? 1 : -1;
}

/* The closest points of the stage, where equally near ones may be others. */
static struct closest points_of(const struct wide x[4], int kind)
{
    struct closest r;
    if (kind == CONTACT_VF)
        closest_vf(x, &r);
    else
        closest_ee(x, &r);
    return r;
}

/* The vector times a power of two that makes its length about 2^200: the
 * components of lesser vectors may underflow. */
static struct wide level(struct wide a)
{
    if (length(a) < 0x1p-500)
        a = wide_scale(0x1p600, a);
    return length(a) > 0 ? wide_scale(ldexp(1, 200 - ilogb(length(a))), a) : a;
}

/* The cosine of the angle between two vectors; 0 if one of them is zero. */
static double cosine(struct wide a, struct wide b)
{
    a = level(a);
    b = level(b);
    double l = length(a) * length(b);
    return l > 0 ? wide_dot(a, b) / l : 0;
}

/* The closest point of a side of a pair, in coordinates relative to its vertex
 * i. It is at i if j is i, else in the edge or the face that has i and j. */
struct spot {
    int32_t i, j;
    int corners;    /* vertices of the side that it lies between */
    struct wide at; /* m, relative to i */
    struct wide p;  /* m, from here to the other side's closest point */
    double error;   /* m, of its place (§2.5); a vertex is where it is */
};

static struct spot find_spot(const struct proximity *s, int64_t k, int side,
                             const struct wide x[4])
{
    struct closest r = points_of(x, s->kind[k]);
    struct spot q = {.p = side ? r.p : wide_scale(-1, r.p)};
    int split = split_of(s, k), start = side ? split : 0;
    int end = side ? 4 : split, i = 0;
    for (int c = start; c < end; c++)
        if (r.c[c] != 0) {
            i = q.corners++ ? i : c;
            q.j = s->pair[4 * k + c];
        }
    q.i = s->pair[4 * k + i];
    for (int c = start; c < end; c++)
        q.at = wide_axpy(q.at, fabs(r.c[c]), wide_sub(x[c], x[i]));
    if (q.corners > 1)
        q.error = 0x1p-48 * size_of(x); /* the stage's and ours */
    return q;
}

/* §3.2: what the triangles around a spot say of p. */
struct beside {
    bool may, must; /* the surface comes nearer: perhaps, surely */
    bool vague;     /* the normal of a triangle is mere rounding */
    double most;    /* the cosine of p and the normal that p is most along */
};

/* Rounding of the cosines here, and of their squares in the stage. */
static const double blur = 0x1p-20;

/* Looks towards a vertex of a triangle, which is at e relative to q->i. */
static void look_towards(const struct spot *q, struct wide e, double least,
                         struct beside *b)
{
    struct wide d = wide_sub(e, q->at);
    if (length(d) == 0 && q->error == 0)
        return;
    double c = cosine(q->p, d), room = blur + q->error / length(d);
    b->may = b->may || c > least - room;
    b->must = b->must || c > least + room;
}

/* Looks along the normal of the triangle with the sides e and f. A triangle
 * without area has none. */
static void look_along(const struct spot *q, struct wide e, struct wide f,
                       struct beside *b)
{
    e = level(e);
    f = level(f);
    struct wide n = wide_cross(e, f);
    bool sure = length(n) > needle * length(e) * length(f);
    b->vague = b->vague || (!sure && length(n) > 0);
    if (sure)
        b->most = fmax(b->most, fabs(cosine(n, q->p)));
}

/* Looks at the triangles around the spot; least: the cosine from which on they
 * come nearer. */
static struct beside look(const struct proximity *s, const struct spot *q,
                          double least)
{
    struct beside b = {0};
    struct wide o = wide_of(s->x[q->i]);
    if (q->corners == 3 || !s->one_rings.n_start)
        return b;
    for (int32_t t = s->one_rings.start[q->i]; t < s->one_rings.start[q->i + 1];
         t++) {
        const int32_t *opposite = s->one_rings.opposite[t];
        struct wide e = wide_sub(wide_of(s->x[opposite[0]]), o);
        struct wide f = wide_sub(wide_of(s->x[opposite[1]]), o);
        if (q->i != q->j && opposite[0] != q->j && opposite[1] != q->j)
            continue;
        look_towards(q, e, least, &b);
        look_towards(q, f, least, &b);
        look_along(q, e, f, &b);
    }
    return b;
}

/* What may become of a pair that is nearer than its thickness. */
struct fate {
    bool keep, drop;    /* both are allowed where rounding decides */
    double least, most; /* of the gap of a kept pair, in distances */
};

/* §3.2: a pair with a prescribed side is dropped where this surface comes
 * nearer and p is more than 60° off all its normals. Where p is less, the gap
 * is along the normal that p is most along. */
static struct fate led_fate(const struct proximity *s, int64_t k, int side,
                            const struct wide x[4])
{
    struct spot q = find_spot(s, k, side, x);
    struct beside b = look(s, &q, 0x1p-14);
    struct fate f = {true, false, 1, 1};
    if (!b.may)
        return f;
    f.drop = b.most < 0.5 + blur;
    f.keep = !b.must || b.vague || b.most > 0.5 - blur;
    f.least = (b.must ? fmax(0.5, b.most) : 0.5) - blur;
    f.most = b.must && !b.vague ? b.most + blur : 1;
    return f;
}

/* §3.3: a pair of free sides is dropped where the surface comes nearer at the
 * closest point of the face, or at one of those of two edges. */
static struct fate free_fate(const struct proximity *s, int64_t k,
                             const struct wide x[4])
{
    struct fate f = {true, false, 1, 1};
    for (int side = s->kind[k] == CONTACT_VF; side < 2; side++) {
        struct spot q = find_spot(s, k, side, x);
        struct beside b = look(s, &q, 0x1p-10);
        f.keep = f.keep && !b.must;
        f.drop = f.drop || b.may;
    }
    return f;
}

/* §3.4: whether a pair is the one of those with its closest points that is a
 * contact. Two edges: neither point is an end. A vertex and a face: of the
 * triangles that have the point on their edge or at their vertex, and not the
 * vertex itself, the first one is this face. Where the fan has no triangle
 * there the face is a contact. */
static bool has_place(const struct proximity *s, int64_t k,
                      const struct wide x[4])
{
    struct closest r = points_of(x, s->kind[k]);
    const int32_t *v = s->pair + 4 * k;
    if (s->kind[k] == CONTACT_EE)
        return r.c[0] != 0 && r.c[1] != 0 && r.c[2] != 0 && r.c[3] != 0;
    struct spot q = find_spot(s, k, 1, x);
    if (q.corners == 3 || !s->one_rings.n_start)
        return true;
    for (int32_t t = s->one_rings.start[q.i]; t < s->one_rings.start[q.i + 1];
         t++) {
        int32_t a = s->one_rings.opposite[t][0],
                b = s->one_rings.opposite[t][1];
        bool there = q.j == q.i || q.j == a || q.j == b;
        if (!there || a == v[0] || b == v[0])
            continue;
        bool has_a = false, has_b = false;
        for (int j = 1; j < 4; j++) {
            has_a |= v[j] == a;
            has_b |= v[j] == b;
        }
        return has_a && has_b;
    }
    return true;
}

/* Pairs whose p has no direction are kept. In those below 2^-450 m it may have
 * one or not (§2.4); their gaps are less than the bound. */
static struct fate find_fate(const struct proximity *s, int64_t k,
                             const struct wide x[4])
{
    int side = prescribed_of(s, k);
    struct closest r = points_of(x, s->kind[k]);
    if (!has_place(s, k, x))
        return (struct fate){.drop = true};
    if (size_of(x) < 0x1p-450)
        return (struct fate){true, true, 0, 1};
    if (length(r.p) <= 0x1p-40 * size_of(x))
        return (struct fate){true, false, 1, 1};
    return side < 0 ? free_fate(s, k, x) : led_fate(s, k, side, x);
}

/* §3.5: the place of each vertex at the start of the slice. */
static void start_of(const struct proximity *s, int64_t k, struct wide from[4])
{
    for (int j = 0; j < 4; j++)
        from[j] = wide_of(s->from[s->pair[4 * k + j]]);
}

static real thickness_of(const struct proximity *s, int64_t k)
{
    return surfaces_pair(&s->surfaces, s->pair + 4 * k).thickness;
}

/* §3.5: how far the points of a pair that arrives are apart at the start, at
 * least. */
static double start_range(const struct proximity *s, int64_t k)
{
    return (double)(s->range * thickness_of(s, k));
}

/* §3.5: whether a pair whose normal is along p surely comes nearer, from the
 * side on which it ends and from far enough. */
static bool surely_arrives(const struct proximity *s, int64_t k,
                           const struct wide x[4])
{
    struct wide from[4], p = wide_make(0, 0, 0);
    struct closest r = points_of(x, s->kind[k]);
    start_of(s, k, from);
    for (int j = 0; j < 4; j++)
        p = wide_axpy(p, r.c[j], wide_sub(from[j], from[0]));
    double d = length(r.p), room = 0x1p-19 * (size_of(x) + size_of(from));
    if (!(d > 0x1p-39 * size_of(x)))
        return false; /* §3.1: n need not be along p */
    double gap = wide_dot(p, r.p) / d;
    return gap > room + lost && gap > d + room + lost &&
           length(p) > start_range(s, k) + room + lost;
}

/* n·Σ c x. */
static double end_gap(const struct contact *c, const struct wide x[4])
{
    double gap = 0;
    for (int j = 0; j < 4; j++)
        gap += (double)c->c[j] * wide_dot(wide_of(c->n), wide_sub(x[j], x[0]));
    return gap;
}

/* §3.5: the gap of a contact is that of the start, and it was larger; its
 * points were beyond the range. */
static const char *check_arrival(const struct proximity *s, int64_t k,
                                 const struct contact *c,
                                 const struct wide x[4])
{
    struct wide from[4];
    start_of(s, k, from);
    double gap = end_gap(c, from), end = end_gap(c, x);
    double room = 0x1p-19 * (size_of(x) + size_of(from)) + lost;
    EXPECT(c->gap >= 0 && fabs(gap - (double)c->gap) <= room);
    EXPECT(end <= gap + room);
    struct wide p = wide_make(0, 0, 0);
    for (int j = 0; j < 4; j++)
        p = wide_axpy(p, (double)c->c[j], wide_sub(from[j], from[0]));
    EXPECT(length(p) >= start_range(s, k) - room);
    return NULL;
}

const char *prop_proximity(const struct proximity *s)
{
    int64_t at = 0;
    for (int64_t k = 0; k < s->n; k++) {
        const int32_t *v = s->pair + 4 * k;
        struct wide x[4];
        for (int j = 0; j < 4; j++)
            x[j] = wide_of(s->x[v[j]]);
        double r = (double)((s->n_from ? 1 : s->range) * thickness_of(s, k));
        const struct contact *c = &s->contact[at];
        bool kept = at < s->found && !memcmp(c->v, v, sizeof c->v) &&
                    c->kind == s->kind[k];
        double d = pair_distance(x, s->kind[k]);
        double bound = 0x1p-22 * size_of(x) + lost; /* §2.1, §2.4 */
        struct fate f = find_fate(s, k, x);
        EXPECT(!kept || d <= r + bound);
        if (s->n_from && !(f.least == 1 && surely_arrives(s, k, x)))
            f.drop = true;
        if (!kept) {
            EXPECT(d >= r - bound || f.drop);
            continue;
        }
        EXPECT(f.keep);
        struct contact end = *c;
        const char *failed = NULL;
        if (s->n_from) {
            failed = check_arrival(s, k, c, x);
            end.gap = (real)end_gap(c, x);
        }
        EXPECT((double)end.gap <= f.most * d + bound);
        EXPECT((double)end.gap >= f.least * d - bound);
        if (k % 8 == 0 && orc_present() && prescribed_of(s, k) < 0)
            EXPECT(is_distance(x, s->kind[k], (double)end.gap, bound));
        failed = failed ? failed : check_contact(&end, x);
        if (failed)
            return failed;
        at++;
    }
    EXPECT(at == s->found);
    return NULL;
}

/* Picks coordinates that are small multiples of 2^e, of its eighth root or of
 * 1, each by itself or all of a vertex alike. */
static void pick_tiny(struct bytes *b, int e, vec x[5])
{
    bool alike = pick(b, 2) == 0;
    int scale = 0;
    for (int k = 0; k < 15; k++) {
        if (!alike || k % 3 == 0)
            scale = pick(b, 3) ? e : pick(b, 2) ? e / 8 : 0;
        real a = (real)ldexp((double)pick(b, 9) - 4, scale);
        *(k % 3 == 0   ? &x[k / 3].x
          : k % 3 == 1 ? &x[k / 3].y
                       : &x[k / 3].z) = a;
    }
    if (pick(b, 2)) /* side A touches the other side */
        x[0] = x[1 + pick(b, 3)];
}

/* §2.4, §3: the properties hold for pairs of any size down to the smallest
 * number, and for needles of any height: the normal's length too. Triangles
 * with a fifth vertex are beside the pair's edges. */
const char *test_proximity_tiny(void)
{
    static const int32_t v[4] = {0, 1, 2, 3}, start[6] = {0, 1, 3, 4, 4, 4};
    static const int32_t opposite[4][2] = {{1, 4}, {2, 4}, {3, 4}, {3, 4}};
    static const struct surface surface = {2, 0};
    static const uint16_t of[5];
    struct bytes b = {.seed = 1, .size = -1};
    const char *failed = NULL;
    const int least = REAL_BITS == 32 ? -149 : -1074;
    for (int k = 0; k < 64 * -least && !failed; k++) {
        vec x[5];
        uint8_t kind = (uint8_t)pick(&b, 2);
        real first = (real)pick(&b, 2), last = (real)pick(&b, 2);
        const real w[5] = {first, first, last, last, 1};
        struct contact contact;
        int32_t at;
        pick_tiny(&b, least + k / 64, x);
        struct proximity p = {.nv = 5,
                              .n = 1,
                              .pair = v,
                              .kind = &kind,
                              .x = x,
                              .w = w,
                              .surfaces = {1, of, &surface},
                              .one_rings = {6, 4, start, opposite},
                              .dt = 1,
                              .range = 1,
                              .at = &at,
                              .cap = 1,
                              .contact = &contact};
        EXPECT(ref_proximity(&p) == DRAPE_OK);
        failed = prop_proximity(&p);
        ran(1);
    }
    choices_free(&b);
    return failed;
}

/* The smallest distance between sample points of both primitives: an upper
 * bound of the distance. */
static double sampled(const struct wide x[4], int kind)
{
    enum { N = 24 };
    double least = HUGE_VAL;
    for (int i = 0; i <= N; i++)
        for (int j = 0; j <= (kind == CONTACT_VF ? N - i : N); j++) {
            double s = (double)i / N, t = (double)j / N;
            struct wide p;
            if (kind == CONTACT_VF) {
                p = wide_axpy(wide_scale(1 - s - t, x[1]), s, x[2]);
                p = wide_sub(x[0], wide_axpy(p, t, x[3]));
            } else {
                p = wide_axpy(wide_scale(1 - s, x[0]), s, x[1]);
                p = wide_sub(p, wide_axpy(wide_scale(1 - t, x[2]), t, x[3]));
            }
            least = length(p) < least ? length(p) : least;
        }
    return least;
}

/* Picks a pair; the families are well-shaped, needle-like, nearly parallel and
 * collapsed pairs. */
static void pick_pair(struct bytes *b, int family, struct wide x[4])
{
    static const double packed[4] = {1, 1e-3, 1e-7, 0};
    for (int k = 0; k < 4; k++)
        x[k] = pick_cube(b);
    struct wide d = wide_sub(x[2], x[1]), e = wide_sub(x[3], x[1]);
    double f = packed[family % 4];
    if (family >= 4) /* edges: the second nearly along the first */
        x[3] = wide_axpy(wide_axpy(x[2], 1, wide_sub(x[1], x[0])), f, e);
    else /* triangles: the last corner near the first edge */
        x[3] = wide_axpy(wide_axpy(x[1], 0.4, d), f, e);
}

const char *test_closest_points(void)
{
    struct bytes b = {.seed = 7, .size = -1};
    for (int k = 0; k < 8 * 1500; k++) {
        int family = k % 8, kind = family >= 4;
        struct wide x[4];
        struct closest r;
        pick_pair(&b, family, x);
        if (kind == CONTACT_VF)
            closest_vf(x, &r);
        else
            closest_ee(x, &r);
        double d = sqrt(r.length2), size = size_of(x);
        double other = pair_distance(x, kind);
        double bound = 0x1p-22 * size; /* §2.1 */
        EXPECT(d <= other + bound);
        EXPECT(d >= other - bound);
        EXPECT(d <= sampled(x, kind) + bound);
        /* no point of a primitive is farther from a sample than the spacing */
        EXPECT(d >= sampled(x, kind) - 4 * size / 24);
        ran(1);
    }
    choices_free(&b);
    return NULL;
}
