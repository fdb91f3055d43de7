/* SPDX-License-Identifier: Apache-2.0 */
/* Choices of real numbers, adversarial by default. Compiled once for each
 * precision. */
#include "tests/base/choices.h"

/* 2^e by repeated doubling or halving: exact. */
static real power(int e)
{
    real r = 1;
    for (; e > 0; e--)
        r *= 2;
    for (; e < 0; e++)
        r *= R(0.5);
    return r;
}

real pick_uniform(struct bytes *b, real lo, real hi)
{
    return lo + (hi - lo) * ((real)(choose(b) >> 8) * R(0x1p-24));
}

static real pick_plain(struct bytes *b, real scale)
{
    int magnitude = (int)pick(b, 140) - 100;
    switch (pick(b, 8)) {
    case 0:
        return R(0.25) * ((int)pick(b, 9) - 4) * scale;
    case 1:
        return pick(b, 2) ? R(0.0) : -R(0.0);
    case 2:
        return (pick(b, 2) ? 1 : -1) * real_min(power(magnitude), scale);
    case 3:
        return pick(b, 2) ? real_up(0) : real_down(0);
    case 4:
        return pick(b, 2) ? real_up((real)b->last) : real_down((real)b->last);
    case 5:
        return (real)b->last;
    default:
        return pick_uniform(b, -scale, scale);
    }
}

real pick_real(struct bytes *b, real scale)
{
    real r = pick_plain(b, scale);
    r = real_max(real_min(r, scale), -scale);
    b->last = (double)r;
    return r;
}

vec pick_vec(struct bytes *b, real scale)
{
    vec r;
    r.x = pick_real(b, scale);
    r.y = pick_real(b, scale);
    r.z = pick_real(b, scale);
    return r;
}
