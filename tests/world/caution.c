/* SPDX-License-Identifier: Apache-2.0 */
/* Caution: a step begins with shorter slices after steps that had to be taken
 * again. spec/world/step.md §7.2, §7.3, §7.5 */
#include "ref/sleep/sleep.h"
#include "ref/world/checkpoint.h"
#include "ref/world/slice.h"
#include "ref/world/state.h"
#include "tests/base/choices.h"

enum { TURNS = 200 }; /* more than the slices of a step, retries included */

/* Makes a step whose slices longer than dt/2^calm multiply their energy by
 * `gain`. Returns how many slices were taken again, or TURNS if the step never
 * ends. */
static int make_step(struct world *w, int calm, double gain)
{
    const double before[3] = {1, 0, 0}, more[3] = {gain, 0, 0};
    int again = 0, turns = 0;
    slice_begin(w);
    while (!slice_last(w)) {
        if (turns++ == TURNS)
            return TURNS;
        bool gains = w->slicing.level < calm;
        if (slice_wrong(w, 0, before, gains ? more : before))
            again++;
        else
            slice_keep(w);
    }
    slice_end(w);
    return again;
}

/* §7.3, §7.5: a step that gains a tenth of its energy is kept; a step that
 * gains a fifth is halved once, and a step that doubles its energy until it
 * does not. After either, eight steps begin halved, and the next begins whole.
 * A cautious step that gains may be halved once more. */
const char *test_world_caution(void)
{
    static const struct {
        double gain;
        int again, slices;
    } row[] = {{1.1, 0, 1}, {1.2, 1, 2}, {2, 3, 8}};
    struct world w = {.plan = {.implicit = true}, .cell = 1, .dt = 1};
    w.def.max_slices = 32;
    w.def.dt = 1;
    EXPECT(make_step(&w, 3, 1.05) == 0);
    EXPECT(w.caution.level == 0 && w.slicing.slices == 1);
    for (int j = 0; j < 3; j++) {
        EXPECT(make_step(&w, 3, row[j].gain) == row[j].again);
        EXPECT(w.caution.level == 1 && w.slicing.slices == row[j].slices);
        for (int k = 0; k < 8; k++) {
            EXPECT(make_step(&w, 1, 2) == 0 && w.slicing.slices == 2);
            ran(1);
        }
        EXPECT(make_step(&w, 0, 2) == 0);
        EXPECT(w.caution.level == 0 && w.slicing.slices == 1);
    }
    w.caution = (struct caution){.level = 1, .again = 1, .calm = 7};
    EXPECT(make_step(&w, 3, 1.1) == 0 && w.slicing.slices == 2);
    EXPECT(w.caution.level == 1 && w.caution.calm == 0);
    EXPECT(make_step(&w, 3, 1.2) == 1 && w.slicing.slices == 4);
    EXPECT(w.caution.level == 1);
    w.def.max_slices = 1; /* caution never exceeds max_slices */
    EXPECT(make_step(&w, 1, 2) == 0 && w.slicing.slices == 1);
    return NULL;
}

/* Makes a step whose displacement needs 2^far slices. Returns how many slices
 * were too long, or TURNS if the step never ends. */
static int make_way(struct world *w, int far)
{
    int again = 0, turns = 0;
    slice_begin(w);
    while (!slice_last(w)) {
        if (turns++ == TURNS)
            return TURNS;
        real way = 16 * w->cell * (real)ldexp(1, far - w->slicing.level);
        again += slice_too_far(w, way * way);
        if (slice_too_far(w, way * way))
            slice_cut(w);
        else
            slice_keep(w);
    }
    slice_end(w);
    return again;
}

/* §7.2: after a step that moved too far, the next eight steps begin with slices
 * that are short enough; a step that moves little ends whole. */
const char *test_world_way(void)
{
    struct world w = {.plan = {.implicit = true}, .cell = 1, .dt = 1};
    w.def.max_slices = 32;
    w.def.dt = 1;
    for (int far = 1; far <= 3; far++) {
        for (int k = 0; k <= 9; k++) {
            EXPECT(make_way(&w, far) == (k % 9 == 0));
            EXPECT(w.slicing.slices == 1 << far);
            ran(1);
        }
        EXPECT(make_way(&w, 0) == 0 && w.slicing.slices == far + 1);
        EXPECT(make_way(&w, 0) == 0 && w.slicing.slices == 1);
    }
    return NULL;
}

/* Whether a slice may move its candidates by so many cells of 1 m. */
static bool may_move(struct world *w, real cells)
{
    slice_begin(w);
    return !slice_too_far(w, cells * cells);
}

/* §7.2: candidates may move by 16 cells where gains of energy are an error, and
 * by 8 where nobody can see them: while bodies are led, or with wind. A slice
 * that moved by more than 8 cells is taken again for a gain for which one that
 * moved by less is kept; then 8 cells are the limit until the step ends. */
const char *test_world_strict(void)
{
    struct world w = {.plan = {.implicit = true}, .cell = 1, .dt = 1};
    const double before[3] = {1, 0, 0}, after[3] = {1.1, 0, 0};
    w.def.max_slices = 32;
    w.def.dt = 1;
    EXPECT(may_move(&w, 15) && !may_move(&w, 17));
    EXPECT(may_move(&w, 7) && !slice_wrong(&w, 0, before, after));
    EXPECT(!w.slicing.strict);
    EXPECT(may_move(&w, 9) && !slice_wrong(&w, 0, before, before));
    EXPECT(may_move(&w, 9) && slice_wrong(&w, 0, before, after));
    EXPECT(w.slicing.level == 1 && slice_too_far(&w, 9 * 9));
    EXPECT(!slice_too_far(&w, 7 * 7) && may_move(&w, 15));
    w.leads = true;
    EXPECT(may_move(&w, 7) && !may_move(&w, 9));
    w.leads = false;
    w.plan.wind = true;
    EXPECT(may_move(&w, 7) && !may_move(&w, 9));
    w.plan.led = true; /* of which nothing moves in this slice */
    w.plan.wind = false;
    EXPECT(may_move(&w, 15) && !may_move(&w, 17));
    w.plan = (struct plan){0};
    EXPECT(may_move(&w, 3) && !may_move(&w, 5));
    ran(1);
    return NULL;
}

