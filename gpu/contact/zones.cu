/* SPDX-License-Identifier: Apache-2.0 */
/* Moves each zone as a rigid body; a block owns a zone. spec/contact/zones.md
 */
#include "gpu/base/real.cuh"
#include "gpu/contact/members.cuh"

/* Threads of a block that owns a zone. */
enum { ZONE_BLOCK = 256 };

/* §2: sums */

static __device__ struct zone_sum add(const struct zone_sum &p,
                                      const struct zone_sum &q)
{
    struct zone_sum r = {p.m + q.m, add(p.a, q.a), add(p.b, q.b),
                         add(p.i, q.i)};
    return r;
}

/* Sums n members pairwise into sum[0], as a tree whose shape depends on n
 * alone. All threads of the block must call it. */
static __device__ void sum_members(struct zone_sum *sum, int64_t n)
{
    __syncthreads();
    for (int64_t step = 1; step < n; step *= 2) {
        int64_t stride = 2 * step * blockDim.x;
        for (int64_t k = 2 * step * threadIdx.x; k + step < n; k += stride)
            sum[k] = add(sum[k], sum[k + step]);
        __syncthreads();
    }
}

static __device__ real mass_of(const struct zones *s, const struct zone *z,
                               int32_t i)
{
    bool free = s->w[i] > 0;
    if (z->prescribed)
        return free ? R(0.0) : R(1.0);
    return 1 / s->w[i];
}

static __device__ struct zone_sum linear_part(const struct zones *s,
                                              const struct zone *z, int32_t i)
{
    real m = mass_of(s, z, i);
    struct zone_sum r = {m,
                         scale(m, sub(s->x0[i], z->base)),
                         scale(m, s->u[i]),
                         {0, 0, 0, 0, 0, 0}};
    return r;
}

static __device__ vec arm_of(const struct zones *s, const struct zone *z,
                             int32_t i)
{
    return sub(sub(s->x0[i], z->base), z->centre);
}

static __device__ struct zone_sum angular_part(const struct zones *s,
                                               const struct zone *z, int32_t i)
{
    real m = mass_of(s, z, i);
    vec r = arm_of(s, z, i), d = sub(s->u[i], z->velocity);
    if (z->prescribed) /* §3.4: the middle of the chord */
        r = axpy(r, R(0.5) * s->dt, d);
    vec mr = scale(m, r), l = cross(mr, d);
    struct zone_sum sum = {m,
                           l,
                           l,
                           {mr.y * r.y + mr.z * r.z, -(mr.x * r.y),
                            -(mr.x * r.z), mr.x * r.x + mr.z * r.z,
                            -(mr.y * r.z), mr.x * r.x + mr.y * r.y}};
    return sum;
}

/* §3: motion */

/* The angular velocity i⁻¹ l, by the adjugate; 0 where the members lie too
 * close to a line. */
static __device__ vec spin_of(sym i, vec l)
{
    real trace = (i.xx + i.yy) + i.zz;
    if (!(trace > 0))
        return make(0, 0, 0);
    real f = 1 / trace;
    sym j = {f * i.xx, f * i.xy, f * i.xz, f * i.yy, f * i.yz, f * i.zz};
    sym a = {j.yy * j.zz - j.yz * j.yz, j.xz * j.yz - j.xy * j.zz,
             j.xy * j.yz - j.xz * j.yy, j.xx * j.zz - j.xz * j.xz,
             j.xy * j.xz - j.xx * j.yz, j.xx * j.yy - j.xy * j.xy};
    real det = (j.xx * a.xx + j.xy * a.xy) + j.xz * a.xz;
    if (!(det > R(0x1p-16)))
        return make(0, 0, 0);
    return scale(1 / det, apply(a, scale(f, l)));
}

/* §3.2: limits the rotation to a quarter turn in the step. */
static __device__ vec limit_spin(vec spin, real dt)
{
    vec half = scale(R(0.5) * dt, spin);
    real rotation = dot(half, half);
    return rotation > 1 ? scale(1 / root(rotation), spin) : spin;
}

/* The mean velocity that moves vertex i with zone z through the step. */
static __device__ vec rigid_velocity(const struct zones *s,
                                     const struct zone *z, int32_t i)
{
    vec half = scale(R(0.5) * s->dt, z->spin);
    vec rotation = cross(z->spin, arm_of(s, z, i));
    rotation = add(rotation, cross(half, rotation));
    return axpy(z->velocity, 1 / (1 + dot(half, half)), rotation);
}

/* Block b owns zone b: its part of `sum`, and u of its free vertices, which are
 * in no other zone. Each thread keeps a copy of the zone's motion. */
KERNEL zones_move_kernel(const struct zones &s, const struct key *member,
                         const int64_t *words)
{
    __shared__ int prescribed;
    int64_t b = blockIdx.x, t = threadIdx.x;
    struct zone z;
    z.first = s.zone[b].first;
    z.end =
        b + 1 < words[MEMBERS_ZONES] ? s.zone[b + 1].first : words[MEMBERS_ALL];
    int64_t n = z.end - z.first;
    const struct key *own = member + z.first;
    struct zone_sum *sum = s.sum + z.first;
    prescribed = 0;
    __syncthreads();
    for (int64_t k = t; k < n; k += ZONE_BLOCK)
        if (!(s.w[own[k].lo] > 0))
            prescribed = 1;
    __syncthreads();
    z.prescribed = prescribed != 0;
    z.base = s.x0[own[0].lo];
    for (int64_t k = t; k < n; k += ZONE_BLOCK)
        sum[k] = linear_part(&s, &z, (int32_t)own[k].lo);
    sum_members(sum, n);
    real m = sum[0].m;
    z.centre = scale(1 / m, sum[0].a);
    z.velocity = scale(1 / m, sum[0].b);
    __syncthreads(); /* all have read sum[0] before it is written again */
    for (int64_t k = t; k < n; k += ZONE_BLOCK)
        sum[k] = angular_part(&s, &z, (int32_t)own[k].lo);
    sum_members(sum, n);
    z.spin = limit_spin(spin_of(sum[0].i, sum[0].a), s.dt);
    for (int64_t k = t; k < n; k += ZONE_BLOCK) {
        int32_t i = (int32_t)own[k].lo;
        if (s.w[i] > 0)
            s.u[i] = rigid_velocity(&s, &z, i);
    }
}

int gpu_zones(struct gpu *g, struct zones *s)
{
    if (!(s->dt > 0 && s->dt <= REAL_BIG) || s->n4 != 4 * s->n ||
        s->n4 > INT32_MAX)
        return DRAPE_EARG;
    int64_t *words = gpu_words(g);
    const struct key *member = gpu_members(g, s, words);
    const int64_t *seen = gpu_read_back_keep(g, MEMBERS_WORDS);
    if (seen[MEMBERS_BAD])
        return DRAPE_EARG;
    s->found = seen[MEMBERS_ZONES];
    s->vertices = seen[MEMBERS_FREE];
    LAUNCH_BLOCKS(g, s->found, ZONE_BLOCK, zones_move_kernel, *s, member,
                  words);
    return gpu_status(g);
}
