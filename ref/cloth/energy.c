/* SPDX-License-Identifier: Apache-2.0 */
/* Energies, each summed by the tree of sum.md. spec/cloth/energy.md */
#include "ref/cloth/energy.h"

#include "ref/base/sum.h"
#include "ref/cloth/law.h"
#include "ref/cloth/triple.h"

/* §1: the elastic energy of the forward springs of p. So each spring counts
 * once. */
static real stretch_energy(const struct energy *s, int64_t p)
{
    int springs = s->triples ? SPRINGS_SINGLE : SPRINGS;
    real e = 0;
    for (int o = 0; o < springs; o++) {
        if (!(s->springs[p] >> o & 1))
            continue;
        int64_t q = p + spring_step(s->m, o);
        real length = vec_length(vec_sub(s->x[q], s->x[p]));
        real one = law_energy(&s->law[o], s->piece, length);
        e += s->triples ? spring_fraction(o, s->beside[p]) * one : one;
    }
    return e;
}

/* §1: the energy of the triples that have their middle at p. */
static real bend_energy(const struct energy *s, int64_t p)
{
    real e = 0;
    for (int o = 0; o < SPRINGS_SINGLE; o++) {
        real k = triple_constant(s->triple, o, s->beside[p]);
        int64_t step = spring_step(s->m, o);
        if (!(k > 0))
            continue;
        vec t = triple_of(s->x[p - step], s->x[p], s->x[p + step]);
        e += R(0.5) * k * vec_dot(t, t);
    }
    return e;
}

static real elastic_energy(const struct energy *s, int64_t p)
{
    real e = stretch_energy(s, p);
    return s->triples ? e + bend_energy(s, p) : e;
}

static void sum_chunk(const struct energy *s, int64_t k)
{
    real sums[3][SUM_CHUNK] = {{0}};
    int64_t start = k * SUM_CHUNK, end = start + SUM_CHUNK;
    for (int64_t p = start; p < end && p < s->count; p++) {
        real m = s->mass[p];
        sums[0][p - start] = R(0.5) * m * vec_dot(s->v[p], s->v[p]);
        sums[1][p - start] = elastic_energy(s, p);
        sums[2][p - start] = -m * vec_dot(s->gravity, s->x[p]);
    }
    for (int e = 0; e < 3; e++)
        s->chunk[e * s->n_chunks + k] = sum_tree(sums[e]);
}

int ref_energy(struct energy *s)
{
    EACH_ITEM
    for (int64_t k = 0; k < s->n_chunks; k++)
        sum_chunk(s, k);
    for (int e = 0; e < 3; e++)
        s->value[e] = ref_sum_finish(s->n_chunks, s->chunk + e * s->n_chunks);
    return DRAPE_OK;
}
