/* SPDX-License-Identifier: Apache-2.0 */
/* The device as a backend: its table of functions, which queue launches and
 * wait only for counts and outcomes. ref/base/backend.h, spec/gpu.md §6 */
#include "gpu/run/batch.cuh"

extern "C" {
#include "gpu/broad/broad.h"
#include "gpu/cloth/motion.h"
#include "gpu/contact/queue.h"
#include "gpu/contact/rounds.h"
#include "gpu/contact/unknowns.h"
#include "gpu/sleep/wake.h"
#include "gpu/world/backend.h"
#include "gpu/world/prescribed.h"
#include "gpu/world/systems.h"
#include "ref/narrow/audit.h"
}

static struct gpu *gpu_of(void *on)
{
    return (struct gpu *)on;
}

static void *take_stream(void *on, enum arena_part part, int64_t n, size_t size)
{
    return gpu_take(gpu_of(on), part, n, size);
}

/* A pool that need not outlast a solve is borrowed from the solvers' memory. */
static int grow_pool(void *on, struct pool *pool, int64_t need, size_t size,
                     bool kept)
{
    struct gpu *g = gpu_of(on);
    int64_t cap = gpu_capacity(g, need);
    gpu_give(g, pool->data);
    pool->data = kept ? gpu_take(g, ARENA_RESPONSE, cap, size)
                      : gpu_borrow(g, ARENA_RESPONSE, cap, size);
    pool->cap = pool->data ? cap : 0;
    return gpu_status(g);
}

static void give_stream(void *on, void *p)
{
    gpu_give(gpu_of(on), p);
}

static void copy_bytes(void *on, void *to, const void *from, size_t bytes)
{
    gpu_copy(gpu_of(on), to, from, bytes);
}

static void clear_bytes(void *on, void *p, size_t bytes)
{
    gpu_clear(gpu_of(on), p, bytes);
}

static void send(void *on, void *to, const void *from, size_t bytes)
{
    gpu_up(gpu_of(on), to, from, bytes);
}

static void begin_work(void *on)
{
    gpu_begin(gpu_of(on));
    if (gpu_of(on)->together)
        gpu_batch_step(gpu_of(on));
}

static void wait_for_work(void *on)
{
    if (!gpu_of(on)->together) /* else only others' time would be measured */
        gpu_wait(gpu_of(on));
}

static int get_status(void *on)
{
    return gpu_status(gpu_of(on));
}

static void trace_output(void *on, struct trace *t, const char *stage,
                         const void *out, size_t bytes)
{
    gpu_trace(gpu_of(on), t, stage, out, bytes);
}

/* STAGE(name) wraps gpu_name as a function of the table. */
#define STAGE(name)                                                            \
    static int name(void *on, struct name *s)                                  \
    {                                                                          \
        return gpu_##name(gpu_of(on), s);                                      \
    }
STAGE(dot)
STAGE(kinematics)
STAGE(moments)
STAGE(islands)
STAGE(spin)
STAGE(history)
STAGE(travel)
STAGE(narrow)
STAGE(audit)
STAGE(proximity)
STAGE(impacts)
STAGE(impulses)
STAGE(contacts)
STAGE(zones)
STAGE(rollback)

/* Bad contacts set a late word, which the readback of the next solve brings:
 * gpu/world/systems.cu. */
static int coulomb(void *on, struct coulomb *s)
{
    return gpu_coulomb_queue(gpu_of(on), s, gpu_queue_words(gpu_of(on)));
}

static int carry(void *on, struct carry *s)
{
    return gpu_carry_queue(gpu_of(on), s, gpu_queue_words(gpu_of(on)));
}

static int retain(void *on, struct retain *s)
{
    return gpu_retain_queue(gpu_of(on), s, gpu_queue_words(gpu_of(on)));
}

static int run_motion(void *on, struct sheet *s)
{
    return gpu_motion(gpu_of(on), s);
}

static int motion_part(void *on, struct sheet *s, int part)
{
    return gpu_motion_part(gpu_of(on), s, part);
}

static void find_energy(void *on, struct sheet *s, const vec *x, const vec *v,
                        double value[3])
{
    gpu_motion_energy(gpu_of(on), s, x, v, value);
}

static int ask_meshes_apart(void *on, struct broad *b, const vec *x0,
                            const vec *x1, real r, bool *apart)
{
    return gpu_broad_meshes_apart(gpu_of(on), b, x0, x1, r, apart);
}

static int run_query(void *on, struct broad *b, const vec *x0, const vec *x1,
                     real r, const uint8_t *moved)
{
    return gpu_broad_query(gpu_of(on), b, x0, x1, r, moved);
}

static void start_response(void *on, struct response *s)
{
    gpu_rounds_start(gpu_of(on), s);
}

static void advance_vertices(void *on, struct response *s, int64_t n,
                             const int32_t *vertex, const uint8_t *moved,
                             bool stop)
{
    gpu_rounds_advance(gpu_of(on), s, n, vertex, moved, stop);
}

