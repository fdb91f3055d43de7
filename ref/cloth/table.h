/* SPDX-License-Identifier: Apache-2.0 */
/* A material's tables of measured tensions, as the caller gives them: their
 * names, their points, and whether these are in range. spec/cloth/cloth.md §9
 */
#ifndef REF_TABLE_H
#define REF_TABLE_H

#include "spec/drape.h"

#define TABLE_STEP 1e-6                   /* between strains, at least */
#define TABLE_STRAIN 10                   /* at most */
#define TABLE_FORCE 1152921504606846976.0 /* 2^60 N/m, at most */

/* The key of a table in a scene; o: enum drape_table. */
static inline const char *table_name(int o)
{
    static const char *const names[DRAPE_TABLES] = {"warp", "weft", "bias"};
    return names[o];
}

/* The number of points of a table, 0 … DRAPE_POINTS; 0: none is given. */
static inline int table_points(const double table[DRAPE_POINTS][2])
{
    int n = 0;
    while (n < DRAPE_POINTS && table[n][0] != 0)
        n++;
    return n;
}

/* The first point of a table that is out of the range which drape.h gives, by
 * itself or beside the point before it; -1: none is. NaN is out of range. */
static inline int table_fault(const double table[DRAPE_POINTS][2])
{
    double strain = 0, force = 0;
    for (int k = 0; k < table_points(table); k++) {
        if (!(table[k][0] >= strain + TABLE_STEP &&
              table[k][0] <= TABLE_STRAIN && table[k][1] > 0 &&
              table[k][1] >= force && table[k][1] <= TABLE_FORCE))
            return k;
        strain = table[k][0];
        force = table[k][1];
    }
    return -1;
}

#endif