/* §7.3, §7.5: slices that the fail-safe ended count for caution too. A whole
 * step that can be taken again ends after 12 rounds, any other slice after the
 * rounds that are allowed. */
const char *test_world_rounds(void)
{
    const double energy[3] = {1, 0, 0};
    struct world w = {.plan = {.implicit = true}, .cell = 1, .dt = 1};
    w.def.max_slices = 32;
    w.def.max_rounds = 16;
    w.def.dt = 1;
    for (int k = 0; k < 2; k++) {
        slice_begin(&w);
        EXPECT(w.slicing.level == 0 && slice_rounds(&w) == 12);
        EXPECT(slice_wrong(&w, DRAPE_ZONES, energy, energy));
        EXPECT(w.slicing.level == 1 && slice_rounds(&w) == 16);
        for (int turns = 0; !slice_last(&w); turns++) {
            EXPECT(turns < TURNS);
            slice_keep(&w);
        }
        slice_end(&w);
        ran(1);
    }
    slice_begin(&w);
    EXPECT(w.slicing.level == 1);
    w.caution.level = 0;
    slice_begin(&w);
    w.def.max_rounds = 5;
    EXPECT(slice_rounds(&w) == 5);
    w.def.max_rounds = 16;
    w.def.max_slices = 1; /* the step cannot be cut, so zones are used */
    slice_begin(&w);
    EXPECT(!slice_can_retry(&w) && slice_rounds(&w) == 16);
    struct response c = {.iterations = 16}; /* response.md §4 */
    for (; c.rounds < 16; c.rounds++)
        EXPECT(response_iterations(&c) ==
               (c.rounds < 3 ? 16 : 16 * (c.rounds - 1)));
    return NULL;
}

struct tape {
    uint8_t data[1024];
    size_t size, at;
};

static int record(void *user, const void *data, size_t bytes)
{
    struct tape *t = user;
    if (bytes > sizeof t->data - t->size)
        return 1;
    if (bytes)
        memcpy(t->data + t->size, data, bytes);
    t->size += bytes;
    return 0;
}

static int play(void *user, void *data, size_t bytes)
{
    struct tape *t = user;
    if (bytes > t->size - t->at)
        return 1;
    if (bytes)
        memcpy(data, t->data + t->at, bytes);
    t->at += bytes;
    return 0;
}

/* A checkpoint keeps the whole state of caution. */
const char *test_world_knows(void)
{
    const struct caution all = {1, 1, 5, 3, 7};
    vec x[2] = {{0, 0, 0}}, v[2] = {{0, 0, 0}};
    struct arena arena;
    struct tape tape = {.size = 0};
    arena_init(&arena, &(drape_allocator){0});
    struct sleep sleep[2] = {{0}};
    struct world a = {
        .caution = all, .nv = 1, .x0 = x, .v0 = v, .sleep = &sleep[0]};
    struct world b = {
        .arena = &arena, .nv = 1, .x0 = x + 1, .v0 = v + 1, .sleep = &sleep[1]};
    b.def.max_slices = 8; /* caution has levels up to 3 */
    EXPECT(checkpoint_save(&a, record, &tape) == DRAPE_OK);
    EXPECT(checkpoint_load(&b, play, &tape) == DRAPE_OK);
    EXPECT(memcmp(&b.caution, &all, sizeof all) == 0);
    ran(1);
    return NULL;
}

/* §7.3: whether a whole slice that ends with `more` energy of kind k than
 * `before` is taken again. */
static bool again(struct world *w, int k, double before, double more)
{
    double start[3] = {0}, end[3] = {0};
    start[k] = before;
    end[k] = before + more;
    w->caution = (struct caution){0};
    slice_begin(w);
    return slice_wrong(w, 0, start, end);
}

const char *test_world_wrong(void)
{
    struct world w = {.plan = {.implicit = true}, .cell = 1, .dt = 1};
    w.def.max_slices = 32;
    w.def.dt = 1;
    for (int k = 0; k < 2; k++) { /* limit: 1/8 of the energy at the end */
        EXPECT(!again(&w, k, 7, 0.999) && again(&w, k, 7, 1.001));
        w.leads = true;
        EXPECT(!again(&w, k, 7, 5));
        w.leads = false;
        w.plan.wind = true;
        EXPECT(!again(&w, k, 7, 5));
        w.plan.wind = w.plan.implicit = false;
        EXPECT(!again(&w, k, 7, 5));
        w.plan.implicit = true;
    }
    EXPECT(!again(&w, 2, 32767, 0.999) && again(&w, 2, 32767, 1.001));
    EXPECT(!again(&w, 2, -32769, 0.999) && again(&w, 2, -32769, 1.001));
    w.mass = 3; /* repulsion: 2 m (g d + (d / dt)² / 2), d = 0.1 reach */
    w.reach = 10;
    w.def.gravity[0] = 3;
    w.def.gravity[2] = 4;
    w.dt = 0.5;
    EXPECT(!again(&w, 2, -1, 41.9) && again(&w, 2, -1, 42.1));
    ran(13);
    return NULL;
}
