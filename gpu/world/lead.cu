/* SPDX-License-Identifier: Apache-2.0 */
/* What is led: obstacles and pins. spec/world/step.md §1 */
#include "gpu/base/real.cuh"
#include "gpu/run/gpu.cuh"

/* The frames about t, and how far between them. */
static void find_frame(const struct prop *p, struct gpu_prop *to, double t)
{
    struct kinematics *k = &to->place;
    double at = t / p->frame_dt;
    int last = p->frames - 1, f = 0;
    k->blend = 0;
    if (at >= last)
        f = last;
    else if (at > 0) {
        f = (int)at;
        k->blend = at - f;
    }
    k->rest = to->frame + 3 * k->n * f;
    k->next = k->blend > 0 ? k->rest + 3 * k->n : NULL;
}

/* Thread k owns pin k: writes where its particle ends. */
static __global__ void __launch_bounds__(GPU_BLOCK)
    pins_kernel(int64_t n, const int32_t *pinned, const vec *x, vec *to)
{
    ITEM(k, n);
    to[pinned[k]] = x[k];
}

int gpu_lead(struct gpu_world *w, double t, vec *x)
{
    struct world *h = w->host;
    int status = DRAPE_OK;
    if (!h->plan.led)
        return DRAPE_OK; /* placed once, when the world was made */
    for (int k = 0; k < h->def.n_motions; k++)
        h->pose[k] = kinematics_pose(&h->def.motions[k], t);
    gpu_up(w->gpu, w->pose, h->pose,
           (size_t)h->def.n_motions * sizeof *h->pose);
    for (int k = 0; k < h->def.n_obstacles && status == DRAPE_OK; k++) {
        if (!h->prop[k].moves)
            continue;
        if (h->prop[k].frames)
            find_frame(&h->prop[k], &w->prop[k], t);
        w->prop[k].place.x = x + h->prop[k].first;
        status = gpu_kinematics(w->gpu, &w->prop[k].place);
    }
    for (int k = 0; k < h->def.n_cloths && status == DRAPE_OK; k++) {
        struct gpu_sheet *s = &w->sheet[k];
        if (s->pins.n)
            status = gpu_kinematics(w->gpu, &s->pins);
        LAUNCH(w->gpu, s->pins.n, pins_kernel, s->pins.n, s->pinned, s->pins.x,
               w->to + s->first);
    }
    return status == DRAPE_OK ? gpu_status(w->gpu) : status;
}

static __device__ bool same_bits(const vec *a, const vec *b)
{
    real_bits p[3], q[3];
    memcpy(p, a, sizeof p);
    memcpy(q, b, sizeof q);
    return p[0] == q[0] && p[1] == q[1] && p[2] == q[2];
}

/* Thread k owns obstacle vertex, or pin, k: notes that it moves. */
static __global__ void __launch_bounds__(GPU_BLOCK)
    moves_kernel(int64_t n, const int32_t *at, const vec *x0, const vec *x1,
                 int64_t *moves)
{
    ITEM(k, n);
    if (!same_bits(&x0[at ? at[k] : k], &x1[k]))
        *moves = 1; /* whoever writes, writes the same */
}

bool gpu_lead_moves(struct gpu_world *w)
{
    const struct world *h = w->host;
    if (!h->plan.led)
        return false;
    int64_t *moves = gpu_words(w->gpu);
    LAUNCH(w->gpu, h->nv - h->nc, moves_kernel, h->nv - h->nc, nullptr,
           w->x0 + h->nc, w->x1 + h->nc, moves);
    for (int k = 0; k < h->def.n_cloths; k++) {
        const struct gpu_sheet *s = &w->sheet[k];
        LAUNCH(w->gpu, s->pins.n, moves_kernel, s->pins.n, s->pinned,
               w->x0 + s->first, s->pins.x, moves);
    }
    return gpu_read_words(w->gpu, 1)[0] != 0;
}

/* Thread k owns obstacle vertex k. */
static __global__ void __launch_bounds__(GPU_BLOCK)
    velocities_kernel(int64_t n, const vec *x0, const vec *x1, real dt, vec *v)
{
    ITEM(k, n);
    vec d = sub(x1[k], x0[k]);
    v[k] = make(d.x / dt, d.y / dt, d.z / dt);
}

void gpu_lead_velocities(struct gpu_world *w)
{
    const struct world *h = w->host;
    int64_t n = h->nv - h->nc;
    LAUNCH(w->gpu, n, velocities_kernel, n, w->x0 + h->nc, w->x1 + h->nc,
           (real)h->dt, w->v1 + h->nc);
}
