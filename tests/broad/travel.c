/* SPDX-License-Identifier: Apache-2.0 */
/* The generator and the properties of stage travel. spec/broad/travel.md */
#include "ref/broad/travel.h"

#include "tests/base/choices.h"

const struct field fields_travel[] = {
    IN(travel, pair, n, 4), IN(travel, kind, n, 1),  IN(travel, x0, nv, 1),
    IN(travel, x1, nv, 1),  OUT_VALUE(travel, most), FIELD_END};

/* Integer coordinates, so that differences are exact. */
static vec pick_corner(struct bytes *b, uint32_t side)
{
    real x = (real)pick(b, side), y = (real)pick(b, side);
    return vec_make(x, y, (real)pick(b, side));
}

void gen_travel(struct bytes *b, struct travel *s)
{
    s->n = for_bench(b) ? 1 << 20 : pick_size(b);
    s->nv = 8 + s->n / 4;
    int32_t *pair = take(b, 4 * s->n, sizeof *pair);
    uint8_t *kind = take(b, s->n, 1);
    vec *x0 = take(b, s->nv, sizeof *x0), *x1 = take(b, s->nv, sizeof *x1);
    bool falls = pick(b, 4) == 0; /* all vertices move alike, so relative
                                     motion is 0 */
    vec fall = pick_corner(b, 8);
    for (int64_t i = 0; i < s->nv; i++) {
        x0[i] = pick_corner(b, 64);
        x1[i] = falls ? vec_add(x0[i], fall) : pick_vec(b, 64);
    }
    for (int64_t k = 0; k < s->n; k++) {
        kind[k] = (uint8_t)pick(b, 2);
        pick_four(b, s->nv, pair + 4 * k);
    }
    s->pair = pair;
    s->kind = kind;
    s->x0 = x0;
    s->x1 = x1;
}

/* Whether vertices a and b of candidate k belong to different primitives. */
static bool across(const struct travel *s, int64_t k, int a, int b)
{
    int first = s->kind[k] ? 2 : 1;
    return (a < first) != (b < first);
}

const char *prop_travel(const struct travel *s)
{
    bool reached = s->most == 0;
    for (int64_t k = 0; k < s->n; k++)
        for (int a = 0; a < 4; a++)
            for (int b = 0; b < 4; b++) {
                int32_t i = s->pair[4 * k + a], j = s->pair[4 * k + b];
                vec d = vec_sub(vec_sub(s->x1[i], s->x0[i]),
                                vec_sub(s->x1[j], s->x0[j]));
                if (!across(s, k, a, b))
                    continue;
                EXPECT(vec_dot(d, d) <= s->most);
                reached |= vec_dot(d, d) == s->most;
            }
    EXPECT(reached); /* some candidate has this motion: a maximum, not just a
                        bound */
    return NULL;
}
