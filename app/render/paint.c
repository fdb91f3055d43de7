/* SPDX-License-Identifier: Apache-2.0 */
/* Colours, light and random numbers of the pictures. */
#include "app/render/paint.h"

vec sky(vec d)
{
    vec horizon = make(0.40f, 0.41f, 0.43f), top = make(0.42f, 0.50f, 0.64f);
    return mix(horizon, top, clamp(d.y));
}

/* Outer and inner colour of each cloth, linear. */
static const float dyes[][2][3] = {
    {{.42f, .018f, .028f}, {.60f, .36f, .13f}},
    {{.020f, .12f, .34f}, {.55f, .56f, .60f}},
    {{.45f, .26f, .030f}, {.34f, .05f, .10f}},
    {{.020f, .24f, .13f}, {.62f, .58f, .42f}},
};
enum { DYES = sizeof dyes / sizeof dyes[0] };

/* Returns the brightness at uv of a woven check: squares of 4 cm, with thin
 * dark threads between them. */
float weave(const float uv[2])
{
    float a = uv[0] * 25, b = uv[1] * 25;
    bool checker = ((int)floorf(a) + (int)floorf(b)) & 1;
    float u = a - floorf(a), v = b - floorf(b);
    bool thread = u < 0.06f || v < 0.06f;
    return (checker ? 1.0f : 0.90f) * (thread ? 0.82f : 1.0f);
}

vec cloth_dye(int k, bool outside)
{
    return from(dyes[k % DYES][outside ? 0 : 1]);
}

float linear(double part)
{
    return (float)(part < 0.04045 ? part / 12.92
                                  : pow((part + 0.055) / 1.055, 2.4));
}

static uint32_t scramble(uint32_t a)
{
    a = (a ^ a >> 16) * 0x7feb352du;
    a = (a ^ a >> 15) * 0x846ca68bu;
    return a ^ a >> 16;
}

/* Random numbers: Roberts' sequence in six dimensions, shifted for each pixel.
 */
void randoms(uint32_t pixel, int k, float out[6])
{
    static const double step[6] = {0.8986538526, 0.8075787467, 0.7257337563,
                                   0.6521834357, 0.5860871504, 0.5266894846};
    for (uint32_t j = 0; j < 6; j++) {
        double shift = scramble(pixel * 6 + j) / 4294967296.0;
        double value = shift + (k + 1) * step[j];
        out[j] = (float)(value - floor(value)) * 0.999999f;
    }
}

uint8_t develop(float light)
{
    float a = light * 0.78f;
    a = a * (2.51f * a + 0.03f) / (a * (2.43f * a + 0.59f) + 0.14f);
    a = clamp(a);
    a = a < 0.0031308f ? 12.92f * a : 1.055f * powf(a, 1 / 2.4f) - 0.055f;
    return (uint8_t)(255 * a + 0.5f);
}
