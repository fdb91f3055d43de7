/* SPDX-License-Identifier: Apache-2.0 */
/* The filters of the exact predicates; the integers behind them are any sign.
 */
#include "ref/narrow/predicates.c"
#include "__fc_builtin.h"
int main(void)
{
    double p[12];
    for (int k = 0; k < 12; k++)
        p[k] = Frama_C_double_interval(-0x1p60, 0x1p60);
    bool left = ref_orient3(p, p + 3, p + 6, p + 9) > 0;
    return left && ref_orient2(p, p + 3, p + 6, 0, 1) > 0;
}
