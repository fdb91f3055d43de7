/* SPDX-License-Identifier: Apache-2.0 */
/* Bodies that deform by frames, in whole steps: fast ones go through nothing, a
 * rigid sequence is a rigid motion, impacts end without a bounce, and cloth
 * rests on a body that breathes. spec/world/kinematics.md §4 */
#include "ref/broad/box.h"
#include "ref/world/kinematics.h"
#include "tests/world/recall.h"
#include "tests/world/scene.h"
#include "tests/world/slab.h"

enum { RINGS = 16, AROUND = 32, BALL = RINGS * AROUND + 2, MOST = 64 };
enum { COUNT = SLAB_SMALL * SLAB_SMALL, BOX = 8 };

/* A sphere whose frames the tests fill in, and the times of the frames. */
struct ball {
    double x[MOST][BALL][3], time[MOST];
    int32_t tri[2 * RINGS * AROUND][3];
};
static struct ball ball;

/* Writes a spheroid about (0, y, z), of radius r across z and of `along` along
 * it. */
static void fill_ball(double (*x)[3], double y, double z, double r,
                      double along)
{
    double pi = acos(-1.0);
    for (int k = 0; k < BALL; k++) {
        double down = pi * (k / AROUND + 1) / (RINGS + 1);
        double turn = 2 * pi * (k % AROUND) / AROUND;
        bool pole = k >= BALL - 2;
        double up = pole ? k == BALL - 1 ? 1 : -1 : cos(down);
        double out = pole ? 0 : sin(down);
        x[k][0] = r * out * cos(turn);
        x[k][1] = y + r * up;
        x[k][2] = z + along * out * sin(turn);
    }
}

static void make_ball(drape_obstacle *o, int frames, int between)
{
    int32_t n = 0, south = BALL - 2, north = BALL - 1;
    for (int32_t k = 0; k < RINGS * AROUND; k++) {
        int32_t next = k - k % AROUND + (k + 1) % AROUND;
        bool first = k < AROUND, last = k >= (RINGS - 1) * AROUND;
        const int32_t cap[3] = {next, k, first ? north : k - AROUND};
        const int32_t foot[3] = {k, next, last ? south : next + AROUND};
        memcpy(ball.tri[n++], cap, sizeof cap);
        memcpy(ball.tri[n++], foot, sizeof foot);
    }
    drape_default_obstacle(o);
    o->n_vertices = BALL;
    o->n_triangles = n;
    o->x = (const double(*)[3])ball.x[0];
    o->tri = (const int32_t(*)[3])ball.tri;
    o->frames = frames;
    o->between = between;
    o->frame_time = ball.time;
    o->frame = (const double(*)[3])ball.x[0];
}

/* A step of a scene without a fault: nothing intersects, and the report says
 * so.
 */
static const char *check_clean(drape_world *world, drape_step_report *r)
{
    const int bad = DRAPE_TRAPPED | DRAPE_PASSED | DRAPE_DIVERGED;
    EXPECT(drape_step(world, r) == DRAPE_OK && !(r->outcome & bad));
    EXPECT(scene_audit(world, 1) == 0);
    ran(1);
    return NULL;
}

/* A ball at 5 m/s that becomes half as long again and shorter, at frames that
 * are no multiples of a step, meets a hung sheet of 21 × 21: between frames it
 * goes 0.1 m, fifty times the thickness. */
static const char *check_fast(int response, int between, double friction)
{
    enum { SIDE = 21, STEPS = 20, FRAMES = 14 };
    static drape_pin pin[SIDE];
    drape_def def;
    drape_cloth sheet;
    drape_obstacle body;
    drape_world *world;
    drape_step_report r;
    int64_t impacts = 0;
    drape_default(&def);
    drape_default_cloth(&sheet);
    for (int k = 0; k < FRAMES; k++) {
        ball.time[k] = 0.02 * k + 0.003 * (k % 2);
        fill_ball(ball.x[k], 0.8, 5 * ball.time[k] - 1, 0.25,
                  0.25 * (1 + 0.5 * sin(1.5 * k)));
    }
    make_ball(&body, FRAMES, between);
    sheet.m = sheet.n = SIDE;
    sheet.width = sheet.height = 1.5;
    sheet.origin[0] = -0.75;
    sheet.origin[1] = 1.5;
    sheet.v[1] = -1;
    sheet.v[2] = 0;
    sheet.material.friction = body.friction = friction;
    for (int i = 0; i < SIDE; i += 2)
        pin[sheet.n_pins++] = (drape_pin){.i = i, .motion = -1};
    sheet.pins = pin;
    def.precision = REAL_BITS;
    def.response = response;
    def.cloths = &sheet;
    def.obstacles = &body;
    def.n_cloths = def.n_obstacles = 1;
    EXPECT(drape_create(&def, &world, NULL) == DRAPE_OK);
    const char *failed = NULL;
    for (int step = 0; step < STEPS && !failed; step++) {
        failed = check_clean(world, &r);
        impacts += r.impacts;
    }
    drape_destroy(world);
    EXPECT(failed || impacts > 100);
    return failed;
}

