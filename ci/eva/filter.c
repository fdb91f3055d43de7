/* SPDX-License-Identifier: Apache-2.0 */
/* The filter of tier 1, of positions of any finite size. */
#include "ref/narrow/filter.c"
#include "__fc_builtin.h"
static void any(double *a, int n, double most)
{
    for (int k = 0; k < n; k++)
        a[k] = Frama_C_double_interval(-most, most);
}
int main(void)
{
    double x[2][4][3];
    struct motion m;
    struct forms s;
    bool inside;
    any(&x[0][0][0], 24, 0x1p1023);
    motion_vf(x, &m);
    int r = filter_signs(&m, &s, &inside);
    motion_ee(x, &m);
    return r + filter_signs(&m, &s, &inside);
}
