/* SPDX-License-Identifier: Apache-2.0 */
/* Fills a world from a checked definition: first the sizes, then the streams,
 * then their contents. */
#include "ref/world/fill.h"

#include <stdarg.h>
#include <stdio.h>

#include "ref/cloth/table.h"
#include "ref/panel/panel.h"
#include "ref/seam/hinge.h"
#include "ref/seam/seam.h"
#include "ref/world/prescribe.h"

static void *take_stream(struct world *w, enum arena_part part, int64_t n,
                         size_t size)
{
    return arena_take(w->arena, part, n, size);
}

static int write_error(drape_error *error, int status, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    if (error)
        vsnprintf(error->text, sizeof error->text, format, args);
    va_end(args);
    return status;
}

/* Says why cloth k cannot have its material. DRAPE_EARG. */
static int say_misfit(const drape_cloth *def, int k, const struct misfit *why,
                      drape_error *error)
{
    const drape_material *m = &def->material;
    if (why->kind == MISFIT_OBLONG)
        return write_error(
            error, DRAPE_EARG,
            "cloth %d: cells of %.4g by %.4g m are too oblong: expected "
            "a ratio of sides below sqrt(stretch / shear) = %.4g",
            k, def->width / (def->m - 1), def->height / (def->n - 1),
            sqrt(m->stretch / m->shear));
    if (why->kind == MISFIT_UNSETTLED)
        return write_error(
            error, DRAPE_EARG,
            "cloth %d: material.stretch: no laws of springs were found "
            "that give these tables",
            k);
    const char *name = table_name(why->table);
    if (why->kind == MISFIT_BENDING)
        return write_error(
            error, DRAPE_EARG,
            "cloth %d: material.stretch.%s: a table needs bending by "
            "triples",
            k, name);
    const double *at = m->table[why->table][why->point];
    double least = 1.001 * why->least; /* not below it when rounded */
    return write_error(
        error, DRAPE_EARG,
        "cloth %d: material.stretch.%s[%d]: %.4g N/m at strain %.4g is too "
        "little beside the other directions: expected at least %.4g",
        k, name, why->point, at[1], at[0], least);
}

/* Sets the sizes of a cloth. DRAPE_EARG and a text if no laws of springs fit
 * its material, or no cell of it is left. */
static int size_cloth(const drape_cloth *def, int k, struct cloth *cloth,
                      drape_error *error)
{
    if (ref_cloth_size(def, cloth) != DRAPE_OK)
        return say_misfit(def, k, &cloth->misfit, error);
    if (cloth->n_triangles == 0)
        return write_error(error, DRAPE_EARG, "cloth %d: %s", k,
                           def->panel ? "its panel has no cell"
                                      : "holes and cuts leave no cell of it");
    return DRAPE_OK;
}

int fill_sizes(struct world *w, const drape_def *def, drape_error *error)
{
    for (int k = 0; k < def->n_cloths; k++) {
        struct sheet *s = &w->sheet[k];
        int status = size_cloth(&def->cloths[k], k, &s->cloth, error);
        if (status != DRAPE_OK)
            return status;
        s->first = w->nv;
        s->first_triangle = w->nt;
        s->pins.n = def->cloths[k].n_pins;
        w->nv += s->cloth.count;
        w->nt += s->cloth.n_triangles;
    }
    w->nc = w->nv;
    w->ntc = w->nt;
    for (int k = 0; k < def->n_obstacles; k++) {
        struct prop *p = &w->prop[k];
        p->first = w->nv;
        p->first_triangle = w->nt;
        p->place.n = def->obstacles[k].n_vertices;
        w->nv += def->obstacles[k].n_vertices;
        w->nt += def->obstacles[k].n_triangles;
    }
    sew_size(w, def);
    return DRAPE_OK;
}

