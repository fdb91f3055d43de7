/* SPDX-License-Identifier: Apache-2.0 */
/* Makes the lists of a panel. spec/panel/panel.md */
#ifndef REF_PANEL_H
#define REF_PANEL_H

#include "ref/base/arena.h"
#include "ref/panel/lists.h"

/* Makes the panel of a cloth that ref_cloth_fill has filled, and corrects its
 * streams: beside, pairs, mass. hinged: as in struct star_grid. DRAPE_OK or
 * DRAPE_ENOMEM. */
int panel_make(const drape_cloth *def, struct cloth *c, const uint8_t *hinged,
               struct arena *arena);

/* Sets the masses of the cloth's particles that have odd cells, and the stars'
 * stiffness, to those of the material that the cloth has. density: kg/m². */
void panel_set_material(struct panel *a, const struct cloth *c, double density);

#endif
