/* SPDX-License-Identifier: Apache-2.0 */
/* Cloths without contact, stepped by the reference and by the device: every
 * stage must give the same bits. spec/cloth/dynamics.md, spec/gpu.md */
#include "tests/world/twin.h"

enum {
    WIDE = 13,
    HIGH = 9,
    COUNT = WIDE * HIGH,
    METHODS = DRAPE_BDF2 + 1,
    SCENES = 5,
    STEPS = 3
};

/* A scene of one cloth with all the memory that its definition points to. */
struct motion_scene {
    drape_def def;
    drape_cloth cloth;
    drape_pin pins[2];
    drape_motion lead;
    double x[COUNT][3], v[COUNT][3];
    uint8_t hole[COUNT];
};

static const double times[2] = {0, 1};
static const double way[2][3] = {{0, 0, 0}, {0.1, 0.3, -0.2}};

/* Sets positions near the grid's plane, with noise of `noise` m, and a rotation
 * as velocity. */
static void set_state(struct motion_scene *s, double noise)
{
    uint32_t random = 1;
    for (int p = 0; p < COUNT; p++)
        for (int k = 0; k < 3; k++) {
            int at = k == 2 ? 0 : k ? p / WIDE : p % WIDE;
            random = random * 1664525 + 1013904223;
            s->x[p][k] = 0.1 * at + noise * ((random >> 8) * 0x1p-23 - 1);
            s->v[p][k] = k == 2 ? 0.1 * (p % WIDE) : 0.05 * (p % 7);
        }
    s->cloth.x = (const double(*)[3])s->x;
    s->cloth.velocity = (const double(*)[3])s->v;
}

/* Scene 0: pinned; 1: with holes and wind; 2: free, damped and crumpled; 3:
 * with a moving pin; 4: as 1, by Newton's method. */
static void make_scene(struct motion_scene *s, int integrator, int scene)
{
    memset(s, 0, sizeof *s);
    drape_default(&s->def);
    drape_default_cloth(&s->cloth);
    s->def.precision = REAL_BITS;
    s->def.integrator = integrator;
    s->def.precond = scene % 2 ? DRAPE_JACOBI : DRAPE_MULTIGRID;
    s->def.matrix = scene < 2 ? DRAPE_COMPACT : DRAPE_CDF;
    s->def.self_collision = s->def.sleep = 0;
    s->def.allow_intersecting = 1;
    s->def.max_substeps = 1 << 20;
    s->def.dt = integrator < DRAPE_BW ? 5e-4 : 1.0 / 60;
    s->def.newton = scene == 4 ? 3 : 0;
    s->def.cloths = &s->cloth;
    s->def.n_cloths = 1;
    s->def.motions = &s->lead;
    s->def.n_motions = 1;
    s->lead = (drape_motion){.keys = 2, .time = times, .position = way};
    s->cloth.m = WIDE;
    s->cloth.n = HIGH;
    s->cloth.width = 0.1 * (WIDE - 1);
    s->cloth.height = 0.1 * (HIGH - 1);
    s->cloth.material.damping = scene == 2 ? 0.01 : 1e-3;
    s->pins[0] = (drape_pin){0, HIGH - 1, scene == 3 ? 0 : -1};
    s->pins[1] = (drape_pin){WIDE - 1, HIGH - 1, -1};
    s->cloth.pins = s->pins;
    s->cloth.n_pins = scene == 2 ? 0 : 2;
    set_state(s, scene == 2 ? 0.05 : 0.004);
    s->hole[0] = s->hole[WIDE * 3 + 4] = s->hole[WIDE * 3 + 5] = 1;
    if (scene == 1 || scene == 4) {
        s->cloth.hole = s->hole;
        s->def.wind = (drape_wind){
            .velocity = {1, -2, 0.5}, .density = 1.2, .drag = 1.1, .lift = 0.8};
    }
}

static const char *compare(const struct motion_scene *s, bool diverges)
{
    struct twin twin;
    const char *failed = twin_run(&s->def, STEPS, &twin);
    if (failed)
        return failed;
    EXPECT(twin.steps == STEPS);
    EXPECT((diverges ? twin.all : ~twin.some) & DRAPE_DIVERGED);
    ran(twin.steps);
    return NULL;
}

/* A free sheet at the largest velocity that is allowed. how = 0: gravity moves
 * it beyond the largest coordinate; how = 1: its mass makes the energy too
 * large. */
static void make_diverge(struct motion_scene *s, int integrator, int how)
{
    make_scene(s, integrator, 2);
    for (int p = 0; p < COUNT; p++) {
        s->v[p][0] = s->v[p][2] = 0;
        s->v[p][1] = -0x1p60;
    }
    s->def.gravity[1] = how == 0 ? -0x1p58 : 0;
    s->cloth.material.density = how == 1 ? 100 : 0.1;
}

const char *test_motion_device(void)
{
    static struct motion_scene s;
    const char *failed = NULL;
    for (int m = 0; m < METHODS && !failed; m++)
        for (int scene = 0; scene < SCENES && !failed; scene++) {
            if (scene == 4 && m < DRAPE_BW)
                continue;
            make_scene(&s, m, scene);
            failed = compare(&s, false);
        }
    for (int m = 0; m < METHODS && !failed; m++)
        for (int how = 0; how < 2 && !failed; how++) {
            make_diverge(&s, m, how);
            failed = compare(&s, true);
        }
    return failed;
}
