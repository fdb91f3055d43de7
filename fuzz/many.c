/* SPDX-License-Identifier: Apache-2.0 */
/* Fuzzes drape_step_many: worlds of one scene, stepped by one call, against one
 * that is stepped alone. */
#include <stdlib.h>

#include "fuzz/fuzz.h"
#include "fuzz/small.h"

enum { ALIKE = 3, STEPS = 2 };

/* Whether a world has the bits of a checkpoint. */
static bool has_bits(const struct tape *want, const drape_world *world)
{
    struct tape now = {0};
    bool same = tape_save(&now, world) && tape_same(want, &now);
    free(now.data);
    return same;
}

/* world [ALIKE + 1]; the last one is stepped alone. One thread works for all
 * others, as they share allocators that several threads must not call. */
static const char *compare(drape_world *const *world, int steps)
{
    int status[ALIKE];
    struct tape alone = {0};
    int last = DRAPE_OK;
    for (int k = 0; k < steps && last == DRAPE_OK; k++)
        last = drape_step(world[ALIKE], NULL);
    int first = drape_step_many(world, ALIKE, steps, 1, NULL, status);
    bool same = first == last && tape_save(&alone, world[ALIKE]);
    for (int k = 0; k < ALIKE; k++)
        same = same && status[k] == last && has_bits(&alone, world[k]);
    free(alone.data);
    return same ? NULL
                : "worlds that are stepped together differ from one alone";
}

const char *fuzz_many(const char *name, const uint8_t *data, size_t size)
{
    static uint32_t words[DRAW_WORDS];
    static struct small s;
    struct bytes b = draw_open(data, size, words);
    drape_world *world[ALIKE + 1] = {NULL};
    const char *failed = NULL;
    int made = 0;
    (void)name;
    small_make(&s, &b);
    s.def.backend = pick(&b, 4) ? DRAPE_GPU : DRAPE_REF;
    while (made <= ALIKE && !drape_create(&s.def, &world[made], NULL))
        made++;
    if (made > ALIKE)
        failed = compare(world, 1 + (int)pick(&b, STEPS));
    for (int k = 0; k <= ALIKE; k++)
        drape_destroy(world[k]);
    if (!failed && (s.host.held || s.device.held))
        failed = "memory was not given back as it was taken";
    choices_free(&b);
    return failed;
}
