/* SPDX-License-Identifier: Apache-2.0 */
/* What cloths in empty space keep of their momentum.
 * spec/momentum/momentum.md §3 */
#include "ref/world/state.h"
#include "ref/world/step.h"
#include "tests/world/slab.h"

enum { SIDE = 12, COUNT = SIDE * SIDE, MOST = 3 };

/* Some sheets of 0.25 m in empty space. */
struct space {
    struct slab d;
    drape_cloth cloth[MOST];
    double v[MOST][COUNT][3];
    struct arena arena;
    struct world *w;
};

static void space_make(struct space *s, int n, int integrator, double gravity)
{
    slab_make(&s->d, integrator);
    s->d.def.dt = 0x1p-6;
    s->d.def.gravity[1] = -gravity;
    s->d.def.n_obstacles = 0;
    s->d.def.cloths = s->cloth;
    s->d.def.n_cloths = n;
    s->d.cloth.m = s->d.cloth.n = SIDE;
    s->d.cloth.width = s->d.cloth.height = 0.25;
    memset(s->v, 0, sizeof s->v);
    for (int k = 0; k < n; k++) {
        s->cloth[k] = s->d.cloth;
        s->cloth[k].velocity = (const double(*)[3])s->v[k];
    }
}

/* Adds a turn about the middle of the sheet, by so much a second, to its
 * velocities. */
static void turn(struct space *s, int k, double rate)
{
    for (int p = 0; p < COUNT; p++)
        s->v[k][p][1] +=
            rate * (p % SIDE - (SIDE - 1) / 2.0) * 0.25 / (SIDE - 1);
}

/* Mass, its centre, momentum, and the angular one about the centre, of n
 * cloths from k on. */
struct whole {
    double mass, x[3], p[3], l[3];
};

static struct whole whole_of(const struct world *w, int k, int n)
{
    struct whole t = {0, {0}, {0}, {0}};
    for (int64_t i = (int64_t)k * COUNT; i < (int64_t)(k + n) * COUNT; i++) {
        double m = 1 / (double)w->w[i];
        t.mass += m;
        for (int a = 0; a < 3; a++) {
            t.x[a] += m * (double)(&w->x0[i].x)[a];
            t.p[a] += m * (double)(&w->v0[i].x)[a];
        }
    }
    for (int a = 0; a < 3; a++)
        t.x[a] /= t.mass;
    for (int64_t i = (int64_t)k * COUNT; i < (int64_t)(k + n) * COUNT; i++)
        for (int a = 0; a < 3; a++) {
            int b = (a + 1) % 3, c = (a + 2) % 3;
            const real *x = &w->x0[i].x, *v = &w->v0[i].x;
            t.l[a] += (((double)x[b] - t.x[b]) * (double)v[c] -
                       ((double)x[c] - t.x[c]) * (double)v[b]) /
                      (double)w->w[i];
        }
    return t;
}

static double size_of(const double a[3])
{
    return sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
}

