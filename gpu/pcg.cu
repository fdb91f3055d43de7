/* SPDX-License-Identifier: Apache-2.0 */
/* Preconditioned conjugate gradients. spec/15_pcg.md */
#include "gpu/pcg_kernels.cuh"

#include "gpu/direction.cuh"
#include "gpu/jacobi.cuh"
#include "gpu/level.cuh"
#include "gpu/loop.cuh"

/* Iterations of a turn, an even number in a loop, as where it begins p does:
 * of multigrid more than one where a look takes longer than what would be
 * queued for nothing. */
enum {
    TURN = 8,
    TURN_MOST = 32,
    TURN_GRID = 4,
    TURN_LOOP = 2,
    SMALL_GRID = 1 << 17
};

static_assert(sizeof(struct course) <= GPU_WORDS * sizeof(int64_t), "words");

/* What multigrid shares. */
static void share(struct pcg *s)
{
    s->grid.mass = s->mass;
    s->grid.n_extra = s->n_extra;
    s->grid.extra = s->extra;
    s->grid.block = s->block;
    s->grid.n_thin = s->n_thin;
    s->grid.thin = s->thin;
    s->grid.fixed = s->fixed;
    s->grid.factor = s->factor;
    s->grid.r = s->r;
    s->grid.z = s->s;
}

static int build(struct gpu *g, struct pcg *s)
{
    struct matrix a = {s->m,       s->n,        s->count,    s->mass,
                       s->n_extra, s->extra,    s->n_blocks, s->block,
                       s->n_cdf,   s->diagonal, s->cdf};
    struct jacobi j = {s->m,       s->n,     s->count,    s->mass,
                       s->n_extra, s->extra, s->n_blocks, s->block,
                       s->n_thin,  s->thin,  s->fixed,    s->factor};
    int status = s->n_cdf ? gpu_matrix(g, &a) : DRAPE_OK;
    if (status == DRAPE_OK)
        status = gpu_jacobi(g, &j);
    if (status != DRAPE_OK || s->precond != DRAPE_MULTIGRID)
        return status;
    return gpu_multigrid_build(g, &s->grid, lent_by(s));
}

int gpu_pcg_set_up(struct gpu *g, struct pcg *s)
{
    int status = build(g, s);
    LAUNCH(g, s->count, pcg_start_kernel, *s);
    return status;
}

/* to = s + β p, q = A to, and the sum of to·q. */
static void multiply(struct gpu *g, struct pcg *s, struct course *c,
                     struct room room, const vec *p, vec *to)
{
    struct mixed m = {s->s, p, c};
    struct image e = {s->fixed, to, s->q, room.item};
    ties<sym> t = {
        {s->m, s->n}, s->mass, s->n_extra ? s->extra : NULL, NULL, s->block};
    struct product a = {s->m, s->n, s->count, s->mass, s->n_extra, s->extra,
                        0,    NULL, s->n_cdf, s->cdf,  to,         s->q};
    if (s->n_cdf) {
        LAUNCH(g, s->count, pcg_direction_kernel, m, to, s->count);
        LAUNCH(g, s->count, pcg_product_kernel, a, cdf_of(s->m, s->n), e,
               &c->go);
    } else
        march<SPRINGS>(g, t, m, e, &c->go);
    LAUNCH_BLOCKS(g, item_blocks(s->count), SUM_CHUNK, pcg_sum_kernel, *s, c,
                  room, true);
}

/* Whether every second step waits for the next: where bytes are what takes
 * time, not launches. */
static bool pairs_steps(const struct pcg *s)
{
    return !s->n_cdf && marches(grid{s->m, s->n});
}

/* Iteration k of all that are queued: where the matrix is compact p changes
 * places, as neighbours read the last one. */
static void iterate(struct gpu *g, struct pcg *s, struct course *c,
                    struct room room, int k)
{
    vec *p = s->p, *to = s->p;
    if (!s->n_cdf && k % 2)
        to = room.other;
    else if (!s->n_cdf)
        p = room.other;
    if (!room.jacobi) {
        gpu_multigrid_cycle(g, &s->grid, lent_by(s), &c->go, room.item);
        LAUNCH_BLOCKS(g, item_blocks(s->count), SUM_CHUNK, pcg_sum_kernel, *s,
                      c, room, false);
    }
    multiply(g, s, c, room, p, to);
    bool waits = pairs_steps(s) && to == s->p;
    int64_t blocks = UPDATES * g->crowd;
    LAUNCH_BLOCKS(g, blocks < s->n_chunks ? blocks : s->n_chunks, SUM_CHUNK,
                  pcg_update_kernel, *s, c, room, waits ? NULL : to);
}

/* Queues iterations, of all so far from `queued` on, and the residual. */
static void take_turn(struct gpu *g, struct pcg *s, struct course *c,
                      struct room room, int queued, int iterations)
{
    if (room.jacobi)
        LAUNCH_BLOCKS(g, s->n_chunks, SUM_CHUNK, pcg_jacobi_kernel, *s, c,
                      room);
    for (int k = 0; k < iterations; k++)
        iterate(g, s, c, room, queued + k);
    if (pairs_steps(s))
        LAUNCH(g, s->count, pcg_settle_kernel, *s, c);
    LAUNCH_BLOCKS(g, s->n_chunks, SUM_CHUNK, pcg_residual_kernel, *s, c, room);
}

