/* SPDX-License-Identifier: Apache-2.0 */
/* Whole solves on the device, compared with the reference and timed.
 * spec/solve/pcg.md */
#include <stdio.h>
#include <stdlib.h>

#include "gpu/cloth/rate.h"
#include "gpu/compare/blas.h"
#include "ref/base/clock.h"
#include "ref/base/sum.h"
#include "tests/base/modes.h"
#include "tests/solve/solver.h"

/* RUNS: repeats of a timing, of which the shortest counts. SHORT: iterations of
 * Jacobi to compare, as a whole solve by the reference takes minutes. */
enum { RUNS = 5, SHORT = 20 };

/* Allocates a stream on the device and copies `host` there, unless NULL. */
static void *put(struct gpu *g, const void *host, int64_t n, size_t size)
{
    void *p = gpu_take(g, ARENA_OTHER, n, size);
    if (p && host)
        gpu_up(g, p, host, (size_t)n * size);
    return p;
}

/* Returns a copy of s with streams of its own on the device, laid out as in a
 * world. */
static struct pcg on_device(struct gpu *g, const struct pcg *s)
{
    struct pcg d = *s;
    int64_t lent = s->grid.n_pool ? s->count : 0;
    d.mass = put(g, s->mass, s->count, sizeof *s->mass);
    d.extra = put(g, s->extra, s->n_extra, sizeof *s->extra);
    d.block = put(g, s->block, s->n_blocks, sizeof *s->block);
    d.packed = put(g, s->packed, s->n_packed, sizeof *s->packed);
    d.fixed = put(g, s->fixed, s->count, 1);
    d.b = put(g, s->b, s->count, sizeof *s->b);
    d.cdf = put(g, NULL, s->n_cdf, sizeof *s->cdf);
    d.diagonal = put(g, NULL, s->count, sizeof *s->diagonal);
    d.factor = put(g, NULL, s->count, sizeof *s->factor);
    d.low = put(g, NULL, s->count, sizeof *s->low);
    d.r = put(g, NULL, s->count, sizeof *s->r);
    d.s = put(g, NULL, s->count, sizeof *s->s);
    d.p = put(g, NULL, 3 * s->count, sizeof *s->p);
    d.q = d.p + s->count;
    d.chunk = put(g, NULL, s->n_chunks, sizeof *s->chunk);
    d.grid.pool = put(g, NULL, s->grid.n_pool - lent, sizeof *s->grid.pool);
    d.grid.room = put(g, NULL, s->grid.n_room, sizeof *s->grid.room);
    d.grid.live = put(g, NULL, s->grid.n_live, sizeof *s->grid.live);
    d.grid.dense = put(g, NULL, s->grid.n_dense, sizeof *s->grid.dense);
    d.dv = put(g, NULL, s->count, sizeof *s->dv);
    return d;
}

/* Makes the rates of a's springs on the device, if a solve there reads rates in
 * place of blocks; else returns none. */
static const struct rate *rates_of(struct gpu *g, const struct system *a,
                                   const struct pcg *d)
{
    struct blocks b = blocks_of(a);
    if (!gpu_rates_help(g, d))
        return NULL;
    b.law = put(g, b.law, SPRINGS, sizeof *b.law);
    b.piece = put(g, b.piece, b.pieces, sizeof *b.piece);
    b.springs = put(g, b.springs, a->count, sizeof *b.springs);
    b.triple = put(g, b.triple, b.triples, sizeof *b.triple);
    b.beside = put(g, b.beside, b.n_beside, sizeof *b.beside);
    b.x = put(g, a->x, a->count, sizeof *a->x);
    b.block = put(g, NULL, SPRINGS * a->count, sizeof *b.block);
    b.n_packed = 0;
    struct rate *rate = put(g, NULL, SPRINGS * a->count, sizeof *rate);
    gpu_blocks_and_rates(g, &b, rate);
    return rate;
}

static bool same_result(struct gpu *g, const struct pcg *s, const struct pcg *d)
{
    size_t bytes = (size_t)s->count * sizeof *s->dv;
    vec *dv = malloc(bytes + 1);
    if (!dv)
        return false;
    gpu_down(g, dv, d->dv, bytes);
    bool same = !memcmp(dv, s->dv, bytes) && s->iterations == d->iterations &&
                s->outcome == d->outcome && s->fell_back == d->fell_back &&
                s->recurrence == d->recurrence && s->residual == d->residual;
    free(dv);
    return same && gpu_status(g) == DRAPE_OK;
}

/* Makes a pinned, draped cloth of n × n particles for both sides, to be solved
 * to 1e-3 in at most `most` iterations. With a trim, contacts hold it, too. */
