/* SPDX-License-Identifier: Apache-2.0 */
/* The wind of a world. spec/cloth/wind.md */
#ifndef REF_AIR_H
#define REF_AIR_H

#include "ref/world/state.h"

/* Takes the streams that stage wind writes, in the backend's memory, where they
 * have not been taken yet: a world without air has none of it. DRAPE_OK,
 * DRAPE_ENOMEM or DRAPE_EDEVICE. */
int air_take(struct world *w);
/* Sets the wind. Its streams have been taken, if it exerts a force or if the
 * definition's does. */
void air_set(struct world *w, const drape_wind *wind);

#endif
