/* SPDX-License-Identifier: Apache-2.0 */
/* Adds bodies to a world and removes them. A world with the new bodies is made
 * in place of the old one, which is released at the end, or stays if anything
 * fails. spec/control/control.md §9 */
#include <stdio.h>
#include <string.h>

#include "ref/api/define.h"
#include "ref/api/record.h"
#include "ref/base/change.h"
#include "ref/base/threads.h"

/* Ends a world of this handle and counts the allocations of its device. */
static void end_world(drape_world *world, struct world *w)
{
    drape_memory m = {0};
    if (!w || !world->ops->end)
        return;
    world->ops->count(w, &m);
    world->gone.host_allocations += m.host_allocations;
    world->gone.device_allocations += m.device_allocations;
    world->ops->end(w);
}

static int make_world(drape_world *world, const drape_def *def,
                      const struct edited *edited, struct world **made,
                      drape_error *error)
{
    struct threads threads;
    threads_begin(&threads, def->threads);
    int status = world->ops->edit.make(def, edited, &world->arena, made, error);
    if (status == DRAPE_OK)
        status = world->ops->edit.inherit(*made, edited, error);
    threads_end(&threads);
    return status;
}

/* Puts a world of this definition in the place of the handle's. */
static int replace_world(drape_world *world, const drape_def *def,
                         const struct edited *edited, drape_error *error)
{
    struct world *made = NULL;
    struct arena old;
    arena_set_aside(&world->arena, &old);
    int status = make_world(world, def, edited, &made, error);
    if (status != DRAPE_OK) {
        end_world(world, made);
        arena_free(&world->arena);
        arena_put_back(&world->arena, &old);
        return status;
    }
    end_world(world, world->world);
    arena_move(&old, &world->arena, world);
    arena_free(&old);
    handle_set(world, def, made);
    return DRAPE_OK;
}

/* Makes the change. On failure error, which may be NULL, gets a text. */
static int change_bodies(drape_world *world, const struct scene_edit *edit,
                         drape_error *error)
{
    drape_error own;
    drape_def def;
    struct edited edited;
    struct arena arena;
    error = error ? error : &own;
    memset(error, 0, sizeof *error);
    world->arena.failed = false;
    arena_init(&arena, &world->arena.allocator);
    int status =
        world->ops->edit.define(world->world, edit, &arena, &def, &edited);
    if (status == DRAPE_OK)
        status = define_check(&def, error);
    if (status == DRAPE_OK)
        status = replace_world(world, &def, &edited, error);
    world->arena.taken += arena.taken;
    arena_free(&arena);
    if (status != DRAPE_OK && !error->text[0])
        snprintf(error->text, sizeof error->text, "%s",
                 drape_status_text(status));
    handle_tell_edit(world, status, error->text);
    return status;
}

static int refuse_call(drape_error *error, const char *why)
{
    if (error)
        snprintf(error->text, sizeof error->text, "%s", why);
    return DRAPE_EARG;
}

int drape_add_cloth(drape_world *world, const drape_cloth *cloth,
                    drape_error *error)
{
    if (!world || !cloth)
        return refuse_call(error, !world ? "world is NULL" : "cloth is NULL");
    int status = change_bodies(
        world, &(struct scene_edit){.cloth = cloth, .removed = -1}, error);
    if (status != DRAPE_OK)
        return status;
    record_cloth(world, cloth);
    return world->cloths - 1;
}

int drape_add_obstacle(drape_world *world, const drape_obstacle *obstacle,
                       drape_error *error)
{
    if (!world || !obstacle)
        return refuse_call(error,
                           !world ? "world is NULL" : "obstacle is NULL");
    int status = change_bodies(
        world, &(struct scene_edit){.obstacle = obstacle, .removed = -1},
        error);
    if (status != DRAPE_OK)
        return status;
    record_obstacle(world, obstacle);
    return world->bodies - world->cloths - 1;
}

int drape_remove(drape_world *world, int body)
{
    if (!world || body < 0 || body >= world->bodies)
        return DRAPE_EARG;
    int status =
        change_bodies(world, &(struct scene_edit){.removed = body}, NULL);
    if (status == DRAPE_OK)
        record_call(world, (struct record){.kind = RECORD_REMOVE, .at = body});
    return status;
}
