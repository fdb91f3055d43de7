/* SPDX-License-Identifier: Apache-2.0 */
/* A candidate: two primitives, named by four vertices, that may be in contact.
 * spec/broad/features.md */
#ifndef REF_PAIR_H
#define REF_PAIR_H

#include "ref/base/stage.h"

/* A vertex and a face, v f f f; or two edges, a a b b. */
enum contact_kind { CONTACT_VF, CONTACT_EE };

/* Whether all four indices are in 0 … nv - 1. */
static inline bool pair_valid(const int32_t v[4], int64_t nv)
{
    for (int k = 0; k < 4; k++)
        if (v[k] < 0 || v[k] >= nv)
            return false;
    return true;
}

#endif
