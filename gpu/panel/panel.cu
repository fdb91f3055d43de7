/* SPDX-License-Identifier: Apache-2.0 */
/* The stages of a panel on a device: there are none yet, and no definition with
 * a panel comes this far. spec/panel/panel.md §8 */
#include "gpu/run/backend.h"

int gpu_panel_pull(struct gpu *g, const struct dynamics *s,
                   const struct springs *f)
{
    (void)g;
    (void)s;
    (void)f;
    return DRAPE_EDEVICE;
}

int gpu_panel_joins(struct gpu *g, const struct dynamics *s,
                    const struct blocks *b)
{
    (void)g;
    (void)s;
    (void)b;
    return DRAPE_EDEVICE;
}

real gpu_panel_tension(struct gpu *g, const struct dynamics *s,
                       const struct energy *e)
{
    (void)g;
    (void)s;
    (void)e;
    return 0;
}
