/* SPDX-License-Identifier: Apache-2.0 */
/* The device as a backend: its table of functions, which queue launches and
 * wait only for counts and outcomes. ref/base/backend.h, spec/gpu.md §6 */
#include "gpu/broad/refit.cuh"
#include "gpu/run/batch.cuh"

extern "C" {
#include "gpu/contact/queue.h"
#include "gpu/run/backend.h"
#include "ref/broad/extent.h"
}

/* A pool that need not outlast a solve is borrowed from the solvers' memory. */
static int grow_pool(struct gpu *g, struct pool *pool, enum arena_part part,
                     int64_t need, size_t size, bool kept)
{
    int64_t cap = gpu_capacity(g, need);
    gpu_give(g, pool->data);
    pool->data =
        kept ? gpu_take(g, part, cap, size) : gpu_borrow(g, part, cap, size);
    pool->cap = pool->data ? cap : 0;
    return gpu_status(g);
}

static void begin_work(struct gpu *g)
{
    gpu_begin(g);
    if (g->together)
        gpu_batch_step(g);
}

static void wait_for_work(struct gpu *g)
{
    if (!g->together) /* else only others' time would be measured */
        gpu_wait(g);
}

/* Bad contacts set a late word, which the readback of the next solve brings:
 * gpu/world/systems.cu. */
static int coulomb(struct gpu *g, struct coulomb *s)
{
    return gpu_coulomb_queue(g, s, gpu_queue_words(g));
}

static int carry(struct gpu *g, struct carry *s)
{
    return gpu_carry_queue(g, s, gpu_queue_words(g));
}

static int retain(struct gpu *g, struct retain *s)
{
    return gpu_retain_queue(g, s, gpu_queue_words(g));
}

/* The bounds are read on the host. */
static int extent(struct gpu *g, struct extent *s)
{
    struct extent there = *s;
    there.bounds = (struct mesh_bounds *)gpu_scratch(g, SLOT_STAGE, s->n_grid,
                                                     sizeof *s->bounds);
    int status = there.bounds ? gpu_extent(g, &there) : gpu_status(g);
    gpu_down(g, s->bounds, there.bounds, (size_t)s->n_grid * sizeof *s->bounds);
    return status == DRAPE_OK ? gpu_status(g) : status;
}

/* How it ended is read by gpu_broad_refitted. */
static int refit(struct gpu *g, struct refit *s)
{
    gpu_refit_queue(g, s, gpu_late_words(g));
    return DRAPE_OK;
}

/* Every stage is called as its tests call it, but for these. */
static constexpr struct backend make_table()
{
    struct backend run = {
        .take = gpu_take,
        .grow = grow_pool,
        .give = gpu_give,
        .copy = gpu_copy,
        .clear = gpu_clear,
        .send = gpu_up,
        .fetch = gpu_down,
        .pushes = 1, /* stored by vertex */
        .begin = begin_work,
        .wait = wait_for_work,
        .status = gpu_status,
        .trace = gpu_trace,
#define STAGE(room, file, X, rule) .X = gpu_##X,
#include "spec/stages.def"
#undef STAGE
#define CALL(result, name, ...) .name = gpu_##name,
#include "ref/base/backend.def"
#undef CALL
    };
    run.coulomb = coulomb;
    run.extent = extent;
    run.refit = refit;
    run.carry = carry;
    run.retain = retain;
    return run;
}

extern const struct backend backend_gpu = make_table();
