/* SPDX-License-Identifier: Apache-2.0 */
/* Solves the coarsest grid by a dense factorisation in binary64.
 * spec/solve/multigrid.md §5 */
#include "ref/solve/coarsest.h"

#include "ref/solve/coarsen.h"

static void put_block(double *a, int64_t p, int64_t q, sym b, double sign)
{
    double e[3][3] = {{(double)b.xx, (double)b.xy, (double)b.xz},
                      {(double)b.xy, (double)b.yy, (double)b.yz},
                      {(double)b.xz, (double)b.yz, (double)b.zz}};
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 3; c++)
            a[(3 * p + r) * DENSE + 3 * q + c] += sign * e[r][c];
}

void coarsest_fill(const struct coarsest *l)
{
    double *a = l->dense;
    for (int k = 0; k < DENSE * DENSE; k++)
        a[k] = 0;
    for (int64_t p = 0; p < l->count; p++) {
        put_block(a, p, p, l->excess[p], 1);
        for (int o = 0; o < STENCIL; o++) {
            int64_t i = p % l->m + stencil_di[o], j = p / l->m + stencil_dj[o];
            int64_t q = i + l->m * j;
            if (i < 0 || i >= l->m || j >= l->n)
                continue;
            sym c = l->block[o * l->count + p];
            put_block(a, p, p, c, 1);
            put_block(a, q, q, c, 1);
            put_block(a, p, q, c, -1);
            put_block(a, q, p, c, -1);
        }
    }
}

/* Sweeps unknown k in the lower triangle of a symmetric matrix: after all of
 * them it is -A⁻¹. inverse: 1 / a[k][k]. */
static void sweep_unknown(int n, double *a, int k, double inverse)
{
    double column[DENSE];
    for (int i = 0; i < n; i++)
        column[i] = i < k ? a[k * DENSE + i] : a[i * DENSE + k];
    for (int i = 0; i < n; i++) {
        double l = column[i] * inverse;
        for (int j = 0; j <= i && i != k; j++)
            a[i * DENSE + j] -= l * column[j];
    }
    for (int i = 0; i < k; i++)
        a[k * DENSE + i] = column[i] * inverse;
    for (int i = k + 1; i < n; i++)
        a[i * DENSE + k] = column[i] * inverse;
    a[k * DENSE + k] = -inverse;
}

/* Inverts a symmetric matrix in place. A pivot that is only rounding error
 * counts as having the inverse 0, and its unknown is not swept. */
static void invert_matrix(int n, double *a)
{
    double inverse[DENSE], trace = 0;
    for (int k = 0; k < n; k++)
        trace += a[k * DENSE + k];
    for (int k = 0; k < n; k++) {
        double d = a[k * DENSE + k];
        inverse[k] = d > 0x1p-40 * trace ? 1 / d : 0;
        if (inverse[k] != 0)
            sweep_unknown(n, a, k, inverse[k]);
    }
    for (int i = 0; i < n; i++)
        for (int j = 0; j <= i; j++)
            a[i * DENSE + j] = a[j * DENSE + i] =
                inverse[i] != 0 && inverse[j] != 0 ? -a[i * DENSE + j] : 0;
}

void coarsest_invert(const struct coarsest *s)
{
    coarsest_fill(s);
    invert_matrix(3 * (int)s->count, s->dense);
}

void coarsest_solve(const struct coarsest *s, const vec *b, vec *z)
{
    int n = 3 * (int)s->count;
    double x[DENSE] = {0}, y[DENSE] = {0};
    for (int64_t p = 0; p < s->count; p++) {
        x[3 * p] = (double)b[p].x;
        x[3 * p + 1] = (double)b[p].y;
        x[3 * p + 2] = (double)b[p].z;
    }
    for (int i = 0; i < n; i++)
        for (int k = 0; k < n; k++)
            y[i] += s->dense[i * DENSE + k] * x[k];
    for (int64_t p = 0; p < s->count; p++)
        z[p] = vec_make((real)y[3 * p], (real)y[3 * p + 1], (real)y[3 * p + 2]);
}
