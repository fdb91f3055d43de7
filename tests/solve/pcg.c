/* SPDX-License-Identifier: Apache-2.0 */
/* Stage pcg: generator, properties, and tests. spec/solve/pcg.md */
#include "ref/solve/pcg.h"

#include <stdlib.h>

#include "ref/base/threads.h"
#include "tests/solve/solver.h"

const struct field fields_pcg[] = {IN(pcg, mass, count, 1),
                                   IN(pcg, extra, n_extra, 1),
                                   IN(pcg, block, n_blocks, 1),
                                   IN(pcg, packed, n_packed, 1),
                                   IN(pcg, fixed, count, 1),
                                   IN(pcg, b, count, 1),
                                   IN(pcg, z, n_z, 1),
                                   SCRATCH(pcg, cdf, n_cdf, 1),
                                   SCRATCH(pcg, diagonal, count, 1),
                                   SCRATCH(pcg, factor, count, 1),
                                   SCRATCH(pcg, low, count, 1),
                                   SCRATCH(pcg, r, count, 1),
                                   SCRATCH(pcg, s, count, 1),
                                   SCRATCH(pcg, p, count, 1),
                                   SCRATCH(pcg, q, count, 1),
                                   SCRATCH(pcg, chunk, n_chunks, 1),
                                   SCRATCH(pcg, grid.parts, grid.n_parts, 1),
                                   SCRATCH(pcg, grid.pool, grid.n_pool, 1),
                                   SCRATCH(pcg, grid.room, grid.n_room, 1),
                                   SCRATCH(pcg, grid.live, grid.n_live, 1),
                                   SCRATCH(pcg, grid.dense, grid.n_dense, 1),
                                   OUT(pcg, dv, count, 1),
                                   OUT_VALUE(pcg, iterations),
                                   OUT_VALUE(pcg, outcome),
                                   OUT_VALUE(pcg, fell_back),
                                   OUT_VALUE(pcg, recurrence),
                                   OUT_VALUE(pcg, residual),
                                   OUT_VALUE(pcg, scale),
                                   OUT_VALUE(pcg, square),
                                   FIELD_END};

void gen_pcg(struct bytes *b, struct pcg *s)
{
    struct system a;
    pick_system(b, &a);
    s->precond = pick(b, 2) ? DRAPE_MULTIGRID : DRAPE_JACOBI;
    s->form = pick(b, 2) ? DRAPE_CDF : DRAPE_COMPACT;
    s->tolerance = pick(b, 2) ? R(1e-3) : 0;
    s->max_iterations = (int32_t)pick(b, 40);
    s->energy = !pick(b, 4);
    solver_give(s, &a);
    if (pick(b, 2)) {
        vec *z = take(b, a.count, sizeof *z);
        for (int64_t p = 0; p < a.count; p++)
            z[p] = pick_vec(b, 1);
        s->n_z = a.count;
        s->z = z;
    }
    if (s->energy && pick(b, 2))
        s->scale = s->square = pick_uniform(b, 0, 10);
}

static bool same(const void *a, const void *b, size_t bytes)
{
    return !memcmp(a, b, bytes);
}

const char *prop_pcg(const struct pcg *s)
{
    bool right = true;
    for (int64_t p = 0; p < s->count; p++) {
        vec zero = {0, 0, 0}, z = s->n_z ? s->z[p] : zero;
        if (s->fixed[p])
            right &= same(&s->dv[p], &z, sizeof z);
    }
    EXPECT(right); /* §1 */
    EXPECT(s->iterations >= 0 && s->iterations <= s->max_iterations);
    if (s->outcome == PCG_CONVERGED) /* §4, §4.1 */
        EXPECT((s->energy ? s->recurrence : s->residual) <= s->tolerance ||
               s->iterations == 0);
    if (s->outcome == PCG_LIMIT)
        EXPECT(s->iterations == s->max_iterations);
    EXPECT(s->outcome >= PCG_CONVERGED && s->outcome <= PCG_BREAKDOWN);
    return NULL;
}

static void *room(int64_t count, size_t size)
{
    return calloc((size_t)count + 1, size);
}