void fill_motions(struct world *w, const drape_def *def)
{
    drape_motion *motion =
        take_stream(w, ARENA_OTHER, def->n_motions, sizeof *motion);
    w->pose = take_stream(w, ARENA_OTHER, def->n_motions, sizeof *w->pose);
    for (int k = 0; k < def->n_motions && motion; k++) {
        const drape_motion *m = &def->motions[k];
        size_t n = (size_t)m->keys;
        double *time = take_stream(w, ARENA_OTHER, m->keys, sizeof *time);
        double(*p)[3] = take_stream(w, ARENA_OTHER, m->keys, sizeof *p);
        double(*q)[4] = take_stream(w, ARENA_OTHER, m->keys, sizeof *q);
        if (!time || !p || !q)
            return;
        memcpy(time, m->time, n * sizeof *time);
        memcpy(p, m->position, n * sizeof *p);
        if (m->rotation)
            memcpy(q, m->rotation, n * sizeof *q);
        motion[k] = *m;
        motion[k].time = time;
        motion[k].position = (const double(*)[3])p;
        motion[k].rotation = m->rotation ? (const double(*)[4])q : NULL;
    }
    w->def.motions = motion;
}

/* Names the first pin whose particle is missing. Returns DRAPE_EARG. */
static int say_pin(const drape_cloth *def, const struct cloth *c, int k,
                   drape_error *error)
{
    int p = 0;
    while (c->fixed[def->pins[p].i + (int64_t)def->m * def->pins[p].j] !=
           CLOTH_ABSENT)
        p++;
    return write_error(
        error, DRAPE_EARG,
        "cloth %d: pin %d: particle (%d, %d) is missing: it is a hole, "
        "or no cell is left around it",
        k, p, def->pins[p].i, def->pins[p].j);
}

/* Copies the definition of a panel for one of the world's own (control.md
 * §9.1). */
static int keep_panel(struct world *w, const drape_cloth *d, struct sheet *s)
{
    const drape_panel *from = d->panel;
    int64_t n = (int64_t)d->m * d->n, cells = (int64_t)(d->m - 1) * (d->n - 1);
    drape_panel *to = take_stream(w, ARENA_OTHER, 1, sizeof *to);
    double(*rest)[2] = take_stream(w, ARENA_OTHER, n, sizeof *rest);
    uint8_t *cell = take_stream(w, ARENA_OTHER, cells, 1);
    drape_ease *ease = take_stream(w, ARENA_OTHER, from->n_eases, sizeof *ease);
    if (w->arena->failed)
        return DRAPE_ENOMEM;
    memcpy(rest, from->rest, (size_t)n * sizeof *rest);
    memcpy(cell, from->cell, (size_t)cells);
    if (from->n_eases > 0)
        memcpy(ease, from->eases, (size_t)from->n_eases * sizeof *ease);
    *to = (drape_panel){.rest = (const double(*)[2])rest,
                        .cell = cell,
                        .eases = from->n_eases > 0 ? ease : NULL,
                        .n_eases = from->n_eases};
    s->made.panel = to;
    return DRAPE_OK;
}

/* Makes the panel of cloth k, if it is one. DRAPE_OK or DRAPE_ENOMEM. */
static int fill_panel(struct world *w, const drape_def *def, int k)
{
    struct cloth *c = &w->sheet[k].cloth;
    if (!def->cloths[k].panel)
        return DRAPE_OK;
    uint8_t *hinged = take_stream(w, ARENA_OTHER, c->count, 1);
    if (!hinged)
        return DRAPE_ENOMEM;
    hinge_mark(def, k, hinged);
    int status = panel_make(&def->cloths[k], c, hinged, w->arena);
    arena_give(w->arena, hinged);
    return status == DRAPE_OK ? keep_panel(w, &def->cloths[k], &w->sheet[k])
                              : status;
}

