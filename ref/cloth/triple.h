/* SPDX-License-Identifier: Apache-2.0 */
/* Bending by triples: three particles in a row resist the second difference of
 * their positions. spec/cloth/cloth.md §7 */
#ifndef REF_TRIPLE_H
#define REF_TRIPLE_H

#include "ref/cloth/cloth.h"

/* §7: whether the cells about a particle let a triple of direction o have its
 * middle there. */
static inline bool has_triple(int o, unsigned cells)
{
    static const unsigned ahead[] = {1 + 4, 1 + 2, 1, 2};
    static const unsigned behind[] = {2 + 8, 4 + 8, 8, 4};
    return !(cells & BESIDE_STARS) && (cells & ahead[o]) && (cells & behind[o]);
}

/* §7: the share of a single spring's constant that belongs to the cells beside
 * it: all of it, or half of it on a border. cells: about its first particle. */
static inline real spring_fraction(int o, unsigned cells)
{
    unsigned both = o == 0 ? 1 + 4 : 1 + 2;
    return o > 1 || (cells & both) == both ? 1 : R(0.5);
}

/* §7: t = x₋ - 2x + x₊ by differences, as neighbours are close. */
static inline vec triple_of(vec before, vec middle, vec after)
{
    return vec_add(vec_sub(before, middle), vec_sub(after, middle));
}

/* The constant, N/m, of the triple of direction o with the given cells about
 * its middle; 0 if there is none. */
static inline real triple_constant(const real *triple, int o, unsigned cells)
{
    return triple[CELL_MASKS * o + (int)cells];
}

#endif
