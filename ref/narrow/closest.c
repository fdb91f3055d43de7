/* SPDX-License-Identifier: Apache-2.0 */
/* Closest points of two primitives: computes a few candidate pairs of points
 * and keeps the nearest pair. spec/contact/proximity.md §1, §2 */
#include "ref/narrow/closest.h"

/* Starts a search: y = x - x[0], and the size of the pair; no candidate yet. */
static void start_search(const struct wide x[4], struct wide y[4],
                         struct closest *r)
{
    r->length2 = -1;
    r->size2 = 0;
    for (int k = 0; k < 4; k++) {
        y[k] = wide_sub(x[k], x[0]);
        double l = wide_dot(y[k], y[k]);
        r->size2 = l > r->size2 ? l : r->size2;
    }
}

/* Keeps the candidate with weights c if its points are nearer than all before;
 * of a tie the first candidate stays. */
static void offer_candidate(struct closest *r, const struct wide y[4],
                            const double c[4])
{
    struct wide p = wide_scale(c[1], y[1]);
    p = wide_axpy(p, c[2], y[2]);
    p = wide_axpy(p, c[3], y[3]);
    double l = wide_dot(p, p);
    if (r->length2 >= 0 && !(l < r->length2))
        return;
    for (int k = 0; k < 4; k++)
        r->c[k] = c[k];
    r->p = p;
    r->length2 = l;
}

/* a / b within [0, 1]; 0 where b is 0. */
static double clamped_ratio(double a, double b)
{
    if (!(a > 0 && b > 0))
        return 0;
    return a < b ? a / b : 1;
}

/* §1.1 */
void closest_vf(const struct wide x[4], struct closest *r)
{
    struct wide y[4];
    start_search(x, y, r);
    struct wide e = wide_sub(y[2], y[1]), f = wide_sub(y[3], y[1]);
    struct wide q = wide_scale(-1, y[1]), n = wide_cross(e, f);
    double nn = wide_dot(n, n);
    if (nn > 0) {
        double s = wide_dot(wide_cross(q, f), n) / nn;
        double t = wide_dot(wide_cross(e, q), n) / nn;
        if (s >= 0 && t >= 0 && s + t <= 1)
            offer_candidate(r, y, (double[4]){1, -(1 - s - t), -s, -t});
    }
    for (int k = 0; k < 3; k++) {
        int a = 1 + k, b = 1 + (k + 1) % 3;
        struct wide d = wide_sub(y[b], y[a]);
        double t = clamped_ratio(-wide_dot(y[a], d), wide_dot(d, d));
        double c[4] = {1, 0, 0, 0};
        c[a] = -(1 - t);
        c[b] = -t;
        offer_candidate(r, y, c);
    }
}

/* §1.2 */
void closest_ee(const struct wide x[4], struct closest *r)
{
    struct wide y[4];
    start_search(x, y, r);
    struct wide d = y[1], e = wide_sub(y[3], y[2]);
    double dd = wide_dot(d, d), ee = wide_dot(e, e), de = wide_dot(d, e);
    double dq = -wide_dot(d, y[2]), eq = -wide_dot(e, y[2]);
    double det = dd * ee - de * de;
    if (det > 0) {
        /* t is the best for the s of the 2 × 2 system, and s then the best for
         * that t: the squared distance errs by the square of the first error */
        double t =
            clamped_ratio(eq + clamped_ratio(de * eq - dq * ee, det) * de, ee);
        double s = clamped_ratio(t * de - dq, dd);
        offer_candidate(r, y, (double[4]){1 - s, s, -(1 - t), -t});
    }
    double t0 = clamped_ratio(eq, ee), t1 = clamped_ratio(eq + de, ee);
    double s0 = clamped_ratio(-dq, dd), s1 = clamped_ratio(de - dq, dd);
    offer_candidate(r, y, (double[4]){1, 0, -(1 - t0), -t0});
    offer_candidate(r, y, (double[4]){0, 1, -(1 - t1), -t1});
    offer_candidate(r, y, (double[4]){1 - s0, s0, -1, 0});
    offer_candidate(r, y, (double[4]){1 - s1, s1, 0, -1});
}

/* The nearest multiple of the quantum: 2^-22, or 2^-50 in binary64. */
static double round_to_quantum(double a)
{
    double shift = REAL_BITS == 32 ? 0x1.8p30 : 0x1.8p2;
    return a + shift - shift;
}

void closest_weights(const struct closest *r, int kind, real c[4])
{
    double s, t, w[4];
    if (kind == 0) {
        s = round_to_quantum(-r->c[2]);
        t = round_to_quantum(-r->c[3]);
        t = t < 1 - s ? t : 1 - s;
        w[0] = 1;
        w[1] = -(1 - s - t);
        w[2] = -s;
    } else {
        s = round_to_quantum(r->c[1]);
        t = round_to_quantum(-r->c[3]);
        w[0] = 1 - s;
        w[1] = s;
        w[2] = -(1 - t);
    }
    w[3] = -t;
    for (int k = 0; k < 4; k++)
        c[k] = (real)w[k];
}

