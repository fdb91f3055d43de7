/* SPDX-License-Identifier: Apache-2.0 */
/* The table of small scenes. Together they run code of every file in ref/;
 * `make coverage` shows the lines that they do not reach. */
#include "tests/whole/whole.h"

#include <stdlib.h>

static const double down[3] = {0, -0.3, 0}, aside[3] = {0.3, 0.1, 0};

/* A random velocity, to `speed` m/s, for each particle of a cloth. */
static void throw(struct show * s, drape_cloth *c, double speed)
{
    uint32_t state = 1;
    size_t n = (size_t)c->m * (size_t)c->n;
    double(*v)[3] = show_keep(s, n * sizeof *v);
    for (size_t p = 0; p < n; p++)
        for (int i = 0; i < 3; i++)
            v[p][i] = speed * show_random(&state);
    c->velocity = (const double(*)[3])v;
}

/* All defaults: a sheet falls onto a ball. */
static void make_drop(struct show *s)
{
    s->steps = 12;
    show_cloth(s, 21, 21, 0.02, 0.16);
    show_ball(s, 0, 0.15, 16);
}

/* Two sheets with the paper's matrix; the second is thrown at the first, fast
 * enough to pass through it. */
static void make_pile(struct show *s)
{
    s->steps = 10;
    s->def.integrator = DRAPE_CK;
    s->def.precond = DRAPE_JACOBI;
    s->def.matrix = DRAPE_CDF;
    show_cloth(s, 13, 11, 0.02, 0.1);
    drape_cloth *c = show_cloth(s, 9, 14, 0.018, 0.13);
    c->u[0] = 0.8;
    c->u[2] = 0.6;
    c->v[0] = -0.6;
    c->v[2] = 0.8;
    throw(s, c, 0.3);
    show_box(s, 0, 0.1);
}

/* A thrown sheet with the fewest rounds and slices, so that zones and rollback
 * run. */
static void make_thrown(struct show *s)
{
    s->steps = 6;
    s->def.response = DRAPE_IMPULSES;
    s->def.max_slices = 1;
    s->def.max_rounds = 2;
    s->def.gravity[1] = -900;
    show_cloth(s, 17, 17, 0.02, 0.15);
    show_ball(s, 0, 0.14, 12)->friction = 0.9;
}

/* The thrown sheet with steps cut into slices. */
static void make_sliced(struct show *s)
{
    make_thrown(s);
    s->def.max_slices = 8;
    s->def.integrator = DRAPE_CK;
}

static void *take(void *user, size_t bytes)
{
    struct show *s = user;
    return s->left-- > 0 ? aligned_alloc(64, (bytes + 63) / 64 * 64) : NULL;
}

static void give(void *user, void *p, size_t bytes)
{
    (void)user;
    (void)bytes;
    free(p);
}

/* Between steps: in the first half of the run, every other step has little
 * memory to allocate. */
static void starve(struct show *s, drape_world *world, int step)
{
    (void)world;
    s->left = step % 2 == 0 && step < s->steps / 2 - 1 ? step : 1 << 20;
}

/* Steps run out of memory, also in later slices, and are repeated. */
static void make_starved(struct show *s)
{
    make_sliced(s);
    s->steps = 12;
    s->left = 1 << 20;
    s->between = starve;
    s->def.allocator = (drape_allocator){take, give, s};
}

/* A box goes through the floor with a pinned cloth between them. */
static void make_crush(struct show *s)
{
    s->steps = 4;
    s->def.max_slices = 2;
    show_cloth(s, 9, 9, 0.02, 0.01);
    show_pin(s, 4, 4, -1);
    show_floor(s, 0, 1);
    show_box(s, 0.08, 0.1)->motion = show_motion(s, 0.4, down, 0);
}

static void change_wind(struct show *s, drape_world *world, int step)
{
    const drape_wind gust = {
        .velocity = {-3, 0, 6}, .density = 1.2, .drag = 1, .lift = 0.3};
    (void)s;
    if (step == 4)
        drape_set_wind(world, &gust);
}

/* A cloth with holes and cuts in wind, between a fixed pin and a moving pin. */
static void make_flag(struct show *s)
{
    s->steps = 10;
    s->between = change_wind;
    s->def.integrator = DRAPE_CK;
    s->def.wind = (drape_wind){
        .velocity = {5, 0, 1}, .density = 1.2, .drag = 1.1, .lift = 0.8};
    drape_cloth *c = show_cloth(s, 17, 12, 0.02, 0);
    uint8_t *hole = show_keep(s, 17 * 12), *cut = show_keep(s, 16 * 11);
    for (int k = 0; k < 3; k++)
        hole[60 + k] = hole[77 + k] = cut[5 + 16 * k] = 1;
    c->hole = hole;
    c->cut = cut;
    show_pin(s, 0, 0, -1);
    show_pin(s, 16, 0, show_motion(s, 0.2, aside, 0.5));
}

