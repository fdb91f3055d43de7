/* SPDX-License-Identifier: Apache-2.0 */
/* Draws numbers from the fuzzer's choices. See fuzz/draw.h. */
#include "fuzz/draw.h"

#include <float.h>
#include <limits.h>
#include <math.h>
#include <string.h>

struct bytes draw_open(const uint8_t *data, size_t size,
                       uint32_t words[DRAW_WORDS])
{
    size_t n = size / sizeof *words < DRAW_WORDS ? size / sizeof *words
                                                 : (size_t)DRAW_WORDS;
    if (n)
        memcpy(words, data, n * sizeof *words);
    return (struct bytes){.data = words, .n_data = n, .size = -1};
}

double draw_in(struct bytes *b, double lo, double hi)
{
    return lo + (hi - lo) * ((double)choose(b) * 0x1p-32);
}

double draw_scale(struct bytes *b, int lo, int hi)
{
    double whole = ldexp(1, lo + (int)pick(b, (uint32_t)(hi - lo)));
    return pick(b, 4) ? whole * draw_in(b, 1, 2) : whole;
}

double draw_any(struct bytes *b)
{
    static const double some[] = {
        0,          1,           DBL_TRUE_MIN,    DBL_MIN,
        1e-300,     1e-30,       FLT_TRUE_MIN,    FLT_MIN,
        1e-9,       DBL_EPSILON, 1 + DBL_EPSILON, 1e3,
        1e6,        0x1p53,      0x1p60,          0x1.0000000000001p60,
        FLT_MAX,    1e300,       DBL_MAX,         (double)INFINITY,
        (double)NAN};
    enum { SOME = sizeof some / sizeof *some };
    uint32_t k = pick(b, SOME + 2);
    uint64_t bits = (uint64_t)choose(b) << 32;
    double value;
    if (k < SOME)
        return bits >> 63 ? -some[k] : some[k];
    if (k == SOME)
        return draw_in(b, -2, 2);
    bits |= choose(b);
    memcpy(&value, &bits, sizeof value);
    return value;
}

int draw_int(struct bytes *b)
{
    static const int some[] = {
        0,     1,     2,   3,   -1,   INT_MIN, 31,      32,     33,  63,  64,
        65,    255,   256, 257, 4095, 4096,    4097,    1e4,    1e5, 1e6, 32767,
        32768, 32769, -2,  1e9, -1e9, 1 << 20, 1 << 24, INT_MAX};
    enum { SOME = sizeof some / sizeof *some };
    uint32_t k = pick(b, SOME + 1);
    return k < SOME ? some[k] : (int)(choose(b) & INT_MAX);
}
