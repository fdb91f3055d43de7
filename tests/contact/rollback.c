/* SPDX-License-Identifier: Apache-2.0 */
/* Stage rollback: generator and properties. spec/contact/rollback.md */
#include "ref/contact/rollback.h"

#include "tests/base/choices.h"

const struct field fields_rollback[] = {IN(rollback, pair, n, 4),
                                        IN(rollback, w, nv, 1),
                                        IN(rollback, x0, nv, 1),
                                        INOUT(rollback, x1, nv, 1),
                                        INOUT(rollback, u, nv, 1),
                                        INOUT(rollback, v, nv, 1),
                                        INOUT(rollback, rolled, nv, 1),
                                        OUT(rollback, touched, nv, 1),
                                        OUT_VALUE(rollback, grown),
                                        OUT_VALUE(rollback, trapped),
                                        FIELD_END};

void gen_rollback(struct bytes *b, struct rollback *s)
{
    s->n = for_bench(b) ? 1 << 16 : pick_size(b);
    s->nv = 4 + s->n * (1 + pick(b, 4));
    s->all = pick(b, 4) == 0;
    int32_t *pair = take(b, 4 * s->n, sizeof *pair);
    real *w = take(b, s->nv, sizeof *w);
    vec *x0 = take(b, s->nv, sizeof *x0);
    s->x1 = take(b, s->nv, sizeof *s->x1);
    s->u = take(b, s->nv, sizeof *s->u);
    s->v = take(b, s->nv, sizeof *s->v);
    s->rolled = take(b, s->nv, 1);
    uint32_t prescribed = pick(b, 2) ? 2 : 16;
    for (int64_t i = 0; i < s->nv; i++) {
        w[i] = pick(b, prescribed) ? 1 : 0;
        x0[i] = pick_vec(b, 4);
        s->rolled[i] = w[i] > 0 && pick(b, 2);
        s->x1[i] = s->rolled[i] ? x0[i] : pick_vec(b, 4);
        s->u[i] = s->v[i] = s->rolled[i] ? vec_make(0, 0, 0) : pick_vec(b, 9);
    }
    for (int64_t k = 0; k < 4 * s->n; k++)
        pair[k] = (int32_t)pick(b, (uint32_t)s->nv);
    s->pair = pair;
    s->w = w;
    s->x0 = x0;
}

static bool still(const struct rollback *s, int64_t i)
{
    return s->x1[i].x == s->x0[i].x && s->x1[i].y == s->x0[i].y &&
           s->x1[i].z == s->x0[i].z && vec_dot(s->v[i], s->v[i]) == 0 &&
           vec_dot(s->u[i], s->u[i]) == 0;
}

const char *prop_rollback(const struct rollback *s)
{
    int64_t grown = 0, fresh = 0;
    for (int64_t i = 0; i < s->nv; i++) {
        EXPECT(!s->rolled[i] || (s->w[i] > 0 && still(s, i)));
        EXPECT(!s->touched[i] || s->rolled[i]);
        grown += s->touched[i];
    }
    EXPECT(grown == s->grown);
    /* §2: every pair that is not trapped has a vertex rolled back in this call
     */
    for (int64_t k = 0; k < s->n; k++) {
        bool any = false;
        for (int j = 0; j < 4; j++) {
            int32_t i = s->pair[4 * k + j];
            EXPECT(s->rolled[i] || !(s->w[i] > 0));
            any |= s->touched[i] != 0;
        }
        fresh += any;
    }
    EXPECT(fresh == s->n - s->trapped);
    for (int64_t i = 0; i < s->nv && s->all && s->grown; i++)
        EXPECT(s->rolled[i] || !(s->w[i] > 0));
    return NULL;
}