/* An explicit method with contact. */
static void make_explicit(struct show *s, int integrator)
{
    s->steps = 5;
    s->def.integrator = integrator;
    s->def.dt = 1.0 / 120;
    show_cloth(s, 11, 11, 0.02, 0.106)->material.damping = 1e-4;
    show_pin(s, 0, 0, -1);
    show_ball(s, 0, 0.1, 8);
}

static void make_euler(struct show *s)
{
    make_explicit(s, DRAPE_EULER);
}

static void make_midpoint(struct show *s)
{
    make_explicit(s, DRAPE_MIDPOINT);
    s->def.wind = (drape_wind){
        .velocity = {1, -9, 1}, .density = 1.2, .drag = 1, .lift = 0.3};
}

static void make_verlet(struct show *s)
{
    make_explicit(s, DRAPE_VERLET);
    s->pin[0].motion = show_motion(s, 0.1, aside, 0.1);
}

static void make_rk4(struct show *s)
{
    make_explicit(s, DRAPE_RK4);
    throw(s, &s->cloth[0], 20);
}

/* An obstacle that deforms, by frames, under a cloth. */
static void make_wave(struct show *s)
{
    enum { FRAMES = 4 };
    s->steps = 10;
    show_cloth(s, 15, 15, 0.02, 0.15);
    drape_obstacle *o = show_ball(s, 0, 0.14, 8);
    size_t n = (size_t)o->n_vertices;
    double(*frame)[3] = show_keep(s, FRAMES * n * sizeof *frame);
    for (size_t p = 0; p < FRAMES * n; p++)
        for (int i = 0; i < 3; i++)
            frame[p][i] = o->x[p % n][i] * (1 + 0.1 * (int)(p / n) * (i != 1));
    o->frames = FRAMES;
    o->frame_dt = 0.03;
    o->frame = (const double(*)[3])frame;
}

static void wake(struct show *s, drape_world *world, int step)
{
    (void)s;
    if (step == 36)
        drape_wake(world);
}

/* A stiff, damped cloth falls asleep on the floor, is woken, sleeps again, and
 * wakes as a far box begins to move. */
static void make_rest(struct show *s)
{
    s->steps = 90;
    s->between = wake;
    drape_material *m = &show_cloth(s, 5, 5, 0.1, 0.002)->material;
    m->damping = 0.1;
    m->friction = 1;
    show_floor(s, 0, 1);
    show_box(s, 3, 0.1)->motion = show_motion(s, 1.4, aside, 0);
    s->time[0][0] = 1.25;
}

/* A scene so large that every loop uses several threads. */
static void make_large(struct show *s)
{
    s->steps = 2;
    s->def.gravity[1] = -60;
    throw(s, show_cloth(s, 75, 67, 0.01, 0.303), 0.05);
    show_ball(s, 0, 0.3, 24);
}

/* A scene of the same size with the other integrator, solver and matrix, and
 * with so few rounds that the fail-safe runs at once. */
static void make_larger(struct show *s)
{
    make_large(s);
    s->def.integrator = DRAPE_CK;
    s->def.response = DRAPE_IMPULSES;
    s->def.precond = DRAPE_JACOBI;
    s->def.matrix = DRAPE_CDF;
    s->def.max_slices = s->def.max_rounds = 1;
    s->def.gravity[1] = -300;
    s->def.wind = (drape_wind){
        .velocity = {5, 0, 1}, .density = 1.2, .drag = 1.1, .lift = 0.8};
}

/* A scene in which nothing can collide. */
static void make_free(struct show *s)
{
    s->steps = 4;
    s->def.self_collision = 0;
    s->def.precond = DRAPE_JACOBI;
    s->def.tolerance = 1e-9;
    s->def.max_iterations = 40;
    show_cloth(s, 33, 9, 0.03, 0);
    show_pin(s, 0, 0, -1);
    show_pin(s, 32, 8, show_motion(s, 0.05, aside, 0.3));
}

/* A start that intersects. */
static void make_pierced(struct show *s)
{
    s->steps = 4;
    s->def.allow_intersecting = 1;
    s->def.precond = DRAPE_MULTIGRID;
    s->def.matrix = DRAPE_CDF;
    show_cloth(s, 11, 11, 0.02, 0.01);
    show_box(s, 0, 0.09);
}

