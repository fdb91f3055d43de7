/* SPDX-License-Identifier: Apache-2.0 */
/* Newton's method through the public API: a pendulum keeps its swing, a swatch
 * gets through a buckle, and one system is what it was. spec/cloth/implicit.md
 * §6 */
#include <math.h>
#include <string.h>

#include "spec/drape.h"
#include "tests/base/notes.h"
#include "tests/world/scene.h"

enum { SIDE = 9, COUNT = SIDE * SIDE };

/* The mean angle of a sheet that hangs from y = z = 0. */
static double angle_of(const drape_world *world, double (*x)[3])
{
    double y = 0, z = 0;
    drape_read(world, x, NULL);
    for (int p = 0; p < COUNT; p++) {
        y += x[p][1];
        z += x[p][2];
    }
    return atan2(z, -y);
}

/* The share of its amplitude that a sheet of 1 m keeps from its first return to
 * its second, released at 0.3 rad, with steps of 1/60 s; *period in steps. -1:
 * a step was not clean. */
static double swing(int integrator, int newton, double *period)
{
    static double x[COUNT][3];
    drape_pin pin[SIDE];
    drape_def def;
    drape_cloth cloth;
    drape_world *world;
    drape_step_report report;
    drape_default(&def);
    drape_default_cloth(&cloth);
    for (int p = 0; p < COUNT; p++) {
        double along = (double)(p / SIDE) / (SIDE - 1);
        x[p][0] = (double)(p % SIDE) / (SIDE - 1);
        x[p][1] = -along * cos(0.3);
        x[p][2] = along * sin(0.3);
    }
    for (int i = 0; i < SIDE; i++)
        pin[i] = (drape_pin){i, 0, -1};
    cloth.m = cloth.n = SIDE;
    cloth.x = (const double(*)[3])x;
    cloth.pins = pin;
    cloth.n_pins = SIDE;
    cloth.material.damping = 0;
    cloth.material.stretch = 1e4;
    def.precision = REAL_BITS;
    def.integrator = integrator;
    def.newton = newton;
    def.self_collision = def.sleep = 0;
    def.cloths = &cloth;
    def.n_cloths = 1;
    if (drape_create(&def, &world, NULL) != DRAPE_OK)
        return -1;
    double angle[3] = {0}, peak[3] = {0}, when[3] = {0};
    int peaks = 0, bad = 0;
    for (int k = 0; k < 260 && peaks < 2 && !bad; k++) {
        bad = drape_step(world, &report) != DRAPE_OK || report.outcome;
        angle[0] = angle[1];
        angle[1] = angle[2];
        angle[2] = angle_of(world, x);
        if (k < 60 || angle[1] <= angle[0] || angle[1] < angle[2])
            continue;
        peak[peaks] = angle[1];
        when[peaks++] = k;
    }
    drape_destroy(world);
    *period = when[1] - when[0];
    return bad || peaks < 2 ? -1 : peak[1] / peak[0];
}

/* implicit.md, blocks.md §8: backward Euler keeps what the formula keeps of a
 * harmonic motion, (1 + ω²h²)^(-1/2) a step, whether it is solved or
 * linearised; BDF2 hardly damps, and Choi–Ko, which linearises it, little more.
 */
const char *test_newton_swings(void)
{
    double period, once;
    double euler = swing(DRAPE_BW, 8, &period), one = swing(DRAPE_BW, 1, &once);
    double turn = 2 * 3.14159265358979 / period;
    double formula = pow(1 + turn * turn, -period / 2);
    EXPECT(fabs(euler - formula) <= 0.015 && fabs(one - formula) <= 0.015);
    double second = swing(DRAPE_BDF2, 0, &period);
    one = swing(DRAPE_BDF2, 1, &once);
    EXPECT(second >= 0.97 && second <= 1 && fabs(one - second) <= 0.02);
    EXPECT(one == swing(DRAPE_CK, 0, &once));
    ran(5);
    return NULL;
}

/* A strip of 5 cm × 1 cm with cells of 1 mm, held level by its short edge,
 * falls and buckles. Returns the most energy that it gains in 20 steps of 1/60
 * s, J, or -1 where a step fails or is cut. */
