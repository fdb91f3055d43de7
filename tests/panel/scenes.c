/* SPDX-License-Identifier: Apache-2.0 */
/* Panels in whole scenes: what is refused, rectangles, bias strips, contact and
 * rest. spec/panel/panel.md */
#include "tests/cloth/sheet.h"
#include "tests/panel/cutting.h"
#include "tests/world/scene.h"

#include <stdlib.h>
#include <string.h>

/* A scene of one cloth over a ball, or without it. */
enum { ROUND = 24, RINGS = 12, BALL = ROUND * (RINGS - 1) + 2 };
struct stage_set {
    drape_def def;
    drape_obstacle ball;
    double x[BALL][3];
    int32_t tri[2 * ROUND * (RINGS - 1)][3];
};

static void add_ball(struct stage_set *s, double radius, double height)
{
    const double pi = 3.1415926535897932;
    int64_t n = 0;
    for (int k = 1; k < RINGS; k++)
        for (int i = 0; i < ROUND; i++) {
            double *x = s->x[(k - 1) * ROUND + i];
            x[0] = radius * sin(pi * k / RINGS) * cos(2 * pi * i / ROUND);
            x[1] = height + radius * cos(pi * k / RINGS);
            x[2] = radius * sin(pi * k / RINGS) * sin(2 * pi * i / ROUND);
        }
    s->x[BALL - 2][1] = height + radius;
    s->x[BALL - 1][1] = height - radius;
    for (int k = 0; k < RINGS; k++)
        for (int i = 0; i < ROUND; i++) {
            int up = (k - 1) * ROUND, down = k * ROUND, j = (i + 1) % ROUND;
            int32_t *t = s->tri[n];
            if (k > 0 && k < RINGS - 1) {
                memcpy(s->tri[n++], (int32_t[3]){up + i, up + j, down + i},
                       sizeof *s->tri);
                memcpy(s->tri[n++], (int32_t[3]){up + j, down + j, down + i},
                       sizeof *s->tri);
            } else {
                t[0] = k ? BALL - 1 : BALL - 2;
                t[1] = k ? up + i : down + j;
                t[2] = k ? up + j : down + i;
                n++;
            }
        }
    drape_default_obstacle(&s->ball);
    s->ball.n_vertices = BALL;
    s->ball.n_triangles = n;
    s->ball.x = (const double(*)[3])s->x;
    s->ball.tri = (const int32_t(*)[3])s->tri;
    s->def.obstacles = &s->ball;
    s->def.n_obstacles = 1;
}

static void set_stage(struct stage_set *s, const drape_cloth *cloth)
{
    memset(s, 0, sizeof *s);
    drape_default(&s->def);
    s->def.precision = REAL_BITS;
    s->def.cloths = cloth;
    s->def.n_cloths = 1;
}

/* Lays a cutting's cloth flat at a height, its middle above the origin. */
static void lay_flat(struct cutting *c, double height)
{
    drape_cloth *d = &c->cloth;
    drape_material m = d->material;
    drape_default_cloth(d);
    m.thickness = 2e-3;
    m.friction = 0.3;
    m.stretch = 300;
    m.shear = 100;
    d->material = m;
    d->m = c->cut.m;
    d->n = c->cut.n;
    d->width = c->cut.h * (d->m - 1);
    d->height = c->cut.h * (d->n - 1);
    d->panel = &c->panel;
    double u[3] = {1, 0, 0}, v[3] = {0, 0, -1};
    memcpy(d->u, u, sizeof u);
    memcpy(d->v, v, sizeof v);
    d->origin[0] = -d->width / 2;
    d->origin[1] = height;
    d->origin[2] = d->height / 2;
}

/* panel.md §1: a panel of regular cells alone is the rectangle, to the bit;
 * with multigrid it would smooth by other blocks. */
