/* SPDX-License-Identifier: Apache-2.0 */
/* Zones and rollback as rounds of a step, on the device.
 * spec/contact/response.md §5 and §6 */
#include "gpu/contact/response.cuh"
#include "gpu/run/gpu.cuh"

/* ---- §5 Zones ---- */

/* Adds the hits to the pairs of the rounds before. */
static int tangle(struct gpu *g, struct response *s)
{
    struct pool *from = &s->tangle[s->tangle_side];
    struct pool *to = &s->tangle[!s->tangle_side];
    size_t pair = 4 * sizeof(int32_t), old = (size_t)s->tangled * pair;
    struct room room = {to, 4 * (s->tangled + s->hits), sizeof(int32_t)};
    int status = gpu_response_grow(g, 1, &room);
    if (status != DRAPE_OK)
        return status;
    gpu_copy(g, to->data, from->data, old);
    gpu_copy(g, (char *)to->data + old, s->hit.data, (size_t)s->hits * pair);
    s->tangled += s->hits;
    s->tangle_side = !s->tangle_side;
    return DRAPE_OK;
}

static int grow_zones(struct gpu *g, struct response *s, int64_t n)
{
    struct room room[] = {{&s->key[0], 4 * n, sizeof(struct key)},
                          {&s->key[1], 4 * n, sizeof(struct key)},
                          {&s->sum, 4 * n, sizeof(struct zone_sum)},
                          {&s->zone, n, sizeof(struct zone)},
                          {&s->vertex, 4 * n, sizeof(int32_t)}};
    return gpu_response_grow(g, 5, room);
}

int gpu_response_stiffen(struct gpu *g, struct response *s)
{
    struct zones z = {};
    int status = tangle(g, s);
    if (status == DRAPE_OK)
        status = grow_zones(g, s, s->tangled);
    if (status != DRAPE_OK)
        return status;
    z.nv = s->nv;
    z.n = s->tangled;
    z.w = s->w;
    z.x0 = s->x0;
    z.pair = (int32_t *)s->tangle[s->tangle_side].data;
    z.dt = s->dt;
    z.u = s->u;
    z.n4 = 4 * s->tangled;
    z.label = s->start;
    z.key = (struct key *)s->key[0].data;
    z.spare = (struct key *)s->key[1].data;
    z.sum = (struct zone_sum *)s->sum.data;
    z.zone = (struct zone *)s->zone.data;
    z.vertex = (int32_t *)s->vertex.data;
    status = gpu_zones(g, &z);
    gpu_trace(g, s->trace, "zones", s->u, (size_t)s->nv * sizeof *s->u);
    if (status != DRAPE_OK)
        return status;
    s->outcome |= DRAPE_ZONES;
    s->zone_vertices = z.vertices;
    gpu_response_advance(g, s, z.vertices, z.vertex, NULL, true);
    return DRAPE_OK;
}

/* ---- §6 Rollback ---- */

int gpu_response_roll(struct gpu *g, struct response *s, int round)
{
    struct rollback r = {};
    r.nv = s->nv;
    r.n = s->hits;
    r.pair = (int32_t *)s->hit.data;
    r.w = s->w;
    r.x0 = s->x0;
    r.x1 = s->x1;
    r.u = s->u;
    r.v = s->v;
    r.rolled = s->rolled;
    r.touched = s->touched;
    r.all = round >= s->roll_rounds;
    int status = gpu_rollback(g, &r);
    gpu_trace(g, s->trace, "rollback", s->rolled, (size_t)s->nv);
    if (status != DRAPE_OK)
        return status;
    s->rolled_back += r.grown;
    if (r.grown)
        s->outcome |= DRAPE_ROLLBACK;
    if (r.trapped)
        s->outcome |= DRAPE_TRAPPED;
    s->hits = r.grown;
    return DRAPE_OK;
}
