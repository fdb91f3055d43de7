/* SPDX-License-Identifier: Apache-2.0 */
/* See tests/control/troupe.h. */
#include "tests/control/troupe.h"

const int troupe_integrators[TROUPE_INTEGRATORS] = {DRAPE_BW, DRAPE_BDF2,
                                                    DRAPE_CK, DRAPE_VERLET};

static const double plate_x[2][TROUPE_PLATE][3] = {
    {{-.05, 0, -.06}, {.05, 0, -.06}, {-.05, 0, .06}, {.05, 0, .06}},
    {{.06, -.05, -.06}, {.2, -.04, -.06}, {.06, -.05, .06}, {.2, -.05, .06}}};
static const int32_t plate_tri[2][3] = {{0, 2, 1}, {1, 2, 3}};
static const double when[3] = {-0.1, 0.1, 0.3};
static const double frames[3][TROUPE_PLATE][3] = {
    {{.06, -.05, -.06}, {.2, -.04, -.06}, {.06, -.05, .06}, {.2, -.05, .06}},
    {{.06, -.3, -.06}, {.2, -.2, -.06}, {.06, -.2, .06}, {.2, -.2, .06}},
    {{.06, -.2, -.06}, {.2, -.2, -.06}, {.06, -.3, .06}, {.2, -.2, .06}}};
static const double times[2] = {0, 0.25};
static const double way[2][3] = {{0.1, 0, 0}, {0.11, -0.02, 0}};
static const double turn[2][4] = {{1, 0, 0, 0}, {0.8, 0, 0.6, 0}};
/* The upper sheet starts as it is told, slightly askew. */
static double above[TROUPE_COUNT][3], speed[TROUPE_COUNT][3];

static void make_sheet(drape_cloth *c)
{
    drape_default_cloth(c);
    c->m = TROUPE_M;
    c->n = TROUPE_N;
    c->width = c->height = 0.2;
    c->origin[0] = c->origin[2] = -0.1;
    c->origin[1] = 0.003;
    c->material.damping = 0.01;
}

static void make_above(drape_cloth *c)
{
    for (int k = 0; k < TROUPE_COUNT; k++) {
        above[k][0] = -0.09 + 0.2 / (TROUPE_M - 1) * (k % TROUPE_M);
        above[k][1] = 0.008 + 0.0003 * (k % 3);
        above[k][2] = -0.1 + 0.2 / (TROUPE_N - 1) * (k / TROUPE_M);
        speed[k][1] = -0.05;
    }
    c->x = (const double(*)[3])above;
    c->velocity = (const double(*)[3])speed;
}

/* Makes a sheet a panel that lacks a cell and a corner, and has a moved one. */
static void make_panel(drape_cloth *c)
{
    enum { CELLS = (TROUPE_M - 1) * (TROUPE_N - 1) };
    static double rest[TROUPE_COUNT][2];
    static uint8_t cell[CELLS];
    static const drape_panel panel = {.rest = (const double(*)[2])rest,
                                      .cell = cell};
    for (int k = 0; k < TROUPE_COUNT; k++) {
        rest[k][0] = c->width / (TROUPE_M - 1) * (k % TROUPE_M);
        rest[k][1] = c->height / (TROUPE_N - 1) * (k / TROUPE_M);
    }
    rest[0][0] += 0.3 * c->width / (TROUPE_M - 1);
    memset(cell, DRAPE_CELL_REGULAR, sizeof cell);
    cell[0] = DRAPE_CELL_RISING;
    cell[TROUPE_M - 2] = DRAPE_CELL_ABSENT;
    cell[CELLS - 1] = DRAPE_CELL_WITHOUT + 2;
    c->panel = &panel;
}

/* Sews three particles of sheet 1 at a corner to sheet 0 below. */
static void make_seam(struct troupe *t)
{
    static const int32_t particle[3] = {0, 1, 2};
    static const int32_t onto[3][2] = {{0, 1}, {1, 2}, {2, 3}};
    static const double part[3] = {0.1, 0.2, 0};
    t->seam = (drape_seam){{1, 0}, 3, particle, onto, part, 0};
    t->def.n_seams = 1;
}

void troupe_make(struct troupe *t, int integrator, int backend)
{
    static const drape_pin pins[2] = {{0, 0, -1}, {6, 5, -1}};
    static uint8_t hole[TROUPE_COUNT], cut[(TROUPE_M - 1) * (TROUPE_N - 1)];
    memset(t, 0, sizeof *t);
    drape_default(&t->def);
    make_sheet(&t->cloth[0]);
    make_sheet(&t->cloth[1]);
    make_above(&t->cloth[1]);
    hole[3 + 2 * TROUPE_M] = 1;
    cut[4] = cut[5] = 1;
    t->cloth[0].hole = hole;
    t->cloth[0].cut = cut;
    t->cloth[0].pins = pins;
    t->cloth[0].n_pins = 2;
    for (int k = 0; k < 2; k++) {
        drape_default_obstacle(&t->obstacle[k]);
        t->obstacle[k].n_vertices = TROUPE_PLATE;
        t->obstacle[k].n_triangles = 2;
        t->obstacle[k].x = plate_x[k];
        t->obstacle[k].tri = plate_tri;
        t->obstacle[k].friction = 0.1 + 0.1 * k;
    }
    t->motion = (drape_motion){2, times, way, turn, {0.1, 0, 0}};
    t->def.backend = backend;
    t->def.precision = REAL_BITS;
    t->def.integrator = integrator;
    t->def.precond = DRAPE_JACOBI;
    if (integrator == DRAPE_VERLET)
        t->def.dt = 1e-3;
    t->def.wind = (drape_wind){
        .velocity = {0.2, 0, 0}, .density = 1.2, .drag = 1, .lift = 0.5};
    t->def.n_cloths = t->def.n_obstacles = 2;
    t->def.n_motions = 1;
    if (integrator == DRAPE_BDF2 || integrator == DRAPE_CK)
        make_panel(&t->cloth[1]);
    if (integrator == DRAPE_BDF2)
        make_seam(t);
}

void troupe_move(struct troupe *t, int k, bool by_frames)
{
    if (!by_frames) {
        t->obstacle[k].motion = 0;
        return;
    }
    t->obstacle[k].frames = 3;
    t->obstacle[k].between = DRAPE_CUBIC;
    t->obstacle[k].frame_time = when;
    t->obstacle[k].frame = frames[0];
}

void troupe_drop(struct troupe *t, int body)
{
    int o = body - t->def.n_cloths;
    if (o >= 0)
        t->obstacle[o] = t->obstacle[--t->def.n_obstacles];
    else {
        t->cloth[body] = t->cloth[1];
        t->def.n_cloths--;
        t->def.n_seams = 0;
    }
}

drape_world *troupe_world(const struct troupe *t)
{
    drape_world *world;
    drape_def def = t->def;
    def.cloths = t->cloth;
    def.obstacles = t->obstacle;
    def.motions = &t->motion;
    def.seams = &t->seam;
    return drape_create(&def, &world, NULL) == DRAPE_OK ? world : NULL;
}
