/* SPDX-License-Identifier: Apache-2.0 */
/* Stage product: generator and properties. spec/solve/product.md */
#include "ref/solve/product.h"

#include <stdlib.h>

#include "tests/solve/system.h"

const struct field fields_product[] = {IN(product, mass, count, 1),
                                       IN(product, extra, n_extra, 1),
                                       IN(product, block, n_blocks, 1),
                                       IN(product, cdf, n_cdf, 1),
                                       IN(product, x, count, 1),
                                       OUT(product, y, count, 1),
                                       FIELD_END};

/* The compressed diagonal format of a system. */
static mat *assemble(struct bytes *b, const struct system *a)
{
    struct matrix s = {.n_cdf = ref_cdf(a->m, a->n).blocks};
    GIVE_SYSTEM(&s, a);
    s.diagonal = take(b, a->count, sizeof *s.diagonal);
    s.cdf = take(b, s.n_cdf, sizeof *s.cdf);
    ref_matrix(&s);
    return s.cdf;
}

void gen_product(struct bytes *b, struct product *s)
{
    struct system a;
    pick_system(b, &a);
    vec *x = take(b, a.count, sizeof *x);
    real scale = pick(b, 3) ? 1 : R(0x1p-70);
    for (int64_t p = 0; p < a.count; p++)
        x[p] = vec_scale(scale, for_bench(b) ? a.b[p] : pick_vec(b, 1));
    GIVE_SYSTEM(s, &a);
    s->x = x;
    if (a.count && !for_bench(b) && pick(b, 2)) {
        s->cdf = assemble(b, &a);
        s->n_cdf = ref_cdf(a.m, a.n).blocks;
        s->n_blocks = 0;
    }
}

/* Writes row r of the block of diagonal k at particle p: of the spring that
 * starts at p (k odd) or ends at p (k even). */
static void block_row(const struct product *s, int64_t p, int k, int r,
                      double row[3])
{
    struct cdf c = ref_cdf(s->m, s->n);
    int o = (k - 1) / 2;
    if (s->n_cdf) {
        const vec *a = &s->cdf[c.start[k] + p].x + r;
        row[0] = -(double)a->x;
        row[1] = -(double)a->y;
        row[2] = -(double)a->z;
        return;
    }
    const sym *b = &s->block[o * s->count + p + (k % 2 ? 0 : c.offset[k])];
    double a[3][3] = {{(double)b->xx, (double)b->xy, (double)b->xz},
                      {(double)b->xy, (double)b->yy, (double)b->yz},
                      {(double)b->xz, (double)b->yz, (double)b->zz}};
    memcpy(row, a[r], sizeof a[r]);
}

static double part(vec a, int r)
{
    return (double)(r == 0 ? a.x : r == 1 ? a.y : a.z);
}

/* §2 and §3: component r of (A x)_p in binary64 by differences, the sum of the
 * sizes of its terms, and the same sum for the dense product. */
struct row {
    double value, size, dense_size;
};

static struct row exact_row(const struct product *s, int64_t p, int r)
{
    struct cdf c = ref_cdf(s->m, s->n);
    double mass = (double)s->mass[p], x = part(s->x[p], r);
    struct row e = {mass * x, fabs(mass * x), fabs(mass * x)};
    if (s->n_extra) {
        sym b = s->extra[p];
        vec rows[3] = {
            {b.xx, b.xy, b.xz}, {b.xy, b.yy, b.yz}, {b.xz, b.yz, b.zz}};
        for (int t = 0; t < 3; t++) {
            double term = part(rows[r], t) * part(s->x[p], t);
            e.value += term;
            e.size += fabs(term);
            e.dense_size += fabs(term);
        }
    }
    for (int k = 1; k < DIAGONALS; k++) {
        int64_t q = p + c.offset[k];
        if (!spring_inside(s->m, s->n, (int32_t)(p % s->m), (int32_t)(p / s->m),
                           (k - 1) / 2, k % 2 ? 1 : -1))
            continue;
        double row[3];
        block_row(s, p, k, r, row);
        for (int t = 0; t < 3; t++) {
            double a = part(s->x[p], t), b = part(s->x[q], t);
            e.value += row[t] * (a - b);
            e.size += fabs(row[t] * (a - b));
            e.dense_size += fabs(row[t]) * (fabs(a) + fabs(b));
        }
    }
    return e;
}

