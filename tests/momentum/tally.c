/* SPDX-License-Identifier: Apache-2.0 */
/* What the host makes of moments: islands, and what they are given back.
 * spec/momentum/momentum.md §3 */
#include "ref/momentum/tally.h"

#include "tests/base/choices.h"
#include "tests/cloth/sheet.h"

enum { BODIES = 3, EACH = 20, ALL = BODIES * EACH, CASES = 200 };

/* Three bodies of some particles each, anywhere and moving anyhow. */
struct crowd {
    real w[ALL];
    vec x[ALL], v[ALL];
    real chunk[MOMENTS];
    struct tally part[BODIES], whole[BODIES];
};

static double uniform(struct bytes *b, double lo, double hi)
{
    return (double)pick_uniform(b, (real)lo, (real)hi);
}

static void crowd_make(struct crowd *s, struct bytes *b)
{
    for (int k = 0; k < BODIES; k++) {
        vec place = vec_make((real)uniform(b, -1, 1), (real)uniform(b, -1, 1),
                             (real)uniform(b, -1, 1));
        vec speed = vec_scale((real)uniform(b, -3, 3), place);
        for (int p = EACH * k; p < EACH * (k + 1); p++) {
            s->w[p] = (real)uniform(b, 10, 1000);
            for (int i = 0; i < 3; i++) {
                (&s->x[p].x)[i] = (real)uniform(b, -0.5, 0.5);
                (&s->v[p].x)[i] = (real)uniform(b, -1, 1);
            }
            s->x[p] = vec_add(place, s->x[p]);
            s->v[p] = vec_add(speed, s->v[p]);
        }
    }
}

static void crowd_measure(struct crowd *s, const int32_t of[BODIES])
{
    for (int k = 0; k < BODIES; k++) {
        struct moments m = {.count = EACH,
                            .w = s->w + EACH * k,
                            .x = s->x + EACH * k,
                            .v = s->v + EACH * k,
                            .n_chunks = 1,
                            .chunk = s->chunk};
        ref_moments(&m);
        s->part[k] = tally_of(&m);
        s->part[k].elastic = 0.125 * (k + 1);
    }
    tally_join(BODIES, of, s->part, s->whole);
}

/* The tally of the particles of the bodies whose island is `island`, by its
 * definition. */
static struct tally direct(const struct crowd *s, const int32_t of[BODIES],
                           int island)
{
    struct tally t = {0};
    for (int pass = 0; pass < 2; pass++)
        for (int p = 0; p < ALL; p++) {
            double m = 1 / (double)s->w[p], r[3], u[3];
            if (of[p / EACH] != island)
                continue;
            for (int i = 0; i < 3; i++) {
                double x = (double)(&s->x[p].x)[i], v = (double)(&s->v[p].x)[i];
                t.centre[i] += pass ? 0 : m * x;
                t.p[i] += pass ? 0 : m * v;
                r[i] = x - t.centre[i] / t.mass;
                u[i] = v - t.p[i] / t.mass;
            }
            t.mass += pass ? 0 : m;
            for (int i = 0, e = 0; i < 3 && pass; i++) {
                int j = (i + 1) % 3, k = (i + 2) % 3;
                t.l[i] += m * (r[j] * u[k] - r[k] * u[j]);
                t.kinetic += m * u[i] * u[i] / 2;
                for (int q = i; q < 3; q++, e++)
                    t.spread[e] += m * r[i] * r[q];
            }
        }
    for (int i = 0; i < 3; i++)
        t.centre[i] /= t.mass;
    return t;
}

static bool near(const double *a, const double *b, int n, double scale)
{
    bool good = true;
    for (int i = 0; i < n; i++)
        good &= fabs(a[i] - b[i]) <= 400 * REAL_U * scale;
    return good;
}

/* §3.1: an island's tally is that of all its particles. */
const char *test_tally_joins(void)
{
    static struct crowd s;
    const int32_t islands[3][BODIES] = {{0, 1, 2}, {0, 1, 0}, {0, 0, 0}};
    for (int c = 0; c < CASES; c++) {
        struct bytes b = {.seed = (uint64_t)c, .size = -1};
        const int32_t *of = islands[c % 3];
        crowd_make(&s, &b);
        crowd_measure(&s, of);
        for (int k = 0; k < BODIES; k++) {
            if (of[k] != k)
                continue;
            struct tally t = direct(&s, of, k), w = s.whole[k];
            double size = t.mass * 16, elastic = 0;
            for (int j = 0; j < BODIES; j++)
                elastic += of[j] == k ? 0.125 * (j + 1) : 0;
            EXPECT(near(&t.mass, &w.mass, 1, t.mass));
            EXPECT(near(t.centre, w.centre, 3, 4) && near(t.p, w.p, 3, size));
            EXPECT(near(t.l, w.l, 3, size) &&
                   near(t.spread, w.spread, 6, size) &&
                   near(&t.kinetic, &w.kinetic, 1, size));
            EXPECT(w.elastic == elastic);
        }
        ran(1);
    }
    return NULL;
}

