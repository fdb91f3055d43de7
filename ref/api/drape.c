/* SPDX-License-Identifier: Apache-2.0 */
/* The public API: checks arguments and calls the world of the requested
 * precision. The pipeline itself is ref/world/step.c. spec/drape.h */
#include "spec/drape.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ref/api/define.h"
#include "ref/api/handle.h"
#include "ref/api/record.h"
#include "ref/base/info.h"
#include "ref/base/threads.h"
#include "ref/narrow/audit.h"
#include "ref/narrow/narrow.h"

/* The log */

enum { LINE = 640 };

static void write_log(const drape_world *world, const char *format, ...)
{
    char line[LINE];
    va_list args;
    va_start(args, format);
    vsnprintf(line, sizeof line, format, args);
    va_end(args);
    world->log(world->log_user, line);
}

static int64_t count_allocations(const drape_world *world, drape_memory *m)
{
    drape_count(world, m);
    return m->host_allocations + m->device_allocations;
}

static const char *device_of(const drape_world *world)
{
    return world->ops->device ? world->ops->device(world->world) : "";
}

static void tell_made(drape_world *world)
{
    drape_memory m;
    if (!world->log)
        return;
    world->taken = count_allocations(world, &m);
    write_log(
        world,
        "made: backend %s, %d bits, %lld vertices, %lld triangles, %zu bytes "
        "here, %zu on the device%s%s",
        world->ops->device ? "gpu" : "ref", world->precision,
        (long long)drape_vertices(world), (long long)drape_triangles(world),
        m.host_bytes, m.device_bytes, world->ops->device ? ": " : "",
        device_of(world));
}

void handle_tell_edit(drape_world *handle, int status, const char *why)
{
    if (status == DRAPE_OK)
        tell_made(handle);
    else if (handle->log)
        handle->log(handle->log_user, why);
}

void handle_tell_step(drape_world *world, int status)
{
    drape_memory m;
    if (!world->log)
        return;
    int64_t taken = count_allocations(world, &m);
    if (taken != world->taken)
        write_log(world,
                  "step %lld: memory grew: %zu bytes here, %zu on the device",
                  (long long)world->steps, m.host_bytes, m.device_bytes);
    world->taken = taken;
    if (status != DRAPE_OK)
        write_log(world, "step %lld: %s%s%s", (long long)world->steps,
                  drape_status_text(status), world->ops->device ? ": " : "",
                  device_of(world));
}

/* The functions of the API */

static const struct world_ops *choose_ops(const drape_def *def)
{
    if (def->backend == DRAPE_GPU)
        return def->precision == 32 ? &world_ops_gpu_32 : &world_ops_gpu_64;
    return def->precision == 32 ? &world_ops_32 : &world_ops_64;
}

void handle_set(drape_world *handle, const drape_def *def, struct world *world)
{
    enum { SMALL_SCENE = 4096 }; /* spec/world/step.md §8 */
    handle->world = world;
    handle->cloths = def->n_cloths;
    handle->bodies = def->n_cloths + def->n_obstacles;
    bool one =
        drape_vertices(handle) < SMALL_SCENE || def->backend == DRAPE_GPU;
    handle->threads = one ? 1 : def->threads;
}

static int make_world(const drape_def *def, drape_world **world,
                      drape_error *error)
{
    struct arena arena;
    arena_init(&arena, &def->allocator);
    drape_world *d = arena_take(&arena, ARENA_OTHER, 1, sizeof *d);
    if (!d)
        return DRAPE_ENOMEM;
    d->arena = arena;
    d->ops = choose_ops(def);
    d->precision = def->precision;
    d->log = def->log;
    d->log_user = def->log_user;
    struct threads threads;
    threads_begin(&threads, def->threads);
    int status = d->ops->make(def, &d->arena, &d->world, error);
    threads_end(&threads);
    if (status == DRAPE_OK) {
        handle_set(d, def, d->world);
        *world = d;
    } else
        drape_destroy(d);
    return status;
}

static int refuse_call(drape_error *error, const char *why)
{
    snprintf(error->text, sizeof error->text, "%s", why);
    return DRAPE_EARG;
}

int drape_create(const drape_def *def, drape_world **world, drape_error *error)
{
    drape_error unused;
    error = error ? error : &unused;
    memset(error, 0, sizeof *error);
    if (world)
        *world = NULL;
    if (!def || !world)
        return refuse_call(error, !def ? "def is NULL" : "world is NULL");
    int status = define_check(def, error);
    if (status == DRAPE_OK)
        status = make_world(def, world, error);
    if (status == DRAPE_OK) {
        tell_made(*world);
        return DRAPE_OK;
    }
    if (!error->text[0])
        strncpy(error->text, drape_status_text(status), sizeof error->text - 1);
    if (def->log)
        def->log(def->log_user, error->text);
    return status;
}

void drape_destroy(drape_world *world)
{
    if (!world)
        return;
    if (world->ops->end && world->world)
        world->ops->end(world->world);
    struct arena arena = world->arena; /* a copy: it owns the world's memory */
    arena_free(&arena);
}

int drape_step(drape_world *world, drape_step_report *report)
{
    if (!world)
        return DRAPE_EARG;
    world->steps++;
    world->arena.failed = false; /* memory may be available again */
    drape_step_report own;
    if (world->record && !report) /* for its outcome */
        report = &own;
    int status = world->ops->step(world->world, report);
    handle_tell_step(world, status);
    if (status == DRAPE_OK && world->record)
        record_call(world,
                    (struct record){.kind = RECORD_STEP, .n = report->outcome});
    return status;
}