struct wide closest_normal(const struct wide x[4], int kind)
{
    if (kind == 0)
        return wide_cross(wide_sub(x[2], x[1]), wide_sub(x[3], x[1]));
    return wide_cross(wide_sub(x[1], x[0]), wide_sub(x[3], x[2]));
}

struct wide closest_lift(struct wide a)
{
    for (int k = 0; k < 3 && wide_dot(a, a) < 0x1p-400; k++)
        a = wide_scale(0x1p300, a);
    return a;
}

struct wide closest_unit(struct wide a, struct wide fallback)
{
    a = closest_lift(a);
    double l = sqrt(wide_dot(a, a));
    if (!(l > 0 && l - l == 0))
        return fallback;
    return wide_make(a.x / l, a.y / l, a.z / l);
}

static struct wide place_of(const struct places *s, int32_t i)
{
    struct wide a = wide_of(s->x0[i]);
    return s->x1 ? wide_axpy(a, s->t, wide_sub(wide_of(s->x1[i]), a)) : a;
}

struct closest_point closest_point_find(const int32_t v[4], int from, int end,
                                        const struct wide x[4],
                                        const double c[4], struct wide p)
{
    struct wide o = x[0];
    struct closest_point f = {.p = closest_lift(p)};
    for (int j = from; j < end; j++) {
        if (c[j] == 0)
            continue;
        if (f.vertices == 0)
            o = x[j];
        if (f.vertices < 2)
            f.v[f.vertices] = v[j];
        f.vertices++;
        f.at = wide_axpy(f.at, c[j] < 0 ? -c[j] : c[j], wide_sub(x[j], o));
    }
    return f;
}

/* Whether triangles of the one-ring of f.v[0] are at the closest point. */
static bool is_at(const struct closest_point *f, const int32_t opposite[2])
{
    return f->vertices == 1 || opposite[0] == f->v[1] || opposite[1] == f->v[1];
}

/* The place of vertex y relative to the closest point's first vertex. */
static struct wide place_beside(const struct places *s,
                                const struct closest_point *f, int32_t y)
{
    return wide_sub(place_of(s, y), place_of(s, f->v[0]));
}

/* Whether the closest point comes nearer to the other side towards vertex y. */
static bool comes_nearer(const struct places *s, const struct closest_point *f,
                         int32_t y, double least)
{
    struct wide d = closest_lift(wide_sub(place_beside(s, f, y), f->at));
    double along = wide_dot(f->p, d);
    return along > 0 &&
           along * along > least * (wide_dot(f->p, f->p) * wide_dot(d, d));
}

bool closest_point_is_local(const struct places *s,
                            const struct one_rings *one_rings,
                            const struct closest_point *f, double least)
{
    int32_t i = f->v[0];
    if (!one_rings->n_start)
        return true;
    for (int32_t k = one_rings->start[i];
         f->vertices < 3 && k < one_rings->start[i + 1]; k++) {
        const int32_t *opposite = one_rings->opposite[k];
        for (int j = 0; j < 2; j++)
            if (is_at(f, opposite) && comes_nearer(s, f, opposite[j], least))
                return false;
    }
    return true;
}

bool closest_point_normal(const struct places *s,
                          const struct one_rings *one_rings,
                          const struct closest_point *f, double least,
                          struct wide *n)
{
    int32_t i = f->v[0];
    double most = least * wide_dot(f->p, f->p);
    bool found = false;
    for (int32_t k = one_rings->start[i]; k < one_rings->start[i + 1]; k++) {
        const int32_t *opposite = one_rings->opposite[k];
        struct wide d = closest_lift(place_beside(s, f, opposite[0]));
        struct wide e = closest_lift(place_beside(s, f, opposite[1]));
        struct wide m = closest_lift(wide_cross(d, e));
        double along = wide_dot(m, f->p), mm = wide_dot(m, m);
        if (!is_at(f, opposite) || !(along * along > most * mm))
            continue;
        most = along * along / mm;
        *n = closest_unit(along < 0 ? wide_scale(-1, m) : m, *n);
        found = true;
    }
    return found;
}

/* Whether a triangle of the one-ring of f.v[0], with these other vertices, is
 * `face`. */
static bool is_face(const int32_t opposite[2], const int32_t face[3])
{
    for (int j = 0; j < 2; j++)
        if (opposite[j] != face[0] && opposite[j] != face[1] &&
            opposite[j] != face[2])
            return false;
    return true;
}

bool closest_point_is_first(const struct one_rings *one_rings,
                            const struct closest_point *f,
                            const int32_t face[3], int32_t other)
{
    int32_t i = f->v[0];
    if (!one_rings->n_start || f->vertices == 3)
        return true;
    for (int32_t k = one_rings->start[i]; k < one_rings->start[i + 1]; k++) {
        const int32_t *opposite = one_rings->opposite[k];
        if (is_at(f, opposite) && opposite[0] != other && opposite[1] != other)
            return is_face(opposite, face);
    }
    return true;
}
