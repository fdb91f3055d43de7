/* SPDX-License-Identifier: Apache-2.0 */
/* Stage blocks: generator and properties. spec/cloth/blocks.md */
#include "ref/cloth/blocks.h"

#include "ref/cloth/triple.h"
#include "tests/cloth/sheet.h"
#include "tests/solve/system.h"

const struct field fields_blocks[] = {IN(blocks, law, laws, 1),
                                      IN(blocks, piece, pieces, 1),
                                      IN(blocks, springs, count, 1),
                                      IN(blocks, triple, triples, 1),
                                      IN(blocks, beside, n_beside, 1),
                                      IN(blocks, x, count, 1),
                                      IN(blocks, q, n_q, 1),
                                      OUT(blocks, block, count, SPRINGS),
                                      OUT(blocks, packed, n_packed, 1),
                                      FIELD_END};

void gen_blocks(struct bytes *b, struct blocks *s)
{
    struct grid g = pick_bent_grid(b);
    s->m = g.m;
    s->count = g.count;
    GIVE_GRID(s, &g);
    s->x = pick_state(b, &g);
    s->tau = pick_uniform(b, R(1e-4), R(0.05));
    s->n_packed = pick(b, 3) ? SPRINGS * g.count : 0;
    s->n_q = for_bench(b) || pick(b, 2) ? g.count : 0;
    s->q = pick_vecs(b, s->n_q, pick(b, 2) ? 1 : R(0.01));
}

/* §5: checks a packed block of c u uᵀ + b I, with d along u: entries to 2^-6 of
 * c
 * + |b|, b not less than it was, and at most 2^-26 of c leaks into directions
 * across u. error: of the entries of the block itself. */
static const char *check_packed(struct packed t, double c, double b,
                                const double d[3], double error)
{
    struct packed_parts a = packed_open(t);
    double e[3] = {(double)a.e.x, (double)a.e.y, (double)a.e.z};
    double size = (double)a.size, all = (double)a.all;
    double square = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
    double room = 0x1p-6 * (c + fabs(b)) + error;
    EXPECT(size >= 0 && all >= b - error);
    EXPECT(all <= b + 0x1p-7 * fabs(b) + error);
    for (int i = 0; i < 3; i++)
        for (int j = i; j < 3; j++) {
            double want = c * d[i] * d[j] / square + (i == j ? b : 0);
            double is = size * e[i] * e[j] + (i == j ? all : 0);
            EXPECT(fabs(is - want) <= room);
            EXPECT(i != j ||
                   is <= want + error + 0x1p-12 * c + 0x1p-7 * fabs(b));
        }
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3;
        double across = d[j] * e[i] - d[i] * e[j];
        EXPECT(size * across * across <= 0x1p-26 * (c + error) * square);
    }
    return NULL;
}

/* §7: the constants of the triples with their middle at p and at q. */
static double triples_at(const struct blocks *s, int o, int64_t p, int64_t q)
{
    return !s->triples
               ? 0
               : (double)triple_constant(s->triple, o, s->beside[p]) +
                     (double)triple_constant(s->triple, o, s->beside[q]);
}

/* §8: turns d, of this length, half way through the predicted motion. */
static void turn(const struct blocks *s, int64_t from, int64_t to,
                 double length, double d[3])
{
    double way[3], square = 0;
    for (int k = 0; k < 3; k++) {
        double a = (double)(&s->q[from].x)[k], b = (double)(&s->q[to].x)[k];
        way[k] = (double)s->tau / 2 * (b - a);
        square += way[k] * way[k];
    }
    double part = fmin(1, 0.025 * length / sqrt(square));
    for (int k = 0; k < 3 && square > 0; k++)
        d[k] += part * way[k];
}

/* §1, §3 and §7: compares the block with share·(a u uᵀ + b (I - u uᵀ)) + 2τ²k I
 * in binary64. */
static const char *check(const struct blocks *s, int o, int64_t from,
                         const sym *block, const struct packed *packed)
{
    int64_t to = from + spring_step(s->m, o);
    vec p = s->x[from], q = s->x[to];
    const struct law *law = &s->law[o];
    double share = s->triples ? (double)spring_fraction(o, s->beside[from]) : 1;
    double d[3] = {(double)q.x - (double)p.x, (double)q.y - (double)p.y,
                   (double)q.z - (double)p.z};
    double length = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
    if (!(length > 1e-15 && length < 1e15))
        return NULL;
    double along = length;
    if (s->n_q) {
        turn(s, from, to, length, d);
        along = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
    }
    double tau = (double)s->tau, slope,
           tension = law_oracle(law, s->piece, length);
    /* Near a kink of the law, rounding or the fit may put the length on its
     * other side. */
    double blur = 16 * REAL_U * (length + (double)law->rest);
    double shift =
        13 * LAW_ERROR * (double)law->bend / (double)law->compression;
    bool kink = fabs(length - (double)law->rest) <= blur ||
                fabs(length - (double)law->knee) <= blur + shift;
    for (int k = 0; k < law->pieces; k++)
        kink |= fabs(length - (double)s->piece[law->first + k].from) <= blur;
    slope = law_oracle_slope(law, s->piece, length);
    double a = share * (tau * (double)law->damp + tau * tau * slope);
    double b = tension > 0 ? share * tau * tau * tension / length : 0;
    double bend = 2 * tau * tau * triples_at(s, o, from, to);
    const real *entry = &block->xx;
    double fit = LAW_SLOPE_ERROR * (double)law->bend / (double)law->rest;
    double stiff = (double)law->stiff * (40 * REAL_U + (kink ? 1 : 0));
    if (length > (double)law->from)
        stiff += 10 * REAL_U * (double)law->gain * length;
    double error = tau * tau * (fit + stiff) + 40 * REAL_U * (a + bend) + 1e-35;
    for (int i = 0, e = 0; i < 3; i++)
        for (int j = i; j < 3; j++, e++) {
            double uu = d[i] * d[j] / (along * along);
            double want = (a - b) * uu + (i == j ? b + bend : 0);
            EXPECT(fabs((double)entry[e] - want) <= error);
        }
    return packed ? check_packed(*packed, a - b, b + bend, d, error) : NULL;
}