const char *test_sequence_fast(void)
{
    const char *failed = NULL;
    for (int k = 0; k < 8 && !failed; k++)
        failed =
            check_fast(k < 6 ? DRAPE_SOLVE : DRAPE_IMPULSES, k / 2 % 2, k % 2);
    return failed;
}

/* Frames of a slab, each where a motion has it at that time. */
static double slab_frame[MOST][BOX][3], slab_rest[BOX][3];

static void follow(const drape_motion *m, int frames, double dt)
{
    static const int32_t motion[BOX];
    vec x[BOX];
    for (int k = 0; k < frames; k++) {
        struct pose pose = kinematics_pose(m, k * dt);
        struct kinematics s = {.n = BOX,
                               .rest = slab_rest[0],
                               .motion = motion,
                               .pose = &pose,
                               .poses = 1,
                               .x = x};
        ref_kinematics(&s);
        for (int p = 0; p < BOX; p++) {
            slab_frame[k][p][0] = (double)x[p].x;
            slab_frame[k][p][1] = (double)x[p].y;
            slab_frame[k][p][2] = (double)x[p].z;
        }
    }
}

/* A slab that turns and rises by a motion, and one by its frames. With a frame
 * a step, which is not cut, both are at the same places when it ends, and the
 * sheet has the same bits; with a frame every four steps too, if the motion is
 * a shift of multiples of 2^-16, of which nothing is rounded. */
static const char *check_rigid(int between, int every)
{
    enum { STEPS = 24 };
    static const double times[2] = {0, 0.5};
    static const double way[2][3] = {{0, 0, 0}, {0.0625, 0.125, 0}};
    static const double turn[2][4] = {{1, 0, 0, 0}, {0.8, 0, 0.6, 0}};
    struct slab d;
    drape_step_report r[2];
    int64_t contacts = 0;
    slab_small(&d, DRAPE_BW, 0.13);
    for (int k = 0; k < 3 * BOX; k++)
        slab_rest[k / 3][k % 3] = round(128 * d.obstacle.x[k / 3][k % 3]) / 128;
    d.motion =
        (drape_motion){2, times, way, every == 1 ? turn : NULL, {0.0625, 0, 0}};
    if (every > 1)
        d.motion.pivot[0] = 0;
    d.obstacle.x = (const double(*)[3])slab_rest;
    d.def.max_slices = 1;
    drape_world *a = slab_world(&d);
    follow(&d.motion, MOST / every, every * d.def.dt);
    d.obstacle.motion = -1;
    d.obstacle.frames = MOST / every;
    d.obstacle.frame_dt = every * d.def.dt;
    d.obstacle.between = between;
    d.obstacle.frame = (const double(*)[3])slab_frame[0];
    d.obstacle.x = d.obstacle.frame;
    drape_world *b = slab_world(&d);
    EXPECT(a && b && scene_hash(a) == scene_hash(b));
    for (int step = 0; step < STEPS; step++) {
        EXPECT(drape_step(a, &r[0]) == DRAPE_OK && r[0].outcome == 0);
        EXPECT(drape_step(b, &r[1]) == DRAPE_OK && r[1].outcome == 0);
        EXPECT(scene_hash(a) == scene_hash(b));
        contacts += r[0].contacts;
        ran(1);
    }
    drape_destroy(a);
    drape_destroy(b);
    EXPECT(contacts > 100);
    return NULL;
}

const char *test_sequence_rigid(void)
{
    const char *failed = NULL;
    for (int k = 0; k < 4 && !failed; k++)
        failed = check_rigid(k % 2, k / 2 ? 4 : 1);
    return failed;
}

/* The mean velocity of the sheet's particles along y, m/s. */
static double mean_speed(const drape_world *world)
{
    static double v[COUNT + BOX][3];
    double sum = 0;
    drape_read(world, NULL, v);
    for (int k = 0; k < COUNT; k++)
        sum += v[k][1] / COUNT;
    return sum;
}

