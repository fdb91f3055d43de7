/* SPDX-License-Identifier: Apache-2.0 */
/* Colours, light and random numbers of the pictures. */
#ifndef APP_RENDER_PAINT_H
#define APP_RENDER_PAINT_H

#include "app/base/vec.h"

#include <stdbool.h>
#include <stdint.h>

/* Light of the sky from direction d; the backdrop has the colour of the
 * horizon.
 */
vec sky(vec d);
/* Colour of cloth number k that is not told its own: outside or inside, linear.
 */
vec cloth_dye(int k, bool outside);
/* Brightness at uv, m at rest, of a woven check. */
float weave(const float uv[2]);
/* Linear light of a part of an sRGB colour, 0 … 1. */
float linear(double part);
/* Sample number k of a pixel: a point of the unit cube in six dimensions,
 * each in [0, 1). */
void randoms(uint32_t pixel, int k, float out[6]);
/* Light to a byte: a soft shoulder, then the sRGB curve. */
uint8_t develop(float light);

#endif
