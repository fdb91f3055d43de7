/* SPDX-License-Identifier: Apache-2.0 */
/* A heavy ribbon finds its rest by long steps of one linear system each.
 * spec/cloth/blocks.md §8 */
#include <math.h>
#include <string.h>

#include "spec/drape.h"
#include "tests/world/scene.h"

enum { CELLS = 50, M = CELLS + 1, COUNT = 2 * M, STEPS = 600 };
static const double LENGTH = 0.08, BEND = 1e-4; /* m, N·m */

/* A ribbon as wide as a cell, of which two rows are held level: the clamp is
 * half a cell before the second of them (cloth.md §7). */
static void lay(drape_def *def, drape_cloth *cloth, double (*x)[3])
{
    static const drape_pin pin[] = {
        {0, 0, -1}, {1, 0, -1}, {0, 1, -1}, {1, 1, -1}};
    double h = LENGTH / (CELLS - 0.5);
    drape_default(def);
    drape_default_cloth(cloth);
    for (int p = 0; p < COUNT; p++) {
        x[p][0] = h * (p % M);
        x[p][1] = 0;
        x[p][2] = h * (p / M);
    }
    cloth->m = M;
    cloth->n = 2;
    cloth->width = h * CELLS;
    cloth->height = h;
    cloth->x = (const double(*)[3])x;
    cloth->pins = pin;
    cloth->n_pins = 4;
    cloth->material.bend = BEND;
    def->precision = REAL_BITS;
    def->self_collision = def->sleep = 0;
    def->newton = 1;
    def->cloths = cloth;
    def->n_cloths = 1;
}

/* How far the particles are apart in two states, at most. */
static double way(double (*a)[3], double (*b)[3])
{
    double most = 0;
    for (int p = 0; p < COUNT; p++)
        for (int c = 0; c < 3; c++)
            most = fmax(most, fabs(a[p][c] - b[p][c]));
    return most;
}

/* Steps of dt from x at rest, until one moves nothing by more than `still`.
 * Returns whether one did. */
static bool settle(drape_def *def, double (*x)[3], double dt, double still)
{
    static double next[COUNT][3];
    drape_world *world;
    drape_step_report report;
    double moved = INFINITY;
    def->dt = dt;
    if (drape_create(def, &world, NULL) != DRAPE_OK)
        return false;
    for (int k = 0; k < STEPS && moved > still; k++) {
        if (drape_step(world, &report) != DRAPE_OK || report.outcome)
            break;
        drape_read(world, next, NULL);
        moved = way(x, next);
        memcpy(x, next, sizeof next);
    }
    drape_destroy(world);
    return moved <= still;
}

/* The drop over the distance of its tip is that of the elastica, 1.069 at
 * w L³/D = 10.04 (validation.md §2), to 1 %. */
const char *test_rest_long(void)
{
    static double x[COUNT][3];
    static const double dt[] = {0.05, 0.15, 0.45, 1};
    drape_def def;
    drape_cloth cloth;
    bool found = false;
    lay(&def, &cloth, x);
    for (int k = 0; k < 4; k++)
        found =
            settle(&def, x, dt[k], LENGTH * (REAL_BITS == 32 ? 1e-5 : 1e-7));
    const double *tip = x[CELLS];
    double h = LENGTH / (CELLS - 0.5);
    EXPECT(found);
    EXPECT(fabs(-tip[1] / (tip[0] - h / 2) / 1.069 - 1) < 0.01);
    ran(1);
    return NULL;
}