/* §7: the block between the ends of the triple that starts at p. */
static const char *check_ends(const struct blocks *s, int o, int64_t p,
                              const sym *block, const struct packed *packed)
{
    int64_t at = p + spring_step(s->m, o);
    real k = triple_constant(s->triple, o, s->beside[at]);
    real want = -(s->tau * s->tau * k);
    EXPECT(want < 0 && block->xx == want && block->yy == want);
    EXPECT(block->zz == want && block->xy == 0 && block->xz == 0 &&
           block->yz == 0);
    const double along[3] = {1, 0, 0};
    return packed ? check_packed(*packed, 0, (double)want, along, 1e-35) : NULL;
}

/* §2: zᵀ B z ≥ 0, up to rounding, for all z of a small lattice. */
static const char *semidefinite(const sym *a)
{
    double trace = (double)a->xx + (double)a->yy + (double)a->zz;
    EXPECT(trace >= 0 && trace <= 1e30);
    for (int k = 0; k < 343; k++) {
        double x = k % 7 - 3, y = k / 7 % 7 - 3, z = k / 49 - 3;
        double form = (double)a->xx * x * x + (double)a->yy * y * y +
                      (double)a->zz * z * z +
                      2 * ((double)a->xy * x * y + (double)a->xz * x * z +
                           (double)a->yz * y * z);
        double square = x * x + y * y + z * z;
        EXPECT(form >= -(8 * REAL_U * trace + 1e-35) * square);
    }
    return NULL;
}

const char *prop_blocks(const struct blocks *s)
{
    static const sym zero;
    for (int64_t k = 0; k < SPRINGS * s->count; k++) {
        int64_t o = k / s->count, p = k % s->count;
        const sym *block = &s->block[k];
        if (!(s->springs[p] >> o & 1)) {
            EXPECT(!memcmp(block, &zero, sizeof zero));
            EXPECT(!s->n_packed || s->packed[k].both == 0);
            continue;
        }
        const struct packed *packed = s->n_packed ? &s->packed[k] : NULL;
        bool ends = s->triples && o >= SPRINGS_SINGLE;
        const char *bad =
            ends ? check_ends(s, (int)o - SPRINGS_SINGLE, p, block, packed)
                 : check(s, (int)o, p, block, packed);
        if (!bad && !ends)
            bad = semidefinite(block);
        if (bad)
            return bad;
    }
    return NULL;
}

/* §5: a c that is not positive counts as 0, as does a b that is NaN; one that
 * is too large as the largest; of equally long axes the first is chosen. */
const char *test_packed_limits(void)
{
    const real nan = (real)NAN, inf = (real)INFINITY;
    const vec x = {1, 0, 0}, even = {R(0.5), R(0.5), R(-0.5)};
    struct packed_parts a = packed_open(packed_make(2, 3, x));
    EXPECT(a.size == 8 && a.all == 3);
    EXPECT(a.e.x == R(0.5) && a.e.y == 0 && a.e.z == 0);
    a = packed_open(packed_make(1, 0, even));
    EXPECT(a.size == 1 && a.all == 0 && a.e.x == R(0.5) && a.e.z == R(-0.5));
    EXPECT(a.e.y == R(0.5) - R(0x1p-15)); /* +1/2 itself has no step */
    a = packed_open(packed_make(-1, nan, x));
    EXPECT(a.size == 0 && a.all == 0);
    a = packed_open(packed_make(inf, inf, x));
    EXPECT(a.size == R(0x1.fep127) && a.all == R(0x1.fep127));
    a = packed_open(packed_make(1, 1, vec_make(nan, nan, nan)));
    EXPECT(a.size == 0 && a.all == 1 && a.e.y == 0);
    /* c is cut off, b goes up, whatever its sign. */
    a = packed_open(packed_make(R(0x1.01ffp0), R(0x1.01ffp0), x));
    EXPECT(a.size == 4 * R(0x1.00p0) && a.all == R(0x1.02p0));
    a = packed_open(packed_make(0, R(-0x1.01ffp0), x));
    EXPECT(a.size == 0 && a.all == R(-0x1.00p0));
    a = packed_open(packed_make(0, -inf, x));
    EXPECT(a.all == R(-0x1.fep127));
    for (int k = 0; k < 64; k++) {
        real b = R(1) + (real)k * R(0x1p-23), low = R(1) + R(0x1p-40);
        EXPECT(packed_open(packed_make(0, b, x)).all >= b);
        EXPECT(packed_open(packed_make(0, -b, x)).all >= -b);
        EXPECT(packed_open(packed_make(0, low * b, x)).all >= low * b);
        EXPECT(packed_open(packed_make(0, -low * b, x)).all >= -low * b);
    }
    ran(72);
    return NULL;
}
