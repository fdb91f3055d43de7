/* SPDX-License-Identifier: Apache-2.0 */
/* Whole scenes through the public API: the same bits with any number of threads
 * and after a checkpoint, no intersection, refusals that name the fault.
 * spec/world/step.md */
#include <stdio.h>

#include "tests/base/choices.h"
#include "tests/world/recall.h"
#include "tests/world/scene.h"
#include "tests/world/slab.h"

/* Makes n steps. Returns the hash of the state, or 0 if a step fails or is not
 * clean. */
static uint64_t run(drape_world *world, int n)
{
    for (int k = 0; k < n; k++) {
        drape_step_report r;
        if (drape_step(world, &r) != DRAPE_OK ||
            r.outcome & (DRAPE_TRAPPED | DRAPE_DIVERGED) ||
            scene_audit(world, 1) != 0)
            return 0;
    }
    return scene_hash(world);
}

/* spec/README.md §1.7: whole steps give the same bits with any number of
 * threads. The cloth is large enough for the step to use them. */
const char *test_world_threads(void)
{
    static const int some[] = {DRAPE_EULER, DRAPE_BW, DRAPE_CK, DRAPE_BDF2};
    for (int k = 0; k < 4; k++) {
        int integrator = some[k];
        uint64_t want = 0;
        for (int threads = 1; threads <= 3; threads += 2) {
            struct slab d;
            slab_make(&d, integrator);
            d.cloth.m = d.cloth.n = 65;
            d.def.threads = threads;
            if (integrator < DRAPE_BW)
                d.def.dt = 1e-4; /* few substeps, for speed */
            d.cloth.origin[1] = 0.1041;
            drape_world *world = slab_world(&d);
            EXPECT(world);
            uint64_t hash = run(world, 2);
            drape_destroy(world);
            EXPECT(hash);
            EXPECT(threads == 1 || hash == want);
            want = hash;
            ran(1);
        }
    }
    return NULL;
}

/* A run resumed from a checkpoint equals an unbroken run; a damaged checkpoint
 * is refused and changes nothing. */
const char *test_world_resume(void)
{
    struct slab d;
    for (int integrator = DRAPE_VERLET; integrator <= DRAPE_BDF2;
         integrator++) {
        static struct recall m;
        slab_make(&d, integrator);
        if (integrator < DRAPE_BW)
            d.def.dt = 2e-4;
        drape_world *a = slab_world(&d), *b = slab_world(&d);
        EXPECT(a && b);
        EXPECT(run(a, 10));
        EXPECT(recall_save(a, &m));
        uint64_t want = run(a, 6);

        m.data[m.size / 2] ^= 1;
        uint64_t before = scene_hash(b);
        EXPECT(recall_load(b, &m) == DRAPE_EMATCH);
        EXPECT(scene_hash(b) == before);
        m.data[m.size / 2] ^= 1;
        m.data[12] ^= 1; /* in the header: steps at rest */
        EXPECT(recall_load(b, &m) == DRAPE_EMATCH);
        m.data[12] ^= 1;
        EXPECT(recall_load(b, &m) == DRAPE_OK);
        EXPECT(run(b, 6) == want && want);
        drape_destroy(b);

        d.cloth.material.friction += 1e-3; /* another scene */
        b = slab_world(&d);
        EXPECT(recall_load(b, &m) == DRAPE_EMATCH);
        m.size /= 2;
        EXPECT(recall_load(b, &m) < 0);
        drape_destroy(a);
        drape_destroy(b);
        ran(1);
    }
    return NULL;
}

/* A world made without air, whose wind blows and then ends, goes on from
 * checkpoints of both times in a world that was made without air, too. */
static bool resume_calm(const struct slab *d, drape_world *world)
{
    static struct recall windy, calm;
    const drape_wind none = {.drag = 1, .lift = 0.3};
    drape_world *other = slab_world(d);
    bool good = other && recall_save(world, &windy);
    uint64_t want = run(world, 2);
    good = good && drape_set_wind(world, &none) == DRAPE_OK &&
           recall_save(world, &calm);
    uint64_t after = run(world, 4);
    good = good && recall_load(other, &windy) == DRAPE_OK &&
           run(other, 2) == want && recall_load(other, &calm) == DRAPE_OK &&
           run(other, 4) == after;
    drape_destroy(other);
    return good;
}

/* Wind set by a call acts like wind in the definition, and wakes a sleeping
 * world, also one that was made without air: it has air until its wind has no
 * density again, and a checkpoint of it goes on in another world. */
const char *test_world_wind(void)
{
    const drape_wind calm = {
        .velocity = {0, 0, 0}, .density = 1.2, .drag = 1, .lift = 0.3};
    const drape_wind gale = {
        .velocity = {6, 0, 2}, .density = 1.2, .drag = 1, .lift = 0.3};
    const drape_wind wrong = {
        .velocity = {0, 0, 0}, .density = -1, .drag = 1, .lift = 0.3};
    for (int k = 0; k < 2; k++) {
        static struct recall m;
        struct slab d;
        slab_make(&d, k ? DRAPE_CK : DRAPE_BW);
        drape_world *airless = slab_world(&d);
        d.def.wind = calm;
        drape_world *a = slab_world(&d);
        d.def.wind = gale;
        drape_world *b = slab_world(&d);
        EXPECT(airless && a && b);
        EXPECT(drape_set_wind(airless, &wrong) == DRAPE_EARG);
        EXPECT(drape_set_wind(a, &wrong) == DRAPE_EARG);
        EXPECT(drape_set_wind(airless, &gale) == DRAPE_OK);
        EXPECT(drape_set_wind(a, &gale) == DRAPE_OK);
        uint64_t want = run(b, 3);
        EXPECT(want && run(a, 3) == want && run(airless, 3) == want);
        EXPECT(recall_save(a, &m));
        uint64_t before = scene_hash(airless);
        EXPECT(recall_load(airless, &m) == DRAPE_EMATCH);
        EXPECT(scene_hash(airless) == before);
        d.def.wind = (drape_wind){{0}, 0, 1, 0.3};
        EXPECT(resume_calm(&d, airless));
        drape_destroy(airless);
        drape_destroy(a);
        drape_destroy(b);
        ran(1);
    }
    return NULL;
}

