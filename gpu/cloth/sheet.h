/* SPDX-License-Identifier: Apache-2.0 */
/* What the device has of a cloth of a world. spec/gpu.md §6 */
#ifndef GPU_SHEET_H
#define GPU_SHEET_H

#include "ref/world/sheet.h"

struct rate;

/* What the device needs for a cloth in addition to its struct sheet. */
struct gpu_sheet {
    struct law *law;     /* device [SPRINGS] */
    struct piece *piece; /* device [PIECES] */
    real *triple;        /* device [TRIPLES] */
    struct rate *rate;   /* device; NULL: the solve does not use rates */
    struct panel *panel; /* host, its streams device; NULL: a rectangle */
    vec *star, *b;       /* device [count], parts of the world's star and b */
};

#endif
