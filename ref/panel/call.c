/* SPDX-License-Identifier: Apache-2.0 */
/* The stages of a panel, called by a cloth's motion. spec/panel/panel.md §8 */
#include "ref/base/backend.h"
#include "ref/base/sum.h"
#include "ref/cloth/blocks.h"
#include "ref/cloth/dynamics.h"
#include "ref/cloth/energy.h"
#include "ref/cloth/springs.h"
#include "ref/panel/joins.h"
#include "ref/panel/pull.h"
#include "ref/panel/tension.h"

int ref_panel_pull(struct gpu *on, const struct dynamics *d,
                   const struct springs *f)
{
    const struct panel *a = d->cloth->panel;
    (void)on;
    struct pull s = {.count = f->count,
                     .m = f->m,
                     .laws = f->laws,
                     .law = f->law,
                     .pieces = f->pieces,
                     .piece = f->piece,
                     .n_cells = a->n_cells,
                     .corner = (const int32_t(*)[4])a->corner,
                     .fibre = (const struct fibre(*)[6])a->fibre,
                     .n_pairs = a->n_pairs,
                     .bend = a->bend,
                     .n_parts = a->n_parts,
                     .part = a->part,
                     .push = (const int32_t(*)[4])a->push,
                     .tie = (const int32_t(*)[16])a->tie,
                     .x = f->x,
                     .n_u = f->n_u,
                     .u = f->u,
                     .span = f->span,
                     .n_v = f->n_v,
                     .v = f->v,
                     .n_pushes = CORNERS * a->n_cells,
                     .pushes = a->pushes,
                     .force = f->force};
    return ref_pull(&s);
}

int ref_panel_joins(struct gpu *on, const struct dynamics *d,
                    const struct blocks *b)
{
    const struct panel *a = d->cloth->panel;
    (void)on;
    struct joins s = {.count = b->count,
                      .laws = b->laws,
                      .law = b->law,
                      .pieces = b->pieces,
                      .piece = b->piece,
                      .n_cells = a->n_cells,
                      .corner = (const int32_t(*)[4])a->corner,
                      .fibre = (const struct fibre(*)[6])a->fibre,
                      .n_pairs = a->n_pairs,
                      .first = a->first,
                      .way = a->way,
                      .bend = a->bend,
                      .from = (const int32_t(*)[2])a->from,
                      .x = b->x,
                      .n_q = b->n_q,
                      .q = b->q,
                      .tau = b->tau,
                      .n_join = CELL_PAIRS * a->n_cells,
                      .join = a->joins,
                      .n_blocks = SPRINGS * b->count,
                      .block = b->block};
    return ref_joins(&s);
}

real ref_panel_tension(struct gpu *on, const struct dynamics *d,
                       const struct energy *e)
{
    const struct panel *a = d->cloth->panel;
    (void)on;
    struct tension s = {.count = e->count,
                        .laws = e->laws,
                        .law = e->law,
                        .pieces = e->pieces,
                        .piece = e->piece,
                        .n_cells = a->n_cells,
                        .corner = (const int32_t(*)[4])a->corner,
                        .fibre = (const struct fibre(*)[6])a->fibre,
                        .n_stars = a->n_stars,
                        .star = a->star,
                        .x = e->x,
                        .n_chunks = sum_chunks(a->n_cells + a->n_stars),
                        .chunk = a->chunk};
    ref_tension(&s);
    return s.value;
}
