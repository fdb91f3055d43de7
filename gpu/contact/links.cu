/* SPDX-License-Identifier: Apache-2.0 */
/* Stage links on the device: the contacts' own matrix times a vector.
 * spec/contact/coulomb.md §3 */
#include "gpu/contact/contact.cuh"
#include "gpu/contact/links.cuh"

/* Blocks of the push kernel for each multiprocessor. */
enum { PUSH_BLOCKS = 8 };

static __device__ inline bool idle(const int32_t *go)
{
    return go && !*go;
}

/* A thread owns every (threads of the grid)-th contact: reads x of its four
 * vertices and writes its push. */
KERNEL links_push_kernel(const struct linked *l, const vec *x,
                         const int32_t *go)
{
    if (idle(go))
        return;
    const struct links *s = &l->s;
    int64_t threads = (int64_t)gridDim.x * blockDim.x;
    for (int64_t k = (int64_t)blockIdx.x * blockDim.x + threadIdx.x; k < s->n;
         k += threads) {
        const struct contact *c = &s->contact[k];
        if (c->coupling != CONTACT_MUTUAL)
            continue;
        vec v = pair_sum(c, x), n = c->n, way = c->way;
        real a = c->stiffness_n, b = c->stiffness_t;
        vec y = axpy(scale(b, v), (a - b) * dot(n, v), n);
        s->push[k] = axpy(y, -b * dot(way, v), way);
    }
}

/* Thread i owns vertex i. */
KERNEL links_gather_kernel(const struct linked *l, int64_t nv, vec *y,
                           const int32_t *go)
{
    if (!idle(go))
        gather_links(l, nv, y);
}

void gpu_links_push(struct gpu *g, const struct linked *links, const vec *x,
                    const int32_t *go)
{
    LAUNCH(g, (int64_t)PUSH_BLOCKS * g->multiprocessors * g->block,
           links_push_kernel, links, x, go);
}

void gpu_links_queue(struct gpu *g, const struct linked *links, int64_t nv,
                     const vec *x, vec *y, const int32_t *go)
{
    gpu_links_push(g, links, x, go);
    LAUNCH_LISTS(g, nv, links_gather_kernel, links, nv, y, go);
}

/* One thread keeps the struct where the kernels read it. */
KERNEL links_keep_kernel(struct linked *to, const struct linked &s)
{
    *to = s;
}

/* False where the contact of an item is not mutual. */
static __device__ inline bool find_mutual(const struct linked *l, int32_t item,
                                          struct mutual *m)
{
    const struct contact *c = &l->s.contact[item / 4];
    *m = {item / 4, c->c[item % 4]};
    return c->coupling == CONTACT_MUTUAL;
}

/* Copies the mutual items of places [from, end) to the places from `from` on.
 * Returns where they end. */
static __device__ int32_t list_by_thread(const struct linked *l, int32_t from,
                                         int32_t end)
{
    int32_t to = from;
    for (int32_t at = from; at < end; at += LIST_AHEAD) {
        int32_t item[LIST_AHEAD];
        struct mutual m[LIST_AHEAD];
        bool good[LIST_AHEAD];
        UNROLL
        for (int k = 0; k < LIST_AHEAD; k++)
            item[k] = l->s.item[at + k < end ? at + k : at];
        UNROLL
        for (int k = 0; k < LIST_AHEAD; k++)
            good[k] = find_mutual(l, item[k], &m[k]) && at + k < end;
        UNROLL
        for (int k = 0; k < LIST_AHEAD; k++)
            if (good[k])
                l->item[to++] = m[k];
    }
    return to;
}

/* The same by all lanes of a warp, which must call it with the same arguments.
 */
static __device__ int32_t list_by_warp(const struct linked *l, int32_t from,
                                       int32_t end)
{
    int lane = (int)threadIdx.x % WARP;
    int32_t to = from;
    for (int32_t row = from; row < end; row += WARP) {
        int32_t item = l->s.item[row + lane < end ? row + lane : row];
        struct mutual m;
        bool good = find_mutual(l, item, &m) && row + lane < end;
        int upto = good; /* how many of this lane and those below it */
        UNROLL
        for (int h = 1; h < WARP; h *= 2) {
            int below = __shfl_up_sync(0xffffffffu, upto, h);
            upto += lane >= h ? below : 0;
        }
        if (good)
            l->item[to + upto - 1] = m;
        to += lane_value(upto, WARP - 1);
    }
    return to;
}

/* Thread i owns vertex i and makes its list; a warp makes the long lists of its
 * vertices together. */
KERNEL links_list_kernel(const struct linked *l, int64_t nv)
{
    int64_t i = own_list(nv);
    int32_t from = i < 0 ? 0 : l->s.start[i],
            end = i < 0 ? 0 : l->s.start[i + 1];
    bool longer = end - from > WARP;
    int32_t past = longer ? from : list_by_thread(l, from, end);
    for (int k = 0; k < WARP; k++) {
        if (!lane_value((int)longer, k))
            continue;
        int32_t to = list_by_warp(l, lane_value(from, k), lane_value(end, k));
        past = k == (int)threadIdx.x % WARP ? to : past;
    }
    if (i >= 0)
        l->end[i] = past;
}

void gpu_links_keep(struct gpu *g, const struct links *s, int64_t nv,
                    struct linked *to, int32_t *end, struct mutual *item)
{
    LAUNCH(g, 1, links_keep_kernel, to, linked{*s, end, item});
    LAUNCH_LISTS(g, nv, links_list_kernel, to, nv);
}

int gpu_links(struct gpu *g, struct links *s)
{
    if (s->nv1 != s->nv + 1 || s->n4 != 4 * s->n || s->n4 > INT32_MAX)
        return DRAPE_EARG;
    struct linked *keep =
        (struct linked *)gpu_scratch(g, SLOT_STAGE, 1, sizeof *keep);
    int32_t *end =
        (int32_t *)gpu_scratch(g, SLOT_STAGE + 1, s->nv, sizeof *end);
    struct mutual *item =
        (struct mutual *)gpu_scratch(g, SLOT_STAGE + 2, s->n4, sizeof *item);
    gpu_links_keep(g, s, s->nv, keep, end, item);
    gpu_links_queue(g, keep, s->nv, s->x, s->y, NULL);
    return gpu_status(g);
}
