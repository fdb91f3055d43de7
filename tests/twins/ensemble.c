/* SPDX-License-Identifier: Apache-2.0 */
/* See tests/twins/ensemble.h. */
#include "tests/twins/ensemble.h"

enum { SIDE = ENSEMBLE_SIDE, COUNT = ENSEMBLE_COUNT };
/* The step in which the thrown cloth meets the one that rests, about. */
enum { MEETS = 48 };
static const double SPEED = 1, GRAVITY = 2, CELL = 1 / 64.0;

static void make_strained(struct ensemble *e)
{
    drape_cloth *c = &e->cloth[ENSEMBLE_RESTS];
    for (int p = 0; p < COUNT; p++) {
        e->strained[p][0] = 4 + 1.0625 * CELL * (p % SIDE);
        e->strained[p][1] = 0.25;
        e->strained[p][2] = CELL * (p / SIDE);
        e->pin[p] = (drape_pin){p % SIDE, p / SIDE, -1};
    }
    c->x = (const double(*)[3])e->strained;
    c->pins = e->pin;
    c->n_pins = COUNT;
}

static void make_thrown(struct ensemble *e)
{
    drape_cloth *c = &e->cloth[ENSEMBLE_THROWN];
    double t = MEETS * e->d.def.dt;
    c->origin[0] = 4.01;
    c->origin[1] = 0.25 + SPEED * t + 0.5 * GRAVITY * t * t;
    c->origin[2] = 0.005;
    for (int p = 0; p < COUNT; p++)
        e->falls[p][1] = -SPEED;
    c->velocity = (const double(*)[3])e->falls;
}

static void make_cloths(struct ensemble *e)
{
    for (int k = 0; k < ENSEMBLE_CLOTHS; k++) {
        drape_cloth *c = &e->cloth[k];
        *c = e->d.cloth;
        c->m = c->n = SIDE;
        c->width = c->height = (SIDE - 1) * CELL;
        c->origin[0] = 4.0 * k;
        c->origin[2] = 0;
        c->material.stretch = 1000 + 100 * k;
    }
    for (int p = 0; p < COUNT; p++)
        e->slides[p][0] = -0.0625;
    e->cloth[ENSEMBLE_SLIDES].velocity = (const double(*)[3])e->slides;
    e->corner[0] = (drape_pin){0, 0, 0};
    e->corner[1] = (drape_pin){SIDE - 1, 0, 0};
    e->cloth[ENSEMBLE_PRESCRIBED].pins = e->corner;
    e->cloth[ENSEMBLE_PRESCRIBED].n_pins = 2;
    make_strained(e);
    make_thrown(e);
}

void ensemble_make(struct ensemble *e, int how)
{
    static const int method[] = {DRAPE_BW, DRAPE_CK, DRAPE_BDF2, DRAPE_VERLET};
    memset(e, 0, sizeof *e);
    slab_small(&e->d, method[how / 2], 0.105);
    e->d.def.response = how % 2 ? DRAPE_IMPULSES : DRAPE_SOLVE;
    e->d.def.gravity[1] = -GRAVITY;
    e->d.obstacle.motion = -1;
    make_cloths(e);
    e->d.def.cloths = e->cloth;
    e->d.def.n_cloths = ENSEMBLE_CLOTHS;
}

/* The slab goes to where it is now and a little further. */
static int lift(drape_world *world, double by)
{
    static double x[ENSEMBLE_NV][3];
    drape_read(world, x, NULL);
    for (int k = 0; k < ENSEMBLE_BOX; k++)
        x[ENSEMBLE_NC + k][1] += by;
    return drape_set_obstacle(world, 0, (const double(*)[3])x + ENSEMBLE_NC);
}

static int lead(drape_world *world, double by)
{
    static double x[ENSEMBLE_NV][3];
    const int32_t list[2] = {1, COUNT - 1};
    double to[2][3];
    drape_read(world, x, NULL);
    for (int k = 0; k < 6; k++)
        to[k / 3][k % 3] =
            x[ENSEMBLE_PRESCRIBED * COUNT + list[k / 3]][k % 3] + by * (k % 2);
    return drape_set_pins(world, ENSEMBLE_PRESCRIBED, 2, list,
                          (const double(*)[3])to);
}

static int thicken(drape_world *world, const struct ensemble *e, int cloth)
{
    drape_material m = e->cloth[cloth].material;
    m.density *= 1.5;
    m.stretch *= 0.75;
    m.friction = 0.05;
    m.thickness *= 1.25;
    return drape_set_material(world, cloth, &m);
}

int ensemble_call(drape_world *world, const struct ensemble *e, int k)
{
    double by = e->d.def.dt * 0.125;
    const drape_wind wind = {{0.5, 0, 0.25}, 1.2, 1, 0.3};
    switch (k) {
    case 3: /* the longest rest begins with the last call before MEETS */
    case 4:
    case MEETS + 8:
        return lift(world, by);
    case 6:
    case 8:
        return lead(world, by);
    case 9:
        return thicken(world, e, ENSEMBLE_SLIDES);
    case MEETS + 6:
        return thicken(world, e, ENSEMBLE_RESTS);
    case MEETS + 10:
        return drape_set_wind(world, &wind);
    default:
        return DRAPE_OK;
    }
}

bool ensemble_same(drape_step_report a, drape_step_report b)
{
    memset(a.seconds, 0, sizeof a.seconds);
    memset(b.seconds, 0, sizeof b.seconds);
    a.work.boxes = a.work.boxes_kept = b.work.boxes = b.work.boxes_kept = 0;
    return !memcmp(&a, &b, sizeof a);
}