static void open_both(struct gpu *g, int32_t n, int trim, int precond,
                      int32_t most, struct system *a, struct pcg *s,
                      struct pcg *d)
{
    struct design design = {
        n, n, SHAPE_DRAPED, TRIM_PINS | trim, 0, DRAPE_TRIPLES};
    make_system(&design, a);
    if (trim != TRIM_NONE)
        hold_system(a, 8);
    *s = (struct pcg){.precond = precond,
                      .form = DRAPE_COMPACT,
                      .tolerance = R(1e-3),
                      .max_iterations = most};
    solver_open(s, a);
    *d = on_device(g, s);
}

/* Returns the shortest time, s, of RUNS solves. */
static double timed(struct gpu *g, struct pcg *d, const struct rate *r)
{
    double least = HUGE_VAL;
    for (int k = 0; k < RUNS; k++) {
        gpu_clock_start(g);
        gpu_pcg_by_rates(g, d, r);
        double t = gpu_clock_stop(g);
        least = t < least ? t : least;
    }
    return least;
}

/* Prints the rest of a line: the reference's time an iteration, and whether
 * both results have the same bits. */
static void compare_bits(struct gpu *g, struct pcg *s, struct pcg *d,
                         const struct rate *r)
{
    s->max_iterations = s->precond == DRAPE_JACOBI ? SHORT : d->max_iterations;
    d->max_iterations = s->max_iterations;
    gpu_pcg_by_rates(g, d, r);
    double start = clock_now();
    ref_pcg(s);
    printf(",%.4g,%s", 1e3 * (clock_now() - start) / s->iterations,
           same_result(g, s, d) ? "same" : "DIFFERENT");
}

/* Prints one line of the benchmark. set_up is the time of a solve of 0
 * iterations. */
static void bench_one(int32_t n, int precond, int solver)
{
    int status;
    struct gpu *g = gpu_open(NULL, &status);
    struct system a;
    struct pcg s, d;
    bool jacobi = precond == DRAPE_JACOBI;
    if (solver == DRAPE_CUBLAS && blas_open(g) != DRAPE_OK) {
        puts("no cuBLAS here");
        gpu_close(g);
        return;
    }
    open_both(g, n, TRIM_NONE, precond, 0, &a, &s, &d);
    d.solver = solver;
    const struct rate *r = rates_of(g, &a, &d);
    double set_up = timed(g, &d, r);
    d.max_iterations = 5000;
    double all = timed(g, &d, r);
    printf("%d,%d,%s,%s,%d,%.3g,%.4g,%.4g,%.4g", REAL_BITS, n,
           jacobi ? "jacobi" : "multigrid",
           solver == DRAPE_CUBLAS ? "cublas" : "exact", d.iterations,
           (double)d.residual, 1e3 * all, 1e3 * set_up,
           1e6 * (all - set_up) / d.iterations);
    if (solver == DRAPE_EXACT)
        compare_bits(g, &s, &d, r);
    puts("");
    fflush(stdout);
    solver_close(&s);
    free_system(&a);
    gpu_close(g);
}

/* Times solves of 20 thousand, 500 thousand and 2 million triangles; only the
 * first on an emulated device. */
void bench_solve(void)
{
    static const int32_t sizes[] = {101, 504, 1008};
    int status;
    struct gpu *g = gpu_open(NULL, &status);
    if (!g)
        return;
    int most = strncmp(gpu_name(g), "emulated", 8) ? 3 : 1;
    gpu_close(g);
    printf("bits,grid,precond,solver,iterations,residual,ms,of them set-up,"
           "us/iteration,reference ms/iteration,bits of dv\n");
    for (int k = 0; k < 4 * most; k++)
        bench_one(sizes[k / 4], k / 2 % 2 ? DRAPE_MULTIGRID : DRAPE_JACOBI,
                  k % 2 ? DRAPE_CUBLAS : DRAPE_EXACT);
}

/* Whether device and reference give the same bits for a draped cloth of n²
 * particles, both with blocks and with rates. An emulated device must have
 * rates for Jacobi. */
static bool agree(struct gpu *g, int32_t n, int trim, int precond)
{
    struct system a;
    struct pcg s, d;
    open_both(g, n, trim, precond, SHORT, &a, &s, &d);
    const struct rate *r = rates_of(g, &a, &d);
    bool rated = r || gpu_device(g) >= 0 || precond != DRAPE_JACOBI;
    bool good =
        rated && ref_pcg(&s) == gpu_pcg(g, &d) && same_result(g, &s, &d) &&
        gpu_pcg_by_rates(g, &d, r) == DRAPE_OK && same_result(g, &s, &d);
    solver_close(&s);
    free_system(&a);
    return good;
}

