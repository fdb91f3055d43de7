/* SPDX-License-Identifier: Apache-2.0 */
/* Live control through the public API, on both backends: a world that is
 * changed equals a world that was made so. spec/control/control.md */
#include <stdio.h>
#include <stdlib.h>

#include "gpu/run/gpu.h"
#include "tests/world/recall.h"
#include "tests/world/scene.h"
#include "tests/world/slab.h"

enum { SIDE = SLAB_SMALL, COUNT = SIDE * SIDE, BOX = 8, NV = COUNT + BOX };
static const int integrators[] = {DRAPE_VERLET, DRAPE_BW, DRAPE_BDF2};
enum { INTEGRATORS = 3 };

/* A small sheet just above a slab that stands still. */
static void make_scene(struct slab *d, int integrator, int backend)
{
    slab_small(d, integrator, 0.103);
    d->def.backend = backend;
    d->def.precond = DRAPE_JACOBI;
    d->obstacle.motion = -1;
}

/* Of the steps of same_steps: those that were cut, and contacts. */
static int64_t cut, contacts;

static const char *same_steps(drape_world *a, drape_world *b, int n)
{
    for (int k = 0; k < n; k++) {
        drape_step_report r, s;
        EXPECT(drape_step(a, &r) == DRAPE_OK && drape_step(b, &s) == DRAPE_OK);
        EXPECT(r.outcome == s.outcome && r.contacts == s.contacts);
        EXPECT(r.iterations == s.iterations && r.slices == s.slices);
        EXPECT(scene_hash(a) == scene_hash(b));
        cut += r.slices > 1;
        contacts += r.contacts;
        ran(1);
    }
    return NULL;
}

static const char *end_both(drape_world *a, drape_world *b, const char *what)
{
    drape_destroy(a);
    drape_destroy(b);
    return what;
}

/* §1: gravity and a material that are set before the first step act as those of
 * a definition. */
static const char *check_settings(int integrator, int backend)
{
    struct slab d;
    const double g[3] = {1, -5, 0.25};
    make_scene(&d, integrator, backend);
    drape_world *a = slab_world(&d);
    drape_material m = d.cloth.material;
    m.density = 0.3;
    m.stretch = 700;
    m.shear = 100;
    m.bend = 1e-4;
    m.thickness = 0.003;
    m.friction = 0.1;
    m.damping = 2e-3;
    const double warp[][2] = {{0.001, 0.2}, {0.004, 3}, {0.02, 40}};
    const double bias[][2] = {{0.002, 0.3}, {0.02, 6}};
    memcpy(m.table[DRAPE_WARP], warp, sizeof warp);
    memcpy(m.table[DRAPE_BIAS], bias, sizeof bias);
    d.cloth.material = m;
    memcpy(d.def.gravity, g, sizeof g);
    drape_world *b = slab_world(&d);
    EXPECT(a && b);
    EXPECT(drape_set_gravity(a, g) == DRAPE_OK);
    EXPECT(drape_set_material(a, 0, &m) == DRAPE_OK);
    return end_both(a, b, same_steps(a, b, 6));
}

const char *test_control_settings(void)
{
    const char *what = NULL;
    for (int k = 0; k < 2 * INTEGRATORS && !what; k++)
        what = check_settings(integrators[k / 2], k % 2);
    return what;
}

/* Copies n vectors to memory of the view's device, in its precision. */
static void *put_there(struct gpu *g, const drape_view *view, size_t n,
                       const double (*x)[3])
{
    real *here = malloc(3 * n * sizeof *here);
    for (size_t k = 0; k < 3 * n; k++)
        here[k] = (real)x[k / 3][k % 3];
    if (view->device == -1 && !view->stream)
        return here;
    void *there = gpu_take(g, ARENA_OTHER, (int64_t)n, 3 * sizeof *here);
    gpu_up(g, there, here, 3 * n * sizeof *here);
    gpu_wait(g);
    free(here);
    return there;
}