static const char *expect_near(const struct product *s)
{
    const double u = REAL_BITS == 32 ? 0x1p-24 : 0x1p-53;
    const double tiny = REAL_BITS == 32 ? 0x1p-143 : 0x1p-1068;
    for (int64_t k = 0; k < 3 * s->count; k++) {
        struct row e = exact_row(s, k / 3, (int)(k % 3));
        double y = part(s->y[k / 3], (int)(k % 3));
        EXPECT(fabs(y - e.value) <= (25 * u + 60 * 0x1p-53) * e.size + tiny);
    }
    return NULL;
}

const char *prop_product(const struct product *s)
{
    return expect_near(s);
}

/* §1: both forms of A give the same bits; §3: these are near the dense product
 * in binary64. */
static const char *expect_forms(const struct system *a, vec *const v[3],
                                mat *cdf, sym *diagonal)
{
    const double u = REAL_BITS == 32 ? 0x1p-24 : 0x1p-53;
    struct matrix f = {
        .n_cdf = ref_cdf(a->m, a->n).blocks, .diagonal = diagonal, .cdf = cdf};
    GIVE_SYSTEM(&f, a);
    EXPECT(ref_matrix(&f) == DRAPE_OK);
    struct product s = {.x = v[0], .y = v[1]};
    GIVE_SYSTEM(&s, a);
    struct product t = s;
    t.n_blocks = 0;
    t.n_cdf = f.n_cdf;
    t.cdf = cdf;
    t.y = v[2];
    EXPECT(ref_product(&s) == DRAPE_OK && ref_product(&t) == DRAPE_OK);
    EXPECT(!memcmp(v[1], v[2], (size_t)a->count * sizeof(vec)));
    for (int64_t k = 0; k < 3 * a->count; k++) {
        double dense = 0;
        for (int64_t q = 0; q < a->count; q++) {
            mat e = dense_entry(a, k / 3, q);
            const vec *row = &e.x + k % 3;
            for (int c = 0; c < 3; c++)
                dense += part(*row, c) * part(v[0][q], c);
        }
        double size = exact_row(&s, k / 3, (int)(k % 3)).dense_size;
        EXPECT(fabs(part(v[1][k / 3], (int)(k % 3)) - dense) <=
               (44 * u + 80 * 0x1p-53) * size);
    }
    return NULL;
}

const char *test_product_forms(void)
{
    for (int k = 0; k < 30; k++) {
        struct system a;
        struct design d = {2 + k % 6,
                           3 + k % 5,
                           (enum shape)(k % SHAPES),
                           k % 3 ? TRIM_HOLE | TRIM_CUT | TRIM_PINS : 0,
                           0.1,
                           k % 2};
        make_system(&d, &a);
        vec *v[3];
        for (int c = 0; c < 3; c++)
            v[c] = calloc((size_t)a.count, sizeof(vec));
        for (int64_t p = 0; p < a.count; p++)
            v[0][p] = vec_make((real)noise_of((uint64_t)p), p % 3 ? 0 : -R(0.0),
                               (real)noise_of((uint64_t)(p + 1000)));
        mat *cdf = calloc((size_t)ref_cdf(a.m, a.n).blocks, sizeof *cdf);
        sym *diagonal = calloc((size_t)a.count, sizeof *diagonal);
        const char *failed = expect_forms(&a, v, cdf, diagonal);
        free(cdf);
        free(diagonal);
        for (int c = 0; c < 3; c++)
            free(v[c]);
        free_system(&a);
        if (failed)
            return failed;
        ran(1);
    }
    return NULL;
}

/* §4: A times a translation is mass·x to the last bit, with the masses of the
 * finest cloth; in binary32 rounding of an assembled diagonal would be as
 * large. */
const char *test_product_constant(void)
{
    struct system a;
    struct design d = {101, 101, SHAPE_DRAPED, TRIM_NONE, 0.1, DRAPE_TRIPLES};
    make_system(&d, &a);
    vec *x = calloc((size_t)a.count, sizeof *x);
    vec *y = calloc((size_t)a.count, sizeof *y);
    for (int64_t p = 0; p < a.count; p++) {
        a.mass[p] = R(2e-7);
        x[p] = vec_make(1, -3, R(0.7));
    }
    struct product s = {.x = x, .y = y};
    GIVE_SYSTEM(&s, &a);
    bool exact = ref_product(&s) == DRAPE_OK;
    for (int64_t p = 0; p < a.count; p++)
        exact &= y[p].x == a.mass[p] * 1 && y[p].y == a.mass[p] * -3 &&
                 y[p].z == a.mass[p] * R(0.7);
    free(x);
    free(y);
    free_system(&a);
    EXPECT(exact);
    ran(1);
    return NULL;
}
