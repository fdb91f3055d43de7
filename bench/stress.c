/* SPDX-License-Identifier: Apache-2.0 */
/* Runs scenes at the edge of what a step can do, and writes how each ends. None
 * may crash or hang, have an intersection that is not reported, or a number
 * that is not finite. spec/accuracy.md §4 */
#include "bench/accuracy.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { TURNS = 6 }; /* the most turns of the twisted strip */

/* A scene, with room for all that a case may need. */
struct stress {
    struct bench *b;
    FILE *out;
    drape_def def;
    drape_cloth cloth[12];
    struct solid solid[2];
    drape_obstacle body[2];
    drape_motion motion[2];
    double time[TURNS + 1], way[2][TURNS + 1][3], turn[2][TURNS + 1][4];
    drape_pin pin[128];
    int64_t pairs; /* the most intersecting pairs after any step */
};

static bool audit(void *user, drape_world *world,
                  const drape_step_report *report)
{
    struct stress *s = user;
    (void)report;
    int64_t n = world_pairs(world, s->def.n_cloths);
    s->pairs = n > s->pairs ? n : s->pairs;
    return true;
}

static void start(struct stress *s, int side)
{
    drape_default(&s->def);
    s->def.cloths = s->cloth;
    s->def.n_cloths = 1;
    s->def.obstacles = s->body;
    s->def.motions = s->motion;
    s->pairs = 0;
    cloth_flat(&s->cloth[0], side, 0.5, 0.3);
}

static void add_ball(struct stress *s)
{
    const double at[3] = {0, 0.2, 0};
    int k = s->def.n_obstacles++;
    solid_ball(&s->solid[k], 0.08, at, 16);
    s->body[k] = s->solid[k].body;
}

/* Pins a corner of the sheet, so that falling strains it. */
static void hang(struct stress *s)
{
    s->pin[0] = (drape_pin){0, 0, -1};
    s->cloth[0].pins = s->pin;
    s->cloth[0].n_pins = 1;
}

/* Runs a case and writes its row. An intersection that no step reported is a
 * failed check. */
static void end(struct stress *s, const char *name, double value, int steps)
{
    struct run r;
    run_watched(s->b, &s->def, steps, audit, s, &r);
    bool good = !s->pairs || r.outcome & DRAPE_TRAPPED;
    bench_check(s->b, good, "%s %g: %lld pairs intersect and no step said so",
                name, value, (long long)s->pairs);
    fprintf(s->out,
            "%s,%g,%s,%d,%g,%s,%lld of %d,%.1f,%.3g,%lld,%lld,%.3g,\"%s\"\n",
            name, value, integrator_name[s->def.integrator], s->def.precision,
            s->def.dt, run_word(&r), (long long)r.steps, steps,
            r.steps ? (double)r.iterations / (double)r.steps : 0, r.residual,
            (long long)s->pairs, (long long)r.contacts, r.seconds, r.text);
    fflush(s->out);
    run_free(&r);
    for (int k = 0; k < s->def.n_obstacles; k++)
        solid_free(&s->solid[k]);
}

/* A sheet falls on a ball, and a sheet of another density falls on the first.
 */
static void mass_ratios(struct stress *s)
{
    for (int k = 0; k <= 6; k += 2)
        for (int upper = 0; upper < 2; upper++) {
            start(s, 17);
            add_ball(s);
            s->def.n_cloths = 2;
            cloth_flat(&s->cloth[1], 17, 0.5, 0.32);
            s->cloth[upper].material.density = 0.2 * pow(10, k / 2.0);
            s->cloth[!upper].material.density = 0.2 / pow(10, k / 2.0);
            end(s, upper ? "mass ratio heavy above" : "mass ratio heavy below",
                pow(10, k), 16);
        }
}

static void damping(struct stress *s)
{
    for (int m = DRAPE_EULER; m <= DRAPE_CK; m++)
        for (int k = -5; k <= 3; k += s->b->quick ? 8 : 2) {
            start(s, 9);
            s->def.integrator = m;
            s->cloth[0].material.damping = pow(10, k);
            if (m < DRAPE_BW)
                s->def.dt = 1e-3;
            s->def.max_substeps = 2000;
            hang(s);
            end(s, "damping in s", pow(10, k), 30);
        }
}

/* Strips, grids of oblong cells, and very small and very large cells; some of
 * them the library must refuse. */
static void shapes(struct stress *s)
{
    static const struct {
        int m, n;
        double width, height;
    } row[] = {{2, 2, 0.5, 0.5},     {2, 400, 0.002, 0.798},
               {400, 2, 0.8, 0.002}, {9, 12, 0.5, 0.5},
               {9, 17, 0.5, 0.5},    {9, 90, 0.5, 0.5},
               {17, 17, 1e-4, 1e-4}, {17, 17, 1e4, 1e4}};
    for (int k = 0; k < (int)(sizeof row / sizeof *row); k++) {
        start(s, 9);
        drape_cloth *c = &s->cloth[0];
        c->m = row[k].m;
        c->n = row[k].n;
        c->width = row[k].width;
        c->height = row[k].height;
        c->material.thickness = fmin(2e-3, c->width);
        if (c->width < 1)
            add_ball(s);
        char name[64];
        snprintf(name, sizeof name, "grid %d x %d of %g m x %g m", c->m, c->n,
                 c->width, c->height);
        end(s, name, (c->width / (c->m - 1)) / (c->height / (c->n - 1)), 30);
    }
}

