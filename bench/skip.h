/* SPDX-License-Identifier: Apache-2.0 */
/* The bare scene, to which one feature is added, and the parts that use it. */
#ifndef BENCH_SKIP_H
#define BENCH_SKIP_H

#include "bench/accuracy.h"

struct skip {
    drape_def def;
    drape_cloth cloth;
    struct solid ball;
    drape_motion motion;
    drape_pin pin[128];
    uint8_t hole[128 * 128];
};

/* Makes the bare scene: one cloth, an explicit integrator, no collisions. */
void skip_bare(struct skip *s);
/* Returns a hash of a run's last positions. */
uint64_t skip_hash(const struct run *r);

#endif
