/* SPDX-License-Identifier: Apache-2.0 */
/* Detection as a part of a round, on the device. spec/contact/response.md §3 */
#include "gpu/contact/response.cuh"
#include "gpu/run/tape.cuh"

static int find_times(struct gpu *g, struct response *s, const struct pairs *p)
{
    struct narrow n = {};
    int64_t most = gpu_room(g, p->n);
    struct room room[] = {{&s->toi, most, sizeof *n.toi},
                          {&s->tier, most, sizeof *n.tier},
                          {&s->at, most, sizeof(int32_t)}};
    int status = gpu_response_grow(g, 3, room);
    if (status != DRAPE_OK)
        return status;
    n.n = p->n;
    n.pair = p->pair;
    n.kind = p->kind;
    n.x0 = s->x0;
    n.x1 = s->x1;
    n.nv = s->nv;
    n.toi = (uint32_t *)s->toi.data;
    n.tier = (uint8_t *)s->tier.data;
    s->candidates += p->n;
    s->narrow++;
    status = gpu_narrow(g, &n);
    gpu_trace(g, s->trace, "narrow", n.toi, (size_t)n.n * sizeof *n.toi);
    return status;
}

static int grow_hits(struct gpu *g, struct response *s, int64_t n)
{
    struct room room[] = {{&s->hit, 4 * n, sizeof(int32_t)},
                          {&s->hit_kind, n, sizeof(uint8_t)},
                          {&s->hit_toi, n, sizeof(uint32_t)}};
    return gpu_response_grow(g, 3, room);
}

static int64_t hits_cap(const struct response *s)
{
    int64_t cap = s->hit.cap / 4;
    if (s->hit_kind.cap < cap)
        cap = s->hit_kind.cap;
    return s->hit_toi.cap < cap ? s->hit_toi.cap : cap;
}

int gpu_response_detect(struct gpu *g, struct response *s,
                        const uint8_t *touched)
{
    struct pairs p;
    struct impacts m = {};
    int status = s->broad(s->user, touched, &p);
    s->hits = 0;
    if (status != DRAPE_OK || !p.n)
        return status;
    s->later += touched ? p.n : 0;
    status = find_times(g, s, &p);
    if (status != DRAPE_OK)
        return status;
    m.nv = s->nv;
    m.n = p.n;
    m.pair = p.pair;
    m.kind = p.kind;
    m.toi = (uint32_t *)s->toi.data;
    m.x0 = s->x0;
    m.w = s->w;
    m.at = (int32_t *)s->at.data;
    do {
        m.cap = hits_cap(s);
        m.hit = (int32_t *)s->hit.data;
        m.hit_kind = (uint8_t *)s->hit_kind.data;
        m.hit_toi = (uint32_t *)s->hit_toi.data;
        status = gpu_impacts(g, &m);
    } while (status == DRAPE_EFULL &&
             (status = grow_hits(g, s, m.found)) == DRAPE_OK);
    s->hits = m.found;
    if (status == DRAPE_OK)
        gpu_trace(g, s->trace, "impacts", m.hit,
                  (size_t)m.found * 4 * sizeof *m.hit);
    s->impacts += m.found;
    if (!touched) {
        s->started = m.started;
        s->led = m.led;
    }
    return status;
}