const char *test_panel_rectangle(void)
{
    enum { M = 13, N = 11 };
    static double rest[M * N][2];
    static uint8_t cell[(M - 1) * (N - 1)];
    struct stage_set s;
    drape_cloth cloth = sheet_default(M, N);
    uint64_t hash[2];
    cloth.width = 0.01 * (M - 1);
    cloth.height = 0.01 * (N - 1);
    cloth.v[1] = 0;
    cloth.v[2] = -1;
    cloth.origin[0] = -cloth.width / 2;
    cloth.origin[1] = 0.11;
    cloth.origin[2] = cloth.height / 2;
    for (int p = 0; p < M * N; p++) {
        rest[p][0] = 0.01 * (p % M);
        rest[p][1] = 0.01 * (p / M);
    }
    memset(cell, DRAPE_CELL_REGULAR, sizeof cell);
    drape_panel panel = {.rest = (const double(*)[2])rest, .cell = cell};
    for (int k = 0; k < 2; k++) {
        drape_world *world;
        drape_step_report r;
        cloth.panel = k ? &panel : NULL;
        set_stage(&s, &cloth);
        add_ball(&s, 0.1, 0);
        s.def.precond = DRAPE_JACOBI;
        EXPECT(drape_create(&s.def, &world, NULL) == DRAPE_OK);
        int64_t contacts = 0;
        for (int step = 0; step < 12; step++) {
            EXPECT(drape_step(world, &r) == DRAPE_OK);
            contacts += r.contacts;
        }
        EXPECT(contacts > 0);
        hash[k] = scene_hash(world);
        drape_destroy(world);
    }
    EXPECT(hash[0] == hash[1]);
    ran(1);
    return NULL;
}

/* Solves the 3 × 3 normal equations of a fit a + b s + c n. Returns b. */
static double fit_slope(int64_t n, const double (*q)[3], const double *y,
                        double out[3])
{
    double a[3][4] = {{0}};
    for (int64_t k = 0; k < n; k++)
        for (int i = 0; i < 3; i++) {
            for (int j = 0; j < 3; j++)
                a[i][j] += q[k][i] * q[k][j];
            a[i][3] += q[k][i] * y[k];
        }
    for (int i = 0; i < 3; i++)
        for (int r = 0; r < 3; r++)
            if (r != i) {
                double f = a[r][i] / a[i][i];
                for (int j = 0; j < 4; j++)
                    a[r][j] -= f * a[i][j];
            }
    for (int i = 0; i < 3; i++)
        out[i] = a[i][3] / a[i][i];
    return out[1];
}

/* panel.md §2: a strip hangs along `turn` to the grain, in its plane. Its
 * modulus in the middle, where the ends do not reach, over theory. */
static const char *check_bias(double turn, double h)
{
    enum { MOST = 1 << 13 };
    static drape_pin pin[MOST];
    static double x[MOST][3], q[MOST][3], y[MOST];
    const double length = 0.5, width = 0.1, strain = 2e-3;
    double out[3];
    struct cutting c;
    struct stage_set s;
    EXPECT(cutting_strip(&c, length, width, turn, h));
    double u = cos(turn), v = sin(turn), C = 1000, G = 300;
    /* compliance: 1/E of an orthotropic sheet with C12 = C66 = G */
    double det = C * C - G * G, s11 = C / det, s12 = -G / det, s66 = 1 / G;
    double modulus = 1 / (s11 * (u * u * u * u + v * v * v * v) +
                          (2 * s12 + s66) * u * u * v * v);
    c.cloth.material.stretch = C;
    c.cloth.material.shear = G;
    int64_t n = (int64_t)c.cut.m * c.cut.n, pins = 0, middle = 0;
    EXPECT(n <= MOST);
    for (int64_t p = 0; p < n; p++)
        if (c.cut.kind[p] != CUT_OUT &&
            u * c.cut.x[p][0] + v * c.cut.x[p][1] < 0.8 * h)
            pin[pins++] =
                (drape_pin){(int)(p % c.cut.m), (int)(p / c.cut.m), -1};
    c.cloth.pins = pin;
    c.cloth.n_pins = (int)pins;
    set_stage(&s, &c.cloth);
    double load = strain * modulus / length;
    s.def.gravity[0] = u * load / c.cloth.material.density;
    s.def.gravity[1] = v * load / c.cloth.material.density;
    s.def.precision = 64;
    s.def.self_collision = 0;
    s.def.dt = 10;
    s.def.newton = 16;
    s.def.tolerance = 1e-12;
    drape_world *world;
    drape_step_report r;
    EXPECT(drape_create(&s.def, &world, NULL) == DRAPE_OK);
    for (int k = 0; k < 6; k++)
        EXPECT(drape_step(world, &r) == DRAPE_OK);
    drape_read(world, x, NULL);
    drape_destroy(world);
    for (int64_t p = 0; p < n; p++) {
        const double *a = c.cut.x[p];
        double along = u * a[0] + v * a[1], across = u * a[1] - v * a[0];
        if (c.cut.kind[p] == CUT_OUT || along < 0.17 || along > 0.33)
            continue;
        q[middle][0] = 1;
        q[middle][1] = along - 0.25;
        q[middle][2] = across - width / 2;
        /* the load falls along the strip: half of its part of (s - 0.25)² */
        double e = load / modulus;
        double moved =
            u * (x[p][0] - c.rest[p][0]) + v * (x[p][1] - c.rest[p][1]);
        y[middle] = moved + 0.5 * e * q[middle][1] * q[middle][1];
        middle++;
    }
    double is = load * 0.25 / fit_slope(middle, (const double(*)[3])q, y, out);
    cutting_free(&c);
    EXPECT(fabs(is / modulus - 1) <= 1e-3);
    ran(1);
    return NULL;
}

