/* SPDX-License-Identifier: Apache-2.0 */
/* Fuzzes drape_load with damaged checkpoints, most of them with a recomputed
 * checksum: they are refused and change nothing, or the world goes on. The
 * first byte selects the world; an input of one byte stands for that world's
 * own checkpoint. */
#include <stdlib.h>
#include <time.h>

#include "fuzz/damage.h"
#include "fuzz/small.h"

enum { HEAD = 168, PATIENCE = 30 };

/* Continues a world that accepted a checkpoint: whatever the checkpoint was,
 * each call must return a status. */
static const char *go_on(struct small *s, drape_world *world)
{
    double begun = (double)clock() / CLOCKS_PER_SEC;
    struct tape a = {.left = -1}, b = {.left = -1};
    bool saved = tape_save(&a, world);
    a.at = 0;
    bool loaded = drape_load(world, tape_read, &a) == DRAPE_OK;
    bool same = tape_save(&b, world) && tape_same(&a, &b);
    free(a.data);
    free(b.data);
    EXPECT(saved && loaded && same);
    for (int k = 0; k < 3; k++) {
        drape_step_report r;
        int status = drape_step(world, &r);
        EXPECT(status == DRAPE_OK && (r.outcome & ~OUTCOME_BITS) == 0);
    }
    EXPECT(small_audit(s, world) >= -1);
    EXPECT((double)clock() / CLOCKS_PER_SEC - begun < PATIENCE);
    return NULL;
}

static const char *load(struct small *s, drape_world *world,
                        const struct tape *own, struct tape *in)
{
    struct tape before = {.left = -1}, after = {.left = -1};
    bool good = tape_save(&before, world);
    int status = drape_load(world, tape_read, in);
    good = good && tape_save(&after, world);
    bool same = tape_same(&before, &after);
    bool mine = in->at == own->size && !memcmp(in->data, own->data, in->at);
    free(before.data);
    free(after.data);
    EXPECT(good);
    EXPECT(status == DRAPE_OK || status == DRAPE_EIO ||
           status == DRAPE_EMATCH || status == DRAPE_EDATA);
    EXPECT(status == DRAPE_OK ? true : same && !mine);
    return status == DRAPE_OK ? go_on(s, world) : NULL;
}

const char *fuzz_load(const char *name, const uint8_t *data, size_t size)
{
    static struct small s;
    struct tape own = {.left = -1}, in = {.left = -1};
    const char *failed = "the repair does not know the checkpoints' layout";
    (void)name;
    if (!size)
        return NULL;
    drape_world *world = damage_world(&s, data[0] % DAMAGE_WORLDS, &own);
    if (world) {
        tape_write(&in, size > 1 ? data + 1 : own.data,
                   size > 1 ? size - 1 : own.size);
        failed = load(&s, world, &own, &in);
        if (!failed && fuzz_kept && !damage_matches(in.data, in.size, own.data))
            failed = "the checkpoint is of another format or world";
    }
    drape_destroy(world);
    free(own.data);
    free(in.data);
    if (!failed && (s.host.held || s.host.wrong))
        failed = "memory was not given back as it was taken";
    return failed;
}

size_t load_mutate(uint8_t *data, size_t size, size_t most, uint64_t seed)
{
    static struct small s;
    struct bytes b = damage_choices(seed);
    if (size < 2 && most > 1) { /* begin with an undamaged checkpoint */
        struct tape own = {.left = -1};
        data[0] = (uint8_t)pick(&b, DAMAGE_WORLDS);
        drape_world *world = damage_world(&s, data[0], &own);
        size = 1;
        if (world && own.size < most) {
            memcpy(data + 1, own.data, own.size);
            size += own.size;
        }
        drape_destroy(world);
        free(own.data);
    }
    for (uint32_t k = 1 + pick(&b, 3); k && size > 1; k--)
        size = 1 + damage(&b, data + 1, size - 1, most - 1, HEAD);
    if (size > 1 && pick(&b, 8))
        damage_repair(data + 1, size - 1);
    choices_free(&b);
    return size ? size : 1;
}
