/* SPDX-License-Identifier: Apache-2.0 */
/* One sheet without contact: its scene, its energy, its equilibrium.
 * spec/validation.md §1 */
#include "validate/validate.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

void sheet_make(const struct validate *v, struct sheet *s, int m, int n,
                double h)
{
    memset(s, 0, sizeof *s);
    drape_default(&s->def);
    drape_default_cloth(&s->cloth);
    s->n = (int64_t)m * n;
    size_t count = (size_t)s->n;
    s->x = take(count, sizeof *s->x);
    s->v = take(count, sizeof *s->v);
    s->hole = take(count, 1);
    s->pin = take(count, sizeof *s->pin);
    s->cloth.m = m;
    s->cloth.n = n;
    s->cloth.width = (m - 1) * h;
    s->cloth.height = (n - 1) * h;
    s->cloth.x = (const double(*)[3])s->x;
    s->cloth.velocity = (const double(*)[3])s->v;
    s->cloth.pins = s->pin;
    for (int64_t p = 0; p < s->n; p++) {
        s->x[p][0] = h * (double)(p % m);
        s->x[p][1] = -h * (double)(p / m);
    }
    s->def.backend = v->backend;
    s->def.precision = v->bits;
    s->def.n_cloths = 1;
    s->def.self_collision = 0;
    s->def.sleep = 0;
    s->def.max_slices = 1;
    s->def.tolerance = v->bits == 64 ? 1e-8 : 1e-5;
}

void sheet_pin(struct sheet *s, int i, int j)
{
    s->pin[s->cloth.n_pins++] = (drape_pin){i, j, -1};
}

void sheet_lay(struct sheet *s)
{
    for (int64_t p = 0; p < s->n; p++) {
        s->x[p][2] = s->x[p][1];
        s->x[p][1] = 0;
    }
}

void sheet_free(struct sheet *s)
{
    free(s->x);
    free(s->v);
    free(s->hole);
    free(s->pin);
}

drape_world *sheet_world(const struct sheet *s, double dt)
{
    drape_def def = s->def;
    drape_cloth cloth = s->cloth;
    drape_world *world;
    drape_error error;
    for (int64_t p = 0; p < s->n && !cloth.hole; p++)
        if (s->hole[p])
            cloth.hole = s->hole;
    def.cloths = &cloth;
    def.dt = dt;
    if (drape_create(&def, &world, &error) == DRAPE_OK)
        return world;
    fprintf(stderr, "validate: %s\n", error.text);
    return NULL;
}

double sheet_energy(const struct sheet *s)
{
    struct sheet still = *s;
    drape_step_report report;
    memset(still.def.gravity, 0, sizeof still.def.gravity);
    /* One explicit step so short that nothing moves. */
    still.def.integrator = DRAPE_EULER;
    drape_world *world = sheet_world(&still, 1e-9);
    if (!world)
        return NAN;
    int status = drape_step(world, &report);
    drape_destroy(world);
    return status == DRAPE_OK ? report.elastic : NAN;
}

/* The largest way of a particle between two states; absent ones stand. */
static double moved(int64_t n, double (*a)[3], double (*b)[3])
{
    double most = 0;
    for (int64_t p = 0; p < n; p++) {
        double d = hypot(hypot(a[p][0] - b[p][0], a[p][1] - b[p][1]),
                         a[p][2] - b[p][2]);
        if (isnan(d))
            return NAN;
        most = fmax(most, d);
    }
    return most;
}

/* Up to `steps` steps of dt from s->x at rest, which becomes the last state,
 * until one moves nothing by more than `still`. Returns the last step's way, or
 * NAN if a step failed or diverged. */
static double settle(struct sheet *s, double dt, int steps, double still)
{
    drape_world *world = sheet_world(s, dt);
    double way = NAN, (*next)[3] = take((size_t)s->n, sizeof *next);
    for (int k = 0; world && k < steps; k++) {
        drape_step_report report;
        if (drape_step(world, &report) != DRAPE_OK ||
            (report.outcome & DRAPE_DIVERGED)) {
            way = NAN;
            break;
        }
        drape_read(world, next, NULL);
        way = moved(s->n, s->x, next);
        memcpy(s->x, next, (size_t)s->n * sizeof *next);
        if (report.outcome & DRAPE_UNCONVERGED)
            way = INFINITY; /* it says nothing of how far rest is */
        if (way <= still)
            break;
    }
    drape_destroy(world);
    free(next);
    return way;
}

/* Seeks rest by steps that solve at least so many systems, as linear ones of
 * such length go on as before (blocks.md §8). */
static bool rest_by(struct sheet *s, int newton, double shortest, double still)
{
    const double longest = 1;
    s->def.integrator = DRAPE_BW;
    s->def.newton = s->def.newton > newton ? s->def.newton : newton;
    memset(s->v, 0, (size_t)s->n * sizeof *s->v);
    /* Each stage starts at rest, which takes the energy that is left. */
    for (double dt = shortest; dt < longest; dt *= 3)
        settle(s, dt, 40, 1e2 * still);
    return settle(s, longest, 1000, still) <= still;
}

bool sheet_rest_from(struct sheet *s, double shortest, double still)
{
    return rest_by(s, 2, shortest, still);
}

bool sheet_rest(struct sheet *s, double still)
{
    size_t bytes = (size_t)s->n * sizeof *s->x;
    double(*start)[3] = take((size_t)s->n, sizeof *start);
    memcpy(start, s->x, bytes);
    bool found = rest_by(s, 2, 1.0 / 60, still);
    if (!found) { /* a way that is followed more closely */
        memcpy(s->x, start, bytes);
        found = rest_by(s, 8, 1.0 / 200, still);
    }
    free(start);
    return found;
}

double sheet_steepest(drape_world *world, double before)
{
    drape_contact_list list;
    double most = before, all = 0;
    if (drape_contacts(world, &list) != DRAPE_OK)
        return NAN;
    for (int pass = 0; pass < 2; pass++)
        for (int64_t k = 0; k < list.n; k++) {
            const drape_contact *t = &list.contact[k];
            double along = 0, square = 0;
            for (int c = 0; c < 3; c++) {
                along += t->impulse[c] * t->normal[c];
                square += t->impulse[c] * t->impulse[c];
            }
            double across = sqrt(fmax(0, square - along * along));
            all += pass ? 0 : fabs(along);
            if (pass && along > 1e-9 * all)
                most = fmax(most, across / along);
        }
    return most;
}
