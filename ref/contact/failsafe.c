/* SPDX-License-Identifier: Apache-2.0 */
/* Zones and rollback as rounds of a step, on either backend.
 * spec/contact/response.md §5 and §6 */
#include "ref/contact/rounds.h"

#include "ref/contact/rollback.h"
#include "ref/contact/zones.h"

/* §5. Adds the hits to the pairs of the rounds before. */
static int add_tangled(struct response *s)
{
    struct pool *from = &s->tangle[s->tangle_side];
    struct pool *to = &s->tangle[!s->tangle_side];
    int64_t n = s->tangled + s->hits;
    struct pool_need pool_need = {to, 4 * n, sizeof(int32_t)};
    int status = response_grow(s, 1, &pool_need);
    if (status != DRAPE_OK)
        return status;
    int32_t *pair = to->data;
    size_t bytes = 4 * sizeof *pair;
    s->run->copy(s->on, pair, from->data, (size_t)s->tangled * bytes);
    s->run->copy(s->on, pair + 4 * s->tangled, s->hit.data,
                 (size_t)s->hits * bytes);
    s->tangled = n;
    s->tangle_side = !s->tangle_side;
    return DRAPE_OK;
}

static int grow_zones(struct response *s, int64_t n)
{
    struct pool_need pool_need[] = {{&s->key[0], 4 * n, sizeof(struct key)},
                                    {&s->key[1], 4 * n, sizeof(struct key)},
                                    {&s->sum, 4 * n, sizeof(struct zone_sum)},
                                    {&s->zone, n, sizeof(struct zone)},
                                    {&s->vertex, 4 * n, sizeof(int32_t)}};
    return response_grow(s, 5, pool_need);
}

int failsafe_zones(struct response *s)
{
    int status = add_tangled(s);
    if (status == DRAPE_OK)
        status = grow_zones(s, s->tangled);
    if (status != DRAPE_OK)
        return status;
    struct zones z = {.nv = s->nv,
                      .n = s->tangled,
                      .w = s->w,
                      .x0 = s->x0,
                      .pair = s->tangle[s->tangle_side].data,
                      .dt = s->dt,
                      .u = s->u,
                      .n4 = 4 * s->tangled,
                      .label = s->start,
                      .key = s->key[0].data,
                      .spare = s->key[1].data,
                      .sum = s->sum.data,
                      .zone = s->zone.data,
                      .vertex = s->vertex.data};
    status = s->run->zones(s->on, &z);
    s->run->trace(s->on, s->trace, "zones", s->u, (size_t)s->nv * sizeof *s->u);
    if (status != DRAPE_OK)
        return status;
    s->outcome |= DRAPE_ZONES;
    s->zone_vertices = z.vertices;
    s->run->rounds_advance(s->on, s, z.vertices, z.vertex, NULL, true);
    return DRAPE_OK;
}

int failsafe_rollback(struct response *s, int round)
{
    struct rollback r = {.nv = s->nv,
                         .n = s->hits,
                         .pair = s->hit.data,
                         .w = s->w,
                         .x0 = s->x0,
                         .x1 = s->x1,
                         .u = s->u,
                         .v = s->v,
                         .rolled = s->rolled,
                         .touched = s->touched,
                         .all = round >= s->roll_rounds};
    int status = s->run->rollback(s->on, &r);
    s->run->trace(s->on, s->trace, "rollback", s->rolled, (size_t)s->nv);
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
