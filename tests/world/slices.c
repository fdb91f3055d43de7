/* SPDX-License-Identifier: Apache-2.0 */
/* Steps that are cut into slices, and steps that are not. spec/world/step.md §7
 */
#include <stdlib.h>

#include "tests/world/scene.h"
#include "tests/world/slab.h"

/* An allocator that fails after `left` allocations. */
struct meter {
    int left;
};

static void *take_metered(void *user, size_t bytes)
{
    struct meter *m = user;
    return m->left-- > 0 ? aligned_alloc(64, (bytes + 63) / 64 * 64) : NULL;
}

static void give_metered(void *user, void *p, size_t bytes)
{
    (void)user;
    (void)bytes;
    free(p);
}

/* Makes the slab scene with its sheet thrown down, 1 mm above the slab. */
static void make_throw(struct slab *d, int integrator, double speed)
{
    static double v[24 * 24][3];
    slab_make(d, integrator);
    for (int k = 0; k < 24 * 24; k++)
        v[k][1] = -speed;
    d->cloth.velocity = (const double(*)[3])v;
    d->cloth.origin[1] = 0.105;
}

/* step.md §7.2: with impulses after the motion a step is cut where a sheet is
 * thrown at an obstacle, and ends without an intersection. It is not cut in
 * free fall, however fast, or where max_slices is 1. Where contacts are solved
 * with the cloths it is cut only while something touches at a loop's end: three
 * times at most. */
const char *test_world_slices(void)
{
    struct slab d;
    drape_step_report r;
    for (int k = 0; k < 6; k++) {
        make_throw(&d, k % 2 ? DRAPE_CK : DRAPE_BW, 20);
        bool free_fall = k == 2;
        d.def.response = k < 4 ? DRAPE_IMPULSES : DRAPE_SOLVE;
        d.def.max_slices = k == 3 ? 1 : 32;
        if (free_fall)
            d.cloth.origin[1] = 2;
        drape_world *world = slab_world(&d);
        EXPECT(world);
        EXPECT(drape_step(world, &r) == DRAPE_OK);
        EXPECT(!(r.outcome & (DRAPE_TRAPPED | DRAPE_DIVERGED)));
        EXPECT(scene_audit(world, 1) == 0);
        EXPECT(k < 2 ? r.slices > 2 && r.slices <= 32
                     : r.slices <= (k < 4 ? 1 : 8));
        EXPECT(r.time == d.def.dt);
        drape_destroy(world);
        ran(1);
    }
    return NULL;
}

/* step.md §7.3: without rounds of impulses only the shortest slice runs the
 * fail-safe; longer slices end before their zones and are taken again. */
const char *test_world_brief(void)
{
    for (int slices = 1; slices <= 4; slices *= 2) {
        struct slab d;
        drape_step_report r;
        make_throw(&d, DRAPE_BW, 2);
        d.def.response = DRAPE_IMPULSES;
        d.def.max_rounds = 0;
        d.def.max_slices = slices;
        drape_world *world = slab_world(&d);
        EXPECT(world);
        EXPECT(drape_step(world, &r) == DRAPE_OK && r.slices == slices);
        EXPECT(r.outcome & DRAPE_ZONES && r.zone_vertices > 0);
        EXPECT((r.work.tries > slices) == (slices > 1));
        EXPECT(scene_audit(world, 1) == 0);
        drape_destroy(world);
        ran(1);
    }
    return NULL;
}

/* A sheet that flies at a slab at rest, where pins lead a corner of it into the
 * slab. The whole step meets the slab, its first half comes nowhere near. */
