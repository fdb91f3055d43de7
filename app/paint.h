/* SPDX-License-Identifier: Apache-2.0 */
/* Colours, light and random numbers of the pictures. */
#ifndef APP_PAINT_H
#define APP_PAINT_H

#include "app/vec.h"

#include <stdbool.h>
#include <stdint.h>

/* Light of the sky from direction d; the backdrop has the colour of the
 * horizon.
 */
vec sky(vec d);
/* Colour of cloth number `dye` at uv, m at rest, on its outer or inner
 * side: a woven check, linear. */
vec cloth_colour(int dye, const float uv[2], bool outside);
/* Sample number k of a pixel: a point of the unit cube in six dimensions,
 * each in [0, 1). */
void randoms(uint32_t pixel, int k, float out[6]);
/* Light to a byte: a soft shoulder, then the sRGB curve. */
uint8_t develop(float light);

#endif
