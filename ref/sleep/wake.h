/* SPDX-License-Identifier: Apache-2.0 */
/* Loops of the reference for waking cloths; the device has the same in
 * gpu/sleep/wake.cu. spec/sleep/sleep.md */
#ifndef REF_WAKE_H
#define REF_WAKE_H

#include "ref/base/backend.h"
#include "ref/base/stage.h"

/* Pairs of candidates, and which bodies move in this slice. */
struct wake {
    int64_t n;
    const int32_t (*pair)[4]; /* [n] v[0] is of one body, v[3] of the other */
    const uint16_t *body;     /* [nv] */
    const uint8_t *active;    /* [bodies] 1: it moves */
    uint8_t *disturbed;       /* inout: [bodies] 1: it does not, and is in a
                            pair with one that does */
};

#endif
