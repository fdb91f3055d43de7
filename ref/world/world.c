/* SPDX-License-Identifier: Apache-2.0 */
/* Makes a world of one precision from a checked definition, and reads its
 * state. */
#include "ref/base/change.h"
#include "ref/sleep/sleep.h"
#include "ref/world/air.h"
#include "ref/world/checkpoint.h"
#include "ref/world/connect.h"
#include "ref/world/fill.h"
#include "ref/world/start.h"
#include "ref/world/state.h"

/* The hashes of the bodies; those of an edited world are known but for a new
 * body. */
static int make_prints(struct world *w, const drape_def *def,
                       const struct edited *edited)
{
    int bodies = def->n_cloths + def->n_obstacles;
    w->print = arena_take(w->arena, ARENA_OTHER, bodies, sizeof *w->print);
    if (!w->print)
        return DRAPE_ENOMEM;
    for (int k = 0; k < bodies && edited; k++)
        if (edited->from[k] >= 0)
            w->print[k] = edited->old->print[edited->from[k]];
    w->fingerprint = checkpoint_fingerprint(def, w->print);
    return DRAPE_OK;
}

/* Gives the cloths that stay the sizes by which the old world's tree was made.
 */
static void keep_sizes(struct world *w, const struct edited *edited)
{
    for (int k = 0; k < w->def.n_cloths; k++)
        if (edited->from[k] >= 0)
            w->sheet[k].size = edited->old->sheet[edited->from[k]].size;
}

int world_make_edited(const drape_def *def, const struct edited *edited,
                      struct arena *arena, struct world **world,
                      drape_error *error)
{
    struct world *w = arena_take(arena, ARENA_OTHER, 1, sizeof *w);
    if (!w)
        return DRAPE_ENOMEM;
    w->arena = arena;
    w->held = arena->bytes;
    w->home = w;
    w->run = &backend_ref;
    w->on = backend_of(arena);
    w->def = *def;
    w->plan = plan_make(def);
    w->dt = def->dt;
    memcpy(w->defined_gravity, def->gravity, sizeof w->defined_gravity);
    w->defined_wind = def->wind;
    w->trace = (struct trace){def->trace, def->trace_user, 0, 0};
    w->tracing = def->trace ? &w->trace : NULL;
    w->sheet = arena_take(arena, ARENA_OTHER, def->n_cloths, sizeof *w->sheet);
    w->prop = arena_take(arena, ARENA_OTHER, def->n_obstacles, sizeof *w->prop);
    fill_motions(w, def);
    w->posed = w->pose;
    if (arena->failed)
        return DRAPE_ENOMEM;
    int status = make_prints(w, def, edited);
    if (status == DRAPE_OK)
        status = sleep_make(w);
    if (status == DRAPE_OK)
        status = fill_sizes(w, def, error);
    if (status == DRAPE_OK)
        status = fill_streams(w, def, error);
    if (status == DRAPE_OK && edited)
        keep_sizes(w, edited);
    else if (status == DRAPE_OK && w->plan.collides)
        status = start_audit(w, error);
    if (status == DRAPE_OK)
        status = connect_stages(w, def);
    if (status == DRAPE_OK)
        status = start_substeps(w, error);
    if (status == DRAPE_OK && w->plan.wind && def->backend == DRAPE_REF)
        status = air_take(w);
    if (status == DRAPE_OK)
        air_set(w, &def->wind);
    w->targets.planned = w->plan.prescribed;
    w->targets.able = w->broad.apart.able;
    *world = w;
    return status;
}

int world_make(const drape_def *def, struct arena *arena, struct world **world,
               drape_error *error)
{
    return world_make_edited(def, NULL, arena, world, error);
}

static void copy_out(double (*out)[3], const vec *a, int64_t n)
{
    for (int64_t i = 0; i < n && out; i++) {
        out[i][0] = (double)a[i].x;
        out[i][1] = (double)a[i].y;
        out[i][2] = (double)a[i].z;
    }
}

int world_read(const struct world *w, double (*x)[3], double (*v)[3])
{
    copy_out(x, w->x0, w->nv);
    copy_out(v, w->v0, w->nv);
    return DRAPE_OK;
}

void world_read_triangles(const struct world *w, int32_t (*tri)[3])
{
    memcpy(tri, w->tri, (size_t)w->nt * sizeof *tri);
}
