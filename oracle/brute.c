/* SPDX-License-Identifier: Apache-2.0 */
/* Finds pairs of overlapping boxes by comparing all pairs. oracle/README.md */
#include "oracle/oracle.h"

#include <stdbool.h>

static bool meet(const double alo[3], const double ahi[3], const double blo[3],
                 const double bhi[3])
{
    for (int k = 0; k < 3; k++)
        if (!(alo[k] <= bhi[k] && blo[k] <= ahi[k]))
            return false;
    return true;
}

int64_t orc_box_pairs(int64_t na, const double (*alo)[3],
                      const double (*ahi)[3], int64_t nb,
                      const double (*blo)[3], const double (*bhi)[3],
                      int64_t cap, int32_t (*pair)[2])
{
    int64_t found = 0;
    bool self = alo == blo && ahi == bhi;
    for (int64_t i = 0; i < na; i++)
        for (int64_t j = self ? i + 1 : 0; j < nb; j++) {
            if (!meet(alo[i], ahi[i], blo[j], bhi[j]))
                continue;
            if (found < cap) {
                pair[found][0] = (int32_t)i;
                pair[found][1] = (int32_t)j;
            }
            found++;
        }
    return found;
}
