/* SPDX-License-Identifier: Apache-2.0 */
/* 5 of 5. The program reads the world's own memory. New here: streams that are
 * borrowed and not copied, and memory that the program gives to the world.
 * 5_share.cu reads such a stream by a kernel, in the device's memory.
 *
 * Invariant: the kinetic energy ½ Σ m |v|² of the borrowed velocities is that
 * of the step's report, and no byte that was given is left at the end. */
#include <drape.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { SIDE = 41, STEPS = 20 };

/* The program's own allocator: C's, and a count of what is out. */
static void *allocate(void *user, size_t bytes)
{
    void *p = aligned_alloc(64, (bytes + 63) / 64 * 64);
    *(size_t *)user += p ? bytes : 0;
    return p;
}

static void release(void *user, void *p, size_t bytes)
{
    *(size_t *)user -= bytes;
    free(p);
}

/* The kinetic energy, straight from the stream. A particle has a quarter of the
 * mass of each of its cells: corners one, borders two, all others four. */
static double kinetic(drape_world *world, double mass)
{
    drape_view view;
    double sum = 0;
    if (drape_borrow(world, &view) != DRAPE_OK || view.device >= 0)
        return -1;           /* on a device: view.device is its number */
    const float *v = view.v; /* float, as def.precision is 32 */
    for (int k = 0; k < SIDE * SIDE; k++) {
        int i = k % SIDE, j = k / SIDE, last = SIDE - 1;
        int cells = (1 + (i > 0 && i < last)) * (1 + (j > 0 && j < last));
        double square = 0;
        for (int c = 0; c < 3; c++)
            square += (double)v[3 * k + c] * (double)v[3 * k + c];
        sum += 0.5 * mass / (last * last) * cells / 4 * square;
    }
    return sum; /* the view ends with the next step */
}

int main(void)
{
    size_t given = 0;
    drape_cloth cloth;
    drape_default_cloth(&cloth);
    cloth.m = cloth.n = SIDE;
    cloth.pins = &(drape_pin){.i = 0, .j = 0, .motion = -1};
    cloth.n_pins = 1;
    drape_def def;
    drape_default(&def);
    def.cloths = &cloth;
    def.n_cloths = 1;
    def.allocator = (drape_allocator){allocate, release, &given};
    drape_world *world;
    if (drape_create(&def, &world, NULL) != DRAPE_OK)
        return 1;

    double worst = 0, most = 0;
    for (int k = 0; k < STEPS; k++) {
        drape_step_report report;
        if (drape_step(world, &report) != DRAPE_OK)
            return 1;
        double mine = kinetic(world, cloth.material.density); /* of 1 m² */
        worst = fmax(worst, fabs(mine / report.kinetic - 1));
        most = fmax(most, mine);
    }
    printf("kinetic energy up to %.4f J, off by %.1e, %zu bytes", most, worst,
           given);
    drape_destroy(world);
    printf(", %zu left\n", given);
    return 0;
}
