/* SPDX-License-Identifier: Apache-2.0 */
/* Computes the 3 × 3 block of each pair of particles that a spring or a triple
 * couples. spec/cloth/blocks.md */
#include "ref/cloth/blocks.h"

#include "ref/cloth/law.h"
#include "ref/cloth/triple.h"

/* §1: the block f fᵀ + b I, f = √c u, where c = a − b and u is the direction.
 */
struct parts {
    real b, c;
    vec u;
};

/* §8: the direction of the spring from p to q, d apart and of this length, half
 * way through the predicted motion. */
static vec spring_direction(const struct blocks *s, int64_t p, int64_t q, vec d,
                            real length)
{
    vec way = vec_make(0, 0, 0);
    if (s->n_q)
        way = vec_scale(R(0.5) * s->tau, vec_sub(s->q[q], s->q[p]));
    real size = vec_length(way), most = R(BLOCKS_ROTATION) * length;
    if (size > most)
        way = vec_scale(most / size, way);
    vec e = vec_add(d, way);
    real turned = vec_length(e);
    return turned > 0 ? vec_scale(1 / turned, e) : vec_scale(1 / length, d);
}

static struct parts spring_parts(const struct blocks *s, int o, int64_t p,
                                 int64_t q)
{
    vec d = vec_sub(s->x[q], s->x[p]);
    const struct law *law = &s->law[o];
    struct parts b = {0, 0, {0, 0, 0}};
    real length = vec_length(d), tau = s->tau;
    if (!(length > 0))
        return b;
    real square = tau * tau;
    real a = tau * law->damp + square * law_slope(law, s->piece, length);
    b.b = square * real_max(law_tension(law, s->piece, length) / length, 0);
    b.c = a - b.b;
    b.u = spring_direction(s, p, q, d, length);
    return b;
}

static real triple_stiffness(const struct blocks *s, int o, int64_t p)
{
    return triple_constant(s->triple, o, s->beside[p]);
}

/* §7: adds to the block of a single spring from p to q the share of the triples
 * that have their middle at one of its ends. */
static struct parts with_triples(const struct blocks *s, int o, int64_t p,
                                 struct parts a)
{
    int64_t q = p + spring_step(s->m, o);
    real fraction = spring_fraction(o, s->beside[p]), square = s->tau * s->tau;
    a.b = fraction * a.b +
          2 * square * (triple_stiffness(s, o, p) + triple_stiffness(s, o, q));
    a.c *= fraction;
    return a;
}

/* §7: of the triple that starts at p, the block between its ends. */
static struct parts end_to_end(const struct blocks *s, int o, int64_t p)
{
    real k = triple_stiffness(s, o, p + spring_step(s->m, o));
    return (struct parts){-(s->tau * s->tau * k), 0, {0, 0, 0}};
}

static struct parts parts_of(const struct blocks *s, int o, int64_t p)
{
    struct parts none = {0, 0, {0, 0, 0}};
    if (!(s->springs[p] >> o & 1))
        return none;
    if (s->triples && o >= SPRINGS_SINGLE)
        return end_to_end(s, o - SPRINGS_SINGLE, p);
    struct parts a = spring_parts(s, o, p, p + spring_step(s->m, o));
    return s->triples ? with_triples(s, o, p, a) : a;
}

static sym triple_block(const struct parts *s)
{
    vec f = vec_scale(real_sqrt(real_max(s->c, 0)), s->u);
    return (sym){f.x * f.x + s->b, f.x * f.y, f.x * f.z,
                 f.y * f.y + s->b, f.y * f.z, f.z * f.z + s->b};
}

int ref_blocks(struct blocks *s)
{
    for (int o = 0; o < SPRINGS; o++) {
        sym *block = s->block + o * s->count;
        EACH_ITEM
        for (int64_t p = 0; p < s->count; p++) {
            struct parts a = parts_of(s, o, p);
            block[p] = triple_block(&a);
            if (s->n_packed)
                s->packed[o * s->count + p] = packed_make(a.c, a.b, a.u);
        }
    }
    return DRAPE_OK;
}
