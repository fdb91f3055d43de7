/* SPDX-License-Identifier: Apache-2.0 */
/* Two sheets that meet. spec/validation.md §9 */
#include "validate/validate.h"

#include <math.h>
#include <string.h>

struct meeting {
    double most;            /* the largest energy of a step, over the start's */
    double linear, angular; /* momentum lost, as a share */
    double torque;          /* of the contacts, as a share of the angular one */
};

/* How two sheets move. */
struct manner {
    const char *name;
    int integrator, newton, slices;
    bool promised; /* energy and linear momentum */
};
static const struct manner manners[] = {
    {"baraff-witkin", DRAPE_BW, 1, 32, true},
    {"baraff-witkin with newton 8", DRAPE_BW, 8, 32, true},
    {"bdf2", DRAPE_BDF2, 4, 32, true}};
/* Every step whole, as the list of contacts is that of the last slice. */
static const struct manner whole = {"", DRAPE_BW, 1, 1, false};
enum { MANNERS = sizeof manners / sizeof *manners };

/* Momentum, the angular one about the origin, of sheets of m² particles. */
static void momentum(const double *mass, int64_t n, double (*x)[3],
                     double (*u)[3], double p[3], double l[3])
{
    memset(p, 0, 3 * sizeof *p);
    memset(l, 0, 3 * sizeof *l);
    for (int64_t k = 0; k < n; k++)
        for (int c = 0; c < 3; c++) {
            int a = (c + 1) % 3, b = (c + 2) % 3;
            p[c] += mass[k] * u[k][c];
            l[c] += mass[k] * (x[k][a] * u[k][b] - x[k][b] * u[k][a]);
        }
}

enum { MOST = 2 * 41 * 41 };
static double place[MOST][3], speed_of[MOST][3], mass[MOST];

/* Two sheets of m² particles of 0.4 m, 15 mm apart and 0.1 m aside, meet at 1
 * m/s each: the upper one is `ratio` times as heavy and as slow. Returns their
 * kinetic energy. */
static double meet_start(int m, double h, double ratio)
{
    double energy = 0;
    for (int k = 0; k < 2 * m * m; k++) {
        int upper = k >= m * m, i = k % (m * m) % m, j = k % (m * m) / m;
        place[k][0] = h * i + 0.1 * upper - 0.2;
        place[k][1] = 0.015 * upper;
        place[k][2] = h * j - 0.2;
        memset(speed_of[k], 0, sizeof speed_of[k]);
        speed_of[k][1] = upper ? -1 / ratio : 1;
        mass[k] = 0.2 * (upper ? ratio : 1) * h * h;
        mass[k] *= (i == 0 || i == m - 1) ? 0.5 : 1;
        mass[k] *= (j == 0 || j == m - 1) ? 0.5 : 1;
        energy += mass[k] * speed_of[k][1] * speed_of[k][1] / 2;
    }
    return energy;
}

/* Their world, in empty space. */
static drape_world *meet_world(const struct validate *v, int m, double h,
                               double ratio, const struct manner *how,
                               double dt)
{
    struct sheet s;
    sheet_make(v, &s, m, m, h);
    drape_cloth cloth[2] = {s.cloth, s.cloth};
    for (int k = 0; k < 2; k++) {
        cloth[k].x = (const double(*)[3])(place + k * m * m);
        cloth[k].velocity = (const double(*)[3])(speed_of + k * m * m);
        cloth[k].material.density *= k ? ratio : 1;
    }
    s.def.cloths = cloth;
    s.def.n_cloths = 2;
    s.def.self_collision = 1;
    s.def.max_slices = how->slices;
    s.def.tolerance = v->bits == 64 ? 1e-7 : 1e-5;
    s.def.integrator = how->integrator;
    s.def.newton = how->newton;
    s.def.dt = dt;
    memset(s.def.gravity, 0, sizeof s.def.gravity);
    drape_world *world;
    drape_error error;
    if (drape_create(&s.def, &world, &error) != DRAPE_OK)
        fprintf(stderr, "validate: %s\n", error.text);
    sheet_free(&s);
    return world;
}

/* The torque, N·m·s, about the origin of the contacts' impulses in the last
 * step, which act where the step began: x. NAN if it was cut into slices. */
static bool contact_torque(drape_world *world, const drape_step_report *report,
                           double (*x)[3], double out[3])
{
    drape_contact_list list;
    if (report->slices > 1 || drape_contacts(world, &list) != DRAPE_OK)
        return false;
    for (int64_t k = 0; k < list.n; k++) {
        const drape_contact *t = &list.contact[k];
        double apart[3] = {0, 0, 0};
        for (int j = 0; j < 4; j++)
            for (int c = 0; c < 3; c++)
                apart[c] += t->weight[j] * x[t->vertex[j]][c];
        for (int c = 0; c < 3; c++) {
            int a = (c + 1) % 3, b = (c + 2) % 3;
            out[c] += apart[a] * t->impulse[b] - apart[b] * t->impulse[a];
        }
    }
    return true;
}

