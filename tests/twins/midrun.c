/* SPDX-License-Identifier: Apache-2.0 */
/* A world whose settings and state are set in the middle of a run beside one
 * that was made with them. spec/control/control.md §1, §2, §4, §5 */
#include "ref/api/handle.h"
#include "ref/world/state.h"
#include "tests/twins/ensemble.h"
#include "tests/world/scene.h"

enum { NV = ENSEMBLE_NC + ENSEMBLE_BOX, BEFORE = 14, AFTER = 8 };

/* What is set: all that live control can. */
struct setting {
    drape_material material[ENSEMBLE_CLOTHS];
    drape_wind wind;
    double gravity[3], x[NV][3], v[NV][3];
    int32_t pin[2];
};

/* The thickest and the stiffest cloth become the thinnest and the softest, so
 * that what follows from all cloths shrinks, too. */
static void choose(const struct ensemble *e, struct setting *s)
{
    const double warp[][2] = {{0.001, 0.2}, {0.004, 3}, {0.02, 40}};
    for (int k = 0; k < ENSEMBLE_CLOTHS; k++) {
        s->material[k] = e->cloth[k].material;
        s->material[k].density *= 1 + 0.25 * k;
        s->material[k].stretch /= 1 + 0.5 * k;
        s->material[k].shear *= 0.5;
        s->material[k].bend *= 2;
        s->material[k].damping *= 2;
        s->material[k].thickness /= 1 + 0.25 * k;
        s->material[k].friction = 0.125 * k;
    }
    s->material[ENSEMBLE_SLIDES].thickness *= 1.5; /* it touches the slab */
    memcpy(s->material[ENSEMBLE_PRESCRIBED].table[DRAPE_WARP], warp,
           sizeof warp);
    s->wind = (drape_wind){{0.5, 0.25, 0}, 1.2, 1, 0.3};
    s->gravity[0] = 0.5;
    s->gravity[1] = -3;
    s->pin[0] = 2;
    s->pin[1] = ENSEMBLE_COUNT - 1;
}

/* Sets the run's own state and other numbers. */
static const char *set(drape_world *w, struct setting *s)
{
    const double(*x)[3] = (const double(*)[3])s->x;
    EXPECT(drape_set_pins(w, ENSEMBLE_PRESCRIBED, 2, s->pin, NULL) == DRAPE_OK);
    EXPECT(drape_step(w, NULL) == DRAPE_OK); /* what is pinned stops */
    EXPECT(drape_read(w, s->x, s->v) == DRAPE_OK);
    EXPECT(drape_set_gravity(w, s->gravity) == DRAPE_OK);
    EXPECT(drape_set_wind(w, &s->wind) == DRAPE_OK);
    for (int k = 0; k < ENSEMBLE_CLOTHS; k++)
        EXPECT(drape_set_material(w, k, &s->material[k]) == DRAPE_OK);
    EXPECT(drape_set_positions(w, 0, ENSEMBLE_NC, x, NULL) == DRAPE_OK);
    EXPECT(drape_set_velocities(w, 0, ENSEMBLE_NC, (const double(*)[3])s->v) ==
           DRAPE_OK);
    return NULL;
}

/* A world that is made so. */
static drape_world *make(struct ensemble *e, const struct setting *s,
                         drape_pin pin[2])
{
    for (int k = 0; k < ENSEMBLE_CLOTHS; k++) {
        e->cloth[k].material = s->material[k];
        e->cloth[k].x = (const double(*)[3])s->x + k * ENSEMBLE_COUNT;
        e->cloth[k].velocity = (const double(*)[3])s->v + k * ENSEMBLE_COUNT;
    }
    for (int k = 0; k < 2; k++)
        pin[k] = (drape_pin){s->pin[k] % ENSEMBLE_SIDE,
                             s->pin[k] / ENSEMBLE_SIDE, -1};
    e->cloth[ENSEMBLE_PRESCRIBED].pins = pin;
    e->d.obstacle.x = (const double(*)[3])s->x + ENSEMBLE_NC;
    e->d.def.wind = s->wind;
    memcpy(e->d.def.gravity, s->gravity, sizeof s->gravity);
    return slab_world(&e->d);
}

/* §1: what follows from all cloths is the same, though a bound that is too wide
 * or too stiff need not show in a state. */
static bool same_bounds(const drape_world *a, const drape_world *b)
{
    const struct world *p = a->world, *q = b->world;
    size_t bodies = (size_t)a->bodies, nv = (size_t)p->nv;
    return p->reach == q->reach && p->cell == q->cell && p->mass == q->mass &&
           p->response.stiffness == q->response.stiffness &&
           !memcmp(p->surface, q->surface, bodies * sizeof *p->surface) &&
           !memcmp(p->w, q->w, nv * sizeof *p->w);
}

static const char *check(int how, int64_t *contacts)
{
    static struct ensemble e;
    static struct setting s;
    drape_pin pin[2];
    drape_step_report p, q;
    ensemble_make(&e, how);
    e.cloth[ENSEMBLE_THROWN].material.thickness *= 1.75;
    choose(&e, &s);
    drape_world *a = slab_world(&e.d);
    EXPECT(a);
    for (int k = 0; k < BEFORE; k++) {
        EXPECT(ensemble_call(a, &e, k) == DRAPE_OK);
        EXPECT(drape_step(a, NULL) == DRAPE_OK);
    }
    const char *failed = set(a, &s);
    drape_world *b = make(&e, &s, pin);
    EXPECT(failed || (b && same_bounds(a, b)));
    for (int k = 0; k < AFTER && !failed; k++) {
        EXPECT(drape_step(a, &p) == DRAPE_OK && drape_step(b, &q) == DRAPE_OK);
        EXPECT(scene_hash(a) == scene_hash(b));
        EXPECT(p.step == q.step + BEFORE + 1 && p.outcome == q.outcome);
        EXPECT(p.kinetic == q.kinetic && p.elastic == q.elastic);
        EXPECT(p.potential == q.potential && p.residual == q.residual);
        EXPECT(p.iterations == q.iterations && p.slices == q.slices);
        EXPECT(p.contacts == q.contacts && p.impacts == q.impacts);
        *contacts += p.contacts;
        ran(1);
    }
    drape_destroy(a);
    drape_destroy(b);
    return failed;
}

const char *test_control_midrun(void)
{
    const char *failed = NULL;
    for (int how = 0; how < ENSEMBLE_HOWS && !failed; how++) {
        int64_t contacts = 0;
        failed = check(how, &contacts);
        EXPECT(failed || contacts > 0);
    }
    return failed;
}
