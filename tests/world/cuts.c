/* SPDX-License-Identifier: Apache-2.0 */
/* Which slices a step is cut into, and how long each tries. spec/world/step.md
 * §7.2, §7.3 */
#include "ref/world/slice.h"
#include "ref/world/state.h"
#include "tests/base/harness.h"

enum { TURNS = 200 }; /* more than the slices of a step, retries included */

/* Makes a step whose displacement needs 2^far slices. Returns how many slices
 * were too long, or TURNS if the step never ends. */
static int make_way(struct world *w, int far)
{
    int again = 0, turns = 0;
    slice_begin(w);
    while (!slice_last(w)) {
        if (turns++ == TURNS)
            return TURNS;
        real way = 4 * w->cell * (real)ldexp(1, far - w->slicing.level);
        again += slice_too_far(w, way * way);
        if (slice_too_far(w, way * way))
            slice_cut(w);
        else
            slice_keep(w);
    }
    return again;
}

/* §7.2: a step whose candidates move too far is cut as often as that needs,
 * once; one that moves little ends whole, and each begins anew. */
const char *test_world_way(void)
{
    struct world w = {.cell = 1, .dt = 1};
    w.def.max_slices = 32;
    w.def.dt = 1;
    EXPECT(make_way(&w, 0) == 0 && w.slicing.slices == 1);
    for (int far = 1; far <= 3; far++)
        for (int k = 0; k < 3; k++) {
            EXPECT(make_way(&w, far) == 1 && w.slicing.slices == 1 << far);
            EXPECT(make_way(&w, 0) == 0 && w.slicing.slices == 1);
            ran(1);
        }
    w.def.max_slices = 4; /* no more than that are made */
    EXPECT(make_way(&w, 5) == 1 && w.slicing.slices == 4);
    return NULL;
}

/* §7.3: a slice that the fail-safe ended is taken again, shorter, up to three
 * times a step. A whole step that can be taken again ends after 12 rounds, any
 * other slice after the rounds that are allowed. */
const char *test_world_rounds(void)
{
    struct world w = {.cell = 1, .dt = 1};
    w.def.max_slices = 32;
    w.def.max_rounds = 16;
    w.def.dt = 1;
    for (int k = 0; k < 2; k++) {
        slice_begin(&w);
        EXPECT(w.slicing.level == 0 && slice_rounds(&w) == 12);
        EXPECT(!slice_wrong(&w, 0));
        for (int level = 1; level <= 3; level++) {
            EXPECT(slice_wrong(&w, DRAPE_ZONES));
            EXPECT(w.slicing.level == level && slice_rounds(&w) == 16);
        }
        EXPECT(!slice_can_retry(&w) && !slice_wrong(&w, DRAPE_ZONES));
        for (int turns = 0; !slice_last(&w); turns++) {
            EXPECT(turns < TURNS);
            slice_keep(&w);
        }
        EXPECT(w.slicing.slices == 8);
        ran(1);
    }
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
