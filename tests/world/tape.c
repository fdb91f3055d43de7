/* SPDX-License-Identifier: Apache-2.0 */
/* Steps as one graph: the same bits as without, wherever a tape ends, and that
 * there are some. spec/gpu.md §13 */
#include <stdio.h>
#include <stdlib.h>

#include "gpu/run/gpu.h"
#include "gpu/world/world.h"
#include "tests/api/guest.h"

/* STEPS: of a run, and DEVICE_STEPS on a device, which records later. */
enum { STEPS = 26, DEVICE_STEPS = 128, VERTICES = 256 };

/* How a scene differs from the guest's. */
struct variant {
    const char *name;
    int integrator, precond;
    bool moves, two, windy;
    bool pinned; /* at a corner that moves */
    bool taps;   /* the plate comes and goes, and nothing falls */
    bool uncut;  /* a step is one slice */
    bool fails;  /* no impulse is allowed, and a slice that needs one ends there
                    or not, as it may be cut once more or not */
    int looks;   /* of a step, or more; no multiple of 7 */
    int least;   /* steps that tapes do whole */
};

static const struct variant variants[] = {
    {"multigrid", DRAPE_BW, DRAPE_MULTIGRID, .uncut = true, .looks = 18,
     .least = 8},
    {"choi-ko, wind, a plate that moves", DRAPE_CK, DRAPE_JACOBI, .moves = true,
     .windy = true, .looks = 18, .least = 6},
    {"two sheets, rounds in each step", DRAPE_BW, DRAPE_JACOBI, .two = true,
     .looks = 31, .least = 4},
    {"a plate that taps", DRAPE_BW, DRAPE_JACOBI, .taps = true, .looks = 13,
     .least = 4},
    {"euler, a pin that moves", DRAPE_EULER, DRAPE_JACOBI, .moves = true,
     .pinned = true, .looks = 18, .least = 4},
    {"midpoint, two sheets, wind", DRAPE_MIDPOINT, DRAPE_JACOBI, .two = true,
     .windy = true, .looks = 18, .least = 4},
    {"verlet, a pin that moves", DRAPE_VERLET, DRAPE_JACOBI, .moves = true,
     .pinned = true, .looks = 18, .least = 4},
    {"no impulses", DRAPE_BW, DRAPE_JACOBI, .moves = true, .fails = true,
     .looks = 13, .least = 1},
    {"rk4, a pin that moves, wind", DRAPE_RK4, DRAPE_JACOBI, .moves = true,
     .windy = true, .pinned = true, .looks = 18, .least = 4},
};

/* A world, without the API around it, which does not show its device. */
struct run {
    struct guest s;
    drape_cloth cloth[2];
    drape_motion motion;
    drape_pin pin;
    bool device; /* there is one: of it a turn of substeps is longer */
    struct arena arena;
    const struct world_ops *ops;
    struct world *world;
    double x[VERTICES][3], v[VERTICES][3];
    drape_step_report report;
    int64_t graphs; /* in reports so far */
};

static const double times[2] = {0, 1}, path[2][3] = {{0}, {0.02, 0.005, 0}};

/* Every third step, so that contact begins and ends again and again. */
enum { TAPS = 44 };
static double tap_time[TAPS], tap[TAPS][3];

static void move_plate(struct run *r, const struct variant *a)
{
    r->motion = (drape_motion){.keys = 2, .time = times, .position = path};
    for (int k = 0; k < TAPS; k++) {
        tap_time[k] = k * (a->fails ? 1 : 3) * r->s.def.dt;
        tap[k][1] = a->fails ? 0.006 * (k * 7 % 5) : k % 2 ? 0.0015 : -0.002;
    }
    if (a->taps || a->fails) {
        r->motion.keys = TAPS;
        r->motion.time = tap_time;
        r->motion.position = (const double(*)[3])tap;
        r->s.def.gravity[1] = a->fails ? -30 : 0;
    }
    r->s.def.motions = &r->motion;
    r->s.def.n_motions = a->moves || a->taps;
    r->s.plate.motion = r->s.def.n_motions - 1;
}

static void define(struct run *r, const struct variant *a, int backend)
{
    drape_def *def = &r->s.def;
    guest_make(&r->s, backend);
    def->integrator = a->integrator;
    def->precond = a->precond;
    r->cloth[0] = r->cloth[1] = r->s.cloth;
    r->cloth[1].origin[1] = 0.006;
    def->cloths = r->cloth;
    def->n_cloths = 1 + a->two;
    if (a->uncut)
        def->max_slices = 1;
    if (a->fails)
        def->max_rounds = 0;
    if (a->integrator < DRAPE_BW) { /* few substeps, and contact at once */
        def->dt = r->device ? 7e-4 : 7e-5;
        r->cloth[0].origin[1] = 0.0019;
    }
    move_plate(r, a);
    r->pin = (drape_pin){0, 0, 0};
    r->cloth[0].pins = &r->pin;
    r->cloth[0].n_pins = a->pinned;
    if (a->windy)
        def->wind = (drape_wind){{0.2, 0, 0}, 1.2, 1, 0.5};
}

static const char *begin(struct run *r, const struct variant *a, int backend)
{
    define(r, a, backend);
    r->world = NULL;
    r->graphs = 0;
    r->ops = backend == DRAPE_GPU ? &world_ops_gpu : &world_ops;
    arena_init(&r->arena, &r->s.def.allocator);
    EXPECT(r->ops->make(&r->s.def, &r->arena, &r->world, NULL) == DRAPE_OK);
    EXPECT(r->world->nv <= VERTICES);
    return NULL;
}

