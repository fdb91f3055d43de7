/* SPDX-License-Identifier: Apache-2.0 */
/* Stage matrix on the device: assembles the matrix in compressed diagonal
 * format. spec/solve/matrix.md */
#include "gpu/solve/grid.cuh"

/* Returns 0 - b: a missing block, which is +0, stays +0. */
static __device__ mat negative(sym b)
{
    return mat{make(0 - b.xx, 0 - b.xy, 0 - b.xz),
               make(0 - b.xy, 0 - b.yy, 0 - b.yz),
               make(0 - b.xz, 0 - b.yz, 0 - b.zz)};
}

/* Thread p owns row p: reads mass, extra and the blocks at p, writes
 * diagonal[p]. §2 */
KERNEL diagonal_kernel(const struct matrix &s)
{
    ITEM(item, s.count);
    struct grid g = {s.m, s.n};
    struct place at = place_of(g, item);
    real mass = s.mass[at.p];
    sym d = {mass, 0, 0, mass, 0, mass};
    if (s.n_extra)
        d = add(d, s.extra[at.p]);
    for (int o = 0; o < SPRINGS; o++) {
        const sym *block = s.block + o * s.count;
        int di = forward_i(o), dj = forward_j(o);
        if (within(g, at.i + di, at.j + dj))
            d = add(d, fetch(block + at.p));
        if (within(g, at.i - di, at.j - dj))
            d = add(d, fetch(block + (at.p - (di + s.m * dj))));
    }
    s.diagonal[at.p] = d;
}

/* Thread p owns row p of every diagonal that has such a row. §3 */
KERNEL matrix_kernel(const struct matrix &s, const struct cdf &c)
{
    ITEM(item, s.count);
    struct grid g = {s.m, s.n};
    struct place at = place_of(g, item);
    sym d = s.diagonal[at.p];
    s.cdf[c.start[0] + at.p] = mat{
        make(d.xx, d.xy, d.xz), make(d.xy, d.yy, d.yz), make(d.xz, d.yz, d.zz)};
    for (int k = 1; k < DIAGONALS; k++) {
        int o = (k - 1) / 2, sign = k % 2 ? 1 : -1;
        int64_t q = at.p + c.offset[k];
        sym b = {0, 0, 0, 0, 0, 0};
        if (q < 0 || q >= s.count)
            continue;
        if (within(g, at.i + sign * forward_i(o), at.j + sign * forward_j(o)))
            b = fetch(&s.block[o * s.count + (sign > 0 ? at.p : q)]);
        s.cdf[c.start[k] + at.p] = negative(b);
    }
}

int gpu_matrix(struct gpu *g, struct matrix *s)
{
    struct cdf c = cdf_of(s->m, s->n);
    if (s->m < 1 || s->n < 1 || s->count != (int64_t)s->m * s->n ||
        s->n_blocks != SPRINGS * s->count ||
        (s->n_extra && s->n_extra != s->count) ||
        (s->n_cdf && s->n_cdf != c.blocks))
        return DRAPE_EARG;
    LAUNCH(g, s->count, diagonal_kernel, *s);
    if (s->n_cdf)
        LAUNCH(g, s->count, matrix_kernel, *s, c);
    return gpu_status(g);
}
