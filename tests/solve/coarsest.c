/* SPDX-License-Identifier: Apache-2.0 */
/* The inverse of the coarsest grid's operator. spec/solve/multigrid.md §5 */
#include "ref/solve/coarsest.h"

#include <math.h>
#include <stdlib.h>

#include "ref/solve/coarsen.h"
#include "tests/solve/system.h"

/* What a particle of a case is: it has mass and edges; or no edges and so
 * little mass that it counts as rounding error, or that it just does not. */
enum { WHOLE, GONE, LIGHT };

static const struct {
    int32_t m, n;
    int kind[COARSEST];
} cases[] = {{4, 4, {WHOLE}},
             {5, 3, {WHOLE}},
             {2, 8, {WHOLE, GONE, WHOLE, WHOLE, WHOLE, WHOLE, GONE}},
             {3, 3, {GONE, WHOLE, WHOLE, WHOLE, LIGHT, WHOLE}},
             {1, 1, {WHOLE}}};

/* A block u uᵀ + I/4, times 1 to 2. */
static sym random_block(uint64_t seed)
{
    double u[3], f = 1.5 + noise_of(seed) / 2;
    for (int k = 0; k < 3; k++)
        u[k] = noise_of(seed + 1 + (uint64_t)k);
    return (sym){
        (real)(f * (u[0] * u[0] + 0.25)), (real)(f * u[0] * u[1]),
        (real)(f * u[0] * u[2]),          (real)(f * (u[1] * u[1] + 0.25)),
        (real)(f * u[1] * u[2]),          (real)(f * (u[2] * u[2] + 0.25))};
}

static double part(sym b, int r, int c)
{
    double a[3][3] = {{(double)b.xx, (double)b.xy, (double)b.xz},
                      {(double)b.xy, (double)b.yy, (double)b.yz},
                      {(double)b.xz, (double)b.yz, (double)b.zz}};
    return a[r][c];
}

/* The operator: an edge between p and q has (x_p - x_q)ᵀ B (x_p - x_q). */
static void add_edge(double a[DENSE][DENSE], int64_t p, int64_t q, sym b)
{
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 3; c++) {
            double e = part(b, r, c);
            a[3 * p + r][3 * p + c] += e;
            a[3 * q + r][3 * q + c] += e;
            a[3 * p + r][3 * q + c] -= e;
            a[3 * q + r][3 * p + c] -= e;
        }
}

/* Fills the edges of a case, and adds them to its operator. */
static void fill_edges(int k, const struct coarsest *s, sym *block,
                       double a[DENSE][DENSE])
{
    const int *kind = cases[k].kind;
    sym none = {0, 0, 0, 0, 0, 0};
    for (int64_t p = 0; p < s->count; p++)
        for (int o = 0; o < STENCIL; o++) {
            int64_t i = p % s->m + stencil_di[o], j = p / s->m + stencil_dj[o];
            int64_t q = i + s->m * j;
            sym *b = &block[o * s->count + p];
            *b = none;
            if (i < 0 || i >= s->m || j >= s->n || kind[p] || kind[q])
                continue;
            *b = random_block((uint64_t)(100 * k + 16 * p + o));
            add_edge(a, p, q, *b);
        }
}

/* Fills the masses: a light particle's is twice the bound of §5, and half of it
 * where a particle is gone. */
static void fill_excess(int k, const struct coarsest *s, sym *excess,
                        double a[DENSE][DENSE])
{
    double trace = 0;
    for (int i = 0; i < 3 * (int)s->count; i++)
        trace += a[i][i] + (cases[k].kind[i / 3] == WHOLE);
    for (int64_t p = 0; p < s->count; p++) {
        int kind = cases[k].kind[p];
        double light = trace * (kind == LIGHT ? 0x1p-39 : 0x1p-41);
        real mass = kind == WHOLE ? 1 : (real)light;
        excess[p] = (sym){mass, 0, 0, mass, 0, mass};
        for (int r = 0; r < 3; r++)
            a[3 * p + r][3 * p + r] += (double)mass;
    }
}

/* The operator has a condition of at most some hundreds, but for light
 * particles, whose unknowns nothing else touches: with 48 unknowns the entries
 * of A X are right to 1e-12. */
static const char *check_inverse(const struct coarsest *s, const int *kind,
                                 double a[DENSE][DENSE])
{
    int n = 3 * (int)s->count;
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++) {
            double sum = 0, entry = s->dense[i * DENSE + j];
            bool gone = kind[i / 3] == GONE || kind[j / 3] == GONE;
            for (int k = 0; k < n; k++)
                sum += a[i][k] * s->dense[k * DENSE + j];
            EXPECT(entry == s->dense[j * DENSE + i]);
            EXPECT(gone ? entry == 0 : fabs(sum - (i == j)) <= 1e-12);
        }
    return NULL;
}

static const char *check_solution(const struct coarsest *s)
{
    vec b[COARSEST] = {{0, 0, 0}}, z[COARSEST] = {{0, 0, 0}};
    int n = 3 * (int)s->count;
    for (int64_t p = 0; p < s->count; p++)
        b[p] = vec_make((real)noise_of((uint64_t)p), R(1.0),
                        (real)noise_of((uint64_t)p + 50));
    coarsest_solve(s, b, z);
    for (int i = 0; i < n; i++) {
        double sum = 0, size = 0;
        for (int k = 0; k < n; k++) {
            double term =
                s->dense[i * DENSE + k] * (double)(&b[k / 3].x)[k % 3];
            sum += term;
            size += fabs(term);
        }
        double got = (double)(&z[i / 3].x)[i % 3];
        EXPECT(fabs(got - sum) <=
               (REAL_BITS == 32 ? 0x1p-24 : 0x1p-53) * fabs(sum) +
                   1e-14 * size);
    }
    return NULL;
}

const char *test_coarsest_inverse(void)
{
    const char *failed = NULL;
    for (int k = 0; k < (int)(sizeof cases / sizeof cases[0]) && !failed; k++) {
        static double a[DENSE][DENSE], dense[DENSE * DENSE];
        static sym excess[COARSEST], block[STENCIL * COARSEST];
        struct coarsest s = {.dense = dense};
        for (int e = 0; e < DENSE * DENSE; e++)
            a[e / DENSE][e % DENSE] = 0;
        s.m = cases[k].m;
        s.n = cases[k].n;
        s.count = (int64_t)s.m * s.n;
        s.excess = excess;
        s.block = block;
        fill_edges(k, &s, block, a);
        fill_excess(k, &s, excess, a);
        coarsest_invert(&s);
        failed = check_inverse(&s, cases[k].kind, a);
        failed = failed ? failed : check_solution(&s);
        ran(1);
    }
    return failed;
}
