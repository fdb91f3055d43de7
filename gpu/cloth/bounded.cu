/* SPDX-License-Identifier: Apache-2.0 */
/* Whether a cloth's step went well: sums and searches on the device, one read,
 * the decision on the host. spec/cloth/dynamics.md §3 */
#include "gpu/base/largest.cuh"
#include "gpu/base/real.cuh"
#include "gpu/cloth/energy.cuh"
#include "gpu/cloth/motion.cuh"

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
static __global__ void __launch_bounds__(GPU_BLOCK)
    sane_kernel(struct dynamics d, struct cloth c, int64_t *word)
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
    e.springs = c->springs;
    e.mass = c->mass;
    e.x = x;
    e.v = v;
    e.gravity = s->dynamics.gravity;
    e.n_chunks = sum_chunks(c->count);
    e.chunk = s->dynamics.chunk;
    return e;
}

static double larger(double a, double b)
{
    return a > b ? a : b;
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
    struct energy e = energy_at(s, x, v);
    int64_t *word = gpu_words(g);
    gpu_energy_into(g, &e, word);
    const int64_t *seen = gpu_read_words(g, 3);
    for (int k = 0; k < 3; k++)
        value[k] = real_of(seen + k);
}

/* The air's, in the precision of the state. */
static double speed_of(vec a)
{
    real square = (a.x * a.x + a.y * a.y) + a.z * a.z;
    return REAL_BITS == 32 ? (double)sqrtf((float)square) : sqrt(square);
}

/* What wind and moving pins may have put in, J, at most. */
static double allowance(const struct sheet *s, double reach, double elastic)
{
    const struct cloth *c = &s->cloth;
    const struct dynamics *d = &s->dynamics;
    double mass = (double)c->cell_mass * (double)(c->n_triangles / 2);
    double pins = (double)c->n_pinned, k = 0;
    for (int o = 0; o < SPRINGS; o++)
        k = larger((double)c->law[o].stiff, k);
    double speed = reach / d->dt;
    double wind = d->windy ? speed_of(d->air) : 0;
    return 2 * mass * (speed * speed + wind * wind) +
           reach * (2 * sqrt(32 * pins * k * elastic) + 16 * pins * k * reach);
}

/* The energy of a strain of 2^-10 in every spring. */
static double least_energy(const struct cloth *c)
{
    double e = 0;
    for (int o = 0; o < SPRINGS; o++) {
        double rest = (double)c->law[o].rest;
        e += (double)c->law[o].k * rest * rest;
    }
    return 0x1p-20 * e * (double)c->count;
}

/* False where the energy has grown without a cause, or is no number. */
static bool bounded(struct sheet *s, const double before[3], double reach)
{
    struct dynamics *d = &s->dynamics;
    const double *after = d->energy;
    double own = after[0] + after[1], least = least_energy(&s->cloth);
    double gain = (after[0] - before[0]) + (after[1] - before[1]) +
                  (after[2] - before[2]) - allowance(s, reach, before[1]);
    double surplus = d->surplus + gain;
    if (!(own >= 0 && own <= 0x1p120) || !(surplus <= 0x1p120))
        return false;
    d->surplus = surplus > 0 ? surplus : 0;
    if (d->surplus <= own / 2 && own > d->reference)
        d->reference = own;
    return d->surplus <= 1024 * larger(d->reference, least);
}

bool gpu_motion_bounded(struct gpu *g, struct sheet *s)
{
    struct dynamics *d = &s->dynamics;
    struct energy start = energy_at(s, d->x, d->v);
    struct energy end = energy_at(s, d->x1, d->v1);
    int64_t *word = gpu_words(g);
    gpu_energy_into(g, &start, word + WORD_BEFORE);
    gpu_energy_into(g, &end, word + WORD_AFTER);
    LAUNCH(g, s->cloth.count, sane_kernel, *d, s->cloth, word);
    const int64_t *seen = gpu_read_words(g, WORDS);
    for (int k = 0; k < 3; k++) {
        d->before[k] = real_of(seen + WORD_BEFORE + k);
        d->energy[k] = real_of(seen + WORD_AFTER + k);
    }
    return !seen[WORD_WILD] &&
           bounded(s, d->before, real_of(seen + WORD_REACH));
}
