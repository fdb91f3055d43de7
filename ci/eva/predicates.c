/* SPDX-License-Identifier: Apache-2.0 */
/* The filters of the exact predicates; the integers behind them are any sign.
 */
#include "ref/narrow/predicates.c"
#include "eva/predicates.h"
int main(void)
{
    point a, b, c, d;
    int u, v;
    any_ref_orient3(a, b, c, d);
    bool left = ref_orient3(a, b, c, d) > 0;
    any_ref_orient2(a, b, c, &u, &v);
    return left && ref_orient2(a, b, c, u, v) > 0;
}
