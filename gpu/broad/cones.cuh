/* SPDX-License-Identifier: Apache-2.0 */
/* The test of a patch's tangent bounds on the device. spec/broad/cones.md §3 */
#ifndef GPU_CONES_CUH
#define GPU_CONES_CUH

#include "gpu/base/real.cuh"

extern "C" {
#include "ref/broad/cones.h"
}

#define CONES_ROOM 32 /* equal to ref/; ci/prove.sh checks both */

static __device__ inline struct tangents join(const struct tangents &a,
                                              const struct tangents &b)
{
    struct tangents c = {min_of(a.ulo, b.ulo), max_of(a.uhi, b.uhi),
                         min_of(a.vlo, b.vlo), max_of(a.vhi, b.vhi)};
    return c;
}

/* The range of p·x for x in a box, and the sum of its largest terms, which
 * scales the error bound. */
struct span {
    real lo, hi, size;
};

static __device__ inline struct span span_axis(real p, real lo, real hi)
{
    real a = p * lo, b = p * hi;
    struct span s = {min_of(a, b), max_of(a, b),
                     max_of(magnitude(a), magnitude(b))};
    return s;
}

static __device__ inline struct span span_dot(vec p, vec lo, vec hi)
{
    struct span x = span_axis(p.x, lo.x, hi.x);
    struct span y = span_axis(p.y, lo.y, hi.y);
    struct span z = span_axis(p.z, lo.z, hi.z);
    struct span s = {(x.lo + y.lo) + z.lo, (x.hi + y.hi) + z.hi,
                     (x.size + y.size) + z.size};
    return s;
}

/* §3: whether these tangent bounds prove that the features of a full patch that
 * share no vertex stay more than r apart. */
static __device__ inline bool spread(const struct tangents &b, real r)
{
    const real room = CONES_ROOM * REAL_UNIT, tiny = R(0x1p-100);
    vec u = scale(R(0.5), add(b.ulo, b.uhi));
    vec v = scale(R(0.5), add(b.vlo, b.vhi));
    real uu = dot(u, u), uv = dot(u, v), vv = dot(v, v);
    real det = uu * vv - uv * uv;
    if (!(det > 0))
        return false;
    vec pu = scale(1 / det, sub(scale(vv, u), scale(uv, v)));
    vec pv = scale(1 / det, sub(scale(uu, v), scale(uv, u)));
    struct span a = span_dot(pu, b.ulo, b.uhi);
    struct span d = span_dot(pv, b.vlo, b.vhi);
    struct span e = span_dot(pu, b.vlo, b.vhi);
    struct span f = span_dot(pv, b.ulo, b.uhi);
    real norm = root(dot(pu, pu) + dot(pv, pv));
    real mu = R(1.5) * r * norm * (1 + room) + tiny;
    real am = a.lo - (a.size * room + mu);
    real bm = d.lo - (d.size * room + mu);
    real c = R(0.5) * max_of(magnitude(e.lo + f.lo), magnitude(e.hi + f.hi));
    real cm = c + ((e.size + f.size) * room + tiny);
    return am > 0 && bm > 0 && am * bm > cm * cm;
}

#endif