static double apart(const double a[3], const double b[3])
{
    const double d[3] = {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
    return size_of(d);
}

/* Whether b has the momentum of a, but for what gravity gave, and its angular
 * momentum but for the part `lost`; both but for rounding in 20 steps. */
static bool same(const struct whole *a, const struct whole *b, double fell,
                 double lost)
{
    const double p[3] = {b->p[0], b->p[1] + fell * a->mass, b->p[2]};
    double rounding = 1e-5 * (size_of(p) + (fell + 0.5) * a->mass);
    return apart(p, a->p) <= rounding &&
           apart(b->l, a->l) <= lost * size_of(a->l) + 0.1 * rounding;
}

/* §3: a sheet that turns at this rate goes on turning, and falls as gravity
 * says. BDF2 solves its equation; of what turns by a linear step, some of the
 * energy that it needs is in the springs (§3.4), and the more the more it turns
 * beyond 0.05 a step (blocks.md §8). */
static const char *check_turning(int integrator, double gravity, double rate,
                                 double lost)
{
    static struct space s;
    drape_step_report r;
    double first = 0;
    space_make(&s, 1, integrator, gravity);
    turn(&s, 0, rate);
    for (int p = 0; p < COUNT; p++)
        s.v[0][p][0] = 0.3;
    s.w = slab_inner(&s.d.def, &s.arena);
    EXPECT(s.w);
    struct whole a = whole_of(s.w, 0, 1);
    for (int step = 0; step < 20; step++) {
        EXPECT(step_advance(s.w, &r) == DRAPE_OK && r.outcome == 0);
        struct whole b = whole_of(s.w, 0, 1);
        EXPECT(same(&a, &b, gravity * r.time, lost));
        double energy = r.kinetic + r.elastic + r.potential;
        first = step ? first : energy;
        EXPECT(energy <= first + 1e-5 * r.kinetic);
        ran(1);
    }
    arena_free(&s.arena);
    return NULL;
}

const char *test_space_turns(void)
{
    const int methods[] = {DRAPE_BW, DRAPE_CK, DRAPE_BDF2};
    const double lost[2][3] = {{0.02, 0.003, 0.003}, {0.35, 0.2, 0.003}};
    const char *failed = NULL;
    for (int k = 0; k < 12 && !failed; k++) {
        int fast = k / 6, m = k % 6 / 2;
        failed = check_turning(methods[m], k % 2 ? 9.81 : 0, fast ? 6.4 : 2.5,
                               lost[fast][m]);
    }
    return failed;
}

/* §2, §3: two sheets that meet keep what they have together, and a third one
 * far away, which turns, what it has. */
static const char *check_apart(int integrator)
{
    static struct space s;
    drape_step_report r;
    space_make(&s, 3, integrator, 0);
    s.cloth[1].origin[1] += 0.008;
    s.cloth[1].origin[0] += 0.06;
    s.cloth[2].origin[1] += 3;
    for (int p = 0; p < COUNT; p++)
        s.v[1][p][1] = -0.8;
    turn(&s, 2, 2);
    s.w = slab_inner(&s.d.def, &s.arena);
    EXPECT(s.w);
    struct whole pair = whole_of(s.w, 0, 2), one = whole_of(s.w, 2, 1);
    int64_t contacts = 0;
    for (int step = 0; step < 12; step++) {
        EXPECT(step_advance(s.w, &r) == DRAPE_OK);
        EXPECT(!slice_failed(r.outcome));
        struct whole b = whole_of(s.w, 0, 2), c = whole_of(s.w, 2, 1);
        EXPECT(same(&pair, &b, 0, 0.01) && same(&one, &c, 0, 0.02));
        contacts += r.contacts;
        ran(1);
    }
    EXPECT(contacts > 0 &&
           apart(whole_of(s.w, 0, 1).p, pair.p) < 0.9 * size_of(pair.p));
    arena_free(&s.arena);
    return NULL;
}

const char *test_space_apart(void)
{
    const int methods[] = {DRAPE_BW, DRAPE_CK, DRAPE_BDF2};
    const char *failed = NULL;
    for (int k = 0; k < 3 && !failed; k++)
        failed = check_apart(methods[k]);
    return failed;
}

/* implicit.md §4: what is given back is no jump, as contact makes it: the past
 * of Choi–Ko and BDF2 stays what it was. */
const char *test_space_past(void)
{
    static struct space s;
    static vec x[COUNT], v[COUNT];
    for (int k = 0; k < 4; k++) {
        space_make(&s, 1, k % 2 ? DRAPE_CK : DRAPE_BDF2, 0);
        turn(&s, 0, 2);
        s.d.def.self_collision = k / 2;
        s.w = slab_inner(&s.d.def, &s.arena);
        EXPECT(s.w);
        for (int step = 0; step < 4; step++) {
            memcpy(x, s.w->x0, sizeof x);
            memcpy(v, s.w->v0, sizeof v);
            EXPECT(step_advance(s.w, NULL) == DRAPE_OK);
            if (s.w->past != 1) /* the step had several slices */
                continue;
            EXPECT(memcmp(x, s.w->past_x, sizeof x) == 0);
            EXPECT(memcmp(v, s.w->past_v, sizeof v) == 0);
            ran(1);
        }
        arena_free(&s.arena);
    }
    return NULL;
}

/* §3: wind gives momentum, and so does a pin: they take it from what is not
 * simulated. */
const char *test_space_held(void)
{
    static const drape_pin pin = {0, 0, -1};
    static struct space s;
    for (int k = 0; k < 2; k++) {
        space_make(&s, 1, DRAPE_BW, k ? 9.81 : 0);
        s.d.def.wind = (drape_wind){.velocity = {0, k ? 0 : 2, 0},
                                    .density = k ? 0 : 1.25,
                                    .drag = 1,
                                    .lift = 0};
        s.cloth[0].pins = k ? &pin : NULL;
        s.cloth[0].n_pins = k;
        s.w = slab_inner(&s.d.def, &s.arena);
        EXPECT(s.w && conserve_applies(s.w) == false);
        for (int step = 0; step < 8; step++)
            EXPECT(step_advance(s.w, NULL) == DRAPE_OK);
        double up = 0, mass = 0, time = 8 * s.d.def.dt;
        for (int64_t i = 0; i < s.w->nc; i++) {
            double m = s.w->w[i] > 0 ? 1 / (double)s.w->w[i] : 0;
            up += m * (double)s.w->v0[i].y;
            mass += m;
        }
        /* ½ ρ v² on a plate; what hangs falls less than freely */
        double thrust = 0.5 * 1.25 * 4 * 0.0625 * time;
        EXPECT(k || (up > 0.5 * thrust && up < thrust));
        EXPECT(!k || up > -0.99 * mass * 9.81 * time);
        arena_free(&s.arena);
        ran(1);
    }
    return NULL;
}
