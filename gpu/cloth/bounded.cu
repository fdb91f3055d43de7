/* SPDX-License-Identifier: Apache-2.0 */
/* Whether a cloth's step went well: sums and searches on the device, one read,
 * the decision on the host. spec/cloth/dynamics.md §3 */
#include "gpu/base/largest.cuh"
#include "gpu/base/real.cuh"
#include "gpu/cloth/energy.cuh"
#include "gpu/cloth/motion.cuh"

extern "C" {
#include "ref/base/sum.h"
#include "ref/cloth/bounded.h"
}

/* The step's small results. */
enum {
    WORD_BEFORE = 0, /* energies: of each the first bytes are a real */
    WORD_AFTER = 4,
    WORD_WILD = 8,  /* 1: a coordinate is not sane */
    WORD_REACH = 9, /* bits of a pin's longest way */
    WORDS = 10
};

/* Thread p owns particle p: reads its new state, and of a pin the way that it
 * went. Any order: a flag that all set alike, and the largest. */
KERNEL sane_kernel(const struct dynamics &d, const struct cloth &c,
                   int64_t *word)
{
    ITEM(p, c.count);
    if (!sane(d.x1[p]) || !sane(d.v1[p]))
        word[WORD_WILD] = 1;
    if (!c.n_pinned || c.fixed[p] != CLOTH_PINNED)
        return;
    note_largest(&word[WORD_REACH], length(sub(d.to[p], d.x[p])));
}

static struct energy energy_at(const struct sheet *s, const vec *x,
                               const vec *v)
{
    const struct cloth *c = &s->cloth;
    struct energy e = {};
    e.count = c->count;
    e.m = c->m;
    e.laws = SPRINGS;
    e.law = s->device->law;
    e.pieces = c->pieces;
    e.piece = s->device->piece;
    e.springs = c->springs;
    e.triples = c->triples;
    e.triple = s->device->triple;
    e.n_beside = c->triples ? c->count : 0;
    e.beside = c->beside;
    e.mass = c->mass;
    e.x = x;
    e.v = v;
    e.gravity = s->dynamics.gravity;
    e.n_chunks = sum_chunks(c->count);
    e.chunk = s->dynamics.chunk;
    return e;
}

/* Queues the three energies of a state: gpu_energy_into. */
static void find_energy(struct gpu *g, const struct sheet *s, const vec *x,
                        const vec *v, int64_t *word)
{
    struct energy e = energy_at(s, x, v);
    gpu_energy_into(g, &e, word);
    if (s->cloth.panel)
        gpu_panel_energy_into(g, s->cloth.panel, &e, word);
}

static double real_of(const int64_t *word)
{
    real value;
    memcpy(&value, word, sizeof value);
    return (double)value;
}

void gpu_motion_energy(struct gpu *g, struct sheet *s, const vec *x,
                       const vec *v, double value[3])
{
    find_energy(g, s, x, v, gpu_words(g));
    const int64_t *seen = gpu_read_back(g, 3);
    for (int k = 0; k < 3; k++)
        value[k] = real_of(seen + k);
}

bool gpu_motion_bounded(struct gpu *g, struct sheet *s)
{
    struct dynamics *d = &s->dynamics;
    int64_t *word = gpu_words(g);
    find_energy(g, s, d->x, d->v, word + WORD_BEFORE);
    find_energy(g, s, d->x1, d->v1, word + WORD_AFTER);
    LAUNCH(g, s->cloth.count, sane_kernel, *d, s->cloth, word);
    const int64_t *seen = gpu_read_back(g, WORDS);
    for (int k = 0; k < 3; k++) {
        d->before[k] = real_of(seen + WORD_BEFORE + k);
        d->energy[k] = real_of(seen + WORD_AFTER + k);
    }
    return bounded_keeps(d, !seen[WORD_WILD], real_of(seen + WORD_REACH));
}