/* Small random scenes end each step without an intersection. */
const char *test_world_random(void)
{
    for (uint64_t seed = 1; seed <= 24; seed++) {
        struct bytes b = {.seed = seed, .size = -1};
        const char *failed = scene_random(&b);
        choices_free(&b);
        if (failed) {
            printf("seed %d\n", (int)seed);
            return failed;
        }
        ran(1);
    }
    return NULL;
}

/* spec/gpu.md §6: stages, reports and states of every step have the same bits
 * on both backends. */
const char *test_world_device(void)
{
    for (uint64_t seed = 1; seed <= 12; seed += SCENE_EVERY) {
        struct bytes b = {.seed = seed, .size = -1};
        int64_t steps = 0;
        const char *failed = scene_twins(&b, &steps);
        choices_free(&b);
        if (failed) {
            printf("seed %d\n", (int)seed);
            return failed;
        }
        ran(steps);
    }
    return NULL;
}

/* The same of panels. A scene that both refuse, as the particle of a pin is
 * missing, has no steps. */
const char *test_panel_device(void)
{
    int64_t all = 0;
    for (uint64_t seed = 1; seed <= 8; seed += SCENE_EVERY) {
        struct bytes b = {.seed = seed, .size = -1};
        int64_t steps = 0;
        const char *failed = scene_panels(&b, &steps);
        choices_free(&b);
        if (failed) {
            printf("seed %d\n", (int)seed);
            return failed;
        }
        all += steps;
    }
    EXPECT(all >= (SCENE_EVERY == 1 ? 18 : 6));
    ran(all);
    return NULL;
}

/* An invalid definition is refused with one line that names the place. */
const char *test_world_refusals(void)
{
    struct slab d;
    drape_world *world;
    drape_error e;
#define REFUSED(change, status, text_)                                         \
    do {                                                                       \
        slab_make(&d, DRAPE_BW);                                               \
        change;                                                                \
        EXPECT(drape_create(&d.def, &world, &e) == (status) && !world);        \
        EXPECT(strstr(e.text, text_));                                         \
        ran(1);                                                                \
    } while (0)
    REFUSED(d.cloth.m = 1, DRAPE_EARG, "cloth 0: m is 1, expected 2");
    REFUSED(d.cloth.width = 0, DRAPE_EARG, "width");
    REFUSED(d.cloth.material.stretch = (double)NAN, DRAPE_EDATA, "stretch");
    REFUSED(d.def.dt = -1, DRAPE_EARG, "dt");
    REFUSED(d.def.precision = 16, DRAPE_EARG, "precision");
    REFUSED(d.def.backend = 2, DRAPE_EARG, "backend");
    REFUSED(d.def.solver = DRAPE_CUBLAS, DRAPE_EARG, "cublas");
    REFUSED(d.obstacle.motion = 3, DRAPE_EARG, "obstacle 0: motion");
    REFUSED(d.obstacle.n_vertices = 5, DRAPE_EARG, "names vertex");
    REFUSED(d.cloth.n_pins = -1, DRAPE_EARG, "n_pins is -1");
    REFUSED(d.cloth.n_pins = 1, DRAPE_EARG, "cloth 0: pins is NULL");
    uint8_t gone[33 * 33], cut[32 * 32] = {1};
    memset(gone, 1, sizeof gone);
    EXPECT(sizeof gone >= (size_t)d.cloth.m * (size_t)d.cloth.n);
    REFUSED(d.cloth.hole = gone, DRAPE_EARG, "cloth 0: holes and cuts leave");
    /* the corner particle has one cell, which is cut away */
    const drape_pin pins[2] = {{1, 0, -1}, {0, 0, -1}};
    REFUSED((d.cloth.cut = cut, d.cloth.pins = pins, d.cloth.n_pins = 2),
            DRAPE_EARG, "cloth 0: pin 1: particle (0, 0) is missing");
    memset(gone, 0, sizeof gone);
    gone[0] = 1;
    REFUSED((d.cloth.hole = gone, d.cloth.pins = pins, d.cloth.n_pins = 2),
            DRAPE_EARG, "cloth 0: pin 1: particle (0, 0) is missing");
    REFUSED(d.cloth.width *= 1.9, DRAPE_EARG, "stretch / shear) = 1.826");
    REFUSED(d.def.obstacles = NULL, DRAPE_EARG, "obstacles is NULL");
    REFUSED(d.motion.position = NULL, DRAPE_EARG, "motion 0: position");
    REFUSED(d.cloth.origin[1] = 0.1, DRAPE_ESTART, "intersecting");
    REFUSED(d.cloth.u[0] = 2, DRAPE_EARG, "unit");
    REFUSED((d.def.integrator = DRAPE_RK4, d.def.max_substeps = 1),
            DRAPE_ELIMIT, "substeps");
#undef REFUSED
    return NULL;
}
