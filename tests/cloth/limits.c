/* SPDX-License-Identifier: Apache-2.0 */
/* Limits of strain: the law, whole sheets that hang by two corners, and the
 * substeps of explicit methods. spec/cloth/cloth.md §8 */
#include "ref/cloth/advance.h"
#include "ref/cloth/law.h"
#include "tests/cloth/sheet.h"

/* The law at one length against finite differences of the oracle, which is in
 * binary64. The error of a difference over h is at most h² by the third
 * derivative, which is 0 but for a jump of the second within h of a joint:
 * there it is at most h by that jump, 2 gain. */
static const char *check_law(const struct law *a, double length)
{
    double h = 1e-5 * (double)a->rest, size = (double)a->stiff, u = 8 * REAL_U;
    double jump = 4 * (double)a->gain * h + 1e-9 * size;
    double slope = law_oracle_slope(a, NULL, length),
           pull = law_oracle(a, NULL, length);
    double rise =
        law_oracle(a, NULL, length + h) - law_oracle(a, NULL, length - h);
    double work = law_oracle_energy(a, NULL, length + h) -
                  law_oracle_energy(a, NULL, length - h);
    EXPECT(fabs(rise / (2 * h) - slope) <= jump);
    EXPECT(fabs(work / (2 * h) - pull) <= jump * h + 1e-9 * fabs(pull));

    real l = (real)length;
    double is = (double)law_tension(a, NULL, l),
           steep = (double)law_slope(a, NULL, l);
    double e = (double)law_energy(a, NULL, l), near = u * size * length;
    EXPECT(fabs(is - law_oracle(a, NULL, (double)l)) <= near + u * fabs(pull));
    EXPECT(fabs(steep - law_oracle_slope(a, NULL, (double)l)) <=
           u * (2 * (double)a->gain * length + size));
    EXPECT(fabs(e - law_oracle_energy(a, NULL, (double)l)) <=
           u * (e + fabs(pull) * length) + near * (double)a->rest * u);
    /* blocks.md §2: T' ≥ T/ℓ, and neither exceeds the bound. */
    EXPECT(steep >= is / length * (1 - u));
    EXPECT(steep <= size * (1 + u) && is / length <= size);
    return NULL;
}

/* §8: energy, tension and slope belong together, the tension and its slope are
 * continuous and grow with the length, at and around the joints too. */
const char *test_limits_law(void)
{
    static const double limit[] = {0.01, 0.05, 0.3, 10};
    for (int k = 0; k < 4; k++) {
        struct law a = {
            .k = 700, .compression = 700, .rest = R(0.01), .stiff = 700};
        law_set_limit(&a, limit[k]);
        double rest = (double)a.rest, to = rest * (1 + LIMIT_TO * limit[k]);
        double last = -1, steep = 0;
        for (int i = 0; i <= 4000; i++) {
            double length = rest * (1 + limit[k] * i / 2000);
            const char *bad = check_law(&a, length);
            if (bad)
                return bad;
            real l = (real)length;
            EXPECT((double)law_tension(&a, NULL, l) >= last);
            EXPECT((double)law_slope(&a, NULL, l) >= steep);
            last = (double)law_tension(&a, NULL, l);
            steep = (double)law_slope(&a, NULL, l);
            ran(1);
        }
        /* §8: by LIMIT_TO of the limit the tension is what the page says. */
        double want = 700 * rest * (LIMIT_PULL + LIMIT_TO * limit[k]);
        double have = (double)law_tension(&a, NULL, (real)to);
        EXPECT(fabs(have / want - 1) <= 1e3 * REAL_U / limit[k]);
        /* Below LIMIT_FROM of the limit no bit is different. */
        struct law free = a;
        law_set_limit(&free, 0);
        real l = (real)(rest * (1 + 0.999 * LIMIT_FROM * limit[k]));
        EXPECT(law_tension(&a, NULL, l) == law_tension(&free, NULL, l));
        EXPECT(law_slope(&a, NULL, l) == law_slope(&free, NULL, l));
        EXPECT(law_energy(&a, NULL, l) == law_energy(&free, NULL, l));
    }
    return NULL;
}

/* The largest strain of a single spring by its limit; all limits alike. */
static double most_strain(const struct sheet *s)
{
    double most = 0;
    for (int64_t p = 0; p < s->c.count; p++)
        for (int o = 0; o < SPRINGS_SINGLE; o++) {
            if (!(s->c.springs[p] >> o & 1))
                continue;
            vec d = vec_sub(s->x[p + spring_step(s->c.m, o)], s->x[p]);
            double is = (double)vec_length(d) / (double)s->c.law[o].rest - 1;
            most = is > most ? is : most;
        }
    return most;
}

/* A square sheet of 1 m and 0.2 kg, of soft cotton with limits of 5 %, that
 * hangs by two corners. */
static int make_hung(struct sheet *s, int n, int method, double density)
{
    drape_pin pins[2] = {{0, 0, -1}, {n - 1, 0, -1}};
    drape_cloth d = sheet_default(n, n);
    d.material.stretch = 1000;
    d.material.shear = 300;
    d.material.density = density;
    d.material.damping = 1e-3;
    d.material.limit[0] = d.material.limit[1] = 0.05;
    d.material.limit[2] = 0.1;
    d.v[1] = -1;
    d.pins = pins;
    d.n_pins = 2;
    int status = sheet_make(s, &d, method);
    s->d.gravity = vec_make(0, R(-9.81), 0);
    return status;
}

/* §8: hung by two corners no spring is beyond its limit by more than a tenth.
 * What a pin bears by the constant and length of a spring decides; as heavy as
 * here a sheet of 0.2 kg/m² is at cells of 100, 13 and 0.5 mm. */
const char *test_limits_hung(void)
{
    static const struct {
        int n;
        double density;
    } of[] = {{11, 0.2}, {16, 1}, {21, 20}};
    for (int k = 0; k < 3; k++) {
        struct sheet s;
        EXPECT(make_hung(&s, of[k].n, DRAPE_BW, of[k].density) == DRAPE_OK);
        for (int step = 0; step < 60; step++)
            EXPECT(sheet_step(&s) == DRAPE_OK && !s.d.outcome);
        double most = most_strain(&s);
        EXPECT(most <= 1.1 * 0.05);
        EXPECT(most > LIMIT_FROM * 0.05 || k == 0);
        sheet_free(&s);
        ran(1);
    }
    return NULL;
}

/* advance.md §4: a sheet with limits that falls into its pins is stable at the
 * substeps of each explicit method, and its energy does not grow. */
const char *test_limits_explicit(void)
{
    for (int method = DRAPE_EULER; method <= DRAPE_RK4; method++) {
        struct sheet s;
        EXPECT(make_hung(&s, 6, method, 5) == DRAPE_OK);
        EXPECT(s.c.bound > 100 * s.c.damped);
        s.d.dt = 1.0 / 240;
        double first = 0;
        for (int step = 0; step < 60; step++) {
            EXPECT(sheet_step(&s) == DRAPE_OK && !s.d.outcome);
            double sum = s.d.energy[0] + s.d.energy[1] + s.d.energy[2];
            double scale = s.d.energy[0] + s.d.energy[1] + 1e-3;
            first = step ? first : sum;
            EXPECT(sum <= first + 0.02 * scale);
        }
        EXPECT(most_strain(&s) > LIMIT_FROM * 0.05);
        sheet_free(&s);
        ran(1);
    }
    return NULL;
}