/* Gives all particles the gain. */
static void crowd_gain(struct crowd *s, const struct gain *g)
{
    struct spin spin = {.count = ALL,
                        .w = s->w,
                        .x = s->x,
                        .keep = (real)g->keep,
                        .v = s->v,
                        .to = s->v};
    for (int i = 0; i < 3; i++) {
        (&spin.centre.x)[i] = (real)g->centre[i];
        (&spin.dv.x)[i] = (real)g->dv[i];
        (&spin.dw.x)[i] = (real)g->dw[i];
    }
    ref_spin(&spin);
}

static double own(const struct tally *t)
{
    return t->kinetic + t->elastic;
}

/* §3.3, §3.4: after the gain all have the momentum that they ought to have, and
 * the angular one as far as there is energy for it. `spare`: the energy that
 * the slice lost, of that of its end; < 0: it gained. */
static const char *check_gain(struct bytes *b, double spare, double more)
{
    static struct crowd s;
    const int32_t one[BODIES] = {0, 0, 0};
    crowd_make(&s, b);
    crowd_measure(&s, one);
    struct tally after = s.whole[0], before = after;
    double p[3], size = after.mass * 16;
    before.elastic += spare * own(&after);
    for (int i = 0; i < 3; i++) {
        p[i] = after.p[i] + 0.1 * after.mass;
        before.l[i] *= more;
    }
    struct gain g = tally_gain(&before, &after, p);
    crowd_gain(&s, &g);
    crowd_measure(&s, one);
    const struct tally *t = &s.whole[0];
    double rounding = 400 * REAL_U * size;
    bool blast = -spare > 1.0 / 16;
    EXPECT(near(t->p, p, 3, size));
    EXPECT(g.keep >= 0 && g.keep <= 1);
    if (more <= 1) /* a smaller turn needs nothing */
        EXPECT(near(t->l, before.l, 3, size));
    /* the energy of the start; what the slice gained stays where it is too
     * much, or where nothing but the turn is left to take it from */
    bool spent = blast || (spare < 0 && g.keep == 0);
    double most = spent ? own(&after) : own(&before);
    EXPECT(own(t) <= most + rounding);
    bool all = near(t->l, before.l, 3, size);
    EXPECT(all || own(t) >= most - rounding);
    EXPECT(all || g.keep == 0); /* all that is not rigid is spent first */
    EXPECT(!blast || more != 1 || g.keep == 1);
    EXPECT(blast || spare >= 0 || more != 1 || g.keep < 1);
    EXPECT(spare < 0 || more != 1 || g.keep > 1 - 1e-12);
    return NULL;
}

const char *test_tally_gains(void)
{
    const double spare[] = {0, 0.01, 0.5, -0.01, -0.05, -0.1, -1};
    const double more[] = {0, 0.9, 1, 1.1, 4};
    const char *failed = NULL;
    for (int c = 0; c < CASES && !failed; c++) {
        struct bytes b = {.seed = (uint64_t)c, .size = -1};
        failed = check_gain(&b, spare[c % 7], more[c / 7 % 5]);
        ran(1);
    }
    return failed;
}

/* §3.3: what is close to a line is not turned, whatever it lost. */
const char *test_tally_line(void)
{
    struct tally after = {.mass = 1, .kinetic = 1, .elastic = 1};
    struct tally before = {.mass = 1, .kinetic = 2, .elastic = 2};
    const double p[3] = {0, 0, 0}, thick[3] = {1, 1e-3, 1e-7};
    before.l[2] = 1e-3;
    for (int k = 0; k < 3; k++) {
        after.spread[0] = 1; /* xx */
        after.spread[3] = after.spread[5] = thick[k];
        struct gain g = tally_gain(&before, &after, p);
        double i = after.spread[0] + after.spread[3];
        EXPECT(g.keep == 1 && g.dw[0] == 0 && g.dw[1] == 0);
        EXPECT(k < 2 ? fabs(g.dw[2] * i - 1e-3) <= 1e-12 : g.dw[2] == 0);
        ran(1);
    }
    return NULL;
}
