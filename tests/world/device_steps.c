/* SPDX-License-Identifier: Apache-2.0 */
/* Whole steps on the device give the bits of the reference: in normal runs,
 * when pools overflow, and when the host ends all loops. spec/gpu.md */
#include <stdio.h>
#include <stdlib.h>

#include "gpu/run/gpu.h"
#include "gpu/world/state.h"
#include "ref/api/ops.h"
#include "tests/api/guest.h"

/* CROWD: sheets of a variant, more than the device merges into one launch. */
enum { STEPS = 12, VERTICES = 256, CROWD = 11 };

/* How a scene differs from the basic scene of tests/api/guest.h. */
struct variant {
    const char *name;
    int integrator, precond;
    bool moves, two, windy;
    bool pinned; /* a pin leads one corner of the sheet */
    bool taps;   /* the plate moves up and down; no gravity */
    bool uncut;  /* a step is one slice */
    int newton;  /* linear systems of a motion, 0: the integrator's own */
    bool alone;  /* no plate; the second sheet falls on the first */
    bool fails;  /* no round of impulses: slices go straight to the fail-safe */
    bool crowd;  /* small sheets that fall on the plate and on each other */
};

static const struct variant variants[] = {
    {"multigrid", DRAPE_BW, DRAPE_MULTIGRID, .uncut = true},
    {"choi-ko, wind, a plate that moves", DRAPE_CK, DRAPE_JACOBI, .moves = true,
     .windy = true},
    {"newton, a plate that taps", DRAPE_BW, DRAPE_MULTIGRID, .taps = true,
     .newton = 3},
    {"bdf2, wind, a plate that moves", DRAPE_BDF2, DRAPE_MULTIGRID,
     .moves = true, .windy = true},
    {"two sheets, rounds in each step", DRAPE_BW, DRAPE_JACOBI, .two = true},
    {"two sheets alone", DRAPE_BW, DRAPE_MULTIGRID, .two = true, .alone = true},
    {"a crowd", DRAPE_BW, DRAPE_MULTIGRID, .crowd = true},
    {"a plate that taps", DRAPE_BW, DRAPE_JACOBI, .taps = true},
    {"euler, a pin that moves", DRAPE_EULER, DRAPE_JACOBI, .moves = true,
     .pinned = true},
    {"midpoint, two sheets, wind", DRAPE_MIDPOINT, DRAPE_JACOBI, .two = true,
     .windy = true},
    {"verlet, a pin that moves", DRAPE_VERLET, DRAPE_JACOBI, .moves = true,
     .pinned = true},
    {"no impulses", DRAPE_BW, DRAPE_JACOBI, .moves = true, .fails = true},
    {"rk4, a pin that moves, wind", DRAPE_RK4, DRAPE_JACOBI, .moves = true,
     .windy = true, .pinned = true},
};

/* A world made without the public API, which would hide its device. */
struct run {
    struct guest s;
    drape_cloth cloth[CROWD];
    drape_motion motion;
    drape_pin pin;
    bool device; /* the machine has a device, with longer runs of substeps */
    struct arena arena;
    const struct world_ops *ops;
    struct world *world;
    double x[VERTICES][3], v[VERTICES][3];
    drape_step_report report;
};

static const double times[2] = {0, 1}, path[2][3] = {{0}, {0.02, 0.005, 0}};

/* The plate moves at every third step, so that contact begins and ends often.
 */
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

/* Sheets in piles of four, all alike but for one in the middle, which comes
 * between those that can be merged. */
static void make_crowd(struct run *r)
{
    for (int k = 0; k < CROWD; k++) {
        drape_cloth *c = &r->cloth[k];
        *c = r->s.cloth;
        c->m = k == 4 ? 5 : 4;
        c->n = 4;
        c->width = c->height = 0.04;
        c->origin[0] = -0.05 + 0.045 * (k % 3);
        c->origin[1] = 0.003 + 0.004 * (k / 3);
        c->origin[2] = -0.02 + 0.003 * (k / 3);
    }
    r->s.def.n_cloths = CROWD;
}

