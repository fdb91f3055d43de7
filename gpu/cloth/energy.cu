/* SPDX-License-Identifier: Apache-2.0 */
/* Energies, each summed by the tree of sum.md. spec/cloth/energy.md */
#include "gpu/cloth/energy.cuh"

#include "gpu/base/sum.cuh"
#include "gpu/cloth/cloth.cuh"

enum { KINDS = 3 };

/* §1: the elastic energy of the forward springs of p. So each spring counts
 * once. */
static __device__ real stretch_energy(const struct energy *s, int p)
{
    real e = 0;
    int mask = s->springs[p], cells = s->triples ? s->beside[p] : 0;
    vec here = s->x[p];
    UNROLL
    for (int o = 0; o < SPRINGS; o++) {
        if (!(mask >> o & 1) || (s->triples && o >= SPRINGS_SINGLE))
            continue;
        int q = p + forward_i(o) + forward_j(o) * s->m;
        real l = length(sub(s->x[q], here));
        real one = spring_energy(&s->law[o], s->piece, l);
        e += s->triples ? spring_fraction(o, cells) * one : one;
    }
    return e;
}

/* §1: the energy of the triples that have their middle at p. */
static __device__ real bend_energy(const struct energy *s, int p)
{
    real e = 0;
    UNROLL
    for (int o = 0; o < SPRINGS_SINGLE; o++) {
        real k = s->triple[CELL_MASKS * o + s->beside[p]];
        int step = forward_i(o) + forward_j(o) * s->m;
        if (!(k > 0))
            continue;
        vec t = triple_at(s->x[p - step], s->x[p], s->x[p + step]);
        e += R(0.5) * k * dot(t, t);
    }
    return e;
}

static __device__ real elastic_energy(const struct energy *s, int p)
{
    real e = stretch_energy(s, p);
    return s->triples ? e + bend_energy(s, p) : e;
}

/* Block k owns chunk k, one thread for each particle. The block that ends last
 * writes the three sums over all chunks to word[0 … 2]; word[KINDS] counts the
 * blocks that have ended. */
KERNEL energy_kernel(const struct energy &a, int64_t *word)
{
    int p = (int)blockIdx.x * SUM_CHUNK + (int)threadIdx.x;
    real value[KINDS] = {0, 0, 0}, sum[KINDS];
    if (p < a.count) {
        real m = a.mass[p];
        vec v = a.v[p];
        value[0] = R(0.5) * m * dot(v, v);
        value[1] = elastic_energy(&a, p);
        value[2] = -m * dot(a.gravity, a.x[p]);
    }
    if (!grid_sums<KINDS>(value, a.chunk, (unsigned *)(word + KINDS), sum))
        return;
    if (threadIdx.x == 0)
        for (int e = 0; e < KINDS; e++)
            *(real *)(word + e) = sum[e];
}

void gpu_energy_into(struct gpu *g, const struct energy *s, int64_t *word)
{
    LAUNCH_BLOCKS(g, s->n_chunks, SUM_CHUNK, energy_kernel, *s, word);
}

int gpu_energy(struct gpu *g, struct energy *s)
{
    gpu_energy_into(g, s, gpu_words(g));
    const int64_t *word = gpu_read_back(g, KINDS);
    for (int e = 0; e < KINDS; e++)
        memcpy(&s->value[e], word + e, sizeof *s->value);
    return gpu_status(g);
}
