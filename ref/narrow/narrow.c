/* SPDX-License-Identifier: Apache-2.0 */
/* Exact continuous collision detection of vertex-face and edge-edge pairs.
 * spec/narrow/narrow.md */
#include "ref/narrow/narrow.h"

#include "ref/base/stage.h"
#include "ref/narrow/exact.h"
#include "ref/narrow/split.h"

/* Widens positions to binary64, which is exact. */
static void widen_positions(const vec x0[4], const vec x1[4], double x[2][4][3])
{
    for (int j = 0; j < 4; j++) {
        x[0][j][0] = (double)x0[j].x;
        x[0][j][1] = (double)x0[j].y;
        x[0][j][2] = (double)x0[j].z;
        x[1][j][0] = (double)x1[j].x;
        x[1][j][1] = (double)x1[j].y;
        x[1][j][2] = (double)x1[j].z;
    }
}

/* Runs tier 3 (§6). §6.5 proves that EXACT_WORDS suffice; if they did not, the
 * result would be the lower bound `least`. */
static uint32_t decide_exactly(double x[2][4][3], int kind, uint32_t least)
{
    uint32_t word[EXACT_WORDS], toi;
    return exact_first(x, kind, word, EXACT_WORDS, &toi) < 0 ? least : toi;
}

/* Runs the tiers of §1 in turn until one of them decides. */
static uint32_t decide_pair(double x[2][4][3], int kind, int *tier)
{
    struct motion m;
    struct forms s;
    bool inside;
    uint32_t toi = 0;
    if (kind)
        motion_ee(x, &m);
    else
        motion_vf(x, &m);
    *tier = 1;
    if (filter_signs(&m, &s, &inside) == FILTER_MISS)
        return NARROW_MISS;
    *tier = 2;
    int end = inside ? split_interval(&m, &s, &toi) : FILTER_UNSURE;
    if (end != FILTER_UNSURE)
        return end == FILTER_HIT ? toi : NARROW_MISS;
    *tier = 3;
    return decide_exactly(x, kind, toi);
}

uint32_t narrow_vf(const vec x0[4], const vec x1[4], int *tier)
{
    double x[2][4][3];
    widen_positions(x0, x1, x);
    return decide_pair(x, 0, tier);
}

uint32_t narrow_ee(const vec x0[4], const vec x1[4], int *tier)
{
    double x[2][4][3];
    widen_positions(x0, x1, x);
    return decide_pair(x, 1, tier);
}

static bool is_finite(vec a)
{
    /* an infinity or NaN minus itself is NaN */
    return a.x - a.x == 0 && a.y - a.y == 0 && a.z - a.z == 0;
}

int ref_narrow(struct narrow *s)
{
    for (int64_t i = 0; i < s->nv; i++)
        if (!is_finite(s->x0[i]) || !is_finite(s->x1[i]))
            return DRAPE_EDATA;
    for (int64_t i = 0; i < 4 * s->n; i++)
        if (s->pair[i] < 0 || s->pair[i] >= s->nv || s->kind[i / 4] > 1)
            return DRAPE_EDATA;
    EACH_ITEM
    for (int64_t i = 0; i < s->n; i++) {
        vec a[4], b[4];
        int tier;
        for (int j = 0; j < 4; j++) {
            a[j] = s->x0[s->pair[4 * i + j]];
            b[j] = s->x1[s->pair[4 * i + j]];
        }
        s->toi[i] =
            s->kind[i] ? narrow_ee(a, b, &tier) : narrow_vf(a, b, &tier);
        s->tier[i] = (uint8_t)tier;
    }
    return DRAPE_OK;
}