/* Both preconditioners, for cloths with and without a hole and a cut: 20
 * thousand triangles and, on a real device, 720 thousand, from which size on
 * kernels divide the cloth into strips and tiles. */
const char *test_solve_gpu(void)
{
    static const int32_t sizes[] = {101, 600};
    for (int k = 0; k < 8; k++) {
        int status, precond = k % 2 ? DRAPE_MULTIGRID : DRAPE_JACOBI;
        struct gpu *g = gpu_open(NULL, &status);
        if (!g)
            return skip("there is no device");
        if (k >= 4 && gpu_device(g) < 0) {
            gpu_close(g);
            break;
        }
        bool good =
            agree(g, sizes[k / 4], k / 2 % 2 ? TRIM_HOLE | TRIM_CUT : TRIM_NONE,
                  precond);
        gpu_close(g);
        EXPECT(good);
        ran(1);
    }
    return NULL;
}

/* The recurrence meets the tolerance in the last iteration that is allowed, but
 * the true residual often does not: CG restarts and ends at once. */
const char *test_solve_gpu_limits(void)
{
    enum { MOST = 12 };
    struct design design = {24,        24, SHAPE_WRINKLED,
                            TRIM_PINS, 0,  DRAPE_TRIPLES};
    int anew = 0;
    for (int32_t most = 1; most <= MOST; most++) {
        int status;
        struct gpu *g = gpu_open(NULL, &status);
        struct system a;
        if (!g)
            return skip("there is no device");
        make_system(&design, &a);
        struct pcg s = {.precond = DRAPE_MULTIGRID,
                        .form = DRAPE_COMPACT,
                        .max_iterations = most};
        solver_open(&s, &a);
        ref_pcg(&s);
        s.tolerance = s.recurrence;
        struct pcg d = on_device(g, &s);
        bool good = ref_pcg(&s) == gpu_pcg(g, &d) && same_result(g, &s, &d);
        anew += s.outcome == PCG_LIMIT;
        solver_close(&s);
        free_system(&a);
        gpu_close(g);
        EXPECT(good);
        ran(1);
    }
    EXPECT(anew > MOST / 4);
    return NULL;
}

/* Sums of n items by every order of emulated threads. */
static bool sums_alike(int64_t n)
{
    static const struct gpu_way ways[] = {
        {0}, {.descending = true}, {.shuffled = 5}};
    int status;
    struct gpu *g = gpu_open(NULL, &status);
    struct sum s = {.n = n, .n_chunks = sum_chunks(n)};
    real *a = malloc((size_t)s.n * sizeof *a);
    real *chunk = malloc((size_t)s.n_chunks * sizeof *chunk);
    for (int64_t k = 0; k < s.n; k++)
        a[k] = (real)noise_of((uint64_t)k);
    struct sum d = s;
    d.a = put(g, a, s.n, sizeof *a);
    s.a = a;
    s.chunk = chunk;
    bool good = ref_sum(&s) == DRAPE_OK;
    for (int k = 0; k < 3 && good; k++) {
        gpu_set_way(g, ways[k]);
        d.chunk = put(g, NULL, s.n_chunks, sizeof *chunk);
        good = gpu_sum(g, &d) == DRAPE_OK &&
               !memcmp(&s.value, &d.value, sizeof s.value);
    }
    gpu_set_way(g, (struct gpu_way){0});
    free(a);
    free(chunk);
    gpu_close(g);
    return good;
}

/* spec/base/sum.md §3: the level in shared memory has one chunk, two chunks, or
 * one more level before it than usual: more than 2^24 items, or 2^17 on an
 * emulated device. */
const char *test_sum_gpu_levels(void)
{
    int status;
    struct gpu *g = gpu_open(NULL, &status);
    if (!g)
        return skip("there is no device");
    int64_t most = gpu_device(g) < 0 ? 1 << 17 : 1 << 24;
    gpu_close(g);
    EXPECT(sums_alike(300) && sums_alike(65536 + 300) &&
           sums_alike(most + 300));
    ran(3);
    return NULL;
}

/* gpu.md §5: blocks of a kernel may run in any order, and one may wait between
 * two of its barriers while all others run: the solve has the same bits. There
 * are more particles than one block of pcg_sum_kernel sums. */
