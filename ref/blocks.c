/* SPDX-License-Identifier: Apache-2.0 */
/* One positive semidefinite block a spring. spec/05_blocks.md */
#include "ref/blocks.h"

#include "ref/law.h"

/* §2: (a − b) u uᵀ + b I, where a ≥ b ≥ 0. */
static sym spring_block(const struct law *law, real tau, vec d)
{
    real length = vec_length(d);
    if (!(length > 0))
        return (sym){0, 0, 0, 0, 0, 0};
    vec u = vec_scale(1 / length, d);
    real square = tau * tau;
    real a = tau * law->damp + square * law_slope(law, length);
    real b = square * real_max(law_tension(law, length) / length, 0);
    vec w = vec_scale(a - b, u);
    return (sym){w.x * u.x + b, w.x * u.y, w.x * u.z,
                 w.y * u.y + b, w.y * u.z, w.z * u.z + b};
}

int ref_blocks(struct blocks *s)
{
    for (int o = 0; o < SPRINGS; o++) {
        int64_t step = spring_di[o] + (int64_t)spring_dj[o] * s->m;
        sym *block = s->block + o * s->count;
        EACH_ITEM
        for (int64_t p = 0; p < s->count; p++) {
            bool is = s->springs[p] >> o & 1;
            vec d = is ? vec_sub(s->x[p + step], s->x[p]) : vec_make(0, 0, 0);
            block[p] = spring_block(&s->law[o], s->tau, d);
        }
    }
    return DRAPE_OK;
}
