/* SPDX-License-Identifier: Apache-2.0 */
/* Live control: checks the arguments of the calls that change a world between
 * two steps. spec/control/control.md */
#include "ref/api/define.h"
#include "ref/api/record.h"
#include "ref/base/change.h"
#include "ref/base/threads.h"

#include <string.h>

/* Makes a call with the threads of the world. */
#define WITHIN(world, call)                                                    \
    do {                                                                       \
        struct threads threads_;                                               \
        threads_begin(&threads_, (world)->threads);                            \
        call;                                                                  \
        threads_end(&threads_);                                                \
    } while (0)

static bool is_cloth(const drape_world *world, int cloth)
{
    return world && cloth >= 0 && cloth < world->cloths;
}

static bool is_obstacle(const drape_world *world, int obstacle)
{
    return world && obstacle >= 0 && obstacle < world->bodies - world->cloths;
}

/* Whether vertices first … first + n - 1 are of cloths. */
static bool of_cloths(const drape_world *world, int64_t first, int64_t n)
{
    if (!world)
        return false;
    int64_t nc = drape_first_vertex(world, world->cloths);
    return first >= 0 && n >= 0 && first <= nc && n <= nc - first;
}

static int check_vectors(int64_t n, struct given x)
{
    return x.here ? define_check_vectors(n, x.here) : DRAPE_OK;
}

int drape_set_gravity(drape_world *world, const double gravity[3])
{
    if (!world || !gravity)
        return DRAPE_EARG;
    int status = define_check_vectors(1, (const double(*)[3])gravity);
    if (status != DRAPE_OK)
        return status;
    WITHIN(world, world->ops->control.gravity(world->world, gravity));
    record_call(world, (struct record){.kind = RECORD_GRAVITY,
                                       .data = gravity,
                                       .bytes = 3 * sizeof *gravity});
    return DRAPE_OK;
}

int drape_set_material(drape_world *world, int cloth,
                       const drape_material *material)
{
    if (!is_cloth(world, cloth) || !material)
        return DRAPE_EARG;
    int status = define_check_material(material);
    if (status == DRAPE_OK)
        WITHIN(world, status = world->ops->control.material(world->world, cloth,
                                                            material));
    if (status == DRAPE_OK)
        record_call(world, (struct record){.kind = RECORD_MATERIAL,
                                           .at = cloth,
                                           .data = material,
                                           .bytes = sizeof *material});
    return status;
}

static int set_positions(drape_world *world, int64_t first, int64_t n,
                         struct given x, drape_error *error)
{
    if (error)
        error->text[0] = 0;
    if (!of_cloths(world, first, n) || (n > 0 && !x.here && !x.there))
        return DRAPE_EARG;
    int status = check_vectors(n, x);
    if (status == DRAPE_OK && n > 0)
        WITHIN(world, status = world->ops->control.positions(
                          world->world, first, n, x, error));
    if (status == DRAPE_OK)
        record_call(world, (struct record){.kind = RECORD_POSITIONS,
                                           .at = first,
                                           .n = n,
                                           .vectors = n,
                                           .x = x});
    return status;
}

int drape_set_positions(drape_world *world, int64_t first, int64_t n,
                        const double (*x)[3], drape_error *error)
{
    return set_positions(world, first, n, (struct given){x, NULL}, error);
}

int drape_set_positions_device(drape_world *world, int64_t first, int64_t n,
                               const void *x, drape_error *error)
{
    return set_positions(world, first, n, (struct given){NULL, x}, error);
}

static int set_velocities(drape_world *world, int64_t first, int64_t n,
                          struct given v)
{
    if (!of_cloths(world, first, n) || (n > 0 && !v.here && !v.there))
        return DRAPE_EARG;
    int status = check_vectors(n, v);
    if (status == DRAPE_OK && n > 0)
        WITHIN(world, status = world->ops->control.velocities(world->world,
                                                              first, n, v));
    if (status == DRAPE_OK)
        record_call(world, (struct record){.kind = RECORD_VELOCITIES,
                                           .at = first,
                                           .n = n,
                                           .vectors = n,
                                           .x = v});
    return status;
}

int drape_set_velocities(drape_world *world, int64_t first, int64_t n,
                         const double (*v)[3])
{
    return set_velocities(world, first, n, (struct given){v, NULL});
}

int drape_set_velocities_device(drape_world *world, int64_t first, int64_t n,
                                const void *v)
{
    return set_velocities(world, first, n, (struct given){NULL, v});
}

