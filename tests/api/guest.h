/* SPDX-License-Identifier: Apache-2.0 */
/* A small scene as a program that embeds drape would make it, with allocators
 * that count. */
#ifndef TESTS_GUEST_H
#define TESTS_GUEST_H

#include "tests/base/harness.h"

/* An allocator that counts, and gives nothing from call `most` on. */
struct purse {
    const drape_allocator *from; /* NULL: the host's */
    size_t held;
    int64_t calls, most;
};

/* A sheet falls a little on a plate that it overhangs. */
struct guest {
    drape_def def;
    drape_cloth cloth;
    drape_obstacle plate;
    struct purse host, device;
};

/* s is not to move while a world of it is there. */
void guest_make(struct guest *s, int backend);

/* DRAPE_OK, or what a step returned. */
int guest_go(drape_world *world, int steps);

#endif
