/* SPDX-License-Identifier: Apache-2.0 */
/* The elastic energy of the odd cells and the stars of a panel, summed by the
 * tree of sum.md. spec/panel/tension.md */
#include "gpu/panel/tension.cuh"

#include "gpu/base/sum.cuh"
#include "gpu/panel/cell.cuh"

/* §1: the energy of the fibres of odd cell k. */
static __device__ real fibre_energy(const struct tension *s, int64_t k)
{
    struct beyond d = beyond_of(s->x, s->corner[k]);
    real e = 0;
    for (int f = 0; f < FIBRES; f++) {
        const struct fibre *a = &s->fibre[k][f];
        if (a->weight > 0)
            e += a->weight * spring_energy(&s->law[law_at(f)], s->piece,
                                           length(form_at(a, &d)));
    }
    return e;
}

/* §1: the energy of form k of the stars. */
static __device__ real star_energy(const struct tension *s, int64_t k)
{
    const struct star *a = &s->star[k];
    vec t = make(0, 0, 0), middle = s->x[a->at[0]];
    UNROLL
    for (int e = 0; e < 4; e++)
        t = axpy(t, a->c[e], sub(s->x[a->at[e + 1]], middle));
    return R(0.5) * a->k * dot(t, t);
}

/* Block k owns chunk k of the items, which are the odd cells, then the stars,
 * and has a thread for each. The block that ends last adds the sum to the real
 * at `word`; `ticket` counts the blocks that have ended. */
KERNEL tension_kernel(const struct tension &s, int64_t *word, int64_t *ticket)
{
    int64_t k = (int64_t)blockIdx.x * SUM_CHUNK + threadIdx.x;
    real value = 0, sum;
    if (k < s.n_cells)
        value = fibre_energy(&s, k);
    else if (k < s.n_cells + s.n_stars)
        value = star_energy(&s, k - s.n_cells);
    if (grid_sums<1>(&value, s.chunk, (unsigned *)ticket, &sum) &&
        threadIdx.x == 0)
        *(real *)word += sum;
}

void gpu_tension_into(struct gpu *g, const struct tension *s, int64_t *word,
                      int64_t *ticket)
{
    LAUNCH_BLOCKS(g, s->n_chunks, SUM_CHUNK, tension_kernel, *s, word, ticket);
}

int gpu_tension(struct gpu *g, struct tension *s)
{
    int64_t *word = gpu_words(g);
    gpu_tension_into(g, s, word, word + 1);
    memcpy(&s->value, gpu_read_back(g, 1), sizeof s->value);
    return gpu_status(g);
}