/* Steps of dt for 0.2 s. */
static struct meeting meet(const struct validate *v, double h, double ratio,
                           const struct manner *how, double dt)
{
    struct meeting out = {NAN, NAN, NAN, NAN};
    int m = (int)(0.4 / h + 0.5) + 1, n = 2 * m * m;
    double start = meet_start(m, h, ratio), p[2][3], l[2][3];
    double torque[3] = {0, 0, 0};
    drape_world *world = meet_world(v, m, h, ratio, how, dt);
    if (!world)
        return out;
    momentum(mass, n, place, speed_of, p[0], l[0]);
    out.most = 1;
    bool uncut = true;
    for (int k = 0; k < (int)(0.2 / dt + 0.5); k++) {
        drape_step_report report;
        bool good = drape_step(world, &report) == DRAPE_OK;
        double energy = good ? report.kinetic + report.elastic : NAN;
        out.most = energy / start <= out.most ? out.most : energy / start;
        uncut = uncut && contact_torque(world, &report, place, torque);
        drape_read(world, place, speed_of);
    }
    momentum(mass, n, place, speed_of, p[1], l[1]);
    double dp = 0, dl = 0, turn = 0, scale = 0.2 * 0.16; /* of one sheet */
    double turned = 0;
    for (int c = 0; c < 3; c++) {
        dp += pow(p[1][c] - p[0][c], 2);
        dl += pow(l[1][c] - l[0][c], 2);
        turn += pow(l[0][c], 2);
        turned += pow(torque[c], 2);
    }
    out.linear = sqrt(dp) / scale;
    out.angular = sqrt(dl / turn);
    out.torque = uncut ? sqrt(turned / turn) : NAN;
    drape_destroy(world);
    return out;
}

/* What two sheets keep, at several sizes of cells or, by the last manner, of
 * steps. */
struct kept {
    struct property energy, linear, angular;
    char name[3][128];
};

static struct property kept_row(char name[128], const char *sheets,
                                const char *what, double theory, double bar)
{
    snprintf(name, 128, "two sheets; %s; %s", sheets, what);
    return (struct property){.part = "meeting",
                             .name = name,
                             .unit = "1",
                             .theory = theory,
                             .bar = bar,
                             .up_to = 1};
}

static void kept_begin(struct kept *k, const char *sheets, int bits,
                       const struct manner *how)
{
    double least = bits == 64 ? 1e-3 : 0.01;
    k->energy = kept_row(k->name[0], sheets, "largest energy over the start's",
                         1, least);
    k->linear = kept_row(k->name[1], sheets, "linear momentum lost", 0, least);
    k->angular = kept_row(k->name[2], sheets, "angular momentum lost", 0, 0.01);
    k->energy.promised = k->linear.promised = how->promised;
    k->angular.promised = how->newton > 1; /* momentum.md §3.4 */
}

static void kept_add(struct kept *k, double size, const struct meeting *m)
{
    property_add(&k->energy, size, m->most);
    property_add(&k->linear, size, m->linear);
    property_add(&k->angular, size, m->angular);
}

static void kept_end(struct validate *v, struct kept *k)
{
    property_end(v, &k->energy);
    property_end(v, &k->linear);
    property_end(v, &k->angular);
}

/* Two sheets of two mass ratios, at several sizes of cells. */
static void meetings(struct validate *v, const double *cell, int sizes)
{
    for (int r = 1; r <= 10; r *= 10)
        for (int q = 0; q < (r == 1 && v->bits == 64 ? MANNERS : 1); q++) {
            char sheets[96];
            struct kept k;
            snprintf(sheets, sizeof sheets, "%d to 1; %s", r, manners[q].name);
            kept_begin(&k, sheets, v->bits, &manners[q]);
            for (int c = 0; c < sizes; c++) {
                struct meeting m = meet(v, cell[c], r, &manners[q], 1.0 / 60);
                kept_add(&k, cell[c], &m);
            }
            kept_end(v, &k);
        }
}

/* The same at several steps, and what contacts take by themselves. */
static void meetings_by_steps(struct validate *v, const double *cell)
{
    for (int q = 0; q < MANNERS; q++) {
        char sheets[96];
        struct kept k;
        snprintf(sheets, sizeof sheets, "1 to 1; %s; by steps",
                 manners[q].name);
        kept_begin(&k, sheets, v->bits, &manners[q]);
        k.angular.up_to = 0;
        for (int per = 60; per <= 480; per *= 2) {
            struct meeting m = meet(v, cell[0], 1, &manners[q], 1.0 / per);
            kept_add(&k, 1.0 / per, &m);
        }
        kept_end(v, &k);
    }
    for (int r = 1; r <= 10; r *= 10) {
        char sheets[32], name[128];
        snprintf(sheets, sizeof sheets, "%d to 1", r);
        struct property p = kept_row(
            name, sheets, "angular momentum that contacts take", 0, 0.01);
        p.promised = true;
        for (int c = 0; c < SIZES; c++)
            property_add(&p, cell[c],
                         meet(v, cell[c], r, &whole, 1.0 / 60).torque);
        property_end(v, &p);
    }
}

void part_meeting(struct validate *v)
{
    static const double cell[SIZES] = {0.04, 0.02, 0.4 / 30, 0.01};
    if (v->quick)
        return;
    meetings(v, cell, v->bits == 64 ? SIZES : SIZES - 1);
    if (v->bits == 64)
        meetings_by_steps(v, cell);
}