const char *test_panel_bias(void)
{
    static const double turn[] = {0.17453292519943295, 0.3490658503988659,
                                  0.5235987755982988, 0.7853981633974483};
    const char *failed = NULL;
    for (int k = 0; k < 4 && !failed && REAL_BITS == 64; k++)
        failed = check_bias(turn[k], 0.01);
    if (REAL_BITS == 32)
        ran(1);
    return failed;
}

/* Steps a world until it is asleep, or `most` times. No step leaves an
 * intersecting pair, by its report and by the audit. */
static const char *settle(drape_world *world, int most, drape_step_report *r)
{
    r->outcome = 0;
    for (int k = 0; k < most && !(r->outcome & DRAPE_ASLEEP); k++) {
        EXPECT(drape_step(world, r) == DRAPE_OK);
        EXPECT(!(r->outcome & (DRAPE_TRAPPED | DRAPE_PASSED | DRAPE_DIVERGED |
                               DRAPE_UNCONVERGED)));
        EXPECT(r->intersecting == 0);
        EXPECT(k % 10 || scene_audit(world, 1) == 0);
    }
    EXPECT(scene_audit(world, 1) == 0);
    return NULL;
}

/* A disc falls on a ball and drapes over it. */
const char *test_panel_ball(void)
{
    struct cutting c;
    struct stage_set s;
    drape_world *world;
    drape_step_report r;
    EXPECT(cutting_disc(&c, 0.1, REAL_BITS == 32 ? 0.008 : 0.012));
    lay_flat(&c, 0.062);
    set_stage(&s, &c.cloth);
    add_ball(&s, 0.05, 0.01);
    EXPECT(drape_create(&s.def, &world, NULL) == DRAPE_OK);
    const char *failed = settle(world, 70, &r);
    EXPECT(!failed);
    EXPECT(r.contacts > 50 && r.kinetic < 1e-6);
    drape_destroy(world);
    cutting_free(&c);
    ran(1);
    return NULL;
}

/* A strip on the bias that hangs from a corner comes to rest; another number of
 * threads gives the same bits. */
const char *test_panel_hangs(void)
{
    struct cutting c;
    struct stage_set s;
    drape_step_report r;
    EXPECT(cutting_strip(&c, 0.12, 0.06, 0.5, 0.01));
    lay_flat(&c, 0);
    int32_t corner = c.cut.corner[0];
    const drape_pin pin = {corner % c.cut.m, corner / c.cut.m, -1};
    c.cloth.pins = &pin;
    c.cloth.n_pins = 1;
    c.cloth.material.damping = 0.02;
    uint64_t hash[2];
    for (int k = 0; k < 2; k++) {
        drape_world *world;
        set_stage(&s, &c.cloth);
        s.def.threads = k ? 2 : 1;
        EXPECT(drape_create(&s.def, &world, NULL) == DRAPE_OK);
        const char *failed = settle(world, 240, &r);
        if (failed)
            return failed;
        EXPECT(r.kinetic < 1e-7);
        hash[k] = scene_hash(world);
        drape_destroy(world);
    }
    EXPECT(hash[0] == hash[1]);
    cutting_free(&c);
    ran(1);
    return NULL;
}

