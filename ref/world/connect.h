/* SPDX-License-Identifier: Apache-2.0 */
/* Connects the stages that a scene uses to its streams and settings. */
#ifndef REF_CONNECT_H
#define REF_CONNECT_H

#include "ref/world/state.h"

/* Sets up the stages of cloth, broad phase and response. The world's own
 * streams must have been filled. DRAPE_OK or an error. */
int connect_stages(struct world *w, const drape_def *def);

#endif
