/* SPDX-License-Identifier: Apache-2.0 */
/* 3 of 5. Two strips are pulled by one motion. New here: materials, motions
 * that lead pins, and a scene that is changed between two steps.
 *
 * Theory: a strip of length L and width W that is strained by e has the energy
 * ½ E e² L W, with E as in 1_hang.c. */
#include <drape.h>
#include <stdio.h>

enum { M = 5, N = 81, STEPS = 120 };

/* A strip of 5 cm × 1 m at x. Its upper end stays, motion 0 leads the lower. */
static void strip(drape_cloth *cloth, double x, double stretch,
                  drape_pin pins[2 * M])
{
    drape_default_cloth(cloth);
    cloth->m = M;
    cloth->n = N;
    cloth->width = 0.05;
    cloth->origin[0] = x;
    cloth->v[1] = -1;
    cloth->v[2] = 0;
    cloth->material.stretch = stretch;
    for (int i = 0; i < M; i++) {
        pins[i] = (drape_pin){.i = i, .j = 0, .motion = -1};
        pins[M + i] = (drape_pin){.i = i, .j = N - 1, .motion = 0};
    }
    cloth->pins = pins;
    cloth->n_pins = 2 * M;
}

static drape_world *make(void)
{
    /* Keys say where a motion is at which time. Here: down by 2 % of the length
     * in one second, and then it stays. */
    const double time[2] = {0, 1};
    const double position[2][3] = {{0, 0, 0}, {0, -0.02, 0}};
    const drape_motion pull = {.keys = 2, .time = time, .position = position};
    drape_pin pins[2][2 * M];
    drape_cloth cloths[2];
    strip(&cloths[0], 0, 1000, pins[0]);
    strip(&cloths[1], 0.1, 4000, pins[1]);

    drape_def def;
    drape_default(&def);
    def.gravity[1] = 0; /* what is measured is the strips' own */
    def.cloths = cloths;
    def.n_cloths = 2;
    def.motions = &pull;
    def.n_motions = 1;
    drape_world *world;
    return drape_create(&def, &world, NULL) == DRAPE_OK ? world : NULL;
}

/* The energy of both strips, J, after STEPS more steps, by when they rest. */
static double energy(drape_world *world)
{
    drape_step_report report = {.elastic = 0};
    for (int k = 0; k < STEPS && drape_step(world, &report) == DRAPE_OK;)
        k++;
    return report.elastic;
}

int main(void)
{
    drape_world *world = make();
    if (!world)
        return 1;
    double first = energy(world);

    /* Between two steps most of a world can be changed: here a stiffness. */
    drape_material material;
    drape_read_material(world, 0, &material);
    material.stretch *= 2;
    drape_set_material(world, 0, &material);
    double second = energy(world);
    printf("energy %.5f J, then %.5f J\n", first, second);
    drape_destroy(world);
    return first > 0 && second > 0 ? 0 : 1;
}