const char *test_solve_gpu_parked(void)
{
    struct design design = {51,        47,  SHAPE_DRAPED,
                            TRIM_PINS, 0.1, DRAPE_TRIPLES};
    for (int parked = 1; parked <= 2; parked++) {
        int status;
        struct gpu *g = gpu_open(NULL, &status);
        struct system a;
        if (!g)
            return skip("there is no device");
        make_system(&design, &a);
        struct pcg s = {.precond = DRAPE_MULTIGRID,
                        .form = DRAPE_COMPACT,
                        .tolerance = R(1e-3),
                        .max_iterations = 8};
        solver_open(&s, &a);
        struct pcg d = on_device(g, &s);
        gpu_set_way(g, (struct gpu_way){.hosted = true, .parked = parked});
        bool good = ref_pcg(&s) == gpu_pcg(g, &d) && same_result(g, &s, &d);
        solver_close(&s);
        free_system(&a);
        gpu_set_way(g, (struct gpu_way){0});
        gpu_close(g);
        EXPECT(good && s.iterations > 1);
        ran(1);
    }
    return NULL;
}

static double part(vec a, int64_t r)
{
    return (double)(r == 0 ? a.x : r == 1 ? a.y : a.z);
}

/* pcg.md §6: |b - A (dv + low)|, computed by the reference. */
static double left_over(const struct pcg *s, const vec *dv, const vec *low)
{
    vec *r = calloc((size_t)s->count + 1, sizeof *r);
    struct pcg a = *s;
    a.dv = (vec *)dv;
    a.low = (vec *)low;
    a.r = r;
    double sum = 0;
    residual_find(&a);
    for (int64_t k = 0; k < 3 * s->count; k++)
        sum += part(r[k / 3], k % 3) * part(r[k / 3], k % 3);
    free(r);
    return sqrt(sum);
}

/* pcg.md §6: checks the solution dv, low of cuBLAS's solver, and how far it is
 * from that of the reference, s->dv. zero [count]: zeros. */
static const char *expect_near(const struct pcg *s, const vec *dv,
                               const vec *low, const vec *zero)
{
    const double u = REAL_BITS == 32 ? 0x1p-24 : 0x1p-53;
    double sums = 6 * (double)s->count * u, slack = 1 + sums / (1 - sums);
    double b = left_over(s, zero, zero), tolerance = (double)s->tolerance;
    double size = 0, error = 0, mass = HUGE_VAL;
    for (int64_t k = 0; k < 3 * s->count; k++) {
        double x = part(dv[k / 3], k % 3), y = part(s->dv[k / 3], k % 3);
        double m = (double)s->mass[k / 3];
        size += x * x + y * y;
        error += (x - y) * (x - y);
        mass = !s->fixed[k / 3] && m < mass ? m : mass;
    }
    EXPECT(left_over(s, dv, low) <= slack * tolerance * b);
    EXPECT(sqrt(error) <=
           2 * slack * tolerance * b / mass + 2 * u * sqrt(size));
    EXPECT(size > 0);
    return NULL;
}

static const char *check_cublas(struct gpu *g, int precond, int form)
{
    struct system a;
    struct design design = {51,        47,  SHAPE_DRAPED,
                            TRIM_PINS, 0.1, DRAPE_TRIPLES};
    make_system(&design, &a);
    struct pcg s = {.precond = precond,
                    .form = form,
                    .tolerance = REAL_BITS == 32 ? R(1e-4) : R(1e-9),
                    .max_iterations = 2000};
    solver_open(&s, &a);
    struct pcg d = on_device(g, &s);
    d.solver = DRAPE_CUBLAS;
    size_t n = (size_t)s.count;
    vec *copy = calloc(3 * n + 1, sizeof *copy);
    bool good = ref_pcg(&s) == DRAPE_OK && gpu_pcg(g, &d) == DRAPE_OK &&
                s.outcome == PCG_CONVERGED && d.outcome == PCG_CONVERGED;
    gpu_down(g, copy, d.dv, n * sizeof *copy);
    gpu_down(g, copy + n, d.low, n * sizeof *copy);
    const char *failed = expect_near(&s, copy, copy + n, copy + 2 * n);
    free(copy);
    solver_close(&s);
    free_system(&a);
    EXPECT(good);
    return failed;
}

const char *test_cublas(void)
{
    for (int k = 0; k < 4; k++) {
        int status;
        struct gpu *g = gpu_open(NULL, &status);
        if (!g || blas_open(g) != DRAPE_OK) {
            gpu_close(g);
            return skip("there is no cuBLAS");
        }
        const char *failed =
            check_cublas(g, k % 2 ? DRAPE_MULTIGRID : DRAPE_JACOBI,
                         k / 2 ? DRAPE_COMPACT : DRAPE_CDF);
        gpu_close(g);
        if (failed)
            return failed;
        ran(1);
    }
    return NULL;
}
