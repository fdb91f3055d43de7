/* SPDX-License-Identifier: Apache-2.0 */
/* The worlds whose checkpoints and logs are damaged. See fuzz/damage.h. */
#include "fuzz/damage.h"

/* Changes a world by live control, so that its checkpoint says so. */
static void change(const struct small *s, drape_world *world)
{
    static double x[1 << 9][3];
    const int32_t pin = 4; /* it may be missing: then no pin is set */
    drape_material m = s->cloth[0].material;
    m.friction += 0.25;
    drape_set_material(world, 0, &m);
    drape_set_pins(world, 0, 1, &pin, NULL);
    if (s->def.n_obstacles && drape_vertices(world) <= 1 << 9 &&
        drape_read(world, x, NULL) == DRAPE_OK)
        drape_set_obstacle(world, 0,
                           (const double(*)[3])x +
                               drape_first_vertex(world, s->def.n_cloths));
}

drape_world *damage_world(struct small *s, unsigned k, struct tape *tape)
{
    static uint64_t seed[DAMAGE_WORLDS]; /* 0: not searched yet */
    uint64_t end = 1000 * (k + 1), try = seed[k] ? seed[k] : end - 999;
    for (; try < end; try++) {
        struct bytes b = damage_choices(try);
        drape_world *world = NULL;
        small_make(s, &b);
        choices_free(&b);
        s->def.n_seams = 0; /* the corpora hold checkpoints of these worlds */
        if (drape_create(&s->def, &world, NULL) != DRAPE_OK)
            continue;
        for (unsigned step = 0; step < k; step++)
            drape_step(world, NULL);
        if (k % 4 == 3)
            change(s, world);
        bool good =
            tape_save(tape, world) && damage_repairs(tape->data, tape->size);
        if (good && (k < DAMAGE_PRESSED || damage_kept(tape->data) > 0)) {
            seed[k] = try;
            return world;
        }
        drape_destroy(world);
    }
    return NULL;
}
