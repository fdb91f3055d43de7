/* SPDX-License-Identifier: Apache-2.0 */
/* The inside of collision response on the device, as ref/contact/failsafe.h. */
#ifndef GPU_RESPONSE_CUH
#define GPU_RESPONSE_CUH

#include "gpu/world/world.h"
#include "ref/contact/failsafe.h"

/* Makes the n pools hold what they must, and more where they grow. No solve
 * comes between what is written to them and who reads it: they are borrowed.
 * DRAPE_OK or DRAPE_ENOMEM. */
int gpu_response_grow(struct gpu *g, int n, const struct room *room);

/* §1: ends of the step for those of n vertices whose mean velocity changed,
 * moved: NULL, all of them; stop: v is u there, too. Both are on the device. */
void gpu_response_advance(struct gpu *g, struct response *s, int64_t n,
                          const int32_t *vertex, const uint8_t *moved,
                          bool stop);

/* §3: fills hit with the pairs that touch, among those with a touched vertex;
 * touched: on the device, or NULL for every pair. */
int gpu_response_detect(struct gpu *g, struct response *s,
                        const uint8_t *touched);

/* §5: the vertices of all hits since impulses ended move in zones. */
int gpu_response_stiffen(struct gpu *g, struct response *s);

/* §6: the vertices of the hits go back; hits is how many did. */
int gpu_response_roll(struct gpu *g, struct response *s, int round);

#endif
