/* SPDX-License-Identifier: Apache-2.0 */
/* Whether a triangle without area touches another, exactly.
 * spec/narrow/audit.md §5 */
#ifndef REF_SLIVER_H
#define REF_SLIVER_H

#include "ref/narrow/tritri.h"

/* True where t and s touch in what the simulation would have to part: a corner
 * of one that is none of the other's on the other; two edges, or an edge and
 * the other's inside, without a common vertex. Either may lie on one line or in
 * one point. */
bool ref_sliver(const struct face *t, const struct face *s);

#endif