static void define(struct run *r, const struct variant *a, int backend)
{
    drape_def *def = &r->s.def;
    guest_make(&r->s, backend);
    def->integrator = a->integrator;
    def->precond = a->precond;
    def->newton = a->newton;
    r->cloth[0] = r->cloth[1] = r->s.cloth;
    r->cloth[1].origin[1] = 0.006;
    def->cloths = r->cloth;
    def->n_cloths = 1 + a->two;
    if (a->crowd)
        make_crowd(r);
    if (a->alone) {
        static double down[VERTICES][3];
        for (int k = 0; k < VERTICES; k++)
            down[k][1] = -1;
        r->cloth[1].velocity = (const double(*)[3])down;
        def->n_obstacles = 0;
        def->gravity[1] = 0;
    }
    if (a->uncut)
        def->max_slices = 1;
    if (a->fails)
        def->max_rounds = 0;
    if (a->integrator < DRAPE_BW) { /* few substeps; contact from the start */
        def->dt = r->device ? 7e-4 : 7e-5;
        r->cloth[0].origin[1] = 0.0019;
    }
    move_plate(r, a);
    r->pin = (drape_pin){0, 0, 0};
    r->cloth[0].pins = &r->pin;
    r->cloth[0].n_pins = a->pinned;
    if (a->windy)
        def->wind = (drape_wind){
            .velocity = {0.2, 0, 0}, .density = 1.2, .drag = 1, .lift = 0.5};
}

static const char *begin(struct run *r, const struct variant *a, int backend)
{
    define(r, a, backend);
    r->world = NULL;
    r->ops = backend == DRAPE_GPU ? &world_ops_gpu : &world_ops;
    arena_init(&r->arena, &r->s.def.allocator);
    EXPECT(r->ops->make(&r->s.def, &r->arena, &r->world, NULL) == DRAPE_OK);
    EXPECT(r->world->nv <= VERTICES);
    return NULL;
}

static const char *step(struct run *r, const struct variant *a)
{
    int64_t k = r->world->step;
    if (a->fails) /* other settings on which launches depend stay */
        r->world->def.max_slices = k > 4 && k % 4 == 1 ? 2 : 4;
    EXPECT(r->ops->step(r->world, &r->report) == DRAPE_OK);
    memset(r->report.seconds, 0, sizeof r->report.seconds);
    EXPECT(r->ops->read(r->world, r->x, r->v) == DRAPE_OK);
    return NULL;
}

static void end(struct run *r)
{
    if (r->world && r->ops->end)
        r->ops->end(r->world);
    arena_free(&r->arena);
}

/* Three steps PLAIN and three SHORT, twice. A crowd, which takes as long as all
 * other variants, makes them once: its launches are the same in each step. */
static int steps_of(const struct variant *a)
{
    return a->crowd ? STEPS / 2 : STEPS;
}

/* The states and reports of the reference's steps. */
struct trail {
    double x[STEPS][VERTICES][3], v[STEPS][VERTICES][3];
    drape_step_report report[STEPS];
};

static const char *lead_way(struct run *r, const struct variant *a,
                            struct trail *t)
{
    const char *what = begin(r, a, DRAPE_REF);
    int64_t met = 0;
    for (int k = 0; k < steps_of(a) && !what; k++) {
        what = step(r, a);
        met += r->report.contacts + r->report.impacts;
        memcpy(t->x[k], r->x, sizeof r->x);
        memcpy(t->v[k], r->v, sizeof r->v);
        t->report[k] = r->report;
    }
    end(r);
    EXPECT(what || met > 0);
    return what;
}

/* PLAIN: a normal step. SHORT: a pool is cut to one item of capacity, so that
 * stages overflow, their pools grow by the least amount, and the stages run
 * again. One run takes three steps PLAIN and three steps SHORT in turn. HOSTED:
 * the host ends all loops, of a run of half as many steps. */
enum how { PLAIN, SHORT, HOSTED };

/* Cuts one of three pools, chosen by k, to one item of capacity. False: the
 * pool has no more than one item. */
static bool cut_pool(struct run *r, int k)
{
    struct world *w = r->world;
    int64_t *const cap[] = {&w->broad.kind.cap, &w->broad.both.cap,
                            &w->response.contact[0].cap};
    int64_t *one = cap[k % 3];
    bool cut = *one > 1;
    *one = cut ? 1 : *one;
    return cut;
}

static void spoil(const void *stream, int64_t n, size_t size)
{
    if (stream)
        memset((void *)stream, 0xff, (size_t)n * size);
}

static void spoil_place(const struct kinematics *s)
{
    spoil(s->rest, s->n, sizeof *s->rest * 3);
    spoil(s->motion, s->n, sizeof *s->motion);
}

