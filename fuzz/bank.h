/* SPDX-License-Identifier: Apache-2.0 */
/* Memory helpers of the fuzz targets: exact-size blocks, an allocator that
 * checks its callers, and byte buffers to which a world is saved and from which
 * it is loaded. */
#ifndef FUZZ_BANK_H
#define FUZZ_BANK_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "spec/drape.h"

/* Blocks of exactly the requested size, so that a sanitizer sees any access
 * beyond them. shelf_free frees all of them. */
struct shelf {
    void *p[64];
    int n;
};
void *shelf_take(struct shelf *s, size_t count, size_t size);
void shelf_free(struct shelf *s);

/* An allocator that fills memory with noise, counts, checks what is freed, and
 * fails `times` calls from call `from` on. */
struct bank {
    size_t held, most; /* bytes in use; most: the limit */
    int64_t calls, blocks, from, times;
    bool wrong; /* out: a block was freed with another size than it was
                   allocated with, or its header was overwritten */
};
void bank_open(struct bank *bank, size_t most);
drape_allocator bank_of(struct bank *bank);

/* A growing byte buffer for drape_write and drape_read_bytes. left: number of
 * calls until the buffer fails; negative: it never fails. */
struct tape {
    uint8_t *data;
    size_t size, room, at;
    int left;
};
int tape_write(void *user, const void *data, size_t bytes);
int tape_read(void *user, void *data, size_t bytes);
/* Empties the buffer and saves a checkpoint to it. Returns false if saving
 * failed. */
bool tape_save(struct tape *tape, const drape_world *world);
bool tape_same(const struct tape *a, const struct tape *b);

#endif
