/* SPDX-License-Identifier: Apache-2.0 */
/* Closest points, their weights and normals. */
#include "ref/narrow/closest.c"
#include "eva/closest.h"
int main(void)
{
    struct wide x[4];
    struct closest r;
    real c[4];
    int kind;
    any_closest_normal(x, &kind);
    struct wide normal = closest_normal(x, kind);
    if (kind) {
        any_closest_ee(x, &r);
        closest_ee(x, &r);
    } else {
        any_closest_vf(x, &r);
        closest_vf(x, &r);
    }
    struct wide n = closest_unit(normal, r.p);
    any_closest_weights(&r, &kind, c);
    closest_weights(&r, kind, c);
    return n.x < 0;
}