static const char *step(struct run *r, const struct variant *a)
{
    int64_t k = r->world->step;
    if (a->fails) /* all else that the launches depend on stays */
        r->world->def.max_slices = k > 9 && k % 4 == 1 ? 2 : 4;
    EXPECT(r->ops->step(r->world, &r->report) == DRAPE_OK);
    memset(r->report.seconds, 0, sizeof r->report.seconds);
    r->graphs += r->report.graphs;
    r->report.graphs = 0;
    EXPECT(r->ops->read(r->world, r->x, r->v) == DRAPE_OK);
    return NULL;
}

static void end(struct run *r)
{
    if (r->world && r->ops->end)
        r->ops->end(r->world);
    arena_free(&r->arena);
}

/* Where the steps of the reference went. */
struct trail {
    int steps;
    double x[DEVICE_STEPS][VERTICES][3], v[DEVICE_STEPS][VERTICES][3];
    drape_step_report report[DEVICE_STEPS];
};

static const char *lead_way(struct run *r, const struct variant *a,
                            struct trail *t)
{
    const char *what = begin(r, a, DRAPE_REF);
    for (int k = 0; k < t->steps && !what; k++) {
        what = step(r, a);
        memcpy(t->x[k], r->x, sizeof r->x);
        memcpy(t->v[k], r->v, sizeof r->v);
        t->report[k] = r->report;
    }
    end(r);
    return what;
}

/* PLAIN: as it is; FALTERS: each step's tape ends at another look, or at this
 * one of all that there are, in other orders of threads; TIGHT: memory is short
 * in each step that has more, and where one is recorded; HOSTED: no tapes, and
 * loops that the host ends. */
enum how { PLAIN, FALTERS, TIGHT, HOSTED };

/* Emulated, a key of whole steps is recorded when it comes up a second time: in
 * every third step, where the wind that is set in each of these makes all keys
 * new. There is room for one item then, by turns of three streams, so that a
 * stage runs twice while it is recorded. */
static void cramp(struct run *r, int k)
{
    struct world *w = r->world;
    int64_t *const cap[] = {&w->broad.kind.cap, &w->broad.both.cap,
                            &w->response.contact[0].cap};
    int64_t *one = cap[k / 3 % 3];
    if (k % 3 == 0)
        r->ops->set_wind(r->world, &r->s.def.wind);
    if (k % 3 == 2 && *one > 1)
        *one = 1;
}

static const char *follow(struct run *r, const struct variant *a,
                          const struct trail *t, enum how how, int look,
                          struct gpu_played *played)
{
    static const char *const differs[] = {
        "it is not the reference's step",
        "a tape that ends early is another step",
        "where memory is short it is another step",
        "where the host ends loops it is another step"};
    const char *what = begin(r, a, DRAPE_GPU);
    if (!what && how == HOSTED)
        gpu_set_hosted(r->world->device->gpu);
    for (int k = 0; k < t->steps && !what; k++) {
        size_t bytes = (size_t)r->world->nv * sizeof *r->x;
        int falters = look ? look : 1 + 7 * k % a->looks;
        struct gpu_way way = {.falters = how == FALTERS ? falters : 0,
                              .tight = how == TIGHT,
                              .descending = how == FALTERS && k & 2};
        gpu_set_way(r->world->device->gpu, way);
        if (how == TIGHT && a->uncut)
            cramp(r, k);
        what = step(r, a);
        if (!what &&
            (memcmp(r->x, t->x[k], bytes) || memcmp(r->v, t->v[k], bytes) ||
             memcmp(&r->report, &t->report[k], sizeof r->report)))
            what = differs[how];
    }
    if (r->world && r->world->device)
        *played = gpu_played(r->world->device->gpu);
    if (!what && r->graphs != played->whole)
        what = "reports count other graphs than there were";
    end(r);
    return what;
}

static const char *compare(struct run *r, const struct variant *a,
                           struct trail *t)
{
    struct gpu_played whole = {0}, part = {0}, none = {0};
    const char *what = lead_way(r, a, t);
    if (!what)
        what = follow(r, a, t, PLAIN, 0, &whole);
    if (!what)
        what = follow(r, a, t, FALTERS, 0, &part);
    for (int look = 1; a->taps && look <= a->looks && !what; look++)
        what = follow(r, a, t, FALTERS, look, &none);
    if (!what)
        what = follow(r, a, t, TIGHT, 0, &none);
    if (!what)
        what = follow(r, a, t, HOSTED, 0, &none);
    EXPECT(what || none.begun == 0);
    EXPECT(what || whole.whole >= a->least);
    EXPECT(what || part.begun - part.whole >= a->least);
    ran(what ? 0 : 4);
    return what;
}

const char *test_tape(void)
{
    static char text[200];
    int status;
    struct gpu *g = gpu_open(NULL, &status);
    if (!g)
        return skip("there is no device");
    struct run *r = malloc(sizeof *r);
    struct trail *t = malloc(sizeof *t);
    const char *what = r && t ? NULL : "out of memory";
    if (!what) {
        r->device = gpu_device(g) >= 0;
        t->steps = r->device ? DEVICE_STEPS : STEPS;
    }
    /* in the other precision it is the same source */
    size_t n = REAL_BITS == 64 ? 1 : sizeof variants / sizeof *variants;
    for (size_t k = 0; k < n && !what; k++) {
        what = compare(r, &variants[k], t);
        if (what) {
            snprintf(text, sizeof text, "%s: %s", variants[k].name, what);
            what = text;
        }
    }
    gpu_set_way(g, (struct gpu_way){0});
    gpu_close(g);
    free(r);
    free(t);
    return what;
}