/* A disc that falls flat in air ends at the speed √(2 σ g / (ρ C)). */
static const char *check_fall(double h, double dt)
{
    struct cutting c;
    struct stage_set s;
    drape_world *world;
    static double v[1 << 10][3];
    EXPECT(cutting_disc(&c, 0.1, h));
    lay_flat(&c, 0);
    set_stage(&s, &c.cloth);
    s.def.dt = dt;
    s.def.wind = (drape_wind){{0, 0, 0}, 1.2, 1.1, 0.5};
    int64_t n = (int64_t)c.cut.m * c.cut.n;
    double sum = 0, all = 0;
    EXPECT(n <= 1 << 10);
    EXPECT(drape_create(&s.def, &world, NULL) == DRAPE_OK);
    for (int k = 0; k * dt < 1; k++)
        EXPECT(drape_step(world, NULL) == DRAPE_OK);
    EXPECT(drape_read(world, NULL, v) == DRAPE_OK);
    drape_destroy(world);
    struct model model;
    EXPECT(model_make(&model, &c) == DRAPE_OK);
    for (int64_t p = 0; p < n; p++) {
        sum -= (double)model.c.mass[p] * v[p][1];
        all += (double)model.c.mass[p];
    }
    double want = sqrt(2 * c.cloth.material.density * 9.81 / (1.2 * 1.1));
    EXPECT(fabs(sum / all / want - 1) < 0.01);
    model_free(&model);
    cutting_free(&c);
    ran(1);
    return NULL;
}

/* wind.md §4: a breeze on a disc at rest gives it the momentum ρ/2 C A u² dt, A
 * the area of all its cells, odd ones too, and its middle no torque. */
const char *test_panel_wind(void)
{
    struct cutting c;
    struct stage_set s;
    drape_world *world;
    drape_step_report r;
    for (int k = 0; k < 4; k++) {
        const char *what =
            check_fall(k % 2 ? 0.01 : 0.02, k / 2 ? 1.0 / 60 : 1.0 / 240);
        EXPECT(!what);
    }
    EXPECT(cutting_disc(&c, 0.1, 0.02));
    lay_flat(&c, 0);
    set_stage(&s, &c.cloth);
    memset(s.def.gravity, 0, sizeof s.def.gravity);
    s.def.dt = 1e-3;
    const double density = 1.2, drag = 1, lift = 1, slow = 1e-2;
    s.def.wind = (drape_wind){{0, slow, 0}, density, drag, lift};
    int64_t n = (int64_t)c.cut.m * c.cut.n;
    static double v[1 << 10][3];
    double push = 0, turn[2] = {0, 0}, area = model_area(&c);
    EXPECT(n <= 1 << 10);
    EXPECT(drape_create(&s.def, &world, NULL) == DRAPE_OK);
    EXPECT(drape_step(world, &r) == DRAPE_OK);
    EXPECT(drape_read(world, NULL, v) == DRAPE_OK);
    drape_destroy(world);
    struct model model;
    EXPECT(model_make(&model, &c) == DRAPE_OK);
    for (int64_t p = 0; p < n; p++) {
        double to = (double)model.c.mass[p] * v[p][1];
        push += to;
        for (int i = 0; i < 2; i++)
            turn[i] += to * c.cut.x[p][i];
    }
    double want = 0.5 * density * drag * area * slow * slow * s.def.dt;
    EXPECT(fabs(push / want - 1) < 1e-3);
    EXPECT(fmax(fabs(turn[0]), fabs(turn[1])) < 0.01 * 0.1 * want);
    model_free(&model);
    cutting_free(&c);
    ran(1);
    return NULL;
}

