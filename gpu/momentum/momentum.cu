/* SPDX-License-Identifier: Apache-2.0 */
/* Sums mass and momentum, finds what touches, and rotates bodies.
 * spec/momentum/momentum.md */
#include "gpu/base/sum.cuh"
#include "gpu/base/unite.cuh"

extern "C" {
#include "ref/momentum/momentum.h"
}

/* Words of moments: its sums, then `at` and `speed`, and the ticket of
 * ends_last. PART: the sums are made in parts, as those of a block must fit
 * into shared memory; the last part is smaller. */
enum { AT = MOMENTS, TICKET = MOMENTS + 6, PART = 6, REST = MOMENTS % PART };

static __device__ void put_vector(real item[3], vec a)
{
    item[0] = a.x;
    item[1] = a.y;
    item[2] = a.z;
}

/* §1: the items of particle p. */
static __device__ void find_items(const struct moments &s, int64_t p,
                                  real item[MOMENTS])
{
    real m = s.w[p] > 0 ? 1 / s.w[p] : 0;
    vec d = sub(s.x[p], s.x[s.count / 2]), e = sub(s.v[p], s.v[s.count / 2]);
    vec md = scale(m, d);
    item[MOMENT_MASS] = m;
    put_vector(item + MOMENT_PLACE, md);
    put_vector(item + MOMENT_SPEED, scale(m, e));
    put_vector(item + MOMENT_SPIN, cross(md, e));
    put_vector(item + MOMENT_SPREAD, scale(md.x, d));
    put_vector(item + MOMENT_SPREAD + 3,
               make(md.y * d.y, md.y * d.z, md.z * d.z));
    item[MOMENT_SQUARE] = m * dot(e, e);
}

/* Block k owns chunk k, one thread for each particle; the block that ends last
 * writes the words. */
KERNEL moments_kernel(const struct moments &s, int64_t *word)
{
    int64_t p = (int64_t)blockIdx.x * SUM_CHUNK + threadIdx.x;
    real item[MOMENTS] = {0}, sum[MOMENTS], origin[6];
    if (p < s.count)
        find_items(s, p, item);
    int e = 0;
    for (; e + PART <= MOMENTS; e += PART)
        put_sums<PART>(item + e, s.n_chunks, blockIdx.x,
                       s.chunk + e * s.n_chunks);
    put_sums<REST>(item + e, s.n_chunks, blockIdx.x, s.chunk + e * s.n_chunks);
    if (!ends_last((unsigned *)(word + TICKET), s.n_chunks))
        return;
    for (e = 0; e + PART <= MOMENTS; e += PART) {
        finish_sums<PART>(s.n_chunks, s.chunk + e * s.n_chunks, sum + e);
        __syncthreads(); /* before the next part overwrites what they share */
    }
    finish_sums<REST>(s.n_chunks, s.chunk + e * s.n_chunks, sum + e);
    put_vector(origin, s.x[s.count / 2]);
    put_vector(origin + 3, s.v[s.count / 2]);
    for (e = 0; e < MOMENTS + 6 && threadIdx.x == 0; e++)
        *(real *)(word + e) = e < AT ? sum[e] : origin[e - AT];
}

int gpu_moments(struct gpu *g, struct moments *s)
{
    LAUNCH_BLOCKS(g, s->n_chunks, SUM_CHUNK, moments_kernel, *s, gpu_words(g));
    const int64_t *word = gpu_read_back(g, TICKET);
    for (int e = 0; e < MOMENTS; e++)
        memcpy(&s->value[e], word + e, sizeof *s->value);
    for (int e = 0; e < 3; e++) {
        memcpy(&s->at.x + e, word + AT + e, sizeof s->at.x);
        memcpy(&s->speed.x + e, word + AT + 3 + e, sizeof s->speed.x);
    }
    return gpu_status(g);
}

/* Thread k owns body k: its label is the body itself. */
KERNEL islands_label_kernel(const struct islands &s)
{
    ITEM(k, s.bodies);
    s.label[k] = (int32_t)k;
}

/* Thread k owns contact k and joins the islands of its two bodies. *bad: the
 * contact has a vertex that is not there. */
KERNEL islands_unite_kernel(const struct islands &s, int64_t *bad)
{
    ITEM(k, s.n);
    const struct contact *c = &s.contact[k];
    bool good = true;
    for (int j = 0; j < 4; j++)
        good = good && c->v[j] >= 0 && c->v[j] < s.nv;
    int32_t a = good ? s.body[c->v[0]] : 0, b = good ? s.body[c->v[3]] : 0;
    if (!good)
        *bad = 1; /* all threads that write, write the same */
    else if (a != b && a < s.bodies && b < s.bodies)
        unite(s.label, a, b);
}

/* Thread k owns body k and writes its root. Other threads shorten the same ways
 * meanwhile. */
KERNEL islands_root_kernel(const struct islands &s)
{
    ITEM(k, s.bodies);
    volatile int32_t *label = s.label;
    int32_t at = (int32_t)k;
    while (label[at] != at)
        at = label[at];
    label[k] = at;
}

int gpu_islands(struct gpu *g, struct islands *s)
{
    int64_t *bad = gpu_words(g);
    LAUNCH(g, s->bodies, islands_label_kernel, *s);
    LAUNCH(g, s->n, islands_unite_kernel, *s, bad);
    LAUNCH(g, s->bodies, islands_root_kernel, *s);
    return gpu_read_back(g, 1)[0] ? DRAPE_EARG : gpu_status(g);
}

/* Thread p owns particle p and writes to[p]. */
KERNEL spin_kernel(const struct spin &s)
{
    ITEM(p, s.count);
    vec rotation = cross(s.dw, sub(s.x[p], s.centre));
    vec to = add(scale(s.keep, s.v[p]), add(s.dv, rotation));
    s.to[p] = s.w[p] > 0 ? to : s.v[p];
}

int gpu_spin(struct gpu *g, struct spin *s)
{
    LAUNCH(g, s->count, spin_kernel, *s);
    return gpu_status(g);
}
