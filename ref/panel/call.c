/* SPDX-License-Identifier: Apache-2.0 */
/* The stages of a panel, called by a cloth's motion. spec/panel/panel.md §6 */
#include "ref/panel/call.h"

#include "ref/base/backend.h"
#include "ref/cloth/dynamics.h"
#include "ref/cloth/motion.h"

void panel_give_wind(const struct panel *panel, struct wind *s)
{
    s->n_cells = panel->n_cells;
    s->corner = (const int32_t(*)[4])panel->corner;
    s->n_parts = panel->n_parts;
    s->owner = panel->part;
    s->push = (const int32_t(*)[4])panel->push;
    s->load = (vec(*)[2])panel->pushes;
}

struct pull panel_pull_of(const struct panel *a, const struct springs *f)
{
    return (struct pull){.count = f->count,
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
}

struct joins panel_joins_of(const struct panel *a, const struct blocks *b)
{
    return (struct joins){.count = b->count,
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
}

struct tension panel_tension_of(const struct panel *a, const struct energy *e)
{
    return (struct tension){.count = e->count,
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
                            .n_chunks = panel_chunks(a),
                            .chunk = a->chunk};
}

int ref_panel_wind(struct gpu *on, const struct dynamics *d, struct wind *s)
{
    (void)on;
    panel_give_wind(d->cloth->panel, s);
    return ref_wind(s);
}

int ref_panel_pull(struct gpu *on, const struct dynamics *d,
                   const struct springs *f)
{
    struct pull s = panel_pull_of(d->cloth->panel, f);
    (void)on;
    return ref_pull(&s);
}

int ref_panel_joins(struct gpu *on, const struct dynamics *d,
                    const struct blocks *b)
{
    struct joins s = panel_joins_of(d->cloth->panel, b);
    (void)on;
    return ref_joins(&s);
}

real panel_energy(const struct panel *panel, const struct energy *e)
{
    struct tension s = panel_tension_of(panel, e);
    ref_tension(&s);
    return s.value;
}