/* What a panel does not go with is refused, with a reason. */
const char *test_panel_refused(void)
{
    static uint8_t cut[1 << 12];
    for (int k = 0; k < 8; k++) {
        static const char *const words[] = {
            "holes and cuts", "triples",   "implicit",   "is 9",
            "0.05",           "cells off", "coordinate", "NULL"};
        struct cutting c;
        struct stage_set s;
        drape_error error = {0};
        drape_world *world = NULL;
        EXPECT(cutting_disc(&c, 0.1, 0.01));
        set_stage(&s, &c.cloth);
        int64_t middle = c.cut.m / 2 + (int64_t)c.cut.m * (c.cut.n / 2);
        int64_t cell = c.cut.m / 2 + (c.cut.m - 1) * (int64_t)(c.cut.n / 2);
        int want = k == 6 ? DRAPE_EDATA : DRAPE_EARG;
        if (k == 0)
            c.cloth.cut = cut;
        if (k == 1)
            c.cloth.bending = DRAPE_SPRINGS;
        if (k == 2)
            s.def.integrator = DRAPE_VERLET;
        if (k == 3)
            c.cut.cell[cell] = 9;
        if (k == 4) { /* its first corner is moved across its diagonal */
            for (int64_t i = -1; i < 1; i++)
                for (int64_t j = -1; j < 1; j++)
                    c.cut.cell[cell + i + j * (c.cut.m - 1)] =
                        DRAPE_CELL_RISING;
            c.rest[middle][0] += 0.006;
            c.rest[middle][1] -= 0.006;
        }
        if (k == 5)
            c.rest[middle][0] += 0.001;
        if (k == 6)
            c.rest[middle][1] = NAN;
        if (k == 7)
            c.panel.cell = NULL;
        EXPECT(drape_create(&s.def, &world, &error) == want);
        EXPECT(strstr(error.text, words[k]));
        cutting_free(&c);
        ran(1);
    }
    return NULL;
}

/* A row of cells whose lower edges are eased by a ratio, as a ring of trapezes,
 * all lengths of it times `scale`: what its springs hold after a short step. */
enum { EASED = 9 };
struct eased {
    double h, ratio, scale, dt, elastic, moved;
    double rest[2 * EASED][2], x[2 * EASED][3];
    uint8_t cell[EASED - 1];
    drape_ease eases[EASED - 1];
    drape_panel panel;
    drape_cloth cloth;
    struct stage_set s;
};

static void eased_make(struct eased *e)
{
    double half = atan((1 - e->ratio) / 2), h = e->h;
    e->panel = (drape_panel){.rest = (const double(*)[2])e->rest,
                             .cell = e->cell,
                             .eases = e->eases,
                             .n_eases = EASED - 1};
    e->cloth = sheet_default(EASED, 2);
    e->cloth.width = h * (EASED - 1);
    e->cloth.height = h;
    e->cloth.material.bend = 0;
    e->cloth.x = (const double(*)[3])e->x;
    e->cloth.panel = &e->panel;
    for (int p = 0; p < 2 * EASED; p++) {
        double angle = 2 * half * (p % EASED);
        double side = e->scale * (p / EASED ? h : e->ratio * h);
        e->rest[p][0] = h * (p % EASED);
        e->rest[p][1] = h * (p / EASED);
        e->x[p][0] = -side / 2 / sin(half) * cos(angle);
        e->x[p][1] = 0;
        e->x[p][2] = side / 2 / sin(half) * sin(angle);
    }
    for (int k = 0; k < EASED - 1; k++) {
        e->cell[k] = DRAPE_CELL_RISING;
        e->eases[k] = (drape_ease){{k + 1, k}, e->ratio};
    }
    set_stage(&e->s, &e->cloth);
    memset(e->s.def.gravity, 0, sizeof e->s.def.gravity);
    e->s.def.dt = e->dt;
}

static const char *eased_step(struct eased *e)
{
    drape_world *world;
    drape_step_report r;
    double to[2 * EASED][3];
    EXPECT(drape_create(&e->s.def, &world, NULL) == DRAPE_OK);
    EXPECT(drape_step(world, &r) == DRAPE_OK);
    EXPECT(drape_read(world, to, NULL) == DRAPE_OK);
    e->elastic = r.elastic;
    e->moved = 0;
    for (int p = 0; p < 2 * EASED; p++)
        for (int i = 0; i < 3; i++)
            e->moved = fmax(e->moved, fabs(to[p][i] - e->x[p][i]));
    drape_destroy(world);
    return NULL;
}

/* Whether a corner that is drawn into its cell is refused with the edge. */
static bool eased_refuses(struct eased *e)
{
    drape_world *world = NULL;
    drape_error error = {0};
    double was[2] = {e->rest[EASED + 1][0], e->rest[EASED + 1][1]};
    e->rest[EASED + 1][0] = e->rest[EASED + 1][1] = 0.45 * e->h;
    int status = drape_create(&e->s.def, &world, &error);
    drape_destroy(world);
    memcpy(e->rest[EASED + 1], was, sizeof was);
    return status == DRAPE_EARG && strstr(error.text, "eases 0") &&
           strstr(error.text, "not convex");
}

