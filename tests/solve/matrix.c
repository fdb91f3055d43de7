/* SPDX-License-Identifier: Apache-2.0 */
/* Stage matrix: generator and properties. spec/solve/matrix.md */
#include "ref/solve/matrix.h"

#include <stdlib.h>

#include "tests/solve/system.h"

const struct field fields_matrix[] = {
    IN(matrix, mass, count, 1),     IN(matrix, extra, n_extra, 1),
    IN(matrix, block, n_blocks, 1), OUT(matrix, diagonal, count, 1),
    OUT(matrix, cdf, n_cdf, 1),     FIELD_END};

void gen_matrix(struct bytes *b, struct matrix *s)
{
    struct system a;
    pick_system(b, &a);
    GIVE_SYSTEM(s, &a);
    s->n_cdf = pick(b, 4) ? ref_cdf(a.m, a.n).blocks : 0;
}

static bool same(const void *a, const void *b, size_t bytes)
{
    return !memcmp(a, b, bytes);
}

static struct system system_of(const struct matrix *s)
{
    struct system a = {.m = s->m,
                       .n = s->n,
                       .count = s->count,
                       .n_extra = s->n_extra,
                       .n_blocks = s->n_blocks,
                       .mass = (real *)s->mass,
                       .extra = (sym *)s->extra,
                       .block = (sym *)s->block};
    return a;
}

/* §3: the sum of all diagonals is the dense matrix, bit for bit, and each block
 * of the format is used exactly once. */
static const char *expect_dense(const struct matrix *s)
{
    struct system a = system_of(s);
    struct cdf c = ref_cdf(s->m, s->n);
    size_t n = (size_t)s->count;
    mat *dense = calloc(n * n, sizeof *dense);
    uint8_t *used = calloc((size_t)c.blocks, 1);
    for (int k = 0; k < DIAGONALS; k++)
        for (int64_t p = 0; p < s->count; p++) {
            int64_t q = p + c.offset[k], at = c.start[k] + p;
            if (q < 0 || q >= s->count)
                continue;
            const mat *b = &s->cdf[at];
            mat *d = &dense[(size_t)p * n + (size_t)q];
            d->x = vec_add(d->x, b->x);
            d->y = vec_add(d->y, b->y);
            d->z = vec_add(d->z, b->z);
            used[at]++;
        }
    bool equal = true, once = true;
    for (size_t k = 0; k < n * n; k++) {
        mat e = dense_entry(&a, (int64_t)(k / n), (int64_t)(k % n));
        equal &= same(&e, &dense[k], sizeof e);
    }
    for (int64_t k = 0; k < c.blocks; k++)
        once &= used[k] == 1;
    free(dense);
    free(used);
    EXPECT(equal);
    EXPECT(once);
    return NULL;
}

const char *prop_matrix(const struct matrix *s)
{
    struct system a = system_of(s);
    for (int64_t p = 0; p < s->count; p++) {
        mat d = dense_entry(&a, p, p);
        EXPECT(same(&d.x, &s->diagonal[p], sizeof d.x));
        EXPECT(same(&d.y.y, &s->diagonal[p].yy, sizeof(real)));
        EXPECT(same(&d.y.z, &s->diagonal[p].yz, sizeof(real)));
        EXPECT(same(&d.z.z, &s->diagonal[p].zz, sizeof(real)));
    }
    return s->n_cdf && s->count <= 64 ? expect_dense(s) : NULL;
}

/* §3: the bytes of the paper's cloth of 1008 × 1008 particles in binary32. */
const char *test_cdf_bytes(void)
{
    struct cdf c = ref_cdf(1008, 1008);
    EXPECT(c.blocks == 17 * INT64_C(1008) * 1008 - 18 * 1008 - 6);
    EXPECT(c.blocks * 9 * 4 <= INT64_C(593) << 20);
    EXPECT(c.blocks * 9 * 4 > INT64_C(592) << 20);
    ran(1);
    return NULL;
}

/* §3: all small grids, without and with holes, cuts and pins, entry by
 * entry. */
const char *test_matrix_dense(void)
{
    for (int k = 0; k < 2 * 7 * 7; k++) {
        struct system a;
        struct design d = {
            2 + k % 7,    2 + k / 7 % 7,
            SHAPE_DRAPED, k < 49 ? TRIM_NONE : TRIM_HOLE | TRIM_CUT | TRIM_PINS,
            0.1,          k % 2};
        make_system(&d, &a);
        struct matrix s = {.n_cdf = ref_cdf(a.m, a.n).blocks};
        GIVE_SYSTEM(&s, &a);
        s.diagonal = calloc((size_t)a.count, sizeof *s.diagonal);
        s.cdf = calloc((size_t)s.n_cdf, sizeof *s.cdf);
        int status = ref_matrix(&s);
        const char *failed = prop_matrix(&s);
        free(s.diagonal);
        free(s.cdf);
        free_system(&a);
        EXPECT(status == DRAPE_OK);
        if (failed)
            return failed;
        ran(1);
    }
    return NULL;
}