static int fill_cloth(struct world *w, const drape_def *all, int k,
                      drape_error *error)
{
    const drape_cloth *def = &all->cloths[k];
    struct sheet *s = &w->sheet[k];
    struct cloth *c = &s->cloth;
    c->cell = take_stream(w, ARENA_CLOTH, c->count, 1);
    c->springs = take_stream(w, ARENA_CLOTH, c->count, 1);
    c->beside = take_stream(w, ARENA_CLOTH, c->count, 1);
    c->fixed = take_stream(w, ARENA_CLOTH, c->count, 1);
    c->mass = take_stream(w, ARENA_CLOTH, c->count, sizeof *c->mass);
    c->tri = w->tri + s->first_triangle;
    if (w->arena->failed)
        return DRAPE_ENOMEM;
    if (ref_cloth_fill(def, c, s->first) != DRAPE_OK)
        return say_pin(def, c, k, error);
    if (fill_panel(w, all, k) != DRAPE_OK)
        return DRAPE_ENOMEM;
    if (ref_cloth_start(def, w->x0 + s->first, w->v0 + s->first) != DRAPE_OK)
        return write_error(error, DRAPE_EDATA,
                           "cloth %d: its flat start leaves |x| up to 2^60", k);
    for (int64_t p = 0; p < c->count; p++) {
        w->w[s->first + p] = c->fixed[p] ? 0 : 1 / c->mass[p];
        w->to[s->first + p] = w->x0[s->first + p];
        w->mass += (double)c->mass[p];
        w->body[s->first + p] = (uint16_t)k;
        if (c->fixed[p])
            w->v0[s->first + p] = vec_make(0, 0, 0);
    }
    struct tree_mesh mesh = {.first_tri = (int32_t)s->first_triangle,
                             .tris = (int32_t)c->n_triangles};
    struct tree_scene scene = {.tri = (const int32_t(*)[3])w->tri, .x = w->x0};
    s->size = tree_size(&scene, &mesh);
    /* With more than half a cell, neighbours at rest would be in contact. */
    real most = R(0.5) * real_min(c->hu, c->hv);
    w->surface[k] =
        (struct surface){real_min((real)def->material.thickness, most),
                         (real)def->material.friction};
    real thickness = w->surface[k].thickness;
    w->reach = real_max(w->reach, thickness);
    w->thinnest = k ? real_min(w->thinnest, thickness) : thickness;
    real side = real_min(c->hu, c->hv);
    w->cell = k ? real_min(w->cell, side) : side;
    return DRAPE_OK;
}

/* Gives all pins of a particle the motion of the last of them, so that it does
 * not matter which of them is written last. */
static int agree_on_motion(struct world *w, const struct sheet *s,
                           int32_t *motion)
{
    int32_t *last = take_stream(w, ARENA_OTHER, s->cloth.count, sizeof *last);
    if (!last)
        return DRAPE_ENOMEM;
    for (int64_t i = 0; i < s->pins.n; i++)
        last[s->pinned[i]] = motion[i];
    for (int64_t i = 0; i < s->pins.n; i++)
        motion[i] = last[s->pinned[i]];
    arena_give(w->arena, last);
    return DRAPE_OK;
}

static int fill_pins(struct world *w, const drape_cloth *def, int k)
{
    struct sheet *s = &w->sheet[k];
    double *rest = take_stream(w, ARENA_CLOTH, 3 * s->pins.n, sizeof *rest);
    int32_t *motion = take_stream(w, ARENA_CLOTH, s->pins.n, sizeof *motion);
    s->pinned = take_stream(w, ARENA_CLOTH, s->pins.n, sizeof *s->pinned);
    s->pins.x = take_stream(w, ARENA_CLOTH, s->pins.n, sizeof *s->pins.x);
    if (w->arena->failed)
        return DRAPE_ENOMEM;
    for (int64_t i = 0; i < s->pins.n; i++) {
        const drape_pin *pin = &def->pins[i];
        s->pinned[i] = pin->i + def->m * pin->j;
        motion[i] = pin->motion;
        vec x = w->x0[s->first + s->pinned[i]];
        rest[3 * i] = (double)x.x;
        rest[3 * i + 1] = (double)x.y;
        rest[3 * i + 2] = (double)x.z;
    }
    s->pins.rest = rest;
    s->pins.motion = motion;
    s->pins.pose = w->pose;
    s->pins.poses = w->def.n_motions;
    s->made = (drape_cloth){.m = def->m,
                            .n = def->n,
                            .width = def->width,
                            .height = def->height,
                            .material = def->material,
                            .bending = def->bending,
                            .panel = s->made.panel};
    s->defined = def->material;
    return s->pins.n > s->cloth.n_pinned ? agree_on_motion(w, s, motion)
                                         : DRAPE_OK;
}