static int set_pins(drape_world *world, int cloth, int64_t n,
                    const int32_t *particle, struct given x)
{
    if (!is_cloth(world, cloth) || n < 0 || (n > 0 && !particle))
        return DRAPE_EARG;
    if (n >
        drape_first_vertex(world, cloth + 1) - drape_first_vertex(world, cloth))
        return DRAPE_EARG;
    int status = check_vectors(n, x);
    if (status == DRAPE_OK)
        WITHIN(world, status = world->ops->control.pins(world->world, cloth, n,
                                                        particle, x));
    if (status == DRAPE_OK)
        record_call(world,
                    (struct record){.kind = RECORD_PINS,
                                    .at = cloth,
                                    .n = n,
                                    .data = particle,
                                    .bytes = (size_t)n * sizeof *particle,
                                    .vectors = n,
                                    .x = x});
    return status;
}

int drape_set_pins(drape_world *world, int cloth, int64_t n,
                   const int32_t *particle, const double (*x)[3])
{
    return set_pins(world, cloth, n, particle, (struct given){x, NULL});
}

int drape_set_pins_device(drape_world *world, int cloth, int64_t n,
                          const int32_t *particle, const void *x)
{
    return set_pins(world, cloth, n, particle, (struct given){NULL, x});
}

static int set_obstacle(drape_world *world, int obstacle, struct given x)
{
    if (!is_obstacle(world, obstacle) || (!x.here && !x.there))
        return DRAPE_EARG;
    int body = world->cloths + obstacle;
    int64_t n =
        drape_first_vertex(world, body + 1) - drape_first_vertex(world, body);
    int status = check_vectors(n, x);
    if (status == DRAPE_OK)
        WITHIN(world, status = world->ops->control.obstacle(world->world,
                                                            obstacle, x));
    if (status == DRAPE_OK)
        record_call(world, (struct record){.kind = RECORD_OBSTACLE,
                                           .at = obstacle,
                                           .n = n,
                                           .vectors = n,
                                           .x = x});
    return status;
}

int drape_set_obstacle(drape_world *world, int obstacle, const double (*x)[3])
{
    return set_obstacle(world, obstacle, (struct given){x, NULL});
}

int drape_set_obstacle_device(drape_world *world, int obstacle, const void *x)
{
    return set_obstacle(world, obstacle, (struct given){NULL, x});
}

int drape_set_pose(drape_world *world, int obstacle, const double position[3],
                   const double rotation[4], const double pivot[3])
{
    static const double upright[4] = {1, 0, 0, 0}, zero[3] = {0, 0, 0};
    const double time = 0;
    struct record_pose p;
    if (!is_obstacle(world, obstacle) || !position)
        return DRAPE_EARG;
    memcpy(p.position, position, sizeof p.position);
    memcpy(p.rotation, rotation ? rotation : upright, sizeof p.rotation);
    memcpy(p.pivot, pivot ? pivot : zero, sizeof p.pivot);
    drape_motion motion = {.keys = 1,
                           .time = &time,
                           .position = (const double(*)[3])p.position,
                           .rotation = (const double(*)[4])p.rotation};
    memcpy(motion.pivot, p.pivot, sizeof p.pivot);
    int status = define_check_motion(&motion);
    if (status == DRAPE_OK)
        WITHIN(world, status = world->ops->control.pose(world->world, obstacle,
                                                        &motion));
    if (status == DRAPE_OK)
        record_call(world, (struct record){.kind = RECORD_POSE,
                                           .at = obstacle,
                                           .data = &p,
                                           .bytes = sizeof p});
    return status;
}

int drape_seam_target(drape_world *world, int seam, const double (*gap)[3])
{
    int64_t n =
        world ? world->ops->control.seam_points(world->world, seam) : -1;
    if (n < 0)
        return DRAPE_EARG;
    int status = gap ? define_check_vectors(n, gap) : DRAPE_OK;
    if (status == DRAPE_OK)
        status = world->ops->control.seam_target(world->world, seam, n, gap);
    if (status == DRAPE_OK)
        record_call(world, (struct record){.kind = RECORD_SEAM,
                                           .at = seam,
                                           .n = n,
                                           .vectors = n,
                                           .x = {gap, NULL}});
    return status;
}

int drape_seam_state(const drape_world *world, int seam, double (*gap)[3],
                     double (*pull)[3])
{
    return world ? world->ops->control.seam_state(world->world, seam, gap, pull)
                 : DRAPE_EARG;
}

int drape_are_sewn(const drape_world *world, int64_t a, int64_t b)
{
    int64_t n = world ? drape_triangles(world) : 0;
    if (a < 0 || a >= n || b < 0 || b >= n)
        return DRAPE_EARG;
    return world->ops->control.sewn(world->world, (int32_t)a, (int32_t)b);
}
