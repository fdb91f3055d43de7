/* SPDX-License-Identifier: Apache-2.0 */
/* The surface around a closest point on the device, as in ref/narrow/closest.h.
 * spec/contact/proximity.md §3.2 */
#ifndef GPU_ONE_RING_CUH
#define GPU_ONE_RING_CUH

#include "gpu/contact/closest.cuh"
#include "gpu/contact/contact.cuh"

/* Vertices that do not move, and vertices at a part t of their way. Their
 * places are loaded before they are used. */
struct still {
    typedef vec loaded;
    const vec *x;
    __device__ vec load(int32_t i) const { return x[i]; }
    __device__ struct wide place(vec a) const { return widen(a); }
};
struct moving {
    struct loaded {
        vec a, b;
    };
    const vec *x0, *x1;
    double t;
    __device__ struct loaded load(int32_t i) const { return {x0[i], x1[i]}; }
    __device__ struct wide place(struct loaded l) const
    {
        struct wide a = widen(l.a);
        return axpy(a, t, sub(widen(l.b), a));
    }
};

/* The closest point on side B, or on side A: the vertices from `split` on, or
 * before it. p: from here to the other side. */
static __device__ inline struct closest_point
closest_point_find_at(int split, bool b, const int32_t v[4],
                      const struct wide x[4], const double c[4], struct wide p)
{
    struct wide o = x[0];
    struct closest_point f = {0, {-1, -1}, wide3(0, 0, 0), lift(p)};
    for (int j = 0; j < 4; j++) {
        if ((j >= split) != b || c[j] == 0)
            continue;
        if (f.vertices == 0)
            o = x[j];
        if (f.vertices < 2)
            f.v[f.vertices] = v[j];
        f.vertices++;
        f.at = axpy(f.at, c[j] < 0 ? -c[j] : c[j], sub(x[j], o));
    }
    return f;
}

/* Whether side A, and side B, is prescribed: has no free vertex. */
static __device__ inline void find_prescribed(const real *w, int split,
                                              const int32_t v[4],
                                              bool prescribed[2])
{
    prescribed[0] = prescribed[1] = true;
    for (int j = 0; j < 4; j++)
        prescribed[j >= split] = prescribed[j >= split] && !(w[v[j]] > 0);
}

/* Whether the closest point comes nearer to the other side towards point y; o:
 * the closest point's first vertex. */
static __device__ inline bool comes_nearer(const struct closest_point *f,
                                           struct wide o, struct wide y,
                                           double least)
{
    struct wide d = lift(sub(sub(y, o), f->at));
    double along = dot(f->p, d);
    return along > 0 && along * along > least * (dot(f->p, f->p) * dot(d, d));
}

/* Whether a triangle around f.v[0], with these other vertices, is at the
 * closest point.
 */
static __device__ inline bool is_at(const struct closest_point *f, int32_t a,
                                    int32_t b)
{
    return f->vertices == 1 || a == f->v[1] || b == f->v[1];
}

/* Triangles around f.v[0] that are loaded before the first is used, so that
 * latencies overlap: the pole of a sphere has a hundred. */
enum { ONE_RING_AHEAD = 4 };

/* The other vertices of a triangle, and their places; at: it is at the closest
 * point. */
template <class PLACES> struct one_ring_triangle {
    bool at;
    typename PLACES::loaded a, b;
};

/* Loads triangles [k, end) around f.v[0], ONE_RING_AHEAD at most. */
template <class PLACES>
static __device__ inline void
load_one_ring(const PLACES &x, const struct one_rings *one_rings,
              const struct closest_point *f, int32_t k, int32_t end,
              struct one_ring_triangle<PLACES> t[ONE_RING_AHEAD])
{
    int32_t a[ONE_RING_AHEAD], b[ONE_RING_AHEAD];
    UNROLL
    for (int e = 0; e < ONE_RING_AHEAD; e++) {
        a[e] = one_rings->opposite[k + e < end ? k + e : k][0];
        b[e] = one_rings->opposite[k + e < end ? k + e : k][1];
    }
    UNROLL
    for (int e = 0; e < ONE_RING_AHEAD; e++) {
        t[e].at = k + e < end && is_at(f, a[e], b[e]);
        t[e].a = x.load(t[e].at ? a[e] : f->v[0]);
        t[e].b = x.load(t[e].at ? b[e] : f->v[0]);
    }
}

