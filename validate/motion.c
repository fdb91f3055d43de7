/* SPDX-License-Identifier: Apache-2.0 */
/* Free fall, and the swing of a hanging sheet. spec/validation.md §5 */
#include "validate/validate.h"

#include <math.h>
#include <string.h>

static const char *const name_of[] = {[DRAPE_EULER] = "euler",
                                      [DRAPE_VERLET] = "verlet",
                                      [DRAPE_BW] = "baraff-witkin",
                                      [DRAPE_CK] = "choi-ko"};

/* The mean depth, m, of a sheet after falling for half a second. */
static double fall(const struct validate *v, int integrator, double dt)
{
    struct sheet s;
    sheet_make(v, &s, 11, 11, 0.02);
    s.def.integrator = integrator;
    drape_world *world = sheet_world(&s, dt);
    double depth = 0;
    for (int k = 0; world && k < (int)(0.5 / dt + 0.5); k++)
        if (drape_step(world, NULL) != DRAPE_OK)
            depth = NAN;
    struct sheet end = s;
    if (world)
        drape_read(world, end.v, NULL);
    for (int64_t p = 0; p < s.n; p++)
        depth += (s.x[p][1] - end.v[p][1]) / (double)s.n;
    drape_destroy(world);
    sheet_free(&s);
    return world ? depth : NAN;
}

static const double length = 0.4, gravity = 9.81;

/* The first mode of a hanging chain: J0 by its series. */
static double bessel(double x)
{
    double term = 1, sum = 1;
    for (int k = 1; k < 30; k++) {
        term *= -x * x / 4 / (k * k);
        sum += term;
    }
    return sum;
}

static const double zero = 2.404825557695773; /* of J0 */

/* Hangs the sheet in that mode, its tip 0.3 of its length off; arcs are kept.
 */
static void swing_start(struct sheet *s, double h)
{
    int m = s->cloth.m;
    double z = 0, y = 0, last = 0;
    for (int j = 0; j < s->cloth.n; j++) {
        double below = fmax(0, 1 - j * h / length);
        double next = 0.3 * length * bessel(zero * sqrt(below));
        z += j ? next - last : 0;
        y -= j ? sqrt(h * h - (next - last) * (next - last)) : 0;
        last = next;
        for (int i = 0; i < m; i++) {
            s->x[i + m * j][1] = y;
            s->x[i + m * j][2] = z;
        }
    }
    for (int i = 0; i < m; i++)
        sheet_pin(s, i, 0);
}

/* What a pendulum is swung by, and what is promised of it. */
struct swinger {
    const char *name;
    int integrator, newton;
    bool euler;  /* its formula is backward Euler's */
    double kept; /* it loses at most this much a period; NAN: not judged */
};

static const struct swinger swingers[] = {
    {"baraff-witkin", DRAPE_BW, 1, true, NAN},
    {"baraff-witkin with newton 8", DRAPE_BW, 8, true, NAN},
    {"choi-ko", DRAPE_CK, 1, false, NAN},
    {"bdf2", DRAPE_BDF2, 0, false, 0.03}};

/* The part of the amplitude that a period keeps, between the first two peaks
 * after the start; peaks by parabolas. */
static double swing(const struct validate *v, const struct swinger *t, double h,
                    double dt)
{
    struct sheet s;
    int n = (int)(length / h + 0.5) + 1;
    sheet_make(v, &s, n, n, h);
    s.def.integrator = t->integrator;
    s.def.newton = t->newton;
    swing_start(&s, h);
    drape_world *world = sheet_world(&s, dt);
    double z[3] = {0, 0, 0}, peak[2] = {NAN, NAN};
    int peaks = 0;
    for (int k = 0; world && peaks < 2 && k * dt < 5; k++) {
        if (drape_step(world, NULL) != DRAPE_OK)
            break;
        drape_read(world, s.x, NULL);
        memmove(z, z + 1, 2 * sizeof *z);
        z[2] = s.x[s.n - 1 - n / 2][2];
        double bend = 2 * z[1] - z[0] - z[2];
        if (k > 2 && z[1] > 0 && z[1] > z[0] && z[1] >= z[2])
            peak[peaks++] = z[1] + (z[2] - z[0]) * (z[2] - z[0]) / (8 * bend);
    }
    drape_destroy(world);
    sheet_free(&s);
    return peak[1] / peak[0];
}

/* What exact backward Euler keeps of an oscillation of the chain. */
static double euler(double dt)
{
    double w = zero / 2 * sqrt(gravity / length) * dt;
    return pow(1 + w * w, -acos(-1) / atan(w));
}

static void swings(struct validate *v, const struct swinger *t)
{
    static const double dts[SIZES] = {1.0 / 60, 1.0 / 120, 1.0 / 240,
                                      1.0 / 960};
    char name[96], over[96];
    snprintf(name, sizeof name, "pendulum; kept a period; %s", t->name);
    snprintf(over, sizeof over, "pendulum; %s over exact backward Euler",
             t->name);
    struct property kept = {.part = "motion",
                            .name = name,
                            .unit = "1",
                            .theory = 1,
                            .bar = t->kept,
                            .up_to = 1,
                            .promised = true};
    struct property ratio = {.part = "motion",
                             .name = over,
                             .unit = "1",
                             .theory = 1,
                             .bar = 0.02,
                             .up_to = 1,
                             .promised = t->newton > 1};
    for (int k = 0; k < (v->quick ? 2 : SIZES); k++) {
        double is = swing(v, t, v->quick ? 0.05 : 0.025, dts[k]);
        property_add(&kept, dts[k], is);
        property_add(&ratio, dts[k], is / euler(dts[k]));
    }
    property_end(v, &kept);
    if (t->euler)
        property_end(v, &ratio);
}

static void swings_by_cells(struct validate *v)
{
    static const double cell[SIZES] = {0.05, 0.025, 0.0125, 0.00625};
    const double dt = 1.0 / 240;
    struct property grid = {.part = "motion",
                            .name = "pendulum; baraff-witkin over exact "
                                    "backward Euler at 1/240 s by cells",
                            .unit = "1",
                            .theory = 1,
                            .bar = 0.02,
                            .up_to = 1,
                            .promised = true};
    for (int k = 0; k < SIZES; k++)
        property_add(&grid, cell[k],
                     swing(v, &swingers[0], cell[k], dt) / euler(dt));
    property_end(v, &grid);
}

void part_motion(struct validate *v)
{
    static const int integrators[] = {DRAPE_EULER, DRAPE_VERLET, DRAPE_BW,
                                      DRAPE_CK};
    static const double dts[SIZES] = {1.0 / 60, 1.0 / 120, 1.0 / 240,
                                      1.0 / 960};
    for (int k = v->quick ? 2 : 0; k < 4; k++) {
        char name[96];
        snprintf(name, sizeof name, "free fall for 0.5 s; %s",
                 name_of[integrators[k]]);
        struct property p = {.part = "motion",
                             .name = name,
                             .unit = "m",
                             .theory = gravity / 8,
                             .bar = 0.003,
                             .share = true,
                             .promised = true};
        for (int d = 0; d < SIZES; d++)
            property_add(&p, dts[d], fall(v, integrators[k], dts[d]));
        property_end(v, &p);
    }
    if (v->quick && v->bits == 32)
        return;
    for (size_t k = 0; k < sizeof swingers / sizeof *swingers; k++)
        swings(v, &swingers[k]);
    if (!v->quick)
        swings_by_cells(v);
}
