/* SPDX-License-Identifier: Apache-2.0 */
/* Stage jacobi: the diagonal blocks of the system, factored.
 * spec/solve/jacobi.md */
#ifndef REF_JACOBI_H
#define REF_JACOBI_H

#include "ref/base/packed.h"
#include "ref/solve/matrix.h"

struct jacobi {
    int32_t m, n;     /* particles along i and j */
    int64_t count;    /* m·n */
    const real *mass; /* [count] kg */
    int64_t n_extra;  /* count, or 0: none */
    const sym *extra; /* [n_extra] kg */
    int64_t n_blocks; /* SPRINGS·count */
    const sym *block; /* [n_blocks] kg, spring o of p at o·count + p */
    int64_t n_packed; /* SPRINGS·count, or 0: none, block is read */
    const struct packed *packed; /* [n_packed] kg, read in place of block */
    const uint8_t *fixed;        /* [count] not 0: the factor is 0 */
    sym *factor;                 /* out: [count] 1/D, in 1/kg, and L; §2 */
};

/* Returns DRAPE_OK. */
int ref_jacobi(struct jacobi *s);

/* A symmetric block summed in binary64, xx xy xz yy yz zz; §1. */
struct wide_sym {
    double a[6];
};

static inline struct wide_sym wide_sym_add(struct wide_sym d, sym b)
{
    d.a[0] += (double)b.xx;
    d.a[1] += (double)b.xy;
    d.a[2] += (double)b.xz;
    d.a[3] += (double)b.yy;
    d.a[4] += (double)b.yz;
    d.a[5] += (double)b.zz;
    return d;
}

/* Adds a packed block. The products are exact in binary64. */
static inline struct wide_sym wide_sym_packed(struct wide_sym d,
                                              struct packed t)
{
    struct packed_parts a = packed_open(t);
    struct wide e = wide_of(a.e), w = wide_scale((double)a.size, e);
    double all = (double)a.all;
    d.a[0] += w.x * e.x + all;
    d.a[1] += w.x * e.y;
    d.a[2] += w.x * e.z;
    d.a[3] += w.y * e.y + all;
    d.a[4] += w.y * e.z;
    d.a[5] += w.z * e.z + all;
    return d;
}

/* §2: factors d = L D Lᵀ. Returns 1/D on the diagonal and L beside it. */
sym ref_factor(struct wide_sym d);

/* §3: solves L D Lᵀ z = r; z = 0 if the factor is 0. */
static inline vec factor_solve(sym f, vec r)
{
    real y = r.y - f.xy * r.x;
    real z = ((r.z - f.xz * r.x) - f.yz * y) * f.zz;
    y = y * f.yy - f.yz * z;
    return vec_make((r.x * f.xx - f.xy * y) - f.xz * z, y, z);
}

#endif
