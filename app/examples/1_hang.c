/* SPDX-License-Identifier: Apache-2.0 */
/* 1 of 5. A square metre of cotton hangs by its upper edge. New here: what
 * every program with drape does. A definition is filled, a world is made of it,
 * the world is stepped, and each step says how it ended. Built with
 *     cc 1_hang.c $(pkg-config --cflags --libs drape) -o 1_hang
 *
 * Theory: each row bears what hangs below it, so a sheet of density ρ and
 * height H is ρ g H² / (2 E) longer than at rest. As its sides are free,
 * E is stretch - shear² / stretch (spec/cloth/cloth.md §4). */
#include <drape.h>
#include <stdio.h>

enum { SIDE = 41, STEPS = 60 };

/* Makes the world, or returns NULL and says why there is none. */
static drape_world *make(void)
{
    /* A definition starts from defaults, so only what differs is written. */
    drape_def def;
    drape_cloth cloth;
    drape_default(&def);         /* gravity along -y, steps of 1/60 s */
    drape_default_cloth(&cloth); /* 1 m × 1 m of light cotton */
    cloth.m = cloth.n = SIDE;    /* particle (i, j) is number i + SIDE j */
    cloth.v[1] = -1;             /* j grows downwards, not along z */
    cloth.v[2] = 0;

    drape_pin pins[SIDE];
    for (int i = 0; i < SIDE; i++)
        pins[i] = (drape_pin){.i = i, .j = 0, .motion = -1};
    cloth.pins = pins;
    cloth.n_pins = SIDE;
    def.cloths = &cloth;
    def.n_cloths = 1;

    /* The world copies all of it: nothing here must outlive this call. */
    drape_world *world;
    drape_error error;
    if (drape_create(&def, &world, &error) != DRAPE_OK)
        fprintf(stderr, "%s\n", error.text);
    return world;
}

int main(void)
{
    drape_world *world = make();
    if (!world)
        return 1;
    int clean = 0;
    for (int k = 0; k < STEPS; k++) {
        drape_step_report report;
        int status = drape_step(world, &report);
        if (status != DRAPE_OK) { /* memory ran out, say */
            fprintf(stderr, "%s\n", drape_status_text(status));
            break;
        }
        clean += report.outcome == 0; /* how the computation ended */
    }

    static double x[SIDE * SIDE][3];
    drape_read(world, x, NULL); /* positions, and no velocities */
    double lowest = 0;
    for (int k = 0; k < SIDE * SIDE; k++)
        lowest = x[k][1] < lowest ? x[k][1] : lowest;
    printf("%d of %d steps clean, longer by %.4f mm\n", clean, STEPS,
           1000 * (-lowest - 1));
    drape_destroy(world);
    return clean == STEPS ? 0 : 1;
}
