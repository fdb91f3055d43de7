/* SPDX-License-Identifier: Apache-2.0 */
/* A small scene, made as a program that embeds drape would make it, with
 * allocators that count. */
#ifndef TESTS_GUEST_H
#define TESTS_GUEST_H

#include "tests/base/harness.h"

/* An allocator that counts, and fails from call `most` on. */
struct counting_allocator {
    const drape_allocator *from; /* NULL: the host's */
    size_t held;
    int64_t calls, most;
};

/* A sheet falls a short way onto a plate that is smaller than the sheet. */
struct guest {
    drape_def def;
    drape_cloth cloth;
    drape_obstacle plate;
    struct counting_allocator host, device;
};

/* Fills s. s must stay at its address while a world made of it exists. */
void guest_make(struct guest *s, int backend);

/* Makes `steps` steps. DRAPE_OK, or the status of the step that failed. */
int guest_go(drape_world *world, int steps);

#endif