/* The matrix, M and the first residual. */
static int prepare(struct gpu *g, struct pcg *s, struct course *c,
                   struct room room)
{
    int status = gpu_pcg_set_up(g, s);
    LAUNCH_BLOCKS(g, s->n_chunks, SUM_CHUNK, pcg_residual_kernel, *s, c, room);
    return status;
}

/* What the launches of a solve depend on. */
struct solve_key {
    struct pcg s;
    struct course *c;
    real *chunk;
    int32_t loop; /* 0: what leads to a loop and its first turn */
};

static void write_key(struct solve_key *key, const struct pcg *s,
                      struct course *c, const struct room *room)
{
    memset((void *)key, 0, sizeof *key); /* what lies between, too */
    memcpy((void *)&key->s, (const void *)s, sizeof key->s);
    key->s.scale = key->s.square = 0; /* not read there, as these */
    key->s.recurrence = key->s.residual = 0;
    key->s.iterations = key->s.outcome = key->s.fell_back = 0;
    key->s.z = s->n_z ? s->z : NULL;
    key->c = c;
    key->chunk = room->chunk;
}

static struct course look(struct gpu *g)
{
    struct course seen;
    int words = (int)((sizeof seen + sizeof(int64_t) - 1) / sizeof(int64_t));
    memcpy((void *)&seen, gpu_look_words(g, words), sizeof seen);
    return seen;
}

/* All up to the end of the first turn, queued as one where that can be. */
static int first_turn(struct gpu *g, struct pcg *s, struct course *c,
                      struct room room, int iterations)
{
    struct solve_key key;
    auto launch = [&] {
        int status = prepare(g, s, c, room);
        take_turn(g, s, c, room, 0, iterations);
        return status;
    };
    write_key(&key, s, c, &room);
    LAUNCH(g, 1, pcg_open_kernel, c, s->scale, s->square);
    return gpu_loop(g, loop_key{&key, sizeof key}, NULL, launch) ? (int)DRAPE_OK
                                                                 : launch();
}

/* Turns in a loop on the device, until they end or the host is to look. */
static bool loop(struct gpu *g, struct pcg *s, struct course *c,
                 struct room room)
{
    struct solve_key key;
    auto launch = [&] {
        take_turn(g, s, c, room, 0,
                  room.jacobi ? (int)TURN_MOST : (int)TURN_LOOP);
        return (int)DRAPE_OK;
    };
    write_key(&key, s, c, &room);
    key.loop = 1;
    return gpu_loop(g, loop_key{&key, sizeof key}, &c->again, launch);
}

/* Iterates until one, or the residual behind it, ends it; the host looks after
 * the first turn, and after each where the device has no loops, or multigrid
 * gave up. */
static struct course solve(struct gpu *g, struct pcg *s, struct room room,
                           int *status)
{
    struct course *c = (struct course *)gpu_words(g), seen = {};
    bool small = s->count <= SMALL_GRID;
    int queued = room.jacobi ? TURN : small ? TURN_GRID : TURN_LOOP;
    *status = first_turn(g, s, c, room, queued);
    if (*status == DRAPE_OK)
        seen = look(g);
    if (*status == DRAPE_OK && seen.again && loop(g, s, c, room))
        seen = look(g);
    while (*status == DRAPE_OK && seen.phase != PHASE_DONE) {
        room.jacobi = s->precond == DRAPE_JACOBI || seen.fell_back;
        int grids = small ? TURN_GRID : 1;
        int iterations = room.jacobi ? TURN_MOST : grids;
        take_turn(g, s, c, room, queued, iterations);
        queued += iterations;
        seen = look(g);
        if (gpu_status(g) != DRAPE_OK)
            break;
    }
    return seen;
}

int gpu_pcg(struct gpu *g, struct pcg *s)
{
    if (s->n_chunks != sum_chunks(s->count) || !(s->tolerance >= 0) ||
        s->max_iterations < 0 || (s->n_z && s->n_z != s->count) ||
        s->precond < DRAPE_JACOBI || s->precond > DRAPE_MULTIGRID ||
        s->form < DRAPE_CDF || s->form > DRAPE_COMPACT)
        return DRAPE_EARG;
    share(s);
    if (s->solver == DRAPE_CUBLAS)
        return gpu_cublas(g, s);
    int status = DRAPE_OK;
    struct course c = {};
    c.from = s->scale; /* where there is nothing to solve */
    c.most = s->square;
    int64_t sums = 2 * s->n_chunks;
    bool lent = s->n_cdf || lies_before(s);
    int64_t all = sums + (lent ? 1 : 4) * s->count;
    real *scratch = (real *)gpu_scratch(g, SLOT_SOLVE, all, sizeof *scratch);
    if (s->count > 0 && scratch) {
        bool jacobi = s->precond == DRAPE_JACOBI;
        struct opening opening = {};
        if (!jacobi)
            opening = gpu_multigrid_opening(&s->grid);
        real *item = scratch + sums;
        vec *other = lent ? s->q + s->count : (vec *)(item + s->count);
        c = solve(g, s, room{scratch, item, other, jacobi, opening}, &status);
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
