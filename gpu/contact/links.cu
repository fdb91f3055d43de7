/* SPDX-License-Identifier: Apache-2.0 */
/* Stage links on the device: the contacts' own matrix times a vector.
 * spec/contact/penalty.md §3 */
#include "gpu/contact/links.cuh"
#include "gpu/contact/lists.cuh"

/* Blocks of the push kernel for each multiprocessor. */
enum { PUSH_BLOCKS = 8 };

static __device__ inline bool idle(const int32_t *go)
{
    return go && !*go;
}

/* A thread owns every (threads of the grid)-th contact: reads x of its four
 * vertices and writes its push. */
static __global__ void __launch_bounds__(GPU_BLOCK)
    links_push_kernel(const struct links *s, const vec *x, const int32_t *go)
{
    if (idle(go))
        return;
    int64_t threads = (int64_t)gridDim.x * blockDim.x;
    for (int64_t k = (int64_t)blockIdx.x * blockDim.x + threadIdx.x; k < s->n;
         k += threads) {
        const struct contact *c = &s->contact[k];
        vec push = make(0, 0, 0);
        if (c->held == CONTACT_MUTUAL) {
            vec v = pair_sum(c, x), n = c->n;
            real a = s->along, b = c->slide * s->across;
            push = axpy(scale(b, v), (a - b) * dot(n, v), n);
        }
        s->push[k] = push;
    }
}

/* The pushes of the items of a vertex, which add to y. */
struct links_list {
    const struct links *s;
    const int32_t *start;
    vec *y;
    __device__ vec value(int32_t at) const
    {
        int32_t item = s->item[at];
        return scale(s->contact[item / 4].c[item % 4], s->push[item / 4]);
    }
    __device__ vec first(int64_t i) const { return y[i]; }
    __device__ void done(int64_t i, vec sum) const { y[i] = sum; }
};

/* Thread i owns vertex i: adds the pushes of its items to y[i], in the order of
 * its list. */
static __global__ void __launch_bounds__(LIST_BLOCK)
    links_gather_kernel(const struct links *s, int64_t nv, vec *y,
                        const int32_t *go)
{
    if (idle(go))
        return;
    struct links_list list = {s, s->start, y};
    int64_t i = own_list(nv);
    if (i >= 0 && list.start[i] == list.start[i + 1])
        i = -1;
    sum_list(list, i);
}

void gpu_links_queue(struct gpu *g, const struct links *links, int64_t nv,
                     const vec *x, vec *y, const int32_t *go)
{
    LAUNCH(g, (int64_t)PUSH_BLOCKS * g->multiprocessors * g->block,
           links_push_kernel, links, x, go);
    LAUNCH_LISTS(g, nv, links_gather_kernel, links, nv, y, go);
}

/* One thread keeps the struct where the kernels read it. */
static __global__ void links_keep_kernel(struct links *to, struct links s)
{
    *to = s;
}

int gpu_links(struct gpu *g, struct links *s)
{
    if (s->nv1 != s->nv + 1 || s->n4 != 4 * s->n || s->n4 > INT32_MAX)
        return DRAPE_EARG;
    struct links *keep =
        (struct links *)gpu_scratch(g, SLOT_STAGE, 1, sizeof *keep);
    LAUNCH(g, 1, links_keep_kernel, keep, *s);
    gpu_links_queue(g, keep, s->nv, s->x, s->y, NULL);
    return gpu_status(g);
}