/* A plate rises at 1/2 m/s by its frames and meets a flat sheet that falls at
 * 1/2 m/s without gravity. One step ends where contact begins; the next and all
 * that follow end with the plate's velocity: restitution is 0. After the plate
 * has stopped the sheet leaves it with that velocity, as nothing pulls it back.
 * What a solve leaves out of balance is up to ten times the tolerance of the
 * momentum that it turns round (lagrange.md §3.4), here of 1 m/s: in each of
 * the two steps, and in the second for the gap that the first has left. */
static const char *check_stop(int between, double friction)
{
    enum { STEPS = 40, RISES = 24 };
    static double v[COUNT][3], time[3];
    struct slab d;
    drape_step_report r;
    int met = -1;
    slab_small(&d, DRAPE_BW, 0.2);
    for (int k = 0; k < COUNT; k++)
        v[k][1] = -0.5;
    for (int f = 0; f < 3; f++) {
        time[f] = f * RISES * d.def.dt;
        for (int k = 0; k < BOX; k++)
            for (int i = 0; i < 3; i++)
                slab_frame[f][k][i] = d.obstacle.x[k][i] +
                                      (i == 1 ? 0.5 * time[f < 2 ? f : 1] : 0);
    }
    d.cloth.velocity = (const double(*)[3])v;
    d.cloth.material.friction = d.obstacle.friction = friction;
    d.def.gravity[1] = 0;
    d.def.tolerance = 1e-6;
    d.obstacle.motion = -1;
    d.obstacle.frames = between ? 2 : 3;
    d.obstacle.between = between;
    d.obstacle.frame_time = time;
    d.obstacle.frame = (const double(*)[3])slab_frame[0];
    drape_world *world = slab_world(&d);
    EXPECT(world);
    double slack = COUNT * (double)REAL_UNIT, struck = 10 * d.def.tolerance;
    for (int step = 0; step < STEPS; step++) {
        const char *failed = check_clean(world, &r);
        if (failed)
            return failed;
        double speed = mean_speed(world);
        if (met < 0 && fabs(speed + 0.5) > slack)
            met = step;
        EXPECT(met < 0 || step == met || fabs(speed - 0.5) <= 3 * struck);
    }
    drape_destroy(world);
    EXPECT(met > 2 && met < RISES - 4);
    return NULL;
}

const char *test_sequence_stop(void)
{
    const char *failed = NULL;
    for (int k = 0; k < 4 && !failed; k++)
        failed = check_stop(k % 2, k / 2);
    return failed;
}

/* A ball breathes, r = 0.1 (1 + 0.05 sin), twice a second, by eight frames a
 * period at uneven times, under a sheet of 0.36 m with friction. */
enum { DISC = 25, PERIODS = 6, EACH = 8, PERIOD = 30 };

static drape_world *make_breath(int backend, int steps)
{
    drape_def def;
    drape_cloth sheet;
    drape_obstacle body;
    drape_world *world;
    drape_default(&def);
    drape_default_cloth(&sheet);
    int frames = steps * EACH / PERIOD + 2;
    for (int k = 0; k < frames; k++) {
        double at = k + 0.2 * (k % 2), pi = acos(-1.0);
        double r = 0.1 * (1 + 0.05 * sin(2 * pi * at / EACH));
        ball.time[k] = at / EACH / 2;
        fill_ball(ball.x[k], 0, 0, r, r);
    }
    make_ball(&body, frames, DRAPE_CUBIC);
    sheet.m = sheet.n = DISC;
    sheet.width = sheet.height = 0.36;
    sheet.origin[0] = sheet.origin[2] = -0.18;
    sheet.origin[1] = 0.103;
    sheet.material.friction = body.friction = 0.6;
    def.backend = backend;
    def.precision = REAL_BITS;
    def.cloths = &sheet;
    def.obstacles = &body;
    def.n_cloths = def.n_obstacles = 1;
    return drape_create(&def, &world, NULL) == DRAPE_OK ? world : NULL;
}

/* The sheet stays in contact: after the first period, in which it falls, with
 * the top of the ball within the distance at which contact begins; and its
 * middle rests: in a period it moves by no more than a solve may leave out of
 * balance, `tolerance` of g dt a step. */