static void make_flight(struct slab *d, int integrator)
{
    static double v[SLAB_SMALL * SLAB_SMALL][3];
    static const drape_pin pins[3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    static const double way[2][3] = {{0}, {0, -8, 0}};
    slab_small(d, integrator, 0.1875);
    for (int k = 0; k < SLAB_SMALL * SLAB_SMALL; k++)
        v[k][1] = -8;
    d->motion.position = way;
    d->cloth.velocity = (const double(*)[3])v;
    d->cloth.pins = pins;
    d->cloth.n_pins = 3;
    d->obstacle.motion = -1;
    d->def.sleep = 0;
}

/* step.md §7: of a slice that is taken again nothing stays. What its contacts
 * pushed is no past of the slice that takes its place, and no contact carries
 * it on: a step of two slices ends as two steps of half its length. */
const char *test_world_undone(void)
{
    for (int k = 0; k < 3; k++) {
        struct slab d;
        drape_step_report r;
        make_flight(&d, DRAPE_BW + k);
        d.def.max_slices = 2;
        drape_world *cut = slab_world(&d);
        d.def.dt /= 2;
        d.def.max_slices = 1;
        drape_world *halves = slab_world(&d);
        EXPECT(cut && halves && drape_step(cut, &r) == DRAPE_OK);
        EXPECT(r.slices == 2 && r.work.tries == 3);
        EXPECT(drape_step(halves, &r) == DRAPE_OK && r.candidates == 0);
        EXPECT(drape_step(halves, &r) == DRAPE_OK && r.candidates > 0);
        EXPECT(scene_hash(cut) == scene_hash(halves));
        drape_destroy(cut);
        drape_destroy(halves);
        ran(1);
    }
    return NULL;
}

/* step.md §7.3: repulsion may add energy. Repulsion pushes a sheet at rest on a
 * slope away from the slope; the added energy, about 1 mJ, exceeds the energy
 * of the sheet, but does not cut the step. */
const char *test_world_rest(void)
{
    for (int k = 0; k < 2; k++) {
        struct slab d;
        slab_make(&d, k ? DRAPE_CK : DRAPE_BW);
        d.cloth.width = d.cloth.height = 0.19;
        d.cloth.origin[0] = d.cloth.origin[2] = -0.095;
        d.cloth.origin[1] = 0.1039; /* 0.1 mm closer than the thickness */
        d.cloth.material.friction = 0.8;
        d.obstacle.motion = -1;
        d.def.gravity[0] = 5.886; /* 9.81 on a slope of 3/4 */
        d.def.gravity[1] = -7.848;
        drape_world *world = slab_world(&d);
        EXPECT(world);
        for (int step = 0; step < 20; step++) {
            drape_step_report r;
            EXPECT(drape_step(world, &r) == DRAPE_OK && r.contacts > 0);
            EXPECT(r.slices == 1 && r.work.tries == 1);
            ran(1);
        }
        drape_destroy(world);
    }
    return NULL;
}

/* Makes a sheet at rest in empty space, which the slab hits in step 4. */
static void make_blow(struct slab *d, int integrator)
{
    static const double time[3] = {0, 3.0 / 60, 4.0 / 60};
    static const double way[3][3] = {{0}, {0}, {0, 0.5, 0}};
    slab_make(d, integrator);
    d->motion = (drape_motion){.keys = 3, .time = time, .position = way};
    d->def.gravity[1] = 0;
    d->cloth.width = d->cloth.height = 23.0 / 64;    /* exact numbers: no */
    d->cloth.origin[0] = d->cloth.origin[2] = -0.25; /* force by rounding */
    d->cloth.origin[1] = 0.375;
}

/* Makes a swatch that hangs by an edge and falls further than a cell. */
static void make_swatch(struct slab *d, int integrator)
{
    static const drape_pin pins[3] = {{0, 0, -1}, {0, 1, -1}, {0, 2, -1}};
    slab_make(d, integrator);
    d->def.n_obstacles = d->def.n_motions = 0;
    d->cloth.bending = DRAPE_SPRINGS;
    d->cloth.m = 16;
    d->cloth.n = 3;
    d->cloth.width = 0.015;
    d->cloth.height = 0.002;
    d->cloth.pins = pins;
    d->cloth.n_pins = 3;
}

static int hash_written(void *user, const void *data, size_t bytes)
{
    uint64_t *hash = user;
    *hash = hash_bytes(*hash, data, bytes);
    return 0;
}

/* A hash of everything that the next step reads; 0 if saving fails. */
static uint64_t checkpoint_hash(const drape_world *world)
{
    uint64_t hash = HASH_START;
    return drape_save(world, hash_written, &hash) == DRAPE_OK ? hash : 0;
}

/* step.md §7: a step that runs out of memory, in whichever slice, leaves the
 * state as it was; repeated, it gives the same bits. */
const char *test_world_restore(void)
{
    struct slab d;
    int failed = 0;
    for (int k = 0; k < 6; k++) {
        struct meter m = {1 << 20};
        int integrator = k % 2 ? DRAPE_CK : DRAPE_BW;
        if (k < 2)
            make_throw(&d, integrator, 20);
        else if (k < 4)
            make_blow(&d, integrator);
        else
            make_swatch(&d, integrator);
        d.def.response = k < 4 ? DRAPE_IMPULSES : DRAPE_SOLVE;
        d.def.allocator = (drape_allocator){take_metered, give_metered, &m};
        drape_world *a = slab_world(&d), *b = slab_world(&d);
        EXPECT(a && b);
        for (int step = 0; step < (k / 2 == 1 ? 3 : 0); step++)
            EXPECT(!drape_step(a, NULL) && !drape_step(b, NULL));
        uint64_t before = checkpoint_hash(b);
        drape_step_report r;
        EXPECT(before && drape_step(a, &r) == DRAPE_OK);
        EXPECT(r.slices > 1);
        int status = DRAPE_ENOMEM;
        for (int left = 0; status != DRAPE_OK && left < 200; left++) {
            m.left = left;
            status = drape_step(b, NULL);
            m.left = 1 << 20; /* a checkpoint takes memory, too */
            EXPECT(status == DRAPE_OK || status == DRAPE_ENOMEM);
            EXPECT(status == DRAPE_OK || checkpoint_hash(b) == before);
            failed += status != DRAPE_OK;
        }
        EXPECT(status == DRAPE_OK && checkpoint_hash(a) == checkpoint_hash(b));
        m.left = 1 << 20;
        drape_destroy(a);
        drape_destroy(b);
        ran(1);
    }
    EXPECT(failed > 0);
    return NULL;
}

/* step.md §7.5: a swatch hangs by an edge and falls further than a cell in a
 * step. The linearised solve of a whole step diverges, shorter slices do not;
 * where the step may not be cut it reports DIVERGED and time does not advance.
 * Both backends. */
const char *test_world_cut(void)
{
    for (int k = 0; k < 4; k++) {
        struct slab d;
        drape_step_report r;
        make_swatch(&d, DRAPE_BW);
        d.def.backend = k % 2 ? DRAPE_GPU : DRAPE_REF;
        d.def.max_slices = k < 2 ? 32 : 1;
        drape_world *world = slab_world(&d);
        EXPECT(world && drape_step(world, &r) == DRAPE_OK);
        EXPECT(!(r.outcome & DRAPE_DIVERGED) == (k < 2));
        EXPECT(r.step == (k < 2) && (r.slices > 1) == (k < 2));
        EXPECT(k >= 2 || r.work.tries > r.slices);
        drape_destroy(world);
        ran(1);
    }
    return NULL;
}

/* Two cloths whose density is so small that their mass in this precision is 0.
 * They intersect, and in 64 bits a pin of one moves; or they start apart, and a
 * pin leads one into the other. */
static void make_burst(struct slab *d, drape_cloth cloth[2], bool apart)
{
    static const drape_pin pin[2] = {{0, 0, 0}, {2, 2, -1}};
    static const double times[2] = {0, 1}, up[2][3] = {{0}, {0.2, 0.02, 0}},
                        down[2][3] = {{0}, {0, -0.3, 0}};
    slab_make(d, DRAPE_BW);
    d->def.n_obstacles = 0;
    d->def.max_slices = 2;
    /* so small numbers take a processor long, and emulated multigrid, too */
    d->def.max_iterations = 20;
    d->def.precond = DRAPE_JACOBI;
    d->motion.time = times;
    d->motion.position = apart ? down : up;
    d->def.allow_intersecting = !apart;
    drape_default_cloth(&d->cloth);
    d->cloth.m = d->cloth.n = 4;
    d->cloth.width = d->cloth.height = 0.003;
    d->cloth.origin[0] = -0.05;
    d->cloth.material.friction = 1;
    d->cloth.material.density = REAL_BITS == 32 ? 1e-42 : 1e-319;
    cloth[0] = cloth[1] = d->cloth;
    cloth[1].origin[0] += 0.001;
    cloth[1].origin[1] += apart ? 3e-4 : 0;
    cloth[1].pins = pin;
    cloth[1].n_pins = apart ? 2 : REAL_BITS == 64;
    d->def.cloths = cloth;
    d->def.n_cloths = 2;
}

/* step.md §3.3, §11: where contact leads beyond all numbers the slice is taken
 * again; then the step reports DIVERGED, not what it met on the way, and the
 * state stays. Both backends agree on it, and on the work they did. The next
 * step begins at the same state and is the same step again, so it is made by
 * one method only. */
static const char *check_burst(int integrator, bool apart, int *burst)
{
    struct slab d;
    drape_cloth cloth[2];
    drape_step_report r[2];
    drape_world *world[2];
    make_burst(&d, cloth, apart);
    d.def.integrator = integrator;
    for (int k = 0; k < 2; k++) {
        bool left_out = scene_left_out(integrator, DRAPE_GPU);
        d.def.backend = k && !left_out ? DRAPE_GPU : DRAPE_REF;
        world[k] = slab_world(&d);
        EXPECT(world[k]);
    }
    for (int step = 0; step < (integrator == DRAPE_BW ? 2 : 1); step++) {
        uint64_t before = checkpoint_hash(world[0]);
        memset(r, 0, sizeof r);
        for (int k = 0; k < 2; k++) {
            EXPECT(drape_step(world[k], &r[k]) == DRAPE_OK);
            memset(r[k].seconds, 0, sizeof r[k].seconds);
        }
        uint64_t after = checkpoint_hash(world[0]);
        bool stays = r[0].outcome & DRAPE_DIVERGED;
        EXPECT(!memcmp(&r[0], &r[1], sizeof r[0]));
        EXPECT(checkpoint_hash(world[1]) == after);
        EXPECT((before == after) == stays);
        /* after a bad step slices are as short as they may be at once */
        EXPECT(!stays || step > 0 || r[0].work.tries > 1);
        EXPECT(!stays || !(r[0].outcome & DRAPE_PASSED));
        EXPECT(!(r[0].outcome & DRAPE_TRAPPED) == !r[0].intersecting);
        *burst += stays && r[0].contacts > 0;
    }
    drape_destroy(world[0]);
    drape_destroy(world[1]);
    return NULL;
}

const char *test_world_burst(void)
{
    int burst = 0; /* steps, by one method at least */
    for (int k = 0; k < 6; k++) {
        const char *failed = check_burst(DRAPE_BW + k / 2, k % 2, &burst);
        if (failed)
            return failed;
        ran(1);
    }
    EXPECT(burst >= 2);
    return NULL;
}
