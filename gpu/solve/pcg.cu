/* SPDX-License-Identifier: Apache-2.0 */
/* Preconditioned conjugate gradients: the host queues the kernels, and the
 * device decides when the iteration ends. spec/solve/pcg.md, spec/gpu.md §9 */
#include "gpu/solve/pcg_kernels.cuh"

#include "gpu/run/loop.cuh"

/* Iterations that are queued between two readbacks or two tests of a loop:
 * Jacobi's first chunk and later ones, multigrid's on small grids and in a
 * loop. Multiples of RING, as each chunk begins with the first direction of the
 * ring. On a small grid a readback takes longer than iterations that turn out
 * to be superfluous. */
enum {
    CHUNK = 8,
    CHUNK_MOST = 32,
    CHUNK_GRID = 4,
    CHUNK_LOOP = 2,
    SMALL_GRID = 1 << 17
};

static_assert(CHUNK % (int)RING == 0 && CHUNK_MOST % (int)RING == 0, "chunks");
static_assert(sizeof(struct pcg_state) <= GPU_WORDS * sizeof(int64_t), "words");

/* §3: to = s + β p, q = A to, and the sum of to·q. */
static void search(struct gpu *g, struct pcg *s, struct pcg_state *c,
                   struct scratch scratch, const vec *p, vec *to)
{
    gpu_pcg_search(g, s, {c, scratch.rate, p, to, scratch.item});
    LAUNCH_BLOCKS(g, item_blocks(s->count), SUM_CHUNK, pcg_sum_kernel, *s, c,
                  scratch, true);
}

/* Queues iteration k of the solve. Where products sweep, memory traffic and not
 * launches takes the time; dv is then updated only with the last of a ring. */
static void iterate(struct gpu *g, struct pcg *s, struct pcg_state *c,
                    struct scratch scratch, int k)
{
    int place = k % scratch.ring;
    vec *p = scratch.p[(place + scratch.ring - 1) % scratch.ring],
        *to = scratch.p[place];
    if (!scratch.jacobi) {
        gpu_multigrid_cycle(g, &s->grid, lent_by(s), &c->go, scratch.item);
        LAUNCH_BLOCKS(g, item_blocks(s->count), SUM_CHUNK, pcg_sum_kernel, *s,
                      c, scratch, false);
    }
    search(g, s, c, scratch, p, to);
    bool waits = gpu_pcg_sweeps(s) && place + 1 < scratch.ring;
    int64_t blocks = UPDATES * g->multiprocessors;
    LAUNCH_AT_ONCE(g, blocks < s->n_chunks ? blocks : s->n_chunks, SUM_CHUNK,
                   UPDATES, pcg_update_kernel, *s, c, scratch,
                   waits ? NULL : to);
}

/* Queues a chunk: iterations, which are numbered from `queued` on, then the
 * true residual. */
static void queue_chunk(struct gpu *g, struct pcg *s, struct pcg_state *c,
                        struct scratch scratch, int queued, int iterations)
{
    if (scratch.jacobi)
        LAUNCH_BLOCKS(g, s->n_chunks, SUM_CHUNK, pcg_jacobi_kernel, *s, c,
                      scratch);
    for (int k = 0; k < iterations; k++)
        iterate(g, s, c, scratch, queued + k);
    if (gpu_pcg_sweeps(s))
        LAUNCH(g, s->count, pcg_settle_kernel, *s, c, scratch);
    LAUNCH_BLOCKS(g, s->n_chunks, SUM_CHUNK, pcg_residual_kernel, *s, c,
                  scratch);
}

/* Queues the matrix, M and the first residual. */
static int prepare(struct gpu *g, struct pcg *s, struct pcg_state *c,
                   struct scratch scratch)
{
    int status = gpu_pcg_set_up(g, s);
    LAUNCH_BLOCKS(g, s->n_chunks, SUM_CHUNK, pcg_residual_kernel, *s, c,
                  scratch);
    return status;
}

/* Everything that the launches of a solve depend on: the key of its graph. */
struct solve_key {
    struct pcg s;
    struct pcg_state *c;
    real *chunk;
    const struct rate *rate;
};

static void write_key(struct solve_key *key, const struct pcg *s,
                      struct pcg_state *c, const struct scratch *scratch)
{
    memset((void *)key, 0, sizeof *key); /* padding, too */
    memcpy((void *)&key->s, (const void *)s, sizeof key->s);
    key->s.scale = key->s.square =
        0; /* kernels of the graph do not read these */
    key->s.recurrence = key->s.residual = 0;
    key->s.iterations = key->s.outcome = key->s.fell_back = 0;
    key->s.z = s->n_z ? s->z : NULL;
    key->c = c;
    key->chunk = scratch->chunk;
    key->rate = scratch->rate;
}

