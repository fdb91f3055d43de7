/* SPDX-License-Identifier: Apache-2.0 */
/* Tier 2, of forms within the range that the filter lets pass. */
#include "ref/narrow/split.c"
#include "__fc_builtin.h"
int main(void)
{
    struct motion m;
    struct forms s;
    uint32_t toi;
    m.count = Frama_C_interval(3, 4);
    for (int k = 0; k < 3; k++) {
        s.eq[k] = Frama_C_double_interval(0x1p-800, 0x1p200);
        s.eb[k] = Frama_C_double_interval(0x1p-800, 0x1p200);
        for (int j = 0; j < 4; j++) {
            for (int t = 0; t < 2; t++)
                m.box[j].at[t][k] = Frama_C_double_interval(-0x1p200, 0x1p200);
            for (int i = 0; i < 3; i++)
                s.q[j][k][i] = Frama_C_double_interval(-0x1p400, 0x1p400);
        }
    }
    s.ev = Frama_C_double_interval(0x1p-800, 0x1p700);
    for (int i = 0; i < 4; i++)
        s.v[i] = Frama_C_double_interval(-0x1p700, 0x1p700);
    return split_interval(&m, &s, &toi);
}