/* The ring is at rest, where the cells as they were cut are not. By a uniform
 * strain it takes the energy of the grid times the area that it has left
 * (panel.md §2), at cells of any size: in 32 bits places of 0.2 m are off by
 * 1e-8 m, which of a strain of 1 % of 5 mm is 2e-4 at each end. */
const char *test_panel_eased(void)
{
    static struct eased e;
    for (int k = 0; k < 6; k++) {
        double elastic[2];
        const char *failed;
        e = (struct eased){.h = 0.005 * (1 << k % 3),
                           .ratio = k / 3 ? 0.5 : 0.8,
                           .scale = 1,
                           .dt = 1.0 / 60};
        eased_make(&e);
        failed = eased_step(&e);
        EXPECT(!failed && e.moved < (REAL_BITS == 64 ? 1e-12 : 1e-7));
        EXPECT(eased_refuses(&e));
        elastic[0] = e.elastic;
        e.panel.n_eases = 0;
        failed = eased_step(&e);
        EXPECT(!failed && elastic[0] < 1e-6 * e.elastic);
        for (int other = 0; other < 2; other++) {
            e.scale = 1.01;
            e.dt = 1e-7;
            e.ratio = other ? 0.95 : e.ratio;
            eased_make(&e);
            failed = eased_step(&e);
            EXPECT(!failed);
            elastic[other] = e.elastic;
        }
        double left = (1 + (k / 3 ? 0.5 : 0.8)) / (1 + 0.95);
        EXPECT(fabs(elastic[0] / elastic[1] - left) <
               (REAL_BITS == 64 ? 1e-6 : 2e-3));
    }
    static const char *const words[] = {"no edge of a cell", "ratio", "ratio",
                                        "end", "no edge of a cell"};
    const drape_ease bad[] = {{{0, 2}, 1},
                              {{0, 1}, 0.4},
                              {{0, 1}, NAN},
                              {{0, 2 * EASED}, 1},
                              {{0, 1}, 1}};
    for (int k = 0; k < 5; k++) {
        drape_world *world;
        drape_error error;
        e.eases[1] = bad[k];
        e.cell[0] = k == 4 ? DRAPE_CELL_REGULAR : DRAPE_CELL_RISING;
        EXPECT(drape_create(&e.s.def, &world, &error) != DRAPE_OK);
        EXPECT(strstr(error.text, "panel.eases"));
        EXPECT(strstr(error.text, words[k]));
    }
    ran(1);
    return NULL;
}

/* control.md §1: a panel whose material was set is one that was made of it:
 * masses, fibres and stars, also where nothing bent before. */
const char *test_panel_material(void)
{
    for (int k = 0; k < 3; k++) {
        struct cutting c;
        struct stage_set s;
        drape_world *world[2];
        EXPECT(cutting_disc(&c, 0.1, 0.02));
        lay_flat(&c, 0.062);
        c.cloth.material.bend = k == 1 ? 0 : 1e-4;
        drape_material to = c.cloth.material;
        to.density *= 2;
        to.stretch *= 1.5;
        to.bend = k == 2 ? 0 : 3e-4;
        set_stage(&s, &c.cloth);
        add_ball(&s, 0.05, 0.01);
        s.def.backend = k == 0 ? DRAPE_GPU : DRAPE_REF;
        for (int i = 0; i < 2; i++) {
            EXPECT(drape_create(&s.def, &world[i], NULL) == DRAPE_OK);
            c.cloth.material = to;
        }
        EXPECT(drape_set_material(world[0], 0, &to) == DRAPE_OK);
        for (int i = 0; i < 2; i++)
            for (int step = 0; step < 8; step++)
                EXPECT(drape_step(world[i], NULL) == DRAPE_OK);
        EXPECT(scene_hash(world[0]) == scene_hash(world[1]));
        for (int i = 0; i < 2; i++)
            drape_destroy(world[i]);
        cutting_free(&c);
        ran(1);
    }
    return NULL;
}