static void take_back(struct gpu *g, const drape_view *view, void *there)
{
    if (view->device == -1 && !view->stream)
        free(there);
    else
        gpu_give(g, there);
}

/* §2: a world whose state is set steps as a world that was made in it, whatever
 * it did before. there: by the calls of a device. */
static const char *check_state(int integrator, int backend, bool there)
{
    static double x[NV][3], v[NV][3];
    struct slab d;
    int status;
    drape_view view;
    make_scene(&d, integrator, backend);
    drape_world *a = slab_world(&d);
    EXPECT(a && drape_borrow(a, &view) == DRAPE_OK);
    for (int k = 0; k < 5; k++)
        EXPECT(drape_step(a, NULL) == DRAPE_OK);
    drape_read(a, x, v);
    for (int k = 0; k < COUNT; k++) {
        x[k][1] += 0.0005;
        v[k][0] = 0.1;
    }
    const double(*xs)[3] = (const double(*)[3])x;
    const double(*vs)[3] = (const double(*)[3])v;
    d.cloth.x = xs;
    d.cloth.velocity = vs;
    drape_world *b = slab_world(&d);
    EXPECT(b);
    if (there) {
        struct gpu *g = gpu_open(NULL, &status);
        void *p = put_there(g, &view, COUNT, xs);
        void *q = put_there(g, &view, COUNT, vs);
        EXPECT(drape_set_positions_device(a, 0, COUNT, p, NULL) == DRAPE_OK);
        EXPECT(drape_set_velocities_device(a, 0, COUNT, q) == DRAPE_OK);
        take_back(g, &view, p);
        take_back(g, &view, q);
        gpu_close(g);
    } else {
        EXPECT(drape_set_positions(a, 0, 50, xs, NULL) == DRAPE_OK);
        EXPECT(drape_set_positions(a, 50, COUNT - 50, xs + 50, NULL) ==
               DRAPE_OK);
        EXPECT(drape_set_velocities(a, 0, COUNT, vs) == DRAPE_OK);
    }
    EXPECT(scene_hash(a) == scene_hash(b));
    return end_both(a, b, same_steps(a, b, 6));
}

const char *test_control_state(void)
{
    const char *what = NULL;
    for (int k = 0; k < 4 * INTEGRATORS && !what; k++)
        if (!scene_left_out(integrators[k / 4], k % 2))
            what = check_state(integrators[k / 4], k % 2, k / 2 % 2);
    return what;
}

/* §2: positions that intersect are refused, which changes nothing, or they are
 * trapped if the definition allows that. */
static const char *check_start(int backend, int allow)
{
    static double x[NV][3];
    static struct recall before, after;
    struct slab d;
    drape_error error;
    drape_step_report r;
    make_scene(&d, DRAPE_BW, backend);
    d.def.allow_intersecting = allow;
    drape_world *a = slab_world(&d);
    EXPECT(a && drape_step(a, NULL) == DRAPE_OK);
    drape_read(a, x, NULL);
    for (int k = 0; k < COUNT; k++)
        x[k][1] = 0.05;
    EXPECT(recall_save(a, &before));
    int status =
        drape_set_positions(a, 0, COUNT, (const double(*)[3])x, &error);
    EXPECT(status == (allow ? DRAPE_OK : DRAPE_ESTART));
    EXPECT(allow || strstr(error.text, "cloth 0 triangle"));
    EXPECT(recall_save(a, &after));
    EXPECT(recall_same(&before, &after) == !allow);
    EXPECT(drape_step(a, &r) == DRAPE_OK);
    EXPECT(!!(r.outcome & DRAPE_TRAPPED) == allow);
    drape_destroy(a);
    ran(1);
    return NULL;
}

const char *test_control_start(void)
{
    const char *what = NULL;
    for (int k = 0; k < 4 && !what; k++)
        what = check_start(k % 2, k / 2);
    return what;
}

