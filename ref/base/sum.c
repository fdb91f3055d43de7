/* SPDX-License-Identifier: Apache-2.0 */
/* Sums by a tree of fixed shape. spec/base/sum.md */
#include "ref/base/sum.h"

real ref_sum_finish(int64_t n, real *chunk)
{
    while (n > 1) {
        int64_t m = sum_chunks(n);
        /* In place: chunk k of the next level reads items from SUM_CHUNK·k on,
         * and none of these has been overwritten yet. */
        for (int64_t k = 0; k < m; k++) {
            real s[SUM_CHUNK];
            for (int64_t i = 0; i < SUM_CHUNK; i++) {
                int64_t item = SUM_CHUNK * k + i;
                s[i] = item < n ? chunk[item] : 0;
            }
            chunk[k] = sum_tree(s);
        }
        n = m;
    }
    return n ? chunk[0] : 0;
}

int ref_sum(struct sum *s)
{
    EACH_ITEM
    for (int64_t k = 0; k < sum_chunks(s->n); k++) {
        real t[SUM_CHUNK];
        for (int64_t i = 0; i < SUM_CHUNK; i++) {
            int64_t item = SUM_CHUNK * k + i;
            t[i] = item < s->n ? s->a[item] : 0;
        }
        s->chunk[k] = sum_tree(t);
    }
    s->value = ref_sum_finish(sum_chunks(s->n), s->chunk);
    return DRAPE_OK;
}

static real term_of(const struct dot *s, int64_t k)
{
    real term = vec_dot(s->a[k], s->b[k]);
    return s->n_w ? s->w[k] * term : term;
}

int ref_dot(struct dot *s)
{
    EACH_ITEM
    for (int64_t k = 0; k < sum_chunks(s->n); k++) {
        real t[SUM_CHUNK];
        for (int64_t i = 0; i < SUM_CHUNK; i++) {
            int64_t item = SUM_CHUNK * k + i;
            t[i] = item < s->n ? term_of(s, item) : 0;
        }
        s->chunk[k] = sum_tree(t);
    }
    s->value = ref_sum_finish(sum_chunks(s->n), s->chunk);
    return DRAPE_OK;
}