static void spoil_tree(const struct tree *t, const struct tree_map *map)
{
    spoil(t->first, t->n, sizeof *t->first);
    spoil(t->parent, t->n, sizeof *t->parent);
    spoil(t->count, t->n, sizeof *t->count);
    spoil(t->level, t->n, sizeof *t->level);
    spoil(t->rank, t->n, sizeof *t->rank);
    spoil(t->mesh, t->n, sizeof *t->mesh);
    spoil(t->order, t->n_tri, sizeof *t->order);
    spoil(t->tri, t->n_tri, sizeof *t->tri);
    spoil(t->own, t->n_tri, sizeof *t->own);
    spoil(t->place, t->n_cloth, sizeof *t->place);
    spoil(t->range, t->n_range, sizeof *t->range);
    spoil(map->at, map->n_at, sizeof *map->at);
    spoil(map->full, t->n_cloth, sizeof *map->full);
}

/* Spoils the streams of the world on the host, which is never stepped: a kernel
 * that reads them by mistake finds the right numbers there in emulation. */
static void spoil_host(struct run *r)
{
    struct world *h = r->world->device->host;
    int64_t bodies = h->def.n_cloths + h->def.n_obstacles;
    spoil(h->x0, h->nv, sizeof *h->x0);
    spoil(h->v0, h->nv, sizeof *h->v0);
    spoil(h->past_x, h->nc, sizeof *h->past_x);
    spoil(h->past_v, h->nc, sizeof *h->past_v);
    spoil(h->to, h->nc, sizeof *h->to);
    spoil(h->w, h->nv, sizeof *h->w);
    spoil(h->body, h->nv, sizeof *h->body);
    spoil(h->surface, bodies, sizeof *h->surface);
    spoil(h->broad.root, h->broad.roots, sizeof *h->broad.root);
    spoil_tree(&h->broad.tree, &h->broad.map);
    for (int k = 0; k < h->def.n_obstacles; k++)
        spoil_place(&h->prop[k].place);
    for (int k = 0; k < h->def.n_cloths; k++) {
        struct cloth *c = &h->sheet[k].cloth;
        spoil(c->cell, c->count, sizeof *c->cell);
        spoil(c->springs, c->count, sizeof *c->springs);
        spoil(c->beside, c->count, sizeof *c->beside);
        spoil(c->fixed, c->count, sizeof *c->fixed);
        spoil(c->mass, c->count, sizeof *c->mass);
        spoil(h->sheet[k].pinned, h->sheet[k].pins.n, sizeof(int32_t));
        spoil_place(&h->sheet[k].pins);
    }
}

static const char *follow(struct run *r, const struct variant *a,
                          const struct trail *t, bool hosted)
{
    static const char *const differs[] = {
        "it is not the reference's step",
        "where memory is short it is another step",
        "where the host ends loops it is another step"};
    const char *what = begin(r, a, DRAPE_GPU);
    int cuts = 0;
    if (!what)
        spoil_host(r);
    if (!what && hosted)
        gpu_set_hosted(r->world->device->gpu);
    for (int k = 0; k < steps_of(a) / (hosted ? 2 : 1) && !what; k++) {
        enum how how = hosted ? HOSTED : k % 6 < 3 ? PLAIN : SHORT;
        size_t bytes = (size_t)r->world->nv * sizeof *r->x;
        struct gpu_way way = {.tight = how == SHORT,
                              .descending = how != PLAIN && k & 2};
        gpu_set_way(r->world->device->gpu, way);
        if (how == SHORT)
            cuts += cut_pool(r, k);
        what = step(r, a);
        if (!what &&
            (memcmp(r->x, t->x[k], bytes) || memcmp(r->v, t->v[k], bytes) ||
             memcmp(&r->report, &t->report[k], sizeof r->report)))
            what = differs[how];
    }
    end(r);
    EXPECT(what || hosted || cuts > 0);
    return what;
}

static const char *compare(struct run *r, const struct variant *a,
                           struct trail *t)
{
    const char *what = lead_way(r, a, t);
    for (int hosted = 0; hosted < 2 && !what; hosted++)
        what = follow(r, a, t, hosted);
    ran(what ? 0 : 2);
    return what;
}

const char *test_device_steps(void)
{
    static char text[200];
    int status;
    struct gpu *g = gpu_open(NULL, &status);
    if (!g)
        return skip("there is no device");
    struct run *r = malloc(sizeof *r);
    struct trail *t = malloc(sizeof *t);
    const char *what = r && t ? NULL : "out of memory";
    if (!what)
        r->device = gpu_device(g) >= 0;
    /* binary64 is compiled from the same source, so one variant is enough */
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
