/* SPDX-License-Identifier: Apache-2.0 */
/* What a device has of a panel, and the stages of panels as a cloth's motion
 * calls them. spec/panel/panel.md */
#include "gpu/cloth/energy.cuh"
#include "gpu/panel/tension.cuh"

extern "C" {
#include "gpu/cloth/sheet.h"
#include "gpu/run/backend.h"
#include "ref/cloth/dynamics.h"
#include "ref/panel/call.h"
}

/* Streams of the panel h, and scratch, on the device. */
#define TAKE(name, count) GPU_TAKE_COPY(g, p->name, ARENA_CLOTH, h->name, count)
#define TAKE_SCRATCH(name, count)                                              \
    GPU_TAKE_COPY(g, p->name, ARENA_CLOTH, NULL, count)

struct panel *gpu_panel_make(struct gpu *g, const struct panel *h)
{
    struct panel *p =
        (struct panel *)arena_take(&g->host, ARENA_OTHER, 1, sizeof *p);
    if (!p) {
        g->failed = g->failed == DRAPE_OK ? (int)DRAPE_ENOMEM : g->failed;
        return NULL;
    }
    *p = *h;
    TAKE(corner, h->n_cells);
    TAKE(fibre, h->n_cells);
    TAKE(first, h->n_pairs);
    TAKE(way, h->n_pairs);
    TAKE(bend, h->n_pairs);
    TAKE(from, h->n_pairs);
    TAKE(part, h->n_parts);
    TAKE(push, h->n_parts);
    TAKE(tie, h->n_parts);
    TAKE(star, h->n_stars);
    TAKE_SCRATCH(pushes, CORNERS * h->n_cells);
    TAKE_SCRATCH(joins, CELL_PAIRS * h->n_cells);
    TAKE_SCRATCH(chunk, panel_chunks(h));
    return p;
}

int gpu_panel_wind(struct gpu *g, const struct dynamics *d, struct wind *s)
{
    panel_give_wind(d->cloth->panel, s);
    return gpu_wind(g, s);
}

int gpu_panel_pull(struct gpu *g, const struct dynamics *d,
                   const struct springs *f)
{
    struct pull s = panel_pull_of(d->cloth->panel, f);
    return gpu_pull(g, &s);
}

int gpu_panel_joins(struct gpu *g, const struct dynamics *d,
                    const struct blocks *b)
{
    struct joins s = panel_joins_of(d->cloth->panel, b);
    return gpu_joins(g, &s);
}

void gpu_panel_energy_into(struct gpu *g, const struct panel *p,
                           const struct energy *e, int64_t *word)
{
    struct tension s = panel_tension_of(p, e);
    gpu_tension_into(g, &s, word + 1, word + 3);
}
