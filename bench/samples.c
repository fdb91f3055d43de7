/* SPDX-License-Identifier: Apache-2.0 */
/* Makes scenes of cloth without contact, for run time against error, orders and
 * stability. */
#include "bench/accuracy.h"

#include <stdlib.h>
#include <string.h>

const char *const sample_name[] = {"stretched", "hanging", "flag", "falling",
                                   "swinging"};

/* Whether particle (i, j) is held. */
static bool held(enum sample_kind kind, int i, int j, int last)
{
    switch (kind) {
    case SAMPLE_STRETCHED:
        return i == 0 || j == 0 || i == last || j == last;
    case SAMPLE_HANGING:
    case SAMPLE_SWINGING:
        return j == 0;
    case SAMPLE_FLAG:
        return i == 0;
    default:
        return j == 0 && (i == 0 || i == last);
    }
}

/* Sets the start of the particle at a, b in [0, 1], its place in the cloth. The
 * velocity is smooth, and 0 where the cloth is held. */
static void place(enum sample_kind kind, double a, double b, double x[3],
                  double v[3])
{
    double w = 16 * a * (1 - a) * b * (1 - b);
    double start[SAMPLES][3] = {{1.3 * a, 1.2 * b, 0},
                                {1.02 * a, -1.02 * b, 0},
                                {1.02 * a, -1.02 * b, 0},
                                {a, 0, b},
                                {a, -0.955336489 * b, 0.295520207 * b}};
    double push[SAMPLES][3] = {{0.5 * w * (a - 0.3), 0.3 * w * b, w},
                               {0, 0, b * b * (a - 0.3)},
                               {0, 0, a * a * (b - 0.3)},
                               {0, 0, 0},
                               {0, 0, 0}};
    memcpy(x, start[kind], sizeof start[kind]);
    memcpy(v, push[kind], sizeof push[kind]);
}

void sample_make(struct sample *s, enum sample_kind kind, int side)
{
    int n = side * side;
    memset(s, 0, sizeof *s);
    drape_default(&s->def);
    drape_default_cloth(&s->cloth);
    s->def.cloths = &s->cloth;
    s->def.n_cloths = 1;
    s->def.self_collision = 0;
    s->def.sleep = 0;
    s->cloth.m = s->cloth.n = side;
    s->x = bench_take((size_t)n, sizeof *s->x);
    s->v = bench_take((size_t)n, sizeof *s->v);
    s->pin = bench_take((size_t)n, sizeof *s->pin);
    for (int p = 0; p < n; p++) {
        int i = p % side, j = p / side, last = side - 1;
        place(kind, (double)i / last, (double)j / last, s->x[p], s->v[p]);
        if (held(kind, i, j, last))
            s->pin[s->cloth.n_pins++] = (drape_pin){i, j, -1};
    }
    s->cloth.x = (const double(*)[3])s->x;
    s->cloth.velocity = (const double(*)[3])s->v;
    s->cloth.pins = s->pin;
    if (kind == SAMPLE_FLAG)
        s->def.wind = (drape_wind){{7, 0, 1.5}, 1.2, 1, 0.5};
}

void sample_free(struct sample *s)
{
    free(s->x);
    free(s->v);
    free(s->pin);
}
