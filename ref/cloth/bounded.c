/* SPDX-License-Identifier: Apache-2.0 */
/* Whether a cloth's motion went well: no number is out of range, and the energy
 * has not grown without a cause. spec/cloth/dynamics.md §3 */
#include "ref/cloth/bounded.h"

/* What wind and moving pins may have put in, J, at most. */
static double allowed_gain(const struct dynamics *s, double reach,
                           double elastic)
{
    const struct cloth *c = s->cloth;
    double mass = (double)c->cell_mass * (double)(c->n_triangles / 2);
    double k = 0, pins = (double)c->n_pinned;
    for (int o = 0; o < SPRINGS; o++)
        k = (double)c->law[o].stiff > k ? (double)c->law[o].stiff : k;
    for (int64_t o = 0; o < c->triples; o++)
        k = (double)c->triple[o] > k ? (double)c->triple[o] : k;
    double speed = reach / s->dt,
           wind = s->windy ? (double)vec_length(s->air) : 0;
    return 2 * mass * (speed * speed + wind * wind) +
           reach * (2 * sqrt(64 * pins * k * elastic) + 32 * pins * k * reach);
}

/* The energy of a strain of 2^-10 in every spring. */
static double least_energy(const struct cloth *c)
{
    double e = 0;
    for (int o = 0; o < SPRINGS; o++)
        e += (double)c->law[o].k * (double)c->law[o].rest *
             (double)c->law[o].rest;
    return 0x1p-20 * e * (double)c->count;
}

/* False where the energy has grown without a cause, or is no number. What
 * contacts add has a cause. */
static bool is_energy_bounded(struct dynamics *s, double reach)
{
    const double *before = s->before, *after = s->energy;
    double own = after[0] + after[1], least = least_energy(s->cloth);
    if (s->met)
        return own >= 0 && own <= 0x1p120;
    double gain = (after[0] - before[0]) + (after[1] - before[1]) +
                  (after[2] - before[2]) - allowed_gain(s, reach, before[1]);
    double surplus = s->surplus + gain;
    if (!(own >= 0 && own <= 0x1p120) || !(surplus <= 0x1p120))
        return false;
    s->surplus = surplus > 0 ? surplus : 0;
    if (s->surplus <= own / 2 && own > s->reference)
        s->reference = own;
    double reference = s->reference > least ? s->reference : least;
    return s->surplus <= 1024 * reference;
}

bool bounded_keeps(struct dynamics *s, bool sane, double reach)
{
    double reference = s->reference, surplus = s->surplus;
    if (sane && is_energy_bounded(s, reach))
        return true;
    s->outcome |= DRAPE_DIVERGED;
    s->reference = reference;
    s->surplus = surplus;
    memcpy(s->energy, s->before, sizeof s->energy);
    return false;
}