static double drop_swatch(int integrator, int newton)
{
    drape_pin pin[11];
    drape_def def;
    drape_cloth cloth;
    drape_world *world;
    drape_step_report report;
    drape_default(&def);
    drape_default_cloth(&cloth);
    for (int j = 0; j < 11; j++)
        pin[j] = (drape_pin){0, j, -1};
    cloth.m = 51;
    cloth.n = 11;
    cloth.width = 0.05;
    cloth.height = 0.01;
    cloth.pins = pin;
    cloth.n_pins = 11;
    def.precision = REAL_BITS;
    def.integrator = integrator;
    def.newton = newton;
    def.cloths = &cloth;
    def.n_cloths = 1;
    if (drape_create(&def, &world, NULL) != DRAPE_OK)
        return -1;
    double start = 0, most = 0;
    bool good = true;
    for (int k = 0; k < 20; k++) {
        good &= drape_step(world, &report) == DRAPE_OK && !report.outcome &&
                report.slices == 1;
        double all = report.kinetic + report.elastic + report.potential;
        start = k == 0 ? all : start;
        most = fmax(most, all - start);
    }
    drape_destroy(world);
    return good ? most : -1;
}

/* §6.2: the motion of one system goes beyond the minimum of the step's energy;
 * Newton's method with its line search does not. So the strip gains a part of
 * what it can fall with one system, and nothing with Newton's method. */
const char *test_newton_swatch(void)
{
    const double fall = 0.05 * 0.01 * 0.2 * 9.81 * 0.05; /* J, of its length */
    double one = drop_swatch(DRAPE_BW, 1), more = drop_swatch(DRAPE_BW, 5);
    EXPECT(one > 0.1 * fall && more >= 0 && more < 1e-3 * fall);
    double second = drop_swatch(DRAPE_BDF2, 0);
    EXPECT(second >= 0 && second < 1e-3 * fall);
    ran(3);
    return NULL;
}

/* Steps a scene. Returns the hash of its end and of all stages; *m is its
 * memory. */
static uint64_t trail(int integrator, int newton, drape_memory *m)
{
    struct notes notes = {0};
    drape_def def;
    drape_cloth cloth;
    drape_world *world;
    drape_default(&def);
    drape_default_cloth(&cloth);
    cloth.m = cloth.n = 13;
    cloth.pins = (drape_pin[]){{0, 0, -1}};
    cloth.n_pins = 1;
    def.precision = REAL_BITS;
    def.integrator = integrator;
    def.newton = newton;
    def.cloths = &cloth;
    def.n_cloths = 1;
    def.trace = notes_take;
    def.trace_user = &notes;
    memset(m, 0, sizeof *m);
    if (drape_create(&def, &world, NULL) != DRAPE_OK)
        return 0;
    uint64_t hash = 0;
    for (int k = 0; k < 4; k++)
        hash |= drape_step(world, NULL) != DRAPE_OK;
    drape_count(world, m);
    hash = hash ? 0 : scene_hash(world);
    for (size_t k = 0; k < notes.n; k++)
        hash = hash * 31 + notes.note[k].digest;
    drape_destroy(world);
    notes_free(&notes);
    return hash;
}

/* §6.6: with one system all stages, bits and memory are as without Newton's
 * method; and BDF2 is then Choi–Ko. */
const char *test_newton_one(void)
{
    static const int same[3][2] = {
        {DRAPE_BW, DRAPE_BW}, {DRAPE_CK, DRAPE_CK}, {DRAPE_CK, DRAPE_BDF2}};
    for (int k = 0; k < 3; k++) {
        drape_memory a, b;
        uint64_t none = trail(same[k][0], 0, &a);
        uint64_t one = trail(same[k][1], 1, &b);
        EXPECT(none && none == one && a.host_bytes == b.host_bytes);
        uint64_t two = trail(same[k][1], 2, &b);
        EXPECT(two && none != two && a.host_bytes < b.host_bytes);
        ran(1);
    }
    return NULL;
}