/* Two sheets of other numbers of particles are sewn together, edge to edge, and
 * fall onto a ball. A point pulls by half a newton at most. */
static void make_sewn(struct show *s)
{
    enum { POINTS = 13, PLACES = 9 };
    drape_seam *seam = show_keep(s, sizeof *seam);
    int32_t *particle = show_keep(s, POINTS * sizeof *particle);
    int32_t(*onto)[2] = show_keep(s, POINTS * sizeof *onto);
    double *part = show_keep(s, POINTS * sizeof *part);
    s->steps = 8;
    s->def.integrator = DRAPE_BDF2;
    show_cloth(s, PLACES, 8, 0.03, 0.16)->origin[2] = -0.2105;
    show_cloth(s, POINTS, 11, 0.02, 0.16)->origin[2] = 0.0005;
    show_ball(s, 0, 0.15, 12);
    for (int k = 0; k < POINTS; k++) {
        double at = (double)k * (PLACES - 1) / (POINTS - 1);
        int left = at < PLACES - 2 ? (int)at : PLACES - 2;
        particle[k] = k;
        part[k] = at - left;
        for (int i = 0; i < 2; i++)
            onto[k][i] = PLACES * 7 + left + i;
    }
    *seam = (drape_seam){.cloth = {1, 0},
                         .n = POINTS,
                         .particle = particle,
                         .onto = (const int32_t(*)[2])onto,
                         .part = part,
                         .strength = 0.5};
    s->def.seams = seam;
    s->def.n_seams = 1;
}

static void change_panel(struct show *s, drape_world *world, int step)
{
    drape_material m = s->cloth[1].material;
    m.bend *= 4;
    m.density *= 2;
    if (step == 2)
        drape_set_material(world, 1, &m);
    if (step == 5)
        drape_seam_target(world, 0, NULL);
    change_wind(s, world, step);
}

/* The same, and the sheet that has the points is a panel, rounded and eased at
 * its far end. Its material changes, and wind begins. */
static void make_tailored(struct show *s)
{
    enum { M = 13, N = 11 };
    make_sewn(s);
    double(*rest)[2] = show_keep(s, sizeof(double[M * N][2]));
    uint8_t *cell = show_keep(s, (M - 1) * (N - 1));
    drape_ease *ease = show_keep(s, sizeof *ease);
    drape_panel *panel = show_keep(s, sizeof *panel);
    for (int p = 0; p < M * N; p++) {
        double off = (p % M - M / 2) / 8.0, last = p / M == N - 1;
        rest[p][0] = 0.02 * (p % M);
        rest[p][1] = 0.02 * (p / M - last * off * off / 2);
    }
    for (int k = 0; k < (M - 1) * (N - 1); k++)
        cell[k] = k < (M - 1) * (N - 2) ? DRAPE_CELL_REGULAR
                                        : DRAPE_CELL_RISING + k % 2;
    cell[(M - 1) * (N - 2)] = DRAPE_CELL_WITHOUT + 3;
    cell[(M - 1) * (N - 1) - 1] = DRAPE_CELL_WITHOUT + 2;
    *ease = (drape_ease){{4 + M * (N - 1), 5 + M * (N - 1)}, 0.9};
    *panel = (drape_panel){(const double(*)[2])rest, cell, ease, 1};
    s->cloth[1].panel = panel;
    s->def.integrator = DRAPE_BW;
    s->between = change_panel;
}

/* A cloth so fast that each step diverges. */
static void make_diverged(struct show *s)
{
    s->steps = 3;
    throw(s, show_cloth(s, 7, 7, 0.02, 0), 1e6);
}

const struct scene_row scene_rows[] = {
    {"drop", make_drop},         {"pile", make_pile},
    {"thrown", make_thrown},     {"sliced", make_sliced},
    {"starved", make_starved},   {"crush", make_crush},
    {"flag", make_flag},         {"euler", make_euler},
    {"midpoint", make_midpoint}, {"verlet", make_verlet},
    {"rk4", make_rk4},           {"wave", make_wave},
    {"rest", make_rest},         {"large", make_large},
    {"larger", make_larger},     {"free", make_free},
    {"pierced", make_pierced},   {"diverged", make_diverged},
    {"sewn", make_sewn},         {"tailored", make_tailored},
};
const int n_scene_rows = sizeof scene_rows / sizeof scene_rows[0];
