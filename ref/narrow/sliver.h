/* SPDX-License-Identifier: Apache-2.0 */
/* Decides exactly whether a degenerate triangle touches another triangle.
 * spec/narrow/audit.md §5 */
#ifndef REF_SLIVER_H
#define REF_SLIVER_H

#include "ref/narrow/tritri.h"

/* True where t and s have a contact that the simulation would have to
 * separate: a corner of one triangle on the other, two edges, or an edge and
 * the inside of a face, each without a common vertex. Either triangle may be
 * degenerate. */
bool ref_sliver(const struct face *t, const struct face *s);

#endif