/* Particles that coincide: one spring, a row, all of them in one point. */
static void coincident(struct stress *s)
{
    static double x[81][3];
    for (int kind = 0; kind < 3; kind++)
        for (int m = DRAPE_EULER; m <= DRAPE_CK; m++) {
            if (s->b->quick && m % 3 != kind)
                continue;
            start(s, 9);
            s->def.integrator = m;
            s->def.allow_intersecting = 1;
            s->def.self_collision = 0; /* else the start intersects itself */
            if (m < DRAPE_BW)
                s->def.dt = 1e-3;
            for (int p = 0; p < 81; p++) {
                bool here = kind == 2 || (kind == 1 && p / 9 < 2);
                int q = here ? p % (kind == 2 ? 1 : 9) : p;
                if (kind == 0 && p == 41)
                    q = 40;
                x[p][0] = 0.0625 * (q % 9);
                x[p][1] = 0.3;
                x[p][2] = 0.0625 * (q / 9);
            }
            s->cloth[0].x = (const double(*)[3])x;
            hang(s);
            end(s,
                kind == 0   ? "one spring of length 0"
                : kind == 1 ? "two rows coincide"
                            : "all in one point",
                kind, 30);
        }
}

/* A ball that crosses the sheet, or half of it, in one step. */
static void fast_obstacle(struct stress *s)
{
    for (int k = 0; k < (s->b->quick ? 1 : 4); k++) {
        start(s, 17);
        add_ball(s);
        s->def.integrator = k < 2 ? DRAPE_BW : k == 2 ? DRAPE_CK : DRAPE_VERLET;
        double way = k % 2 ? 0.25 : 0.5; /* m a step, sheets of 0.5 m */
        s->time[1] = 20 * s->def.dt;
        s->way[0][0][0] = -1;
        s->way[0][1][0] = 20 * way - 1;
        s->way[0][0][1] = s->way[0][1][1] = 0.1; /* at the sheet's height */
        s->motion[0] =
            (drape_motion){.keys = 2,
                           .time = s->time,
                           .position = (const double(*)[3])s->way[0]};
        s->def.n_motions = 1;
        s->body[0].motion = 0;
        end(s, "fast ball: m a step", way, 20);
    }
}

/* Sets motion k, of one end of the strip: it rotates about the x axis by about
 * half a turn a second, and moves towards x = 0 by a tenth of `from` a second.
 */
static void turn(struct stress *s, int k, double from, int turns)
{
    s->motion[k] = (drape_motion){.keys = turns + 1,
                                  .time = s->time,
                                  .position = (const double(*)[3])s->way[k],
                                  .rotation = (const double(*)[4])s->turn[k],
                                  .pivot = {from, 0.3, 0}};
    for (int t = 0; t <= turns; t++) {
        double a = (k ? 1 : -1) * t * 3.14159265358979 / 2 * 0.98;
        double way[3] = {from * (1 - 0.1 * t), 0.3, 0};
        double turned[4] = {cos(a), sin(a), 0, 0};
        s->time[t] = t;
        memcpy(s->way[k][t], way, sizeof way);
        memcpy(s->turn[k][t], turned, sizeof turned);
    }
}

/* A strip whose ends rotate in opposite directions: it is twisted by about a
 * turn a second. */
static void twist(struct stress *s, int turns)
{
    start(s, 13);
    drape_cloth *c = &s->cloth[0];
    s->def.gravity[1] = 0;
    s->def.dt = 1.0 / 120;
    s->def.n_motions = 2;
    c->m = 49;
    c->width *= 1.2;
    c->height *= 0.3;
    c->origin[0] = -c->width / 2;
    c->origin[2] = -c->height / 2;
    for (int k = 0; k < 2; k++) {
        turn(s, k, (k - 0.5) * c->width, turns);
        for (int j = 0; j < c->n; j++)
            s->pin[k * c->n + j] = (drape_pin){k * (c->m - 1), j, k};
    }
    c->pins = s->pin;
    c->n_pins = 2 * c->n;
    end(s, "twist: turns", turns, 120 * turns);
}

/* Eight sheets, one above the other, that fall on each other. */
static void layers(struct stress *s)
{
    start(s, 9);
    solid_plane(&s->solid[0], 2, 0);
    s->body[0] = s->solid[0].body;
    s->def.n_obstacles = 1;
    s->def.n_cloths = 8;
    for (int k = 0; k < s->def.n_cloths; k++)
        cloth_flat(&s->cloth[k], 13, 0.4, 0.003 + 0.004 * k);
    end(s, "layers", s->def.n_cloths, 12);
}

/* An obstacle of slivers: the ball squeezed along y, with some triangles that
 * have no area. */
static void slivers(struct stress *s)
{
    for (int k = 0; k <= 12; k += s->b->quick ? 12 : 4) {
        start(s, 17);
        add_ball(s);
        for (int64_t p = 0; p < s->body[0].n_vertices; p++)
            s->solid[0].x[p][1] =
                0.2 + (s->solid[0].x[p][1] - 0.2) * pow(10, -k);
        for (int64_t t = 0; t < 20; t++)
            s->solid[0].tri[t][2] = s->solid[0].tri[t][1];
        end(s, "slivers: height by width", pow(10, -k), s->b->quick ? 20 : 40);
    }
}

void part_stress(struct bench *b)
{
    static struct stress s;
    s = (struct stress){.b = b};
    s.out = bench_csv(b, "stress",
                      "case,value,integrator,precision,dt,end,steps,"
                      "iterations a step,worst residual,intersecting pairs,"
                      "contacts,seconds,text");
    damping(&s);
    coincident(&s);
    fast_obstacle(&s);
    slivers(&s);
    for (int k = 2; k <= TURNS && !b->quick; k += 2)
        twist(&s, k);
    if (!b->quick) {
        shapes(&s);
        mass_ratios(&s);
        layers(&s);
    }
    fclose(s.out);
}
