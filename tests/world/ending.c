/* SPDX-License-Identifier: Apache-2.0 */
/* A step reports exactly whether the state that it ends in intersects.
 * spec/world/step.md §11 */
#include "tests/world/recall.h"
#include "tests/world/scene.h"
#include "tests/world/slab.h"

enum { SIDE = 9, STEPS = 10 };

/* A sheet over the slab. Two of its edges are prescribed down past the slab and
 * up again; the middle of the sheet, which the slab holds, cannot follow. */
struct press {
    struct slab d;
    drape_pin pin[2 * SIDE];
    drape_motion motion[2];
};

static const double times[3] = {0, 4.0 / 60, 8.0 / 60};
static const double way[3][3] = {{0, 0, 0}, {0, -0.2, 0}, {0, 0.01, 0}};

static void make_press(struct press *p, int integrator)
{
    slab_make(&p->d, integrator);
    drape_cloth *c = &p->d.cloth;
    c->m = c->n = SIDE;
    c->width = c->height = 0.15; /* narrower than the slab */
    c->origin[0] = c->origin[2] = -0.075;
    p->d.obstacle.motion = -1;
    p->motion[0] = (drape_motion){.keys = 3, .time = times, .position = way};
    p->d.def.motions = p->motion;
    for (int k = 0; k < 2 * SIDE; k++)
        p->pin[k] = (drape_pin){k % SIDE, k < SIDE ? 0 : SIDE - 1, 0};
    c->pins = p->pin;
    c->n_pins = 2 * SIDE;
}

/* The report of a step agrees with an audit of the state. */
static const char *agree(const drape_world *world, const drape_step_report *r)
{
    int64_t found = scene_audit(world, 1);
    EXPECT(r->intersecting == found);
    EXPECT(!!(r->outcome & DRAPE_TRAPPED) == (found > 0));
    EXPECT(!(r->outcome & DRAPE_PASSED) || found == 0);
    return NULL;
}

static drape_world *make(const struct press *p, int backend)
{
    struct slab d = p->d;
    d.def.backend = backend;
    d.def.precond = DRAPE_JACOBI; /* emulated multigrid is slow */
    d.def.cloths = &p->d.cloth;
    d.def.obstacles = &p->d.obstacle;
    return slab_world(&d);
}

/* Runs the press on one backend. hash: of the state after each step. */
static const char *follow(const struct press *p, int backend,
                          uint64_t hash[STEPS], int *trapped)
{
    drape_world *world = make(p, backend);
    EXPECT(world);
    const char *failed = NULL;
    *trapped = 0;
    for (int k = 0; k < STEPS && !failed; k++) {
        drape_step_report r;
        memset(&r, 0, sizeof r);
        if (drape_step(world, &r) != DRAPE_OK)
            failed = "a step failed";
        else
            failed = agree(world, &r);
        memset(r.seconds, 0, sizeof r.seconds);
        hash[k] = hash_bytes(scene_hash(world), &r, sizeof r);
        *trapped += (r.outcome & DRAPE_TRAPPED) != 0;
        ran(1);
    }
    drape_destroy(world);
    return failed;
}

/* §11: a step reports TRAPPED if and only if its state has an intersecting
 * pair, with the same bits on both backends. The state has none any more once
 * the pins are back. */
const char *test_ending_trapped(void)
{
    for (int method = DRAPE_BW; method <= DRAPE_CK; method++) {
        struct press p;
        uint64_t hash[2][STEPS];
        int trapped[2];
        make_press(&p, method);
        const char *failed = follow(&p, DRAPE_REF, hash[0], &trapped[0]);
        if (failed)
            return failed;
        EXPECT(trapped[0] > 2 && trapped[0] < STEPS);
        if (scene_left_out(method, DRAPE_GPU))
            continue;
        failed = follow(&p, DRAPE_GPU, hash[1], &trapped[1]);
        if (failed)
            return failed;
        EXPECT(!memcmp(hash[0], hash[1], sizeof hash[0]));
    }
    return NULL;
}

/* §11: a checkpoint keeps the number of intersecting pairs. */
const char *test_ending_resumed(void)
{
    static struct recall f;
    struct press p;
    drape_step_report r[2];
    make_press(&p, DRAPE_BW);
    drape_world *world[2] = {make(&p, DRAPE_REF), make(&p, DRAPE_GPU)};
    EXPECT(world[0] && world[1]);
    do
        EXPECT(drape_step(world[0], &r[0]) == DRAPE_OK);
    while (!(r[0].outcome & DRAPE_TRAPPED));
    EXPECT(recall_save(world[0], &f));
    EXPECT(recall_load(world[1], &f) == DRAPE_OK);
    for (int k = 0; k < 2; k++)
        EXPECT(drape_step(world[k], &r[k]) == DRAPE_OK);
    EXPECT(r[1].outcome & DRAPE_TRAPPED);
    EXPECT(r[0].intersecting == r[1].intersecting &&
           r[0].outcome == r[1].outcome);
    ran(1);
    drape_destroy(world[0]);
    drape_destroy(world[1]);
    return NULL;
}

