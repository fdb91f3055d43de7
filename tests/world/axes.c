/* SPDX-License-Identifier: Apache-2.0 */
/* The solver treats all axes alike: a problem on a line or in a plane has the
 * same bits along whichever axes it lies. Where multigrid breaks down, Jacobi
 * continues. spec/solve/pcg.md §3, §5 */
#include "tests/solve/solver.h"

enum { M = 19, N = 15 };

/* The two axes of a plane, or the one axis of a line, ascending. A sum of three
 * numbers does not depend on where a 0 stands among them, but it does depend on
 * the order of the others; so the order of the axes is kept. */
static const int lies[5][2] = {{0, 1}, {0, 2}, {0, -1}, {1, -1}, {2, -1}};

static vec turned(vec a, int k)
{
    real r[3] = {0, 0, 0};
    r[lies[k][0]] = a.x;
    if (lies[k][1] >= 0)
        r[lies[k][1]] = a.y;
    return vec_make(r[0], r[1], r[2]);
}

/* Block a with its xx, and in a plane xy and yy, at the axes of case k; the
 * other diagonal entries are zz. */
static sym turned_block(sym a, int k)
{
    real r[3][3] = {{a.zz, 0, 0}, {0, a.zz, 0}, {0, 0, a.zz}};
    int p = lies[k][0], q = lies[k][1];
    r[p][p] = a.xx;
    if (q >= 0) {
        r[p][q] = r[q][p] = a.xy;
        r[q][q] = a.yy;
    }
    return (sym){r[0][0], r[0][1], r[0][2], r[1][1], r[1][2], r[2][2]};
}

static void make_turned(struct system *a, int k)
{
    struct design d = {
        M, N, SHAPE_WRINKLED, TRIM_HOLE | TRIM_PINS, 0.1, DRAPE_TRIPLES};
    make_system(&d, a);
    for (int64_t i = 0; i < a->n_blocks; i++)
        a->block[i] = turned_block(a->block[i], k);
    for (int64_t i = 0; i < a->count; i++) {
        vec b = vec_make(a->b[i].y, a->b[i].x, 0); /* gravity on the line */
        a->b[i] = turned(b, k);
    }
}

/* Solves to a tolerance at which binary32 needs restarts. Returns the number of
 * iterations, or -1. */
static int solve_turned(int k, int precond, int form, vec *dv)
{
    struct system a;
    make_turned(&a, k);
    struct pcg s = {.precond = precond,
                    .form = form,
                    .tolerance = REAL_BITS == 32 ? R(1e-6) : R(1e-13),
                    .max_iterations = 400};
    solver_open(&s, &a);
    s.n_packed = s.grid.n_packed = 0; /* thin directions are rounded by axis */
    int status = ref_pcg(&s);
    memcpy(dv, s.dv, (size_t)a.count * sizeof *dv);
    solver_close(&s);
    free_system(&a);
    return status == DRAPE_OK ? s.iterations : -1;
}

static const char *compare(int precond, int form)
{
    static vec dv[5][M * N];
    int iterations[5];
    for (int k = 0; k < 5; k++)
        iterations[k] = solve_turned(k, precond, form, dv[k]);
    for (int k = 0; k < 5; k++) {
        int first = k < 2 ? 0 : 2;
        EXPECT(iterations[k] > 2 && iterations[k] == iterations[first]);
        for (int p = 0; p < M * N; p++) {
            vec a = dv[first][p], want = turned(a, k), is = dv[k][p];
            EXPECT(is.x == want.x && is.y == want.y && is.z == want.z);
        }
    }
    ran(1);
    return NULL;
}

const char *test_pcg_axes(void)
{
    const char *failed = NULL;
    for (int k = 0; k < 4 && !failed; k++)
        failed = compare(k & 1 ? DRAPE_MULTIGRID : DRAPE_JACOBI,
                         k & 2 ? DRAPE_CDF : DRAPE_COMPACT);
    return failed;
}

/* Gives springs a negative stiffness that the masses outweigh: A is positive
 * definite, but the smoother of multigrid does not converge. */
static void make_pushing(struct system *a, real push)
{
    const sym block = {-push, 0, 0, -push, 0, -push};
    struct design d = {24, 24, SHAPE_FLAT, TRIM_NONE, 0, DRAPE_SPRINGS};
    make_system(&d, a);
    for (int64_t i = 0; i < a->count; i++) {
        a->mass[i] = 1;
        a->b[i] = vec_make(1, (real)noise_of((uint64_t)i), 2);
        for (int o = 0; o < SPRINGS; o++)
            if (a->cloth.springs[i] >> o & 1)
                a->block[o * a->count + i] = block;
    }
}

/* §5: where multigrid breaks down, Jacobi continues and converges. */
const char *test_pcg_falls_back(void)
{
    for (int k = 22; k <= 24; k += 2) {
        struct system a;
        make_pushing(&a, 1 / (real)k);
        struct pcg s = {.precond = DRAPE_MULTIGRID,
                        .form = DRAPE_COMPACT,
                        .tolerance = R(1e-4),
                        .max_iterations = 500};
        solver_open(&s, &a);
        s.n_packed = s.grid.n_packed = 0;
        int status = ref_pcg(&s);
        solver_close(&s);
        free_system(&a);
        EXPECT(status == DRAPE_OK && s.fell_back == (k == 22));
        EXPECT(s.outcome == PCG_CONVERGED && s.residual <= s.tolerance);
        ran(1);
    }
    return NULL;
}
