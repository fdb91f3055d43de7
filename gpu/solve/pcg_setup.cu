/* SPDX-License-Identifier: Apache-2.0 */
/* Prepares a solve: the matrix, its preconditioner, and the start of dv.
 * spec/solve/pcg.md §1 */
#include "gpu/run/merge.cuh"
#include "gpu/solve/pcg.cuh"

extern "C" {
#include "ref/solve/jacobi.h"
}

/* §1. Thread k owns particle k: writes dv[k] and low[k]. */
KERNEL pcg_start_kernel(const struct pcg &s)
{
    ITEM(k, s.count);
    s.dv[k] = s.fixed[k] && s.n_z ? s.z[k] : make(0, 0, 0);
    s.low[k] = make(0, 0, 0);
}

/* The argument of the stages that pcg_set_up calls. */
struct on {
    struct gpu *g;
    const struct pcg *s;
};

static int matrix(void *to, struct matrix *s)
{
    return gpu_matrix(((struct on *)to)->g, s);
}

static int jacobi(void *to, struct jacobi *s)
{
    return gpu_jacobi(((struct on *)to)->g, s);
}

static int multigrid(void *to, struct multigrid *s)
{
    return gpu_multigrid_build(((struct on *)to)->g, s,
                               lent_by(((struct on *)to)->s));
}

int gpu_pcg_prepare(struct gpu *g, struct pcg *s)
{
    static const struct pcg_stages stages = {matrix, jacobi, multigrid};
    struct on to = {g, s};
    return pcg_set_up(s, &stages, &to);
}

int gpu_pcg_set_up(struct gpu *g, struct pcg *s)
{
    int status = gpu_pcg_prepare(g, s);
    MERGE(g, s->count, (*s), pcg_start_kernel);
    return status;
}
