/* SPDX-License-Identifier: Apache-2.0 */
/* Energies, each summed by the tree of 10_sum.md. spec/08_energy.md */
#include "gpu/energy.cuh"

#include "gpu/cloth.cuh"

enum { KINDS = 3 };

/* §1: of the forward springs, so that each counts once. */
static __device__ real elastic(const struct energy *s, int p)
{
    real e = 0;
    int mask = s->springs[p];
    vec here = s->x[p];
    UNROLL
    for (int o = 0; o < SPRINGS; o++)
        if (mask >> o & 1) {
            int q = p + forward_i(o) + forward_j(o) * s->m;
            e += spring_energy(&s->law[o], length(sub(s->x[q], here)));
        }
    return e;
}

/* The sums of KINDS values of each thread of a block of SUM_CHUNK, halving
 * strides: thread 0 finds them in s[…][0]. */
static __device__ void sum_kinds(real (*s)[SUM_CHUNK], int t)
{
    __syncthreads();
    for (int h = SUM_CHUNK / 2; h > 0; h /= 2) {
        if (t < h)
            for (int e = 0; e < KINDS; e++)
                s[e][t] += s[e][t + h];
        __syncthreads();
    }
}

/* Block k owns chunk k: a thread a particle; writes chunk[e·n_chunks + k]. */
static __global__ void __launch_bounds__(SUM_CHUNK)
    energy_kernel(struct energy a)
{
    __shared__ real s[KINDS][SUM_CHUNK];
    int t = (int)threadIdx.x, p = (int)blockIdx.x * SUM_CHUNK + t;
    real kinetic = 0, spring = 0, height = 0;
    if (p < a.count) {
        real m = a.mass[p];
        vec v = a.v[p];
        kinetic = R(0.5) * m * dot(v, v);
        spring = elastic(&a, p);
        height = -m * dot(a.gravity, a.x[p]);
    }
    s[0][t] = kinetic;
    s[1][t] = spring;
    s[2][t] = height;
    sum_kinds(s, t);
    if (t < KINDS)
        a.chunk[t * a.n_chunks + blockIdx.x] = s[t][0];
}

/* Block e owns energy e: its chunk sums level after level, each in place. A
 * chunk of the next level reads items that no chunk before it writes. */
static __global__ void __launch_bounds__(SUM_CHUNK)
    energy_finish_kernel(struct energy a, int64_t *word)
{
    __shared__ real s[SUM_CHUNK];
    int t = (int)threadIdx.x;
    real *chunk = a.chunk + blockIdx.x * a.n_chunks;
    for (int64_t left = a.n_chunks, more; left > 1; left = more) {
        more = (left + SUM_CHUNK - 1) / SUM_CHUNK;
        for (int64_t k = 0; k < more; k++) {
            int64_t item = SUM_CHUNK * k + t;
            s[t] = item < left ? chunk[item] : 0;
            __syncthreads();
            for (int h = SUM_CHUNK / 2; h > 0; h /= 2) {
                if (t < h)
                    s[t] += s[t + h];
                __syncthreads();
            }
            if (t == 0)
                chunk[k] = s[0];
        }
        __syncthreads();
    }
    if (t == 0)
        *(real *)(word + blockIdx.x) = a.n_chunks ? chunk[0] : 0;
}

void gpu_energy_into(struct gpu *g, const struct energy *s, int64_t *word)
{
    LAUNCH_BLOCKS(g, s->n_chunks, SUM_CHUNK, energy_kernel, *s);
    LAUNCH_BLOCKS(g, KINDS, SUM_CHUNK, energy_finish_kernel, *s, word);
}

int gpu_energy(struct gpu *g, struct energy *s)
{
    gpu_energy_into(g, s, gpu_words(g));
    const int64_t *word = gpu_read_words(g, KINDS);
    for (int e = 0; e < KINDS; e++)
        memcpy(&s->value[e], word + e, sizeof *s->value);
    return gpu_status(g);
}
