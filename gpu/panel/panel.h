/* SPDX-License-Identifier: Apache-2.0 */
/* What a device has of a panel. spec/panel/panel.md */
#ifndef GPU_PANEL_H
#define GPU_PANEL_H

#include "gpu/run/gpu.h"
#include "ref/panel/lists.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Makes *p, which lies on the host, a copy of h with its streams on the device.
 * A lack of memory shows in gpu_status. */
void gpu_panel_make(struct gpu *g, const struct panel *h, struct panel *p);

#ifdef __cplusplus
}
#endif
#endif
