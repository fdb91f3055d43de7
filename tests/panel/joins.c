/* SPDX-License-Identifier: Apache-2.0 */
/* Stage joins: generator and properties. spec/panel/joins.md */
#include "ref/panel/joins.h"

#include "ref/cloth/blocks.h"
#include "tests/base/choices.h"
#include "tests/panel/odd.h"

const struct field fields_joins[] = {IN(joins, law, laws, 1),
                                     IN(joins, piece, pieces, 1),
                                     IN(joins, corner, n_cells, 1),
                                     IN(joins, fibre, n_cells, 1),
                                     IN(joins, first, n_pairs, 1),
                                     IN(joins, way, n_pairs, 1),
                                     IN(joins, bend, n_pairs, 1),
                                     IN(joins, from, n_pairs, 1),
                                     IN(joins, x, count, 1),
                                     IN(joins, q, n_q, 1),
                                     SCRATCH(joins, join, n_join, 1),
                                     INOUT(joins, block, n_blocks, 1),
                                     FIELD_END};

enum { SIX = sizeof(sym) / sizeof(real) };

void gen_joins(struct bytes *b, struct joins *s)
{
    struct odd a = pick_odd(b);
    GIVE_ODD(s, &a);
    s->n_pairs = a.panel.n_pairs;
    s->first = a.panel.first;
    s->way = a.panel.way;
    s->bend = a.panel.bend;
    s->from = (const int32_t(*)[2])a.panel.from;
    s->tau = pick_uniform(b, R(1e-4), R(0.05));
    s->n_q = for_bench(b) || pick(b, 2) ? s->count : 0;
    s->q = pick_vecs(b, s->n_q, pick(b, 2) ? 1 : R(0.01));
    s->n_join = CELL_PAIRS * s->n_cells;
    s->n_blocks = SPRINGS * s->count;
    s->block = take(b, s->n_blocks, sizeof *s->block);
    for (int64_t k = 0; k < SIX * s->n_blocks; k++)
        ((real *)s->block)[k] = odd_before(k);
}

/* The block of a pair in binary64, xx xy xz yy yz zz, and a bound on the
 * stage's error. */
struct exact {
    double a[SIX], error;
};

/* blocks.md §8: turns d half way through the predicted motion. */
static void turn(const struct joins *s, const struct fibre *f,
                 const int32_t at[4], double length, double d[3])
{
    double way[3], size, square = 0, more = 0;
    odd_form(f, at, s->q, way, &size);
    for (int i = 0; i < 3; i++) {
        way[i] *= (double)s->tau / 2;
        square += way[i] * way[i];
    }
    double part = fmin(1, BLOCKS_ROTATION * length / sqrt(square));
    for (int i = 0; i < 3; i++) {
        d[i] += square > 0 ? part * way[i] : 0;
        more += d[i] * d[i];
    }
    for (int i = 0; i < 3; i++)
        d[i] /= sqrt(more);
}

/* Adds the block of a fibre times -c_p c_q for the corners p and q of a pair.
 */
static void add_fibre(const struct joins *s, int64_t k, int f, int pair,
                      struct exact *e)
{
    const struct fibre *a = &s->fibre[k][f];
    const struct law *law = &s->law[fibre_law[f]];
    double d[3], size, tau = (double)s->tau;
    if (!(a->weight > 0))
        return;
    odd_form(a, s->corner[k], s->x, d, &size);
    double length = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
    double off = 12 * REAL_U * size, moved = 0;
    if (!(length > 1e-15 && length < 1e12 && off < 0x1p-10 * length)) {
        e->error = INFINITY;
        return;
    }
    for (int i = 0; i < 3; i++)
        d[i] /= s->n_q ? 1 : length;
    if (s->n_q) {
        double way[3];
        odd_form(a, s->corner[k], s->q, way, &moved);
        turn(s, a, s->corner[k], length, d);
    }
    /* Near a kink of the law, rounding may put the length on its other side. */
    double blur = off + 16 * REAL_U * (length + (double)law->rest);
    bool kink = fabs(length - (double)law->rest) <= blur;
    for (int i = 0; i < law->pieces; i++)
        kink |= fabs(length - (double)s->piece[law->first + i].from) <= blur;
    double tension = law_oracle(law, s->piece, length);
    double along = tau * (double)law->damp +
                   tau * tau * law_oracle_slope(law, s->piece, length);
    double b = tension > 0 ? tau * tau * tension / length : 0;
    double stiff = (double)law->stiff * (60 * REAL_U + (kink ? 1 : 0)) +
                   (kink ? 0 : off * 2 * (double)law->gain);
    stiff += 20 * REAL_U * (double)law->gain * length +
             off * (double)law->stiff / length;
    double turned = (off + 12 * REAL_U * tau * moved) / length + 20 * REAL_U;
    double error = tau * tau * stiff + 4 * turned * along + 60 * REAL_U * along;
    double c[CORNERS] = {0, (double)a->c[0], (double)a->c[1], (double)a->c[2]};
    double most[CORNERS] = {0, fabs(c[1]), fabs(c[2]), fabs(c[3])};
    c[0] = -(c[1] + c[2] + c[3]);
    most[0] = most[1] + most[2] + most[3];
    int p = pair_ends[pair][0], q = pair_ends[pair][1];
    double part = -(double)a->weight * c[p] * c[q];
    for (int i = 0, n = 0; i < 3; i++)
        for (int j = i; j < 3; j++, n++)
            e->a[n] +=
                part * ((fmax(along - b, 0)) * d[i] * d[j] + (i == j ? b : 0));
    e->error +=
        (double)a->weight * most[p] * most[q] * (error + 20 * REAL_U * along) +
        1e-35;
}

/* §1, §2: the block of pair k against its definition. */
static const char *check_pair(const struct joins *s, int64_t k)
{
    int64_t at = s->way[k] * s->count + s->first[k];
    double bend = (double)s->tau * (double)s->tau * (double)s->bend[k];
    struct exact e = {{bend, 0, 0, bend, 0, bend}, 0};
    for (int i = 0; i < 2; i++)
        for (int f = 0; f < FIBRES && s->from[k][i] >= 0; f++)
            add_fibre(s, s->from[k][i] / CELL_PAIRS, f,
                      s->from[k][i] % CELL_PAIRS, &e);
    e.error += 60 * REAL_U * (1 + fabs(bend));
    for (int i = 0; i < SIX && e.error < INFINITY; i++) {
        double before = (double)odd_before(SIX * at + i);
        double is = (double)((const real *)(s->block + at))[i];
        EXPECT(fabs(is - before - e.a[i]) <=
               e.error + 4 * REAL_U * fabs(e.a[i]));
    }
    return NULL;
}

const char *prop_joins(const struct joins *s)
{
    int64_t k = 0;
    const char *failed = NULL;
    struct bytes b = {0};
    bool *paired = take(&b, s->n_blocks, sizeof *paired);
    for (k = 0; k < s->n_pairs && !failed; k++) {
        paired[s->way[k] * s->count + s->first[k]] = true;
        failed = check_pair(s, k);
    }
    for (k = 0; k < SIX * s->n_blocks && !failed; k++)
        if (!paired[k / SIX] && ((const real *)s->block)[k] != odd_before(k))
            failed = "§2: a block of no pair has changed";
    choices_free(&b);
    return failed;
}
