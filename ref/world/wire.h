/* SPDX-License-Identifier: Apache-2.0 */
/* Gives each stage that a scene needs its streams and settings. */
#ifndef REF_WIRE_H
#define REF_WIRE_H

#include "ref/world/state.h"

/* After the world's own streams are filled. DRAPE_OK or DRAPE_ENOMEM. */
int wire_stages(struct world *w, const drape_def *def);

#endif