/* Cholesky factorisation in place of the dense matrix, whose fixed rows are
 * rows of I. Returns false if the matrix is not positive definite. */
static bool cholesky(double *a, int64_t n)
{
    for (int64_t j = 0; j < n; j++) {
        for (int64_t k = 0; k < j; k++)
            for (int64_t i = j; i < n; i++)
                a[i * n + j] -= a[i * n + k] * a[j * n + k];
        if (!(a[j * n + j] > 0))
            return false;
        double d = sqrt(a[j * n + j]);
        for (int64_t i = j; i < n; i++)
            a[i * n + j] /= d;
    }
    return true;
}

static void solve_dense(const double *l, int64_t n, double *x)
{
    for (int64_t i = 0; i < n; i++) {
        for (int64_t k = 0; k < i; k++)
            x[i] -= l[i * n + k] * x[k];
        x[i] /= l[i * n + i];
    }
    for (int64_t i = n - 1; i >= 0; i--) {
        for (int64_t k = i + 1; k < n; k++)
            x[i] -= l[k * n + i] * x[k];
        x[i] /= l[i * n + i];
    }
}

static double part(vec a, int64_t r)
{
    return (double)(r == 0 ? a.x : r == 1 ? a.y : a.z);
}

/* Fills the dense matrix of the free particles and its right-hand side. */
static void fill_dense(const struct system *a, const struct pcg *s, double *l,
                       double *x)
{
    int64_t n = 3 * a->count;
    for (int64_t r = 0; r < n; r++) {
        vec zero = {0, 0, 0};
        x[r] = a->fixed[r / 3] ? 0 : part(a->b[r / 3], r % 3);
        for (int64_t c = 0; c < n; c++) {
            mat e = dense_entry(a, r / 3, c / 3);
            double v = part(*(&e.x + r % 3), c % 3);
            bool fixed = a->fixed[r / 3] || a->fixed[c / 3];
            l[r * n + c] = fixed ? (r == c ? 1 : 0) : v;
            if (!a->fixed[r / 3] && a->fixed[c / 3])
                x[r] -= v * part(s->n_z ? s->z[c / 3] : zero, c % 3);
        }
    }
}

/* §4: |dv - A⁻¹b| ≤ |A⁻¹| |residual|, where 1/|A⁻¹| is at least the smallest
 * free mass. */
static const char *expect_solution(const struct system *a, const struct pcg *s)
{
    int64_t n = 3 * a->count;
    double *l = room(n * n, sizeof *l), *x = room(n, sizeof *x);
    fill_dense(a, s, l, x);
    double size = 0, error = 0, mass = 1;
    for (int64_t r = 0; r < n; r++)
        size += x[r] * x[r];
    bool positive = cholesky(l, n);
    solve_dense(l, n, x);
    for (int64_t r = 0; r < n; r++) {
        double e = part(s->dv[r / 3], r % 3) - x[r];
        error += a->fixed[r / 3] ? 0 : e * e;
        if (!a->fixed[r / 3] && (double)a->mass[r / 3] < mass)
            mass = (double)a->mass[r / 3];
    }
    free(l);
    free(x);
    EXPECT(positive);
    EXPECT(s->outcome == PCG_CONVERGED);
    EXPECT(sqrt(error) <= 1.01 * (double)s->tolerance * sqrt(size) / mass);
    return NULL;
}

const char *test_pcg_dense(void)
{
    for (int k = 0; k < 24; k++) {
        struct system a;
        struct design d = {4 + k % 3,
                           3 + k % 4,
                           (enum shape)(k % SHAPES),
                           k % 2 ? TRIM_HOLE | TRIM_CUT | TRIM_PINS : 0,
                           0.1,
                           k / 8 % 2};
        make_system(&d, &a);
        struct pcg s = {.precond = k / 4 % 2 ? DRAPE_MULTIGRID : DRAPE_JACOBI,
                        .form = k % 4 < 2 ? DRAPE_CDF : DRAPE_COMPACT,
                        .tolerance = REAL_BITS == 32 ? R(1e-4) : R(1e-9),
                        .max_iterations = 1000};
        vec *z = room(a.count, sizeof *z);
        for (int64_t p = 0; p < a.count; p++)
            z[p] = vec_make((real)noise_of((uint64_t)p), R(0.5), 0);
        solver_open(&s, &a);
        s.z = z;
        s.n_z = k % 3 ? s.count : 0;
        int status = ref_pcg(&s);
        const char *failed = expect_solution(&a, &s);
        if (!failed)
            failed = prop_pcg(&s);
        solver_close(&s);
        free(z);
        free_system(&a);
        EXPECT(status == DRAPE_OK);
        if (failed)
            return failed;
        ran(1);
    }
    return NULL;
}

