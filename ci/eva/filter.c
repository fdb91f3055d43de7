/* SPDX-License-Identifier: Apache-2.0 */
/* The filter of tier 1, of positions of any finite size. */
#include "ref/narrow/filter.c"
#include "eva/filter.h"
int main(void)
{
    double x[2][4][3];
    struct motion m;
    struct forms s;
    bool inside;
    any_motion_vf(x, &m);
    motion_vf(x, &m);
    int r = filter_signs(&m, &s, &inside);
    any_motion_ee(x, &m);
    motion_ee(x, &m);
    return r + filter_signs(&m, &s, &inside);
}
