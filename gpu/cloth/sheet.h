/* SPDX-License-Identifier: Apache-2.0 */
/* What the device has of a cloth of a world. spec/gpu.md §6 */
#ifndef GPU_SHEET_H
#define GPU_SHEET_H

#include "gpu/run/gpu.h"
#include "ref/world/sheet.h"

struct rate;

/* What the device needs for a cloth in addition to its struct sheet. */
struct gpu_sheet {
    struct law *law;     /* device [SPRINGS] */
    struct piece *piece; /* device [PIECES] */
    real *triple;        /* device [TRIPLES] */
    struct rate *rate;   /* device; NULL: the solve does not use rates */
    vec *star, *b;       /* device [count], parts of the world's star and b */
};

#ifdef __cplusplus
extern "C" {
#endif

/* Returns a copy of a panel of the host, on the host, whose streams lie on the
 * device; or NULL: gpu_status says why. gpu/panel/panel.cu */
struct panel *gpu_panel_make(struct gpu *g, const struct panel *h);

#ifdef __cplusplus
}
#endif
#endif
