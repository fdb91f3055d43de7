/* SPDX-License-Identifier: Apache-2.0 */
/* Memory of exact size, an allocator that looks after itself, and bytes that a
 * world is saved to and loaded from. */
#ifndef FUZZ_BANK_H
#define FUZZ_BANK_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "spec/drape.h"

/* Memory of exactly that size, so that a sanitizer sees a read beyond it;
 * freed by shelf_free. */
struct shelf {
    void *p[64];
    int n;
};
void *shelf_take(struct shelf *s, size_t count, size_t size);
void shelf_free(struct shelf *s);

/* An allocator that gives memory full of noise, counts, checks what is given
 * back, and fails from call `from` on, `times` times. */
struct bank {
    size_t held, most; /* bytes; most: that it has */
    int64_t calls, blocks, from, times;
    bool wrong; /* out: something was given back that was not as taken */
};
void bank_open(struct bank *bank, size_t most);
drape_allocator bank_of(struct bank *bank);

/* Bytes that grow, as what a drape_write writes to and a drape_read_bytes
 * reads from. left: calls until it fails; negative: it never does. */
struct tape {
    uint8_t *data;
    size_t size, room, at;
    int left;
};
int tape_write(void *user, const void *data, size_t bytes);
int tape_read(void *user, void *data, size_t bytes);
/* A checkpoint into a tape emptied before; false where there is none. */
bool tape_save(struct tape *tape, const drape_world *world);
bool tape_same(const struct tape *a, const struct tape *b);

#endif
