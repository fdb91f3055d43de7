/* SPDX-License-Identifier: Apache-2.0 */
/* The fused kernels of the explicit methods, which run only without a trace,
 * compared with the reference. The sheets have several thread blocks, so that a
 * block that writes too early shows in its neighbours. --cases 1 takes the
 * small sheet only and --hosted launches each substep, for compute-sanitizer.
 * spec/gpu.md §13 */
#include <stdio.h>
#include <stdlib.h>

#include "gpu/run/gpu.h"
#include "gpu/world/state.h"
#include "ref/api/ops.h"
#include "tests/api/guest.h"
#include "tests/base/modes.h"

/* Beyond 2^16 particles blocks own larger tiles (gpu/cloth/springs.cuh). The
 * steps are short, so that there are few substeps; on a device they are longer,
 * so that substeps fill a loop on the device. */
enum { LONGER_ON_A_DEVICE = 12 };
static const struct variant {
    int m, n;
    double dt;    /* s */
    int substeps; /* the fewest of any method */
} variants[] = {{69, 21, 3e-6, 6}, {257, 256, 7e-7, 2}};

struct rumpled {
    struct guest s;
    bool device; /* there is a real device, and not --cases 1 */
    drape_pin pin;
    drape_motion motion;
    double (*x)[3], (*v)[3]; /* [m·n] m, m/s, the start state */
};

/* The state and the report at the end of a run. */
struct ended {
    double (*x)[3], (*v)[3];
    drape_step_report report;
};

static const double times[2] = {0, 1}, path[2][3] = {{0}, {0.02, 0.005, 0}};

/* Fills the start state with noise, so that no two particles move alike. */
static void rumple(struct rumpled *r)
{
    const drape_cloth *c = &r->s.cloth;
    uint32_t random = 1;
    for (int k = 0; k < 3 * c->m * c->n; k++) {
        int p = k / 3;
        double flat[3] = {p % c->m, 0, p / c->m};
        random = random * 1664525 + 1013904223;
        double by = random / 4294967296.0 - 0.5;
        r->x[p][k % 3] = 0.01 * (flat[k % 3] + 0.1 * by);
        r->v[p][k % 3] = by;
    }
}

static void define(struct rumpled *r, const struct variant *a, int integrator,
                   int backend)
{
    drape_def *def = &r->s.def;
    drape_cloth *c = &r->s.cloth;
    guest_make(&r->s, backend);
    def->integrator = integrator;
    def->dt = r->device ? LONGER_ON_A_DEVICE * a->dt : a->dt;
    def->self_collision = 0;
    def->n_obstacles = 0;
    def->wind = (drape_wind){
        .velocity = {0.2, 0, 0}, .density = 1.2, .drag = 1, .lift = 0.5};
    c->m = a->m;
    c->n = a->n;
    c->width = 0.01 * (a->m - 1);
    c->height = 0.01 * (a->n - 1);
    rumple(r);
    c->x = (const double(*)[3])r->x;
    c->velocity = (const double(*)[3])r->v;
    r->motion = (drape_motion){.keys = 2, .time = times, .position = path};
    r->pin = (drape_pin){0, 0, 0};
    def->motions = &r->motion;
    def->n_motions = 1;
    c->pins = &r->pin;
    c->n_pins = 1;
}

static const char *go(struct rumpled *r, const struct world_ops *ops,
                      struct ended *end)
{
    struct arena arena;
    struct world *world = NULL;
    arena_init(&arena, &r->s.def.allocator);
    int status = ops->make(&r->s.def, &arena, &world, NULL);
    if (status == DRAPE_OK && world->device && options.hosted)
        gpu_set_hosted(world->device->gpu);
    for (int k = 0; k < 2 && status == DRAPE_OK; k++)
        status = ops->step(world, &end->report);
    if (status == DRAPE_OK)
        status = ops->read(world, end->x, end->v);
    if (world && ops->end)
        ops->end(world);
    arena_free(&arena);
    return status == DRAPE_OK ? NULL : drape_status_text(status);
}

static const char *compare(struct rumpled *r, const struct variant *a,
                           int method, struct ended end[2])
{
    size_t bytes = (size_t)(a->m * a->n) * sizeof *r->x;
    define(r, a, method, DRAPE_REF);
    const char *what = go(r, &world_ops, &end[0]);
    define(r, a, method, DRAPE_GPU);
    if (!what)
        what = go(r, &world_ops_gpu, &end[1]);
    if (what)
        return what;
    EXPECT(end[0].report.outcome == 0 && end[1].report.outcome == 0);
    EXPECT(end[0].report.substeps >= a->substeps);
    EXPECT(end[0].report.substeps == end[1].report.substeps);
    EXPECT(end[0].report.kinetic == end[1].report.kinetic);
    EXPECT(memcmp(end[0].x, r->x, bytes));
    EXPECT(!memcmp(end[0].x, end[1].x, bytes));
    EXPECT(!memcmp(end[0].v, end[1].v, bytes));
    ran(1);
    return NULL;
}

static const char *compare_all(struct rumpled *r, struct ended end[2])
{
    static const int methods[] = {DRAPE_EULER, DRAPE_MIDPOINT, DRAPE_VERLET,
                                  DRAPE_RK4};
    static char text[200];
    size_t n = options.cases == 1 ? 1 : sizeof variants / sizeof *variants;
    for (size_t j = 0; j < n; j++)
        for (int k = 0; k < 4; k++) {
            const char *what = compare(r, &variants[j], methods[k], end);
            if (what) {
                snprintf(text, sizeof text, "%d × %d, method %d: %s",
                         variants[j].m, variants[j].n, methods[k], what);
                return text;
            }
        }
    return NULL;
}

const char *test_fused(void)
{
    enum { MOST = 257 * 256 };
    int status;
    struct gpu *g = gpu_open(NULL, &status);
    if (!g)
        return skip("there is no device");
    struct rumpled *r = calloc(1, sizeof *r);
    double(*x)[3] = calloc(6 * MOST, sizeof *x);
    const char *what = r && x ? NULL : "out of memory";
    if (!what) {
        struct ended end[2] = {{x, x + MOST, {0}},
                               {x + 2 * MOST, x + 3 * MOST, {0}}};
        r->device = gpu_device(g) >= 0 && options.cases != 1;
        r->x = x + 4 * MOST;
        r->v = x + 5 * MOST;
        what = compare_all(r, end);
    }
    gpu_close(g);
    free(x);
    free(r);
    return what;
}
