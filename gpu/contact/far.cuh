/* SPDX-License-Identifier: Apache-2.0 */
/* Proves cheaply, in the build's precision, that a candidate is not nearer than
 * its reach T, as most are not. Only the others are measured in binary64. The
 * reach is `range` times the thickness, rounded: the number with which the
 * measured distance is compared. So its rounding is no error of the proof,
 * which holds for any T: spec/contact/proximity.md §6 */
#ifndef GPU_FAR_CUH
#define GPU_FAR_CUH

#include "gpu/contact/contact.cuh"

/* §6.2: whether the sides are further apart than the reach along axis d. y: the
 * vertices relative to the first; side B begins at SPLIT; square: that of the
 * reach. */
template <int SPLIT>
static __device__ inline bool parted(const vec y[4], vec d, real square)
{
    real low = 0, high = dot(d, y[SPLIT]), dd = dot(d, d);
    if (SPLIT == 2)
        low = min_of(low, dot(d, y[1]));
    UNROLL
    for (int j = SPLIT + 1; j < 4; j++)
        high = max_of(high, dot(d, y[j]));
    real gap = low - high;
    return gap > 0 && dd > R(0x1p-80) &&
           gap * gap > (1 + R(0x1p-10)) * (square * dd);
}

/* a / b within [0, 1], where that is a number. */
static __device__ inline real far_ratio(real a, real b)
{
    return min_of(max_of(a / b, R(0)), R(1));
}

/* Approximately the vector from the closest point of edge b to edge a's. */
static __device__ inline vec between_edges(const vec y[4])
{
    vec a = y[1], b = sub(y[3], y[2]), q = y[2];
    real aa = dot(a, a), bb = dot(b, b), ab = dot(a, b);
    real aq = dot(a, q), bq = dot(b, q);
    real s = far_ratio(aq * bb - bq * ab, aa * bb - ab * ab);
    real t = far_ratio(s * ab - bq, bb);
    s = far_ratio(t * ab + aq, aa);
    return sub(scale(s, a), axpy(q, t, b));
}

/* §6: whether a pair of kind `kind` with vertices at x is certainly not nearer
 * than its reach. */
static __device__ inline bool surely_far(const vec x[4], int kind, real reach)
{
    vec y[4] = {make(0, 0, 0), sub(x[1], x[0]), sub(x[2], x[0]),
                sub(x[3], x[0])};
    real square = reach * reach;
    real size2 =
        max_of(max_of(dot(y[1], y[1]), dot(y[2], y[2])), dot(y[3], y[3]));
    if (!(square > R(0x1p-40) && size2 <= R(0x1p16) * square))
        return false;
    if (kind == CONTACT_EE)
        return parted<2>(y, between_edges(y), square);
    vec d = scale(-1, add(add(y[1], y[2]), y[3]));
    if (parted<1>(y, d, square))
        return true;
    vec n = cross(sub(y[2], y[1]), sub(y[3], y[1]));
    return parted<1>(y, dot(n, y[1]) > 0 ? scale(-1, n) : n, square);
}

#endif