/* Places of the box at frame k: it is lifted, tilted and carried along. All are
 * numbers of binary32, so that the state holds them. */
enum { FRAMES = 6 };
static void fill_frames(const struct slab *d, double speed,
                        double (*frame)[BOX][3])
{
    for (int k = 0; k < FRAMES; k++)
        for (int p = 0; p < BOX; p++) {
            const double *x = d->obstacle.x[p];
            double lift = (k % 4) * speed * (p % 2 ? 1 : 0.5);
            frame[k][p][0] = (double)(float)(x[0] + k * speed);
            frame[k][p][1] = (double)(float)(x[1] + lift);
            frame[k][p][2] = (double)(float)x[2];
        }
}

/* §5: an obstacle that is told its place in each step moves as one with these
 * frames, also where steps are cut. */
static const char *check_frames(int integrator, int backend, double speed)
{
    static double frame[FRAMES][BOX][3];
    struct slab d;
    make_scene(&d, integrator, backend);
    fill_frames(&d, speed, frame);
    d.obstacle.x = (const double(*)[3])frame[0];
    drape_world *a = slab_world(&d);
    d.obstacle.frames = FRAMES;
    d.obstacle.frame_dt = d.def.dt;
    d.obstacle.frame = (const double(*)[3])frame;
    drape_world *b = slab_world(&d);
    const char *what = NULL;
    EXPECT(a && b);
    for (int k = 1; k < FRAMES && !what; k++) {
        const double(*x)[3] = (const double(*)[3])frame[k];
        EXPECT(drape_set_obstacle(a, 0, x) == DRAPE_OK);
        what = same_steps(a, b, 1);
    }
    if (!what) /* both stay where they are */
        what = same_steps(a, b, 2);
    return end_both(a, b, what);
}

const char *test_control_obstacle(void)
{
    static const double speed[] = {0x1p-9, 0x1p-4};
    const char *what = NULL;
    cut = contacts = 0;
    for (int k = 0; k < 2 * INTEGRATORS && !what; k++)
        for (int i = 0; i < 2 && !what; i++)
            if (!scene_left_out(integrators[k / 2], k % 2))
                what = check_frames(integrators[k / 2], k % 2, speed[i]);
    EXPECT(what || (cut > 0 && contacts > 0));
    return what;
}

/* §5: a pose puts an obstacle where the motion with this key puts it. */
const char *test_control_pose(void)
{
    static const double time[2] = {0, 0x1p-6};
    static const double p[2][3] = {{0, 0, 0}, {0.01, -0.02, 0}};
    static const double q[2][4] = {{1, 0, 0, 0}, {0.8, 0, 0.6, 0}};
    static const double pivot[3] = {0.0625, 0, 0};
    static double x[2][NV][3];
    for (int backend = 0; backend < 2; backend++) {
        struct slab d;
        make_scene(&d, DRAPE_BW, backend);
        drape_world *a = slab_world(&d);
        d.motion = (drape_motion){2, time, p, q, {0.0625, 0, 0}};
        d.obstacle.motion = 0;
        d.motion.position = (const double(*)[3])p;
        drape_world *b = slab_world(&d);
        double shift[3] = {p[1][0], p[1][1], p[1][2]};
        EXPECT(a && b);
        EXPECT(drape_set_pose(a, 0, shift, q[1], pivot) == DRAPE_OK);
        EXPECT(drape_step(a, NULL) == DRAPE_OK);
        EXPECT(drape_step(b, NULL) == DRAPE_OK);
        drape_read(a, x[0], NULL);
        drape_read(b, x[1], NULL);
        EXPECT(!memcmp(x[0] + COUNT, x[1] + COUNT, BOX * sizeof *x[0]));
        end_both(a, b, NULL);
        ran(1);
    }
    return NULL;
}