static struct pcg_state read_state(struct gpu *g)
{
    struct pcg_state seen;
    int words = (int)((sizeof seen + sizeof(int64_t) - 1) / sizeof(int64_t));
    memcpy((void *)&seen, gpu_read_back_keep(g, words), sizeof seen);
    return seen;
}

/* Queues the first chunk, and then chunks as a loop on the device until the
 * solve has ended or the host must decide; or the first chunk alone, if the
 * device has no such loop. */
static int queue(struct gpu *g, struct pcg *s, struct pcg_state *c,
                 struct scratch scratch, int iterations)
{
    struct solve_key key;
    auto first = [&] {
        int status = prepare(g, s, c, scratch);
        queue_chunk(g, s, c, scratch, 0, iterations);
        return status;
    };
    auto body = [&] {
        queue_chunk(g, s, c, scratch, 0,
                    scratch.jacobi ? (int)CHUNK_MOST : (int)CHUNK_LOOP);
        return (int)DRAPE_OK;
    };
    write_key(&key, s, c, &scratch);
    LAUNCH(g, 1, pcg_open_kernel, c, s->scale, s->square);
    return gpu_loop(g, loop_key{&key, sizeof key}, {&c->again, first, body, {}})
               ? (int)DRAPE_OK
               : first();
}

/* Runs the solve to its end. The host reads the state back, and again after
 * each chunk if the device has no loops or multigrid gave up. */
static struct pcg_state solve(struct gpu *g, struct pcg *s,
                              struct scratch scratch, int *status)
{
    struct pcg_state *c = (struct pcg_state *)gpu_words(g), seen = {};
    bool small = s->count <= SMALL_GRID;
    int queued = scratch.jacobi ? CHUNK : small ? CHUNK_GRID : CHUNK_LOOP;
    *status = queue(g, s, c, scratch, queued);
    if (*status == DRAPE_OK)
        seen = read_state(g);
    while (*status == DRAPE_OK && seen.phase != PHASE_DONE) {
        scratch.jacobi = s->precond == DRAPE_JACOBI || seen.fell_back;
        int grids = small ? CHUNK_GRID : 1;
        int iterations = scratch.jacobi ? CHUNK_MOST : grids;
        queue_chunk(g, s, c, scratch, queued, iterations);
        queued += iterations;
        seen = read_state(g);
        if (gpu_status(g) != DRAPE_OK)
            break;
    }
    return seen;
}

int gpu_pcg(struct gpu *g, struct pcg *s)
{
    return gpu_pcg_by_rates(g, s, NULL);
}

/* Lays out scratch for sums and directions. With a compact matrix the next
 * direction is written to another stream, as neighbours still read the last
 * one; with Jacobi, which takes many iterations, and products that sweep, there
 * is a ring of RING streams. False if there is no memory. */
static bool lay_out(struct gpu *g, const struct pcg *s, struct scratch *scratch)
{
    int64_t sums = 2 * s->n_chunks, count = s->count;
    scratch->jacobi = s->precond == DRAPE_JACOBI;
    scratch->ring = s->n_cdf                               ? 1
                    : scratch->jacobi && gpu_pcg_sweeps(s) ? (int)RING
                                                           : 2;
    bool lent = scratch->ring > 1 && lies_before(s);
    int64_t vecs = scratch->ring - 1 - lent,
            all = sums + (1 + 3 * vecs) * count;
    scratch->chunk = (real *)gpu_scratch(g, SLOT_SOLVE, all, sizeof(real));
    if (!scratch->chunk)
        return false;
    if (!scratch->jacobi)
        scratch->opening = gpu_multigrid_opening(&s->grid);
    scratch->item = scratch->chunk + sums;
    vec *more = (vec *)(scratch->item + count);
    scratch->p[0] = s->p;
    for (int k = 1; k < scratch->ring; k++)
        scratch->p[k] =
            k == 1 && lent ? s->q + count : more + (k - 1 - lent) * count;
    return true;
}

int gpu_pcg_by_rates(struct gpu *g, struct pcg *s, const struct rate *rate)
{
    int status = pcg_open(s);
    if (status != DRAPE_OK)
        return status;
    if (s->solver != DRAPE_EXACT)
        return gpu_pcg_compare(g, s);
    struct pcg_state c = {};
    c.from = s->scale; /* the result if there is nothing to solve */
    c.most = s->square;
    struct scratch scratch = {};
    scratch.rate = rate;
    if (s->count > 0 && lay_out(g, s, &scratch)) {
        c = solve(g, s, scratch, &status);
    } else {
        status = gpu_pcg_set_up(g, s);
    }
    s->iterations = c.iterations;
    s->outcome = c.outcome;
    s->fell_back = c.fell_back;
    s->scale = s->energy ? c.from : s->scale;
    s->square = s->energy ? c.most : s->square;
    s->recurrence = c.recurrence;
    s->residual = c.residual;
    return status == DRAPE_OK ? gpu_status(g) : status;
}
