/* SPDX-License-Identifier: Apache-2.0 */
/* Two piles that sleep in one world: what hits a sheet of one wakes this pile
 * as a whole, and not the other. spec/sleep/sleep.md §2, §4 */
#include "tests/world/scene.h"
#include "tests/world/slab.h"

enum { SIDE = 6, COUNT = SIDE * SIDE, FLAKE = 3 };
/* A sheet of each pile, which is held, one that lies on it and overhangs, and a
 * flake that falls on the part that overhangs, far from the sheet below. */
enum { HELD, LIES = HELD + 2, FALLS = LIES + 2, CLOTHS };
enum { NC = 4 * COUNT + FLAKE * FLAKE, MEETS = 112, STEPS = MEETS + 8 };

struct piles {
    struct slab d;
    drape_cloth cloth[CLOTHS];
    drape_pin pin[COUNT];
};

static void make(struct piles *s, int hit)
{
    slab_small(&s->d, DRAPE_BW, 0.25);
    double t = MEETS * s->d.def.dt;
    s->d.def.gravity[1] = -1;
    for (int p = 0; p < COUNT; p++)
        s->pin[p] = (drape_pin){p % SIDE, p / SIDE, -1};
    for (int k = 0; k < CLOTHS; k++) {
        drape_cloth *c = &s->cloth[k];
        int side = k == FALLS ? FLAKE : SIDE, pile = k == FALLS ? hit : k % 2;
        *c = s->d.cloth;
        c->m = c->n = side;
        c->width = c->height = (side - 1) / 64.0;
        c->material.bend = 1e-3;
        c->origin[0] = 8 * pile;
        c->origin[2] = 0;
        if (k < LIES) {
            c->pins = s->pin;
            c->n_pins = COUNT;
            continue;
        }
        c->origin[0] += 2 / 64.0;
        c->origin[1] += 0.0045;
    }
    s->cloth[FALLS].origin[0] += 4.25 / 64;
    s->cloth[FALLS].origin[2] += 1.5 / 64;
    s->cloth[FALLS].origin[1] += 0.5 * t * t;
    s->d.def.cloths = s->cloth;
    s->d.def.n_cloths = CLOTHS;
    s->d.def.n_obstacles = 0;
}

/* Whether the sheets of a pile are where they were. */
static bool stays(int pile, double (*x)[3], double (*was)[3])
{
    bool good = true;
    for (int k = pile; k < FALLS; k += 2)
        good &= !memcmp(x + k * COUNT, was + k * COUNT, COUNT * sizeof *x);
    return good;
}

static const char *check(int hit)
{
    static struct piles s;
    static double x[2][NC][3];
    int asleep = 0, most = 0;
    make(&s, hit);
    drape_world *world = slab_world(&s.d);
    EXPECT(world);
    for (int k = 0; k < STEPS; k++) {
        drape_step_report r;
        drape_read(world, x[0], NULL);
        EXPECT(drape_step(world, &r) == DRAPE_OK && r.outcome == 0);
        drape_read(world, x[1], NULL);
        /* they fall asleep by piles, and one pile wakes */
        EXPECT(r.asleep % 2 == 0);
        EXPECT(r.asleep >= asleep || (asleep == 4 && r.asleep == 2));
        bool woke = most == 4 && r.asleep == 2;
        for (int pile = 0; pile < 2 && most == 4; pile++)
            EXPECT((woke && pile == hit) || stays(pile, x[1], x[0]));
        asleep = r.asleep;
        most = asleep > most ? asleep : most;
        ran(1);
    }
    EXPECT(most == 4 && asleep == 2 && !stays(hit, x[1], x[0]));
    drape_destroy(world);
    return NULL;
}

/* §2: with an explicit integrator all cloths are one island, however far apart:
 * the slab that rises to one of them wakes both in one step. Else it wakes
 * one. */
static const char *check_far(int integrator)
{
    enum { RISES = 40, END = 80 };
    static struct piles s;
    static double time[3], way[3][3];
    int last = 0;
    make(&s, 0);
    double y = s.cloth[0].origin[1];
    slab_small(&s.d, integrator, y);
    time[1] = RISES * s.d.def.dt;
    time[2] = 2 * time[1];
    way[2][1] = y - 0.1;
    s.d.motion =
        (drape_motion){3, time, (const double(*)[3])way, NULL, {0, 0, 0}};
    s.d.def.cloths = s.cloth;
    s.d.def.n_cloths = 2;
    drape_world *world = slab_world(&s.d);
    EXPECT(world);
    for (int k = 0; k < END && (k < RISES || last == 2); k++) {
        drape_step_report r;
        EXPECT(drape_step(world, &r) == DRAPE_OK);
        EXPECT(k >= RISES || r.asleep == (k < 29 ? 0 : 2));
        last = r.asleep;
        ran(1);
    }
    EXPECT(last == (integrator < DRAPE_BW ? 0 : 1));
    drape_destroy(world);
    return NULL;
}

const char *test_islands_wake(void)
{
    const char *failed = check(0);
    failed = failed ? failed : check(1);
    failed = failed ? failed : check_far(DRAPE_VERLET);
    return failed ? failed : check_far(DRAPE_BW);
}
