/* SPDX-License-Identifier: Apache-2.0 */
/* Preconditioned conjugate gradients. spec/solve/pcg.md */
#include "gpu/solve/pcg_kernels.cuh"

#include "gpu/run/loop.cuh"
#include "gpu/solve/direction.cuh"
#include "gpu/solve/jacobi.cuh"
#include "gpu/solve/level.cuh"

/* Iterations of a turn, in a loop rings of directions, as each turn begins with
 * the first: of multigrid more than one where a look takes longer than what
 * would be queued for nothing. */
enum {
    TURN = 8,
    TURN_MOST = 32,
    TURN_GRID = 4,
    TURN_LOOP = 2,
    SMALL_GRID = 1 << 17
};

static_assert(TURN % (int)RING == 0 && TURN_MOST % (int)RING == 0, "turns");
static_assert(sizeof(struct course) <= GPU_WORDS * sizeof(int64_t), "words");

/* Where pcg_set_up's stages run. */
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

int gpu_pcg_set_up(struct gpu *g, struct pcg *s)
{
    static const struct pcg_stages stages = {matrix, jacobi, multigrid};
    struct on to = {g, s};
    int status = pcg_set_up(s, &stages, &to);
    LAUNCH(g, s->count, pcg_start_kernel, *s);
    return status;
}

/* q = A to, to = s + β p. */
static void multiply(struct gpu *g, const struct pcg *s, struct mixed m,
                     struct image e, const struct room *room, const int32_t *go)
{
    const sym *extra = s->n_extra ? s->extra : NULL;
    struct grid grid = {s->m, s->n};
    struct rates r = room->rates;
    struct product a = {s->m, s->n, s->count, s->mass, s->n_extra, s->extra,
                        0,    NULL, s->n_cdf, s->cdf,  e.p,        s->q};
    if (s->n_cdf) {
        LAUNCH(g, s->count, pcg_direction_kernel, m, e.p, s->count);
        LAUNCH(g, s->count, pcg_product_kernel, a, cdf_of(s->m, s->n), e, go);
    } else if (r.of) {
        ties<struct rate> t = {grid, s->mass, extra, NULL, r.of};
        march<SPRINGS>(g, t, grounded<struct mixed>{m, r.x}, e, go);
    } else {
        ties<sym> t = {grid, s->mass, extra, NULL, s->block};
        product_of<SPRINGS>(g, t, m, e, go);
    }
}

/* to = s + β p, q = A to, and the sum of to·q. */
static void search(struct gpu *g, struct pcg *s, struct course *c,
                   struct room room, const vec *p, vec *to)
{
    struct mixed m = {s->s, p, c};
    struct image e = {s->fixed, to, s->q, room.item};
    multiply(g, s, m, e, &room, &c->go);
    LAUNCH_BLOCKS(g, item_blocks(s->count), SUM_CHUNK, pcg_sum_kernel, *s, c,
                  room, true);
}

/* Whether steps wait for the last of a ring: where bytes are what takes time,
 * not launches. */
static bool steps_wait(const struct pcg *s)
{
    return !s->n_cdf && marches(grid{s->m, s->n});
}

/* Iteration k of all that are queued. */
static void iterate(struct gpu *g, struct pcg *s, struct course *c,
                    struct room room, int k)
{
    int turn = k % room.ring;
    vec *p = room.p[(turn + room.ring - 1) % room.ring], *to = room.p[turn];
    if (!room.jacobi) {
        gpu_multigrid_cycle(g, &s->grid, lent_by(s), &c->go, room.item);
        LAUNCH_BLOCKS(g, item_blocks(s->count), SUM_CHUNK, pcg_sum_kernel, *s,
                      c, room, false);
    }
    search(g, s, c, room, p, to);
    bool waits = steps_wait(s) && turn + 1 < room.ring;
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
    if (steps_wait(s))
        LAUNCH(g, s->count, pcg_settle_kernel, *s, c, room);
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
    struct rates rates;
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
    key->rates = room->rates;
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

bool gpu_rates_help(const struct gpu *g, const struct pcg *s)
{
    return g->bulk && s->solver == DRAPE_EXACT && s->form == DRAPE_COMPACT &&
           s->precond == DRAPE_JACOBI && marches(grid{s->m, s->n});
}

int gpu_pcg(struct gpu *g, struct pcg *s)
{
    return gpu_pcg_by_rates(g, s, rates{});
}

/* Room for the sums and for directions: where the matrix is compact p changes
 * places, as neighbours read the last one, and where they wait, Jacobi's, which
 * has many, in a ring. false if there is none. */
static bool lay_out(struct gpu *g, const struct pcg *s, struct room *room)
{
    int64_t sums = 2 * s->n_chunks, count = s->count;
    room->jacobi = s->precond == DRAPE_JACOBI;
    room->ring = s->n_cdf ? 1 : room->jacobi && steps_wait(s) ? (int)RING : 2;
    bool lent = room->ring > 1 && lies_before(s);
    int64_t vecs = room->ring - 1 - lent, all = sums + (1 + 3 * vecs) * count;
    room->chunk = (real *)gpu_scratch(g, SLOT_SOLVE, all, sizeof(real));
    if (!room->chunk)
        return false;
    if (!room->jacobi)
        room->opening = gpu_multigrid_opening(&s->grid);
    room->item = room->chunk + sums;
    vec *more = (vec *)(room->item + count);
    room->p[0] = s->p;
    for (int k = 1; k < room->ring; k++)
        room->p[k] =
            k == 1 && lent ? s->q + count : more + (k - 1 - lent) * count;
    return true;
}

int gpu_pcg_by_rates(struct gpu *g, struct pcg *s, struct rates r)
{
    int status = pcg_open(s);
    if (status != DRAPE_OK)
        return status;
    if (s->solver != DRAPE_EXACT)
        return gpu_pcg_compare(g, s);
    struct course c = {};
    c.from = s->scale; /* where there is nothing to solve */
    c.most = s->square;
    struct room room = {};
    room.rates = r;
    if (s->count > 0 && lay_out(g, s, &room)) {
        c = solve(g, s, room, &status);
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