/* §4 and §5: a solve that does not converge, or meets a NaN, ends with the
 * outcome that says so. */
const char *test_pcg_outcomes(void)
{
    struct system a;
    struct design d = {31, 17, SHAPE_DRAPED, TRIM_PINS, 0.1, DRAPE_TRIPLES};
    make_system(&d, &a);
    struct pcg s = {.precond = DRAPE_JACOBI,
                    .form = DRAPE_COMPACT,
                    .tolerance = R(1e-3),
                    .max_iterations = 3};
    solver_open(&s, &a);
    bool limit = ref_pcg(&s) == DRAPE_OK && s.outcome == PCG_LIMIT &&
                 s.iterations == 3 && s.residual > s.tolerance;
    s.max_iterations = 1000;
    bool good = ref_pcg(&s) == DRAPE_OK && s.outcome == PCG_CONVERGED;
    s.tolerance = 0;
    bool stalls = ref_pcg(&s) == DRAPE_OK &&
                  (s.outcome == PCG_STALLED || s.outcome == PCG_LIMIT ||
                   s.outcome == PCG_BREAKDOWN);
    s.tolerance = R(1e-3);
    real keep = a.block[40].xx;
    a.block[40].xx = R(0.0) / (a.block[40].xx - a.block[40].xx);
    bool nan_block = ref_pcg(&s) == DRAPE_OK && s.outcome == PCG_BREAKDOWN;
    a.block[40].xx = -1000;
    bool indefinite = ref_pcg(&s) == DRAPE_OK && s.outcome != PCG_CONVERGED;
    a.block[40].xx = keep;
    a.b[9].y = R(1) / R(0.0);
    bool infinite = ref_pcg(&s) == DRAPE_OK && s.outcome == PCG_BREAKDOWN;
    s.tolerance = -1;
    bool refused = ref_pcg(&s) == DRAPE_EARG;
    solver_close(&s);
    free_system(&a);
    EXPECT(limit);
    EXPECT(good);
    EXPECT(stalls);
    EXPECT(nan_block);
    EXPECT(indefinite);
    EXPECT(infinite);
    EXPECT(refused);
    ran(7);
    return NULL;
}

/* Two cloths that are solved alternately do not influence each other, nor does
 * the number of threads influence them. */
const char *test_pcg_repeats(void)
{
    struct system a[2];
    struct pcg s[2] = {{0}};
    uint64_t hash[2][2];
    struct threads threads;
    for (int c = 0; c < 2; c++) {
        struct design d = {
            c ? 40 : 90,           71,  c ? SHAPE_DRAPED : SHAPE_WRINKLED,
            TRIM_HOLE | TRIM_PINS, 0.1, c};
        make_system(&d, &a[c]);
        s[c].precond = DRAPE_MULTIGRID;
        s[c].form = c ? DRAPE_CDF : DRAPE_COMPACT;
        s[c].tolerance = R(1e-3);
        s[c].max_iterations = 50;
        solver_open(&s[c], &a[c]);
    }
    for (int k = 0; k < 4; k++) {
        threads_begin(&threads, 1 + k / 2);
        ref_pcg(&s[k % 2]);
        threads_end(&threads);
        hash[k % 2][k / 2] = hash_bytes(HASH_START, s[k % 2].dv,
                                        (size_t)s[k % 2].count * sizeof(vec));
    }
    for (int c = 0; c < 2; c++) {
        solver_close(&s[c]);
        free_system(&a[c]);
        EXPECT(s[c].outcome == PCG_CONVERGED);
        EXPECT(hash[c][1] == hash[c][0]);
        ran(2);
    }
    return NULL;
}