int64_t drape_first_vertex(const drape_world *world, int body)
{
    if (!world || body < 0 || body > world->bodies)
        return DRAPE_EARG;
    return world->ops->first_vertex(world->world, body);
}

int64_t drape_first_triangle(const drape_world *world, int body)
{
    if (!world || body < 0 || body > world->bodies)
        return DRAPE_EARG;
    return world->ops->first_triangle(world->world, body);
}

int drape_bodies(const drape_world *world, int *cloths)
{
    if (!world)
        return DRAPE_EARG;
    if (cloths)
        *cloths = world->cloths;
    return world->bodies;
}

int64_t drape_vertices(const drape_world *world)
{
    return world ? drape_first_vertex(world, world->bodies) : DRAPE_EARG;
}

int64_t drape_triangles(const drape_world *world)
{
    return world ? drape_first_triangle(world, world->bodies) : DRAPE_EARG;
}

int drape_read(const drape_world *world, double (*x)[3], double (*v)[3])
{
    return world ? world->ops->read(world->world, x, v) : DRAPE_EARG;
}

int drape_borrow(drape_world *world, drape_view *view)
{
    if (!world || !view)
        return DRAPE_EARG;
    view->vertices = drape_vertices(world);
    view->triangles = drape_triangles(world);
    view->precision = world->precision;
    return world->ops->borrow(world->world, view);
}

static int list_contacts(drape_world *world, bool there,
                         drape_contact_list *list)
{
    if (!world || !list)
        return DRAPE_EARG;
    world->arena.failed = false;
    memset(list, 0, sizeof *list);
    return world->ops->contacts(world->world, there, list);
}

int drape_contacts(drape_world *world, drape_contact_list *list)
{
    return list_contacts(world, false, list);
}

int drape_contacts_device(drape_world *world, drape_contact_list *list)
{
    return list_contacts(world, true, list);
}

int drape_read_triangles(const drape_world *world, int32_t (*tri)[3])
{
    if (!world || !tri)
        return DRAPE_EARG;
    world->ops->read_triangles(world->world, tri);
    return DRAPE_OK;
}

int drape_clock(const drape_world *world, int64_t *step, double *time)
{
    if (!world)
        return DRAPE_EARG;
    world->ops->clock(world->world, step, time);
    return DRAPE_OK;
}

int drape_read_material(const drape_world *world, int cloth,
                        drape_material *material)
{
    if (!world || cloth < 0 || cloth >= world->cloths || !material)
        return DRAPE_EARG;
    *material = *world->ops->material(world->world, cloth);
    return DRAPE_OK;
}

int drape_read_wind(const drape_world *world, drape_wind *wind)
{
    if (!world || !wind)
        return DRAPE_EARG;
    *wind = *world->ops->wind(world->world);
    return DRAPE_OK;
}

int drape_read_gravity(const drape_world *world, double gravity[3])
{
    if (!world || !gravity)
        return DRAPE_EARG;
    memcpy(gravity, world->ops->gravity(world->world), 3 * sizeof *gravity);
    return DRAPE_OK;
}

void drape_wake(drape_world *world)
{
    if (!world)
        return;
    world->ops->wake(world->world);
    record_call(world, (struct record){.kind = RECORD_WAKE});
}

int drape_set_wind(drape_world *world, const drape_wind *wind)
{
    if (!world || !wind)
        return DRAPE_EARG;
    int status = define_check_wind(wind);
    if (status == DRAPE_OK)
        status = world->ops->set_wind(world->world, wind);
    if (status == DRAPE_OK)
        record_call(world, (struct record){.kind = RECORD_WIND,
                                           .data = wind,
                                           .bytes = sizeof *wind});
    return status;
}

int drape_plan(const drape_world *world, drape_plan_row *row, int capacity)
{
    if (!world || capacity < 0 || (capacity > 0 && !row))
        return DRAPE_EARG;
    return world->ops->plan(world->world, row, capacity);
}

int drape_count(const drape_world *world, drape_memory *memory)
{
    if (!world || !memory)
        return DRAPE_EARG;
    const struct arena *a = &world->arena;
    *memory = world->gone;
    memory->host_allocations += a->taken;
    for (int k = 0; k < ARENA_PARTS; k++)
        memory->host_bytes += a->bytes[k];
    if (world->ops->count)
        world->ops->count(world->world, memory);
    return DRAPE_OK;
}

int drape_save(const drape_world *world, drape_write *write, void *user)
{
    if (!world || !write)
        return DRAPE_EARG;
    return world->ops->save(world->world, write, user);
}

int drape_load(drape_world *world, drape_read_bytes *read, void *user)
{
    if (!world || !read)
        return DRAPE_EARG;
    struct threads threads;
    threads_begin(&threads, world->threads);
    int status = world->ops->load(world->world, read, user);
    threads_end(&threads);
    if (status == DRAPE_OK)
        record_state(world);
    return status;
}

const char *drape_info(void)
{
    return gpu_info();
}

const char *drape_status_text(int status)
{
    switch (status) {
    case DRAPE_OK:
        return "no error";
    case DRAPE_EARG:
        return "an argument is out of its range";
    case DRAPE_EDATA:
        return "a number is not finite or beyond 2^60";
    case DRAPE_ENOMEM:
        return "out of memory";
    case DRAPE_EFULL:
        return "an output is too small";
    case DRAPE_ESTART:
        return "the start state intersects";
    case DRAPE_EDEVICE:
        return "no such backend here, or its device is lost";
    case DRAPE_EMATCH:
        return "a checkpoint of another scene, build or version";
    case DRAPE_EIO:
        return "reading or writing failed";
    case DRAPE_ELIMIT:
        return "the scene forbids it by a limit of its own";
    default:
        return "unknown status";
    }
}
