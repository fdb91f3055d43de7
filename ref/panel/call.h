/* SPDX-License-Identifier: Apache-2.0 */
/* The stages of a panel, filled for either backend from the stage of the cloth
 * that each follows, and from the panel, whose streams lie in the memory of the
 * backend. spec/panel/panel.md §6 */
#ifndef REF_CALL_H
#define REF_CALL_H

#include "ref/base/sum.h"
#include "ref/cloth/blocks.h"
#include "ref/cloth/energy.h"
#include "ref/cloth/springs.h"
#include "ref/cloth/wind.h"
#include "ref/panel/joins.h"
#include "ref/panel/pull.h"
#include "ref/panel/tension.h"

/* Gives stage wind a panel's odd cells, whose loads lie in the scratch of stage
 * pull. */
void panel_give_wind(const struct panel *panel, struct wind *s);
/* NOLINTBEGIN(readability-inconsistent-declaration-parameter-name) */
struct pull panel_pull_of(const struct panel *panel, const struct springs *f);
struct joins panel_joins_of(const struct panel *panel, const struct blocks *b);
struct tension panel_tension_of(const struct panel *panel,
                                const struct energy *e);
/* NOLINTEND(readability-inconsistent-declaration-parameter-name) */

/* How many chunks the sum of a panel's energy has. */
static inline int64_t panel_chunks(const struct panel *panel)
{
    return sum_chunks(panel->n_cells + panel->n_stars);
}

#endif