static int fill_obstacle(struct world *w, const drape_obstacle *def, int k)
{
    struct prop *p = &w->prop[k];
    int64_t n = def->n_vertices;
    double *rest = take_stream(w, ARENA_OBSTACLE, 3 * n, sizeof *rest);
    int32_t *motion = take_stream(w, ARENA_OBSTACLE, n, sizeof *motion);
    if (def->frames)
        p->frame = take_stream(w, ARENA_OBSTACLE, 3 * n * def->frames,
                               sizeof *p->frame);
    double *time =
        def->frames && def->frame_time
            ? take_stream(w, ARENA_OBSTACLE, def->frames, sizeof *time)
            : NULL;
    if (w->arena->failed)
        return DRAPE_ENOMEM;
    memcpy(rest, def->x, (size_t)(3 * n) * sizeof *rest);
    if (def->frames)
        memcpy(p->frame, def->frame,
               (size_t)(3 * n * def->frames) * sizeof *p->frame);
    if (time)
        memcpy(time, def->frame_time, (size_t)def->frames * sizeof *time);
    for (int64_t i = 0; i < n; i++) {
        motion[i] = def->motion;
        w->body[p->first + i] = (uint16_t)(w->def.n_cloths + k);
    }
    for (int64_t t = 0; t < def->n_triangles; t++)
        for (int i = 0; i < 3; i++)
            w->tri[p->first_triangle + t][i] =
                (int32_t)(p->first + def->tri[t][i]);
    w->surface[w->def.n_cloths + k].friction = (real)def->friction;
    p->place.rest = rest;
    p->place.motion = motion;
    p->place.pose = w->pose;
    p->place.poses = w->def.n_motions;
    p->frames =
        (struct sequence){def->frames, def->between, def->frame_dt, time};
    p->moves = def->motion >= 0 || def->frames > 0;
    return DRAPE_OK;
}

static int take_streams(struct world *w)
{
    const struct plan *p = &w->plan;
    const struct state_list s = state_streams(w);
    int64_t bodies = w->def.n_cloths + w->def.n_obstacles;
    for (int k = 0; k < STATE_STREAMS; k++)
        if (s.of[k].n)
            *s.of[k].at = take_stream(w, ARENA_STATE, s.of[k].n, sizeof(vec));
    w->x1 = take_stream(w, ARENA_STATE, w->nv, sizeof *w->x1);
    w->v1 = take_stream(w, ARENA_STATE, w->nv, sizeof *w->v1);
    w->to = take_stream(w, ARENA_STATE, w->nc, sizeof *w->to);
    w->w = take_stream(w, ARENA_STATE, w->nv, sizeof *w->w);
    w->body = take_stream(w, ARENA_STATE, w->nv, sizeof *w->body);
    w->surface = take_stream(w, ARENA_STATE, bodies, sizeof *w->surface);
    w->tri = take_stream(w, ARENA_STATE, w->nt, sizeof *w->tri);
    w->watch = take_stream(w, ARENA_STATE, w->def.n_cloths, sizeof *w->watch);
    if (p->history && p->collides) {
        w->free_x = take_stream(w, ARENA_STATE, w->nc, sizeof *w->free_x);
        w->free_v = take_stream(w, ARENA_STATE, w->nc, sizeof *w->free_v);
    }
    return w->arena->failed ? DRAPE_ENOMEM : DRAPE_OK;
}

int fill_streams(struct world *w, const drape_def *def, drape_error *error)
{
    int status = take_streams(w);
    for (int k = 0; k < def->n_cloths && status == DRAPE_OK; k++) {
        status = fill_cloth(w, def, k, error);
        if (status == DRAPE_OK)
            status = fill_pins(w, &def->cloths[k], k);
    }
    for (int k = 0; k < def->n_obstacles && status == DRAPE_OK; k++)
        status = fill_obstacle(w, &def->obstacles[k], k);
    if (status == DRAPE_OK)
        status = prescribe_positions(w, 0, w->x0);
    if (status == DRAPE_OK)
        memcpy(w->x1, w->x0, (size_t)w->nv * sizeof *w->x0);
    return status == DRAPE_OK ? sew_fill(w, def, error) : status;
}