static void touch_vertices(void *on, const struct response *s)
{
    gpu_rounds_touch(gpu_of(on), s);
}

static void cap_targets(void *on, const struct response *s,
                        struct contact *contact)
{
    gpu_rounds_settle(gpu_of(on), s, contact);
}

static void shift_state(void *on, const struct shift *s)
{
    gpu_unknowns_shift(gpu_of(on), s);
}

static void find_jump(void *on, const struct jumps *s)
{
    gpu_unknowns_jump(gpu_of(on), s);
}

static void subtract_part(void *on, int64_t n, real part, const vec *q, vec *r)
{
    gpu_unknowns_lessen(gpu_of(on), n, part, q, r);
}

static void place_pins(void *on, int64_t n, const int32_t *pinned, const vec *x,
                       vec *to)
{
    gpu_prescribed_pin(gpu_of(on), n, pinned, x, to);
}

static void blend_places(void *on, const struct blend *s)
{
    gpu_prescribed_blend(gpu_of(on), s);
}

static void keep_fixed(void *on, int64_t n, const uint8_t *fixed,
                       const vec *old, vec *a)
{
    gpu_prescribed_keep(gpu_of(on), n, fixed, old, a);
}

static bool are_sane(void *on, int64_t n, const vec *a)
{
    return gpu_prescribed_sane(gpu_of(on), n, a);
}

static void fetch(void *on, void *host, const void *from, size_t bytes)
{
    gpu_down(gpu_of(on), host, from, bytes);
}

static void renew_laws(void *on, struct sheet *s)
{
    gpu_motion_laws(gpu_of(on), s);
}

static bool find_difference(void *on, int64_t n, const int32_t *at,
                            const vec *x0, const vec *x1)
{
    return gpu_prescribed_differs(gpu_of(on), n, at, x0, x1);
}

static void find_disturbed(void *on, struct wake *s)
{
    gpu_wake_find(gpu_of(on), s);
}

static void set_mask(void *on, int64_t n, const uint16_t *body,
                     const uint8_t *awake, uint8_t *to)
{
    gpu_wake_mask(gpu_of(on), n, body, awake, to);
}

static void find_displacements(void *on, int64_t n, const uint16_t *body,
                               const vec *x0, const vec *x1, int bodies,
                               real *most)
{
    gpu_wake_displacements(gpu_of(on), n, body, x0, x1, bodies, most);
}

static void find_velocities(void *on, int64_t n, const vec *x0, const vec *x1,
                            real dt, vec *v)
{
    gpu_prescribed_velocities(gpu_of(on), n, x0, x1, dt, v);
}

static real find_furthest(void *on, int64_t n, const vec *x0, const vec *x1)
{
    return gpu_prescribed_furthest(gpu_of(on), n, x0, x1);
}

static int ending_streams(void *on, struct audit *s, int64_t nt, int64_t cloths)
{
    gpu_prescribed_group(gpu_of(on), nt, cloths, (int32_t *)s->group);
    return gpu_status(gpu_of(on));
}

extern const struct backend backend_gpu = {
    .take = take_stream,
    .grow = grow_pool,
    .give = give_stream,
    .copy = copy_bytes,
    .clear = clear_bytes,
    .send = send,
    .pushes = 1, /* stored by vertex */
    .begin = begin_work,
    .wait = wait_for_work,
    .status = get_status,
    .trace = trace_output,
    .dot = dot,
    .kinematics = kinematics,
    .moments = moments,
    .islands = islands,
    .spin = spin,
    .history = history,
    .travel = travel,
    .narrow = narrow,
    .audit = audit,
    .proximity = proximity,
    .impacts = impacts,
    .impulses = impulses,
    .contacts = contacts,
    .zones = zones,
    .rollback = rollback,
    .coulomb = coulomb,
    .carry = carry,
    .retain = retain,
    .motion = run_motion,
    .motion_part = motion_part,
    .energy = find_energy,
    .joint_set_up = gpu_systems_set_up,
    .joint_measure = gpu_systems_measure,
    .joint = gpu_systems_joint,
    .broad_meshes_apart = ask_meshes_apart,
    .broad_query = run_query,
    .start = start_response,
    .advance = advance_vertices,
    .touch = touch_vertices,
    .cap_targets = cap_targets,
    .slice_room = gpu_systems_room,
    .shift = shift_state,
    .jump = find_jump,
    .lessen = subtract_part,
    .pin = place_pins,
    .blend = blend_places,
    .keep = keep_fixed,
    .sane = are_sane,
    .fetch = fetch,
    .laws = renew_laws,
    .moves = gpu_prescribed_moves,
    .differs = find_difference,
    .wake_find = find_disturbed,
    .wake_mask = set_mask,
    .wake_displacements = find_displacements,
    .velocities = find_velocities,
    .furthest = find_furthest,
    .ending_streams = ending_streams};