/* Where a weightless sheet at rest lies: above the slab, across it, or pierced
 * by a needle. */
enum lie { BESIDE, WITHIN, PIERCED };

static void make_rest(struct press *p, enum lie lie)
{
    static const double needle[3][3] = {
        {0.01, 0, 0.013}, {0.02, 0.3, 0.015}, {0.03, 0, 0.018}};
    static const int32_t tri[1][3] = {{0, 1, 2}};
    make_press(p, DRAPE_BW);
    p->d.def.allow_intersecting = 1;
    p->d.def.gravity[1] = 0;
    p->motion[0].keys = 1;
    p->d.cloth.pins = NULL;
    p->d.cloth.n_pins = 0;
    p->d.cloth.width = p->d.cloth.height = 0.46;
    p->d.cloth.origin[0] = p->d.cloth.origin[2] = -0.23;
    p->d.cloth.origin[1] = lie == BESIDE ? 0.12 : 0.09;
    if (lie != PIERCED)
        return;
    p->d.cloth.material.thickness = 1e-4; /* so thin that no pair repels */
    p->d.obstacle.x = needle;
    p->d.obstacle.n_vertices = 3;
    p->d.obstacle.tri = tri;
    p->d.obstacle.n_triangles = 1;
}

/* §11: where the start intersects, and may, each step reports this from the
 * first on, asleep or not. */
const char *test_ending_start(void)
{
    for (int k = 0; k < 6; k++) {
        struct press p;
        enum lie lie = (enum lie)(k / 2);
        make_rest(&p, lie);
        drape_world *world = make(&p, k % 2 ? DRAPE_GPU : DRAPE_REF);
        EXPECT(world);
        drape_step_report r = {.step = 0};
        for (int step = 0; step < (lie == PIERCED ? 40 : 3); step++) {
            EXPECT(drape_step(world, &r) == DRAPE_OK);
            const char *failed = agree(world, &r);
            if (failed)
                return failed;
            EXPECT(step > 0 || (r.intersecting > 0) == (lie != BESIDE));
            ran(1);
        }
        EXPECT(lie != PIERCED || r.outcome == (DRAPE_ASLEEP | DRAPE_TRAPPED));
        drape_destroy(world);
    }
    return NULL;
}

/* §11: without self-collision, cloths that intersect each other do not count.
 */
const char *test_ending_alone(void)
{
    for (int k = 0; k < 2; k++) {
        struct press p;
        make_rest(&p, BESIDE);
        drape_cloth two[2] = {p.d.cloth, p.d.cloth};
        two[1].v[1] = 0.6; /* slanted through the first */
        two[1].v[2] = 0.8;
        two[1].origin[1] -= 0.6 * 0.1;
        p.d.def.self_collision = k;
        p.d.def.cloths = two;
        p.d.def.n_cloths = 2;
        drape_world *world = slab_world(&p.d);
        drape_step_report r;
        EXPECT(world && drape_step(world, &r) == DRAPE_OK);
        EXPECT(!!(r.outcome & DRAPE_TRAPPED) == k && (r.intersecting > 0) == k);
        drape_destroy(world);
        ran(1);
    }
    return NULL;
}

/* §11: a cloth that is prescribed through a plate within a step is reported
 * (PASSED), though nothing intersects at the end. */
const char *test_ending_passed(void)
{
    static const double at[2] = {0, 1.0 / 60};
    static const double down[2][3] = {{0, 0, 0}, {0, -0.2, 0}};
    struct press p;
    drape_pin all[SIDE * SIDE];
    for (int k = 0; k < 2; k++) {
        make_press(&p, DRAPE_BW);
        p.motion[0] = (drape_motion){.keys = 2, .time = at, .position = down};
        for (int i = 0; i < SIDE * SIDE; i++)
            all[i] = (drape_pin){i % SIDE, i / SIDE, 0};
        p.d.cloth.pins = all;
        p.d.cloth.n_pins = SIDE * SIDE;
        p.d.def.max_slices = 1;
        drape_world *world = make(&p, k ? DRAPE_GPU : DRAPE_REF);
        EXPECT(world);
        drape_step_report r;
        EXPECT(drape_step(world, &r) == DRAPE_OK);
        EXPECT(r.outcome & DRAPE_PASSED && !(r.outcome & DRAPE_TRAPPED));
        EXPECT(scene_audit(world, 1) == 0 && r.intersecting == 0);
        EXPECT(drape_step(world, &r) == DRAPE_OK);
        EXPECT(!(r.outcome & (DRAPE_PASSED | DRAPE_TRAPPED)));
        drape_destroy(world);
        ran(1);
    }
    return NULL;
}
