/* SPDX-License-Identifier: Apache-2.0 */
/* A world from which bodies were removed beside one that never had them.
 * spec/control/control.md §9 */
#include "tests/base/choices.h"
#include "tests/world/recall.h"
#include "tests/world/scene.h"
#include "tests/world/slab.h"

enum { M = 9, N = 8, COUNT = M * N, BOX = 8, NV = 2 * COUNT + 2 * BOX };
enum { EDIT = 12, END = 24, CASES = 10 };

/* A sheet with holes and cuts, prescribed by a corner, that slides on a slab.
 * The other world has two bodies before these: a cloth of which all particles
 * are pinned, so light that it has no part in the balance of a solve
 * (lagrange.md §3.4), and a slab with frames that moves by some thicknesses in
 * a step: what arrives there, or may, is nothing to the sheet (lagrange.md §2).
 */
struct scene {
    struct slab d;
    drape_cloth cloth[2];
    drape_obstacle obstacle[2];
    drape_pin pin[2], held[COUNT];
    uint8_t hole[COUNT], cut[(M - 1) * (N - 1)];
    double v[COUNT][3], frame[2][BOX][3];
};

static void make_sheet(struct scene *s, struct bytes *b)
{
    drape_cloth *c = &s->cloth[1];
    *c = s->d.cloth;
    c->m = M;
    c->n = N;
    c->width = (M - 1) / 64.0;
    c->height = (N - 1) / 64.0;
    c->bending = (int)pick(b, 2);
    c->material.friction = 0.25 * pick(b, 3);
    for (int k = 0; k < 3; k++)
        c->material.limit[k] = 0.05 * pick(b, 2);
    for (int p = 0; p < COUNT; p++) {
        s->hole[p] = p % M > 1 && !pick(b, 16);
        s->v[p][0] = 0.5;
        s->v[p][1] = -0.0625;
    }
    for (int k = 0; k < (M - 1) * (N - 1); k++)
        s->cut[k] = k > 1 && !pick(b, 6);
    s->hole[1] = s->hole[M] = s->hole[M + 1] = 0; /* the corner has a cell */
    s->cut[0] = 0;
    c->hole = s->hole;
    c->cut = s->cut;
    c->velocity = (const double(*)[3])s->v;
    s->pin[0] = (drape_pin){0, 0, 0};
    s->pin[1] = (drape_pin){1, 1, -1};
    c->pins = s->pin;
    c->n_pins = (int)pick(b, 3);
}

static void make_others(struct scene *s)
{
    drape_cloth *c = &s->cloth[0];
    *c = s->cloth[1];
    for (int p = 0; p < COUNT; p++)
        s->held[p] = (drape_pin){p % M, p / M, -1};
    c->pins = s->held;
    c->n_pins = COUNT;
    c->hole = c->cut = NULL;
    c->velocity = NULL;
    c->origin[0] = 8;
    c->material.density = 1e-12;
    c->material.thickness *= 1.25;
    s->obstacle[0] = s->obstacle[1] = s->d.obstacle;
    s->obstacle[1].motion = -1;
    s->obstacle[1].friction = 0.4;
    for (int k = 0; k < 2 * 3 * BOX; k++)
        s->frame[0][k / 3][k % 3] = s->d.obstacle.x[k / 3 % BOX][k % 3] +
                                    (k % 3 == 2 ? 16 + k / (3 * BOX) : 0);
    s->obstacle[0].x = (const double(*)[3])s->frame;
    s->obstacle[0].motion = -1;
    s->obstacle[0].frames = 2;
    s->obstacle[0].frame_dt = 1;
    s->obstacle[0].frame = (const double(*)[3])s->frame;
}

static void make(struct scene *s, int k)
{
    static const int method[] = {DRAPE_BW, DRAPE_CK, DRAPE_BDF2, DRAPE_VERLET};
    struct bytes b = {.seed = (uint64_t)k + 1, .size = -1};
    memset(s, 0, sizeof *s);
    slab_small(&s->d, method[k % 4], 0.104);
    s->d.def.response = k % 3 ? DRAPE_SOLVE : DRAPE_IMPULSES;
    make_sheet(s, &b);
    make_others(s);
    choices_free(&b);
}

/* The world with all bodies, or with the last of each kind. */
static drape_world *start(struct scene *s, bool all)
{
    s->d.def.cloths = s->cloth + !all;
    s->d.def.obstacles = s->obstacle + !all;
    s->d.def.n_cloths = s->d.def.n_obstacles = 1 + all;
    return slab_world(&s->d);
}

/* Changes what live control can of the bodies that stay. */
static int change(drape_world *w, const struct scene *s, bool all, int step)
{
    const double g[3] = {0.25, -9, 0}, at[3] = {0, 0x1p-10 * (step - 3), 0};
    const int32_t pin[2] = {M + 1, 0};
    drape_material m = s->cloth[1].material;
    m.stretch *= 0.75;
    m.friction += 0.125;
    int bad = drape_set_pose(w, all, at, NULL, NULL);
    if (step == 4)
        bad |= drape_set_gravity(w, g) | drape_set_material(w, all, &m);
    m = s->cloth[0].material;
    m.stretch *= 0.75; /* repulsion takes the stiffest of all */
    if (step == 4 && all)
        bad |= drape_set_material(w, 0, &m);
    if (step == 5)
        bad |= drape_set_pins(w, all, 2, pin, NULL);
    return bad;
}

/* Whether the sheet has the same state in both, be it the second cloth or the
 * first. */
static bool same_sheet(drape_world *more, drape_world *less)
{
    static double x[2][NV][3], v[2][NV][3];
    drape_read(more, x[0], v[0]);
    drape_read(less, x[1], v[1]);
    return !memcmp(x[0] + COUNT, x[1], COUNT * sizeof *x[0]) &&
           !memcmp(v[0] + COUNT, v[1], COUNT * sizeof *v[0]);
}

/* The others are removed before step EDIT; from then on both worlds are one. */
static const char *check(int k, int64_t *contacts)
{
    static struct scene s;
    static struct recall m, n;
    drape_step_report r, q;
    make(&s, k);
    drape_world *more = start(&s, true), *less = start(&s, false);
    EXPECT(more && less);
    for (int step = 0; step < END; step++) {
        if (step == EDIT) {
            EXPECT(drape_remove(more, 0) == DRAPE_OK);
            EXPECT(drape_remove(more, 1) == DRAPE_OK);
            drape_wake(less); /* as an edit does */
        }
        bool told = k % 2 && step > 3 && step < EDIT;
        EXPECT(!told || !change(more, &s, true, step));
        EXPECT(!told || !change(less, &s, false, step));
        EXPECT(drape_step(more, &r) == DRAPE_OK);
        EXPECT(drape_step(less, &q) == DRAPE_OK);
        EXPECT(r.contacts == q.contacts && r.outcome == q.outcome);
        EXPECT(step >= EDIT || same_sheet(more, less));
        EXPECT(step < EDIT ||
               (r.kinetic == q.kinetic && r.elastic == q.elastic));
        EXPECT(recall_save(more, &m) && recall_save(less, &n));
        EXPECT(step < EDIT || recall_same(&m, &n));
        *contacts += step > EDIT ? r.contacts : 0;
        ran(1);
    }
    drape_destroy(more);
    drape_destroy(less);
    return NULL;
}

const char *test_edited_beside(void)
{
    const char *failed = NULL;
    for (int k = 0; k < CASES && !failed; k++) {
        int64_t contacts = 0;
        failed = check(k, &contacts);
        EXPECT(failed || contacts > 0);
    }
    return failed;
}
