/* SPDX-License-Identifier: Apache-2.0 */
/* Scenes with one feature more or less. */
#ifndef BENCH_SKIP_H
#define BENCH_SKIP_H

#include "ci/bench/accuracy.h"

struct skip {
    drape_def def;
    drape_cloth cloth;
    struct solid ball;
    drape_motion motion;
    drape_pin pin[128];
    uint8_t hole[128 * 128];
};

/* One cloth, explicit, and nothing else. */
void skip_bare(struct skip *s);
/* Of a run's last positions. */
uint64_t skip_hash(const struct run *r);

/* Parts of part_skip, ci/bench/never.c. */
void skip_never(struct bench *b);
void skip_sleep(struct bench *b);

#endif
