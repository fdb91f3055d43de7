/* SPDX-License-Identifier: Apache-2.0 */
/* A fast body that moves into a hung sheet and stops there.
 * spec/contact/impulses.md §5, spec/contact/response.md §4 */
#include "ref/api/handle.h"
#include "ref/contact/contacts.h"
#include "ref/world/state.h"
#include "tests/world/scene.h"

enum { SIDE = 41, EVERY = 4, RINGS = 24, AROUND = 48, STEPS = 24 };
enum { BALL = RINGS * AROUND + 2 }; /* vertices: rings, then two poles */

static double ball_x[BALL][3];
static int32_t ball_tri[2 * RINGS * AROUND][3];
static drape_pin pin[SIDE];

/* Makes a sphere of radius 0.25 m about (0, 0.8, -1). */
static void make_ball(drape_obstacle *o)
{
    double pi = acos(-1.0);
    int32_t n = 0, south = BALL - 2, north = BALL - 1;
    for (int k = 0; k < BALL; k++) {
        double down = pi * (k / AROUND + 1) / (RINGS + 1);
        double along = 2 * pi * (k % AROUND) / AROUND;
        bool pole = k >= south;
        double y = pole ? k == north ? 1 : -1 : cos(down);
        double r = pole ? 0 : sin(down);
        ball_x[k][0] = 0.25 * r * cos(along);
        ball_x[k][1] = 0.8 + 0.25 * y;
        ball_x[k][2] = 0.25 * r * sin(along) - 1;
    }
    for (int32_t k = 0; k < RINGS * AROUND; k++) {
        int32_t next = k - k % AROUND + (k + 1) % AROUND;
        bool first = k < AROUND, last = k >= (RINGS - 1) * AROUND;
        const int32_t cap[3] = {next, k, first ? north : k - AROUND};
        const int32_t foot[3] = {k, next, last ? south : next + AROUND};
        memcpy(ball_tri[n++], cap, sizeof cap);
        memcpy(ball_tri[n++], foot, sizeof foot);
    }
    o->n_vertices = BALL;
    o->n_triangles = n;
    o->x = (const double(*)[3])ball_x;
    o->tri = (const int32_t(*)[3])ball_tri;
    o->friction = 0.3;
    o->motion = 0;
}

/* Makes a sheet that hangs in the plane z = 0 from pins at its upper edge. */
static void make_sheet(drape_cloth *c)
{
    c->m = c->n = SIDE;
    c->width = c->height = 1.5;
    c->origin[0] = -0.75;
    c->origin[1] = 1.5;
    c->v[1] = -1;
    c->v[2] = 0;
    c->material.thickness = 0.002;
    for (int i = 0; i < SIDE; i += EVERY)
        pin[c->n_pins++] = (drape_pin){.i = i, .motion = -1};
    c->pins = pin;
}

/* The rounds of impulses of a world that a listening backend steps. */
static struct {
    const struct response *of;
    int calls, wrong, late;
} rounds;

/* response.md §4: 8 iterations in the first two rounds, then 16, 24 … */
static int hear_contacts(struct gpu *on, struct contacts *s)
{
    int round = rounds.of->rounds;
    rounds.calls++;
    rounds.late += round > 2;
    rounds.wrong += s->iterations != (round > 2 ? 8 * (round - 1) : 8);
    return backend_ref.contacts(on, s);
}

static void listen(drape_world *world)
{
    static struct backend ear;
    ear = backend_ref;
    ear.contacts = hear_contacts;
    world->world->run = world->world->response.run = &ear;
    memset(&rounds, 0, sizeof rounds);
    rounds.of = &world->world->response;
}

static drape_world *make_world(int response)
{
    static const double time[2] = {0, 0.26};
    static const double way[2][3] = {{0}, {0, 0, 1.3}};
    drape_motion motion = {.keys = 2, .time = time, .position = way};
    drape_def def;
    drape_cloth sheet;
    drape_obstacle ball;
    drape_world *world;
    drape_error error;
    drape_default(&def);
    drape_default_cloth(&sheet);
    drape_default_obstacle(&ball);
    make_ball(&ball);
    make_sheet(&sheet);
    def.precision = REAL_BITS;
    def.response = response;
    def.cloths = &sheet;
    def.obstacles = &ball;
    def.motions = &motion;
    def.n_cloths = def.n_obstacles = def.n_motions = 1;
    return drape_create(&def, &world, &error) == DRAPE_OK ? world : NULL;
}

/* The ball moves at 5 m/s and stops after 0.26 s. Where contacts are solved
 * with the cloth a step needs a round in the mean, and none is cut or taken
 * again. */
static const char *check_solve(void)
{
    drape_world *world = make_world(DRAPE_SOLVE);
    int64_t impacts = 0, total = 0;
    EXPECT(world);
    for (int step = 0; step < STEPS; step++) {
        drape_step_report r;
        EXPECT(drape_step(world, &r) == DRAPE_OK && r.outcome == 0);
        EXPECT(r.slices == 1 && r.work.tries == 1);
        impacts += r.impacts;
        total += r.rounds;
        ran(1);
    }
    EXPECT(total <= 2 * STEPS);
    EXPECT(impacts > 100 && scene_audit(world, 1) == 0);
    drape_destroy(world);
    return NULL;
}

/* With impulses after the motion the rounds have the iterations of response.md
 * §4, and the sheet ends free of intersections. */
static const char *check_impulses(void)
{
    drape_world *world = make_world(DRAPE_IMPULSES);
    int64_t impacts = 0;
    EXPECT(world);
    listen(world);
    for (int step = 0; step < STEPS; step++) {
        drape_step_report r;
        EXPECT(drape_step(world, &r) == DRAPE_OK);
        EXPECT(!(r.outcome & (DRAPE_TRAPPED | DRAPE_DIVERGED)));
        impacts += r.impacts;
        ran(1);
    }
    EXPECT(impacts > 1000);
    EXPECT(rounds.wrong == 0 && rounds.late > 0 && rounds.calls > 5);
    EXPECT(scene_audit(world, 1) == 0);
    drape_destroy(world);
    return NULL;
}

const char *test_world_fast(void)
{
    const char *failed = check_solve();
    return failed ? failed : check_impulses();
}
