/* SPDX-License-Identifier: Apache-2.0 */
/* A step that fails, at whatever point, leaves the state as it was; repeated,
 * it gives the bits of a step that never failed. A slice that contact leads
 * beyond all numbers is taken again. spec/world/step.md §7 */
#include <limits.h>

#include "ref/world/checkpoint.h"
#include "ref/world/collide.h"
#include "ref/world/state.h"
#include "ref/world/step.h"
#include "tests/solve/system.h"
#include "tests/world/slab.h"

enum { SIDE = 12, BEFORE = 5 };

/* The number of calls of the world's functions that succeed before all fail. */
static int left;
/* The reference, but for functions that fail then. */
static struct backend failing;

/* Queries of the response find a position out of range, this many times. */
static int out_of_range;

static int broad_spoilt(void *user, const uint8_t *touched, struct pairs *out)
{
    return out_of_range-- > 0 ? DRAPE_EDATA : collide_broad(user, touched, out);
}

static int broad(void *user, const uint8_t *touched, struct pairs *out)
{
    return left-- > 0 ? broad_spoilt(user, touched, out) : DRAPE_ENOMEM;
}

static int coulomb(struct gpu *on, struct coulomb *s)
{
    return left-- > 0 ? backend_ref.coulomb(on, s) : DRAPE_ENOMEM;
}

static int joint(struct world *w, struct joint *s)
{
    return left-- > 0 ? backend_ref.joint_solve(w, s) : DRAPE_ENOMEM;
}

static int retain(struct gpu *on, struct retain *s)
{
    return left-- > 0 ? backend_ref.retain(on, s) : DRAPE_ENOMEM;
}

static void make_failing(struct world *w)
{
    failing = backend_ref;
    failing.coulomb = coulomb;
    failing.joint_solve = joint;
    failing.retain = retain;
    w->run = &failing;
    w->response.broad = broad;
}

/* Makes a sheet that rests on a slab; the slab strikes it after BEFORE steps.
 */
static struct world *make_struck(int integrator, struct arena *arena)
{
    static double way[3][3], time[3], v[SIDE * SIDE][3];
    struct slab d;
    struct world *w;
    drape_error error;
    slab_make(&d, integrator);
    d.def.dt = integrator < DRAPE_BW ? 0x1p-9 : 0x1p-6;
    way[2][1] = integrator < DRAPE_BW ? 0.75 : 3;
    time[1] = BEFORE * d.def.dt;
    time[2] = 3 * time[1];
    d.motion =
        (drape_motion){3, time, (const double(*)[3])way, NULL, {0, 0, 0}};
    d.cloth.m = d.cloth.n = SIDE;
    d.cloth.width = d.cloth.height = (SIDE - 1) / 64.0;
    d.cloth.origin[0] = d.cloth.origin[2] = -0.0625;
    d.cloth.origin[1] = 0.1035;
    for (int p = 0; p < SIDE * SIDE; p++)
        v[p][0] = 0.1 * noise_of((uint64_t)p);
    d.cloth.velocity = (const double(*)[3])v;
    arena_init(arena, &d.def.allocator);
    return world_make(&d.def, arena, &w, &error) == DRAPE_OK ? w : NULL;
}

static int hash_written(void *user, const void *data, size_t bytes)
{
    uint64_t *hash = user;
    *hash = hash_bytes(*hash, data, bytes);
    return 0;
}

static uint64_t state(const struct world *w)
{
    uint64_t hash = HASH_START;
    return checkpoint_save(w, hash_written, &hash) == DRAPE_OK ? hash : 0;
}

/* Makes one step of b over and over, each time failing one call later, until it
 * succeeds; it must then equal the step of a. */
static const char *fail_step(struct world *a, struct world *b, int *later)
{
    drape_step_report r, again;
    uint64_t before = state(b);
    int status = DRAPE_ENOMEM;
    out_of_range = 1; /* a first slice is taken again, as two: §7.5 */
    EXPECT(before && before == state(a));
    EXPECT(step_advance(a, &r) == DRAPE_OK);
    for (int calls = 0; status != DRAPE_OK; calls++) {
        EXPECT(calls < 400);
        left = calls;
        out_of_range = 1;
        status = step_advance(b, &again);
        EXPECT(status == DRAPE_OK || status == DRAPE_ENOMEM);
        EXPECT(status == DRAPE_OK || state(b) == before);
        *later += status != DRAPE_OK && b->slicing.done > 0;
        ran(1);
    }
    EXPECT(state(b) == state(a));
    EXPECT(again.slices == r.slices && again.outcome == r.outcome);
    EXPECT(again.iterations == r.iterations && again.step == r.step);
    return NULL;
}

const char *test_world_aborts(void)
{
    static const int some[] = {DRAPE_VERLET, DRAPE_BW, DRAPE_CK};
    for (int k = 0; k < 3; k++) {
        struct arena arena[2];
        struct world *a = make_struck(some[k], &arena[0]);
        struct world *b = make_struck(some[k], &arena[1]);
        const char *failed = NULL;
        int later = 0;
        EXPECT(a && b);
        make_failing(b);
        a->response.broad = broad_spoilt;
        for (int step = 0; step < 2 * BEFORE && !failed; step++)
            failed = fail_step(a, b, &later);
        arena_free(&arena[0]);
        arena_free(&arena[1]);
        if (failed)
            return failed;
        EXPECT(later > 0); /* some step failed half-way */
    }
    return NULL;
}

/* Makes a step in which contact leads `times` slices beyond all numbers. */
static drape_step_report spoil(struct world *w, int times)
{
    drape_step_report r;
    w->response.broad = broad_spoilt;
    out_of_range = times;
    r.step = step_advance(w, &r) == DRAPE_OK ? r.step : -1;
    out_of_range = 0;
    return r;
}

/* step.md §3.3, §7.5: a slice that contact leads beyond all numbers is taken
 * again at half the length. If no shorter slice is left the step has diverged,
 * and the state stays. */
static const char *check_spoilt(struct world *w)
{
    for (int step = 1; step <= 2 * BEFORE; step++) {
        int times = step % 4;
        uint64_t before = state(w);
        drape_step_report r = spoil(w, times);
        EXPECT(r.step == step && state(w) != before);
        EXPECT(!(r.outcome & DRAPE_DIVERGED));
        EXPECT(r.slices >= 1 << times && r.work.tries >= r.slices + times);
        ran(1);
    }
    uint64_t before = state(w);
    drape_step_report r = spoil(w, INT_MAX);
    EXPECT(r.outcome & DRAPE_DIVERGED && r.step == 2 * BEFORE);
    EXPECT(state(w) == before && r.work.tries == 1 + w->slicing.deepest);
    ran(1);
    return NULL;
}

const char *test_world_spoilt(void)
{
    static const int some[] = {DRAPE_VERLET, DRAPE_BW, DRAPE_CK, DRAPE_BDF2};
    const char *failed = NULL;
    for (int k = 0; k < 4 && !failed; k++) {
        struct arena arena;
        struct world *w = make_struck(some[k], &arena);
        failed = w ? check_spoilt(w) : "no world";
        arena_free(&arena);
    }
    return failed;
}