/* §4: pins that are told their places move as pins with such a motion. */
enum { KEYS = 5 };
static const char *check_pins(int integrator, int backend, bool there)
{
    static double time[KEYS], way[KEYS][3], at[2][3], x[NV][3];
    static const drape_pin pin[2] = {{2, 3, 0}, {9, 7, 0}};
    static const int32_t list[2] = {2 + 3 * SIDE, 9 + 7 * SIDE};
    drape_pin held[2] = {{2, 3, -1}, {5, 5, -1}};
    struct slab d;
    drape_view view;
    int status;
    make_scene(&d, integrator, backend);
    d.cloth.origin[1] = 0.125;
    for (int k = 0; k < KEYS; k++) {
        time[k] = k * d.def.dt;
        way[k][0] = k * 0x1p-8;
        way[k][1] = (k % 2) * 0x1p-7;
    }
    d.cloth.pins = held; /* other pins than those set */
    d.cloth.n_pins = 2;
    drape_world *a = slab_world(&d);
    d.motion =
        (drape_motion){KEYS, time, (const double(*)[3])way, NULL, {0, 0, 0}};
    d.cloth.pins = pin;
    drape_world *b = slab_world(&d);
    const char *what = NULL;
    EXPECT(a && b && drape_borrow(a, &view) == DRAPE_OK);
    struct gpu *g = gpu_open(NULL, &status);
    drape_read(b, x, NULL);
    for (int k = 1; k < KEYS && !what; k++) {
        for (int i = 0; i < 6; i++)
            at[i / 3][i % 3] = x[list[i / 3]][i % 3] + way[k][i % 3];
        const double(*to)[3] = (const double(*)[3])at;
        void *p = there ? put_there(g, &view, 2, to) : NULL;
        EXPECT((there ? drape_set_pins_device(a, 0, 2, list, p)
                      : drape_set_pins(a, 0, 2, list, to)) == DRAPE_OK);
        if (p)
            take_back(g, &view, p);
        what = same_steps(a, b, 1);
    }
    gpu_close(g);
    if (!what)
        what = same_steps(a, b, 2);
    return end_both(a, b, what);
}

const char *test_control_pins(void)
{
    const char *what = NULL;
    for (int k = 0; k < 4 * INTEGRATORS && !what; k++)
        if (!scene_left_out(integrators[k / 4], k % 2))
            what = check_pins(integrators[k / 4], k % 2, k / 2 % 2);
    return what;
}

/* §4: without pins the sheet falls as one that has none; what is pinned where
 * it is stays there. */
const char *test_control_free(void)
{
    static const drape_pin pin[2] = {{2, 3, -1}, {9, 7, -1}};
    static const int32_t list[3] = {0, 17, COUNT - 1};
    static double x0[NV][3], x1[NV][3];
    for (int k = 0; k < 2 * INTEGRATORS; k++) {
        struct slab d;
        make_scene(&d, integrators[k / 2], k % 2);
        drape_world *b = slab_world(&d);
        d.cloth.pins = pin;
        d.cloth.n_pins = 2;
        drape_world *a = slab_world(&d);
        EXPECT(a && b);
        EXPECT(drape_set_pins(a, 0, 0, NULL, NULL) == DRAPE_OK);
        /* the reports differ, as prescribed motion may add energy */
        for (int i = 0; i < 3; i++) {
            EXPECT(drape_step(a, NULL) == DRAPE_OK);
            EXPECT(drape_step(b, NULL) == DRAPE_OK);
            EXPECT(scene_hash(a) == scene_hash(b));
        }
        EXPECT(drape_set_pins(a, 0, 3, list, NULL) == DRAPE_OK);
        drape_read(a, x0, NULL);
        EXPECT(drape_step(a, NULL) == DRAPE_OK);
        drape_read(a, x1, NULL);
        for (int i = 0; i < 3; i++)
            EXPECT(!memcmp(x0[list[i]], x1[list[i]], sizeof *x0));
        EXPECT(memcmp(x0[50], x1[50], sizeof *x0) != 0);
        end_both(a, b, NULL);
        ran(1);
    }
    return NULL;
}
