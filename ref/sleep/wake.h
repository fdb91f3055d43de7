/* SPDX-License-Identifier: Apache-2.0 */
/* Loops of the reference for waking cloths; the device has the same in
 * gpu/sleep/wake.cu. spec/sleep/sleep.md */
#ifndef REF_WAKE_H
#define REF_WAKE_H

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
void wake_find(struct wake *s);
/* Sets mask[i] to awake[body[i]] for n vertices. */
void wake_mask(int64_t n, const uint16_t *body, const uint8_t *awake,
               uint8_t *mask);
/* Sets most [bodies] to the square of the largest displacement of each body
 * among the first n vertices, m²; 0 for a body that has none of them. */
void wake_displacements(int64_t n, const uint16_t *body, const vec *x0,
                        const vec *x1, int bodies, real *most);

#endif
