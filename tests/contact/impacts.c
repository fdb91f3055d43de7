/* SPDX-License-Identifier: Apache-2.0 */
/* Stage impacts: generator and properties. spec/contact/impacts.md */
#include "ref/contact/impacts.h"

#include "ref/narrow/exact.h"
#include "ref/narrow/narrow.h"
#include "tests/base/choices.h"

const struct field fields_impacts[] = {
    IN(impacts, pair, n, 4),
    IN(impacts, kind, n, 1),
    IN(impacts, toi, n, 1),
    IN(impacts, x0, nv, 1),
    IN(impacts, w, nv, 1),
    SCRATCH(impacts, at, n, 1),
    OUT_USED(impacts, hit, cap, 4, found),
    OUT_USED(impacts, hit_kind, cap, 1, found),
    OUT_USED(impacts, hit_toi, cap, 1, found),
    OUT_VALUE(impacts, found),
    OUT_VALUE(impacts, started),
    OUT_VALUE(impacts, prescribed),
    FIELD_END};

void gen_impacts(struct bytes *b, struct impacts *s)
{
    s->n = for_bench(b) ? 1 << 20 : pick_size(b);
    s->nv = 8 + s->n / 4;
    int32_t *pair = take(b, 4 * s->n, sizeof *pair);
    uint8_t *kind = take(b, s->n, 1);
    uint32_t *toi = take(b, s->n, sizeof *toi);
    vec *x = take(b, s->nv, sizeof *x);
    real *w = take(b, s->nv, sizeof *w);
    for (int64_t i = 0; i < s->nv; i++) {
        x[i].x = (real)pick(b, 3);
        x[i].y = (real)pick(b, 3);
        x[i].z = (real)pick(b, 3);
        w[i] = (real)pick(b, 2);
    }
    for (int64_t k = 0; k < s->n; k++) {
        kind[k] = (uint8_t)pick(b, 2);
        toi[k] = pick(b, 3) ? NARROW_MISS : pick(b, 2) * 12345;
        pick_four(b, s->nv, pair + 4 * k);
    }
    s->pair = pair;
    s->kind = kind;
    s->toi = toi;
    s->x0 = x;
    s->w = w;
    s->cap = pick(b, 8) ? s->n : s->n / 16;
}

/* Whether pair k touches at the start of the step, by the exact tier of the
 * narrow phase alone. */
static bool starts(const struct impacts *s, int64_t k)
{
    static _Thread_local uint32_t word[EXACT_WORDS];
    double x[2][4][3];
    uint32_t toi = NARROW_MISS;
    for (int j = 0; j < 8; j++) {
        vec a = s->x0[s->pair[4 * k + j % 4]];
        x[j / 4][j % 4][0] = (double)a.x;
        x[j / 4][j % 4][1] = (double)a.y;
        x[j / 4][j % 4][2] = (double)a.z;
    }
    exact_first(x, s->kind[k], word, EXACT_WORDS, &toi);
    return toi != NARROW_MISS;
}

const char *prop_impacts(const struct impacts *s)
{
    int64_t at = 0, touching = 0, started = 0, prescribed = 0;
    for (int64_t k = 0; k < s->n; k++) {
        const int32_t *v = s->pair + 4 * k;
        if (s->toi[k] == NARROW_MISS)
            continue;
        touching++;
        bool kept = at < s->found && !memcmp(s->hit + 4 * at, v, 16) &&
                    s->hit_kind[at] == s->kind[k] &&
                    s->hit_toi[at] == s->toi[k];
        real w = 0;
        for (int j = 0; j < 4; j++)
            w += s->w[v[j]];
        bool first = w > 0 && s->toi[k] == 0 && starts(s, k);
        EXPECT(kept == (w > 0 && !first)); /* §1 */
        at += kept;
        started += first;
        prescribed += w == 0;
    }
    EXPECT(at == s->found && s->started == started &&
           s->prescribed == prescribed);
    EXPECT(s->found + s->started + s->prescribed ==
           touching); /* §1: none is lost */
    return NULL;
}