/* Whether the closest point is the nearest point of the triangles around it. */
template <class PLACES>
static __device__ inline bool
closest_point_is_local(const PLACES &x, const struct one_rings *one_rings,
                       const struct closest_point *f, double least)
{
    if (f->vertices == 3 || !one_rings->n_start)
        return true;
    struct wide o = x.place(x.load(f->v[0]));
    int32_t end = one_rings->start[f->v[0] + 1];
    for (int32_t k = one_rings->start[f->v[0]]; k < end; k += ONE_RING_AHEAD) {
        struct one_ring_triangle<PLACES> t[ONE_RING_AHEAD];
        bool nearer = false;
        load_one_ring(x, one_rings, f, k, end, t);
        UNROLL
        for (int e = 0; e < ONE_RING_AHEAD; e++)
            nearer = nearer ||
                     (t[e].at && (comes_nearer(f, o, x.place(t[e].a), least) ||
                                  comes_nearer(f, o, x.place(t[e].b), least)));
        if (nearer)
            return false;
    }
    return true;
}

/* The normal of the triangle at the closest point that p is most along, on p's
 * side. False if the squared cosine between them is not above `least` for any.
 */
template <class PLACES>
static __device__ inline bool
closest_point_normal(const PLACES &x, const struct one_rings *one_rings,
                     const struct closest_point *f, double least,
                     struct wide *n)
{
    double most = least * dot(f->p, f->p);
    bool found = false;
    struct wide o = x.place(x.load(f->v[0]));
    int32_t end = one_rings->start[f->v[0] + 1];
    for (int32_t k = one_rings->start[f->v[0]]; k < end; k += ONE_RING_AHEAD) {
        struct one_ring_triangle<PLACES> t[ONE_RING_AHEAD];
        load_one_ring(x, one_rings, f, k, end, t);
        UNROLL
        for (int e = 0; e < ONE_RING_AHEAD; e++) {
            struct wide a = lift(sub(x.place(t[e].a), o));
            struct wide b = lift(sub(x.place(t[e].b), o));
            struct wide m = lift(cross(a, b));
            double along = dot(m, f->p), mm = dot(m, m);
            if (!t[e].at || !(along * along > most * mm))
                continue;
            most = along * along / mm;
            *n = unit(along < 0 ? scale(-1, m) : m, *n);
            found = true;
        }
    }
    return found;
}

/* Whether a triangle's other vertices than f.v[0] are those of `face`. */
static __device__ inline bool is_face(int32_t a, int32_t b,
                                      const int32_t face[3])
{
    return (a == face[0] || a == face[1] || a == face[2]) &&
           (b == face[0] || b == face[1] || b == face[2]);
}

/* Whether `face`, which has the closest point, is the first triangle there that
 * does not have the vertex `other`. */
static __device__ inline bool
closest_point_is_first_at(const struct one_rings *one_rings,
                          const struct closest_point *f, const int32_t face[3],
                          int32_t other)
{
    if (!one_rings->n_start || f->vertices == 3)
        return true;
    int32_t end = one_rings->start[f->v[0] + 1];
    for (int32_t k = one_rings->start[f->v[0]]; k < end; k++) {
        int32_t a = one_rings->opposite[k][0], b = one_rings->opposite[k][1];
        if (is_at(f, a, b) && a != other && b != other)
            return is_face(a, b, face);
    }
    return true;
}

#endif
