/* SPDX-License-Identifier: Apache-2.0 */
/* A square metre of cotton hangs by two corners: the installed library in a
 * program of its own. Built with
 *     cc hang.c $(pkg-config --cflags --libs drape) -o hang
 * Exits with 0 if every step was clean and the cloth, which swings, is below
 * its pins and not too far.
 */
#include <drape.h>
#include <stdio.h>

enum { SIDE = 41, STEPS = 60 };

static void hear(void *user, const char *line)
{
    fprintf(user, "drape: %s\n", line);
}

/* The lowest y of the cloth, read without a copy. */
static double lowest(drape_world *world)
{
    drape_view view;
    double y = 1e300;
    if (drape_borrow(world, &view) != DRAPE_OK || view.device >= 0)
        return y;
    const float *x = view.x; /* as def.precision is 32 */
    for (int64_t k = 0; k < view.vertices; k++)
        y = (double)x[3 * k + 1] < y ? (double)x[3 * k + 1] : y;
    return y;
}

static int run(drape_world *world)
{
    int clean = 0;
    for (int k = 0; k < STEPS; k++) {
        drape_step_report report;
        int status = drape_step(world, &report);
        if (status != DRAPE_OK) {
            fprintf(stderr, "%s\n", drape_status_text(status));
            return 1;
        }
        clean += report.outcome == 0;
    }
    double y = lowest(world);
    printf("%d of %d steps clean, lowest point %.3f m\n", clean, STEPS, y);
    return clean == STEPS && y < -0.25 && y > -1.6 ? 0 : 1;
}

int main(void)
{
    const drape_pin pins[] = {{0, 0, -1}, {SIDE - 1, 0, -1}};
    drape_def def;
    drape_cloth cloth;
    drape_default(&def);
    drape_default_cloth(&cloth); /* flat, 1 m × 1 m of light cotton */
    cloth.m = cloth.n = SIDE;
    cloth.pins = pins;
    cloth.n_pins = 2;
    def.cloths = &cloth;
    def.n_cloths = 1;
    def.log = hear;
    def.log_user = stderr;

    drape_world *world;
    drape_error error;
    if (drape_create(&def, &world, &error) != DRAPE_OK) {
        fprintf(stderr, "%s\n", error.text);
        return 1;
    }
    int code = run(world);
    drape_destroy(world);
    return code;
}