const char *test_sequence_breath(void)
{
    enum { PARTICLES = DISC * DISC, MIDDLE = PARTICLES / 2 };
    static double x[PARTICLES + BALL][3];
    double was[2] = {0, 0}, rests = PERIOD * 1e-3 * 9.81 / 3600;
    drape_world *world = make_breath(DRAPE_REF, PERIODS * PERIOD);
    EXPECT(world);
    for (int step = 1; step <= PERIODS * PERIOD; step++) {
        drape_step_report r;
        const char *failed = check_clean(world, &r);
        if (failed)
            return failed;
        EXPECT(r.outcome == 0 && drape_read(world, x, NULL) == DRAPE_OK);
        const double *top = x[PARTICLES + BALL - 1], *middle = x[MIDDLE];
        EXPECT(step < 5 || r.contacts > 0);
        EXPECT(step <= PERIOD || middle[1] - top[1] <= 1.25 * 0.002);
        if (step % PERIOD)
            continue;
        EXPECT(step == PERIOD ||
               hypot(middle[0] - was[0], middle[2] - was[1]) <= rests);
        was[0] = middle[0];
        was[1] = middle[2];
    }
    drape_destroy(world);
    return NULL;
}

/* Both backends have the same bits, and so has a world that goes on from the
 * other's checkpoint. */
const char *test_sequence_twins(void)
{
    enum { STEPS = 10, SAVED = 4 };
    static struct recall saved;
    drape_world *world[3];
    drape_step_report r;
    for (int k = 0; k < 3; k++)
        EXPECT((world[k] = make_breath(k % 2, STEPS)) != NULL);
    for (int step = 0; step < STEPS; step++) {
        for (int k = 0; k < 2; k++)
            EXPECT(drape_step(world[k], &r) == DRAPE_OK);
        EXPECT(scene_hash(world[0]) == scene_hash(world[1]));
        if (step >= SAVED) {
            EXPECT(drape_step(world[2], &r) == DRAPE_OK);
            EXPECT(scene_hash(world[0]) == scene_hash(world[2]));
        }
        if (step == SAVED - 1) {
            EXPECT(recall_save(world[1], &saved));
            EXPECT(recall_load(world[2], &saved) == DRAPE_OK);
        }
        ran(1);
    }
    for (int k = 0; k < 3; k++)
        drape_destroy(world[k]);
    return NULL;
}

/* Two plates of one body, of which the one goes through the other and back,
 * with a sheet between them: regions of a body that pass through each other. */
static const char *check_closing(int response)
{
    enum { STEPS = 28 };
    static double frame[3][2 * BOX][3], time[3] = {0, 0.15, 0.3};
    static int32_t tri[24][3];
    struct slab d;
    drape_step_report r;
    int trapped = 0;
    slab_small(&d, DRAPE_BW, 0.11);
    for (int k = 0; k < 2 * BOX; k++)
        for (int f = 0; f < 3; f++)
            for (int i = 0; i < 3; i++)
                frame[f][k][i] =
                    d.obstacle.x[k % BOX][i] +
                    (i == 1 && k >= BOX ? f == 1 ? 0.08 : 0.13 : 0);
    for (int t = 0; t < 24; t++)
        for (int i = 0; i < 3; i++)
            tri[t][i] = d.obstacle.tri[t % 12][i] + (t < 12 ? 0 : BOX);
    d.obstacle.n_vertices = 2 * BOX;
    d.obstacle.n_triangles = 24;
    d.obstacle.tri = (const int32_t(*)[3])tri;
    d.obstacle.motion = -1;
    d.obstacle.frames = 3;
    d.obstacle.frame_time = time;
    d.obstacle.frame = (const double(*)[3])frame[0];
    d.obstacle.x = d.obstacle.frame;
    d.def.response = response;
    drape_world *world = slab_world(&d);
    EXPECT(world);
    for (int step = 0; step < STEPS; step++) {
        EXPECT(drape_step(world, &r) == DRAPE_OK);
        EXPECT(r.intersecting == scene_audit(world, 1));
        EXPECT(!(r.outcome & DRAPE_TRAPPED) == (r.intersecting == 0));
        trapped += r.intersecting > 0;
        ran(1);
    }
    drape_destroy(world);
    EXPECT(trapped > 0);
    return NULL;
}

/* A step that ends with cloth caught in such a place says so, by as many pairs
 * as the audit finds. */
const char *test_sequence_closing(void)
{
    const char *failed = check_closing(DRAPE_SOLVE);
    return failed ? failed : check_closing(DRAPE_IMPULSES);
}
