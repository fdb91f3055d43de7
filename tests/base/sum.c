/* SPDX-License-Identifier: Apache-2.0 */
/* Stages sum and dot: generators and properties. spec/base/sum.md */
#include "ref/base/sum.h"

#include "tests/base/harness.h"

const struct field fields_sum[] = {IN(sum, a, n, 1),
                                   SCRATCH(sum, chunk, n_chunks, 1),
                                   OUT_VALUE(sum, value), FIELD_END};
const struct field fields_dot[] = {
    IN(dot, a, n, 1),      IN(dot, b, n, 1),
    IN(dot, w, n_w, 1),    SCRATCH(dot, chunk, n_chunks, 1),
    OUT_VALUE(dot, value), FIELD_END};

/* Sometimes returns a size at which the tree has a third level. */
static int64_t size_of(struct bytes *b)
{
    if (for_bench(b))
        return 1 << 20;
    int64_t n = pick_size(b);
    return n == 1000 && !pick(b, 3) ? 65536 + pick(b, 3) - 1 : n;
}

void gen_sum(struct bytes *b, struct sum *s)
{
    s->n = size_of(b);
    s->n_chunks = sum_chunks(s->n);
    real *a = take(b, s->n, sizeof *a);
    for (int64_t k = 0; k < s->n; k++)
        a[k] = pick_real(b, 1);
    s->a = a;
}

void gen_dot(struct bytes *b, struct dot *s)
{
    s->n = size_of(b);
    s->n_chunks = sum_chunks(s->n);
    vec *x = take(b, s->n, sizeof *x);
    vec *y = take(b, s->n, sizeof *y);
    for (int64_t k = 0; k < s->n; k++) {
        x[k] = for_bench(b) ? vec_make(1, (real)k, 2) : pick_vec(b, 1);
        y[k] = pick(b, 4) && !for_bench(b) ? pick_vec(b, 1) : x[k];
    }
    s->a = x;
    s->b = y;
    s->n_w = pick(b, 4) || for_bench(b) ? 0 : s->n;
    real *w = take(b, s->n_w, sizeof *w);
    for (int64_t k = 0; k < s->n_w; k++)
        w[k] = pick_real(b, 1);
    s->w = w;
}

/* An independent definition of §2 and §3, by recursion: item i of a chunk is
 * added to item i + h, and the items of a level are the chunk sums of the level
 * below. A leaf is the item one[k] of sum, or x[k]·y[k] of dot, times w[k]
 * where dot has weights. */
struct leaves {
    int64_t n;
    const real *one;
    const vec *x, *y;
    const real *w; /* NULL: none */
};

static int64_t items(const struct leaves *l, int depth)
{
    int64_t n = l->n;
    for (int d = 0; d < depth; d++)
        n = sum_chunks(n);
    return n;
}

static real level(const struct leaves *l, int depth, int64_t item);

static real halves(const struct leaves *l, int depth, int64_t item, int stride)
{
    if (stride == SUM_CHUNK)
        return item < items(l, depth) ? level(l, depth, item) : 0;
    return halves(l, depth, item, 2 * stride) +
           halves(l, depth, item + stride, 2 * stride);
}

static real level(const struct leaves *l, int depth, int64_t item)
{
    if (depth > 0)
        return halves(l, depth - 1, SUM_CHUNK * item, 1);
    if (l->one)
        return l->one[item];
    real term = vec_dot(l->x[item], l->y[item]);
    return l->w ? l->w[item] * term : term;
}

static real expected(const struct leaves *l)
{
    int depth = 1;
    while (items(l, depth) > 1)
        depth++;
    return l->n ? level(l, depth, 0) : 0;
}

static bool same_bits(real a, real b)
{
    return !memcmp(&a, &b, sizeof a);
}

const char *prop_sum(const struct sum *s)
{
    struct leaves l = {s->n, s->a, NULL, NULL, NULL};
    EXPECT(same_bits(s->value, expected(&l)));
    /* §4: the error bound, with the rounding of the plain sum in binary64. */
    double exact = 0, size = 0;
    for (int64_t k = 0; k < s->n; k++) {
        exact += (double)s->a[k];
        size += fabs((double)s->a[k]);
    }
    double unit = REAL_BITS == 32 ? 0x1p-24 : 0x1p-53;
    EXPECT(fabs((double)s->value - exact) <=
           (26 * unit + (double)s->n * 0x1p-52) * size);
    return NULL;
}

const char *prop_dot(const struct dot *s)
{
    struct leaves l = {s->n, NULL, s->a, s->b, s->n_w ? s->w : NULL};
    EXPECT(same_bits(s->value, expected(&l)));
    return NULL;
}
