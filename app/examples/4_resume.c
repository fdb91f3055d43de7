/* SPDX-License-Identifier: Apache-2.0 */
/* 4 of 5. A run is saved, goes on, and is resumed from where it was saved. New
 * here: checkpoints, and several worlds that one call steps.
 *
 * Invariant: a world that was loaded goes on with the bits of the one that was
 * saved, with any number of threads, whatever the other has done meanwhile. */
#include <drape.h>
#include <stdio.h>
#include <string.h>

enum { SIDE = 31, COUNT = SIDE * SIDE, STEPS = 30 };

/* A checkpoint in memory. The caller's functions may as well use a file. */
struct buffer {
    char data[1 << 20];
    size_t end, at;
};

static int put(void *user, const void *data, size_t bytes)
{
    struct buffer *b = user;
    if (bytes > sizeof b->data - b->end)
        return 1; /* drape_save then returns DRAPE_EIO */
    memcpy(b->data + b->end, data, bytes);
    b->end += bytes;
    return 0;
}

static int get(void *user, void *data, size_t bytes)
{
    struct buffer *b = user;
    if (bytes > b->end - b->at)
        return 1;
    memcpy(data, b->data + b->at, bytes);
    b->at += bytes;
    return 0;
}

/* A sheet that swings from two corners, flat at the start. */
static drape_world *make(int threads)
{
    const drape_pin pins[] = {{0, 0, -1}, {SIDE - 1, 0, -1}};
    drape_cloth cloth;
    drape_default_cloth(&cloth);
    cloth.m = cloth.n = SIDE;
    cloth.pins = pins;
    cloth.n_pins = 2;
    drape_def def;
    drape_default(&def);
    def.threads = threads; /* changes no bit */
    def.cloths = &cloth;
    def.n_cloths = 1;
    drape_world *world;
    return drape_create(&def, &world, NULL) == DRAPE_OK ? world : NULL;
}

int main(void)
{
    static struct buffer saved;
    static double x[2][COUNT][3], early[COUNT][3];
    drape_world *world[2] = {make(1), make(2)};
    int bad = !world[0] || !world[1];
    for (int k = 0; k < STEPS && !bad; k++)
        bad = drape_step(world[0], NULL) != DRAPE_OK;
    /* The last call steps both worlds, side by side. */
    bad = bad || drape_save(world[0], put, &saved) != DRAPE_OK ||
          drape_load(world[1], get, &saved) != DRAPE_OK ||
          drape_read(world[1], early, NULL) != DRAPE_OK ||
          drape_step_many(world, 2, STEPS, 0, NULL, NULL) != DRAPE_OK ||
          drape_read(world[0], x[0], NULL) || drape_read(world[1], x[1], NULL);
    int differ = 0, moved = 0;
    for (int k = 0; k < COUNT; k++) {
        differ += memcmp(x[0][k], x[1][k], sizeof x[0][k]) != 0;
        moved += memcmp(x[0][k], early[k], sizeof x[0][k]) != 0;
    }
    printf("%d particles moved, %d differ\n", moved, differ);
    drape_destroy(world[0]);
    drape_destroy(world[1]);
    return bad;
}
