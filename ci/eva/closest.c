/* SPDX-License-Identifier: Apache-2.0 */
/* Closest points, their weights and normals. */
#include "ref/narrow/closest.c"
#include "__fc_builtin.h"
int main(void)
{
    struct wide x[4];
    struct closest r;
    real c[4];
    for (int k = 0; k < 4; k++) {
        x[k].x = Frama_C_double_interval(-0x1p60, 0x1p60);
        x[k].y = Frama_C_double_interval(-0x1p60, 0x1p60);
        x[k].z = Frama_C_double_interval(-0x1p60, 0x1p60);
    }
    int kind = Frama_C_interval(0, 1);
    if (kind)
        closest_ee(x, &r);
    else
        closest_vf(x, &r);
    closest_weights(&r, kind, c);
    struct wide n = closest_unit(closest_normal(x, kind), r.p);
    return n.x < 0;
}
