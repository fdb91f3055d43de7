/* SPDX-License-Identifier: Apache-2.0 */
/* Stars: cylinders in twelve directions. spec/panel/panel.md §4 */
#include "tests/cloth/sheet.h"
#include "tests/panel/cutting.h"

/* The energy of a panel rolled to a cylinder about an axis at `way`, without
 * its springs, over that of a continuum. */
static double cylinder(struct model *s, const struct cutting *c, double bow,
                       double way)
{
    double u = cos(way), v = sin(way);
    for (int64_t p = 0; p < s->c.count; p++) {
        const double *a = c->rest[p];
        double along = u * a[0] + v * a[1], across = u * a[1] - v * a[0];
        s->x[p] = vec_make((real)(sin(bow * along) / bow), (real)across,
                           (real)((1 - cos(bow * along)) / bow));
    }
    double bend = c->cloth.material.bend;
    return model_energy(s) / (bend * bow * bow / 2 * model_area(c));
}

static const char *check_cylinders(const struct cutting *c, double most,
                                   double mean)
{
    const double bow = 5;
    struct model s;
    double sum = 0;
    EXPECT(model_make(&s, c) == DRAPE_OK);
    for (int o = 0; o < SPRINGS; o++)
        s.c.law[o].k = s.c.law[o].compression = 0;
    for (int k = 0; k < 12; k++) {
        double off = cylinder(&s, c, bow, k * 3.1415926535897932 / 12) - 1;
        EXPECT(fabs(off) <= most);
        sum += off / 12;
    }
    EXPECT(fabs(sum) <= mean);
    model_free(&s);
    ran(1);
    return NULL;
}

/* §4: at a twentieth of the length a cylinder's energy is within 2 % in each
 * direction; the error's mean falls with the cells. */
const char *test_panel_cylinders(void)
{
    static const double turn[] = {0.1745, 0.5236, 0.7854, 1.1};
    for (int k = 0; k < 10; k++) {
        double h = k % 2 ? 0.005 : 0.01;
        struct cutting c;
        EXPECT(k / 2 < 4 ? cutting_strip(&c, 0.2, 0.1, turn[k / 2], h)
                         : cutting_disc(&c, 0.1, h));
        const char *failed =
            check_cylinders(&c, k % 2 ? 0.02 : 0.032, k % 2 ? 0.0105 : 0.021);
        cutting_free(&c);
        if (failed)
            return failed;
    }
    return NULL;
}
