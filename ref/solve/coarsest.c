/* SPDX-License-Identifier: Apache-2.0 */
/* Solves the coarsest grid by a dense factorisation in binary64.
 * spec/solve/multigrid.md §5 */
#include "ref/solve/coarsest.h"

#include "ref/solve/coarsen.h"

static void put(double *a, int64_t p, int64_t q, sym b, double sign)
{
    double e[3][3] = {{(double)b.xx, (double)b.xy, (double)b.xz},
                      {(double)b.xy, (double)b.yy, (double)b.yz},
                      {(double)b.xz, (double)b.yz, (double)b.zz}};
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 3; c++)
            a[(3 * p + r) * DENSE + 3 * q + c] += sign * e[r][c];
}

static void fill(const struct coarsest *l, double *a)
{
    for (int k = 0; k < DENSE * DENSE; k++)
        a[k] = 0;
    for (int64_t p = 0; p < l->count; p++) {
        put(a, p, p, l->excess[p], 1);
        for (int o = 0; o < STENCIL; o++) {
            int64_t i = p % l->m + stencil_di[o], j = p / l->m + stencil_dj[o];
            int64_t q = i + l->m * j;
            if (i < 0 || i >= l->m || j >= l->n)
                continue;
            sym c = l->block[o * l->count + p];
            put(a, p, p, c, 1);
            put(a, q, q, c, 1);
            put(a, p, q, c, -1);
            put(a, q, p, c, -1);
        }
    }
}

/* Factors a = L D Lᵀ in place: L below the diagonal of a, 1/D in inverse. A
 * pivot that is only rounding error has 0 in inverse. */
static void factor(int n, double *a, double *inverse)
{
    double trace = 0;
    for (int k = 0; k < n; k++)
        trace += a[k * DENSE + k];
    for (int k = 0; k < n; k++) {
        double d = a[k * DENSE + k];
        inverse[k] = d > 0x1p-40 * trace ? 1 / d : 0;
        for (int i = k + 1; i < n; i++) {
            double l = a[i * DENSE + k] * inverse[k];
            for (int j = k + 1; j <= i; j++)
                a[i * DENSE + j] -= l * a[j * DENSE + k];
        }
        for (int i = k + 1; i < n; i++)
            a[i * DENSE + k] *= inverse[k];
    }
}

void coarsest_factor(const struct coarsest *s)
{
    fill(s, s->dense);
    factor(3 * (int)s->count, s->dense, s->dense + DENSE * DENSE);
}

void coarsest_solve(const struct coarsest *s, const vec *b, vec *z)
{
    int n = 3 * (int)s->count;
    const double *a = s->dense, *inverse = s->dense + DENSE * DENSE;
    double x[DENSE] = {0};
    for (int64_t p = 0; p < s->count; p++) {
        x[3 * p] = (double)b[p].x;
        x[3 * p + 1] = (double)b[p].y;
        x[3 * p + 2] = (double)b[p].z;
    }
    for (int k = 0; k < n; k++)
        for (int i = k + 1; i < n; i++)
            x[i] -= a[i * DENSE + k] * x[k];
    for (int k = 0; k < n; k++)
        x[k] *= inverse[k];
    for (int k = n - 1; k >= 0; k--)
        for (int i = 0; i < k; i++)
            x[i] -= a[k * DENSE + i] * x[k];
    for (int64_t p = 0; p < s->count; p++)
        z[p] = vec_make((real)x[3 * p], (real)x[3 * p + 1], (real)x[3 * p + 2]);
}
