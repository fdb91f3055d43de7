/* SPDX-License-Identifier: Apache-2.0 */
/* Stage bounds: generator and properties. spec/20_bounds.md */
#include "ref/bounds.h"

#include "tests/harness.h"

const struct field fields_bounds[] = {
    IN(bounds, x0, n, 1), IN(bounds, x1, n, 1), OUT(bounds, lo, n, 1),
    OUT(bounds, hi, n, 1), FIELD_END};

void gen_bounds(struct bytes *b, struct bounds *s)
{
    s->n = for_bench(b) ? 1 << 20 : pick_size(b);
    s->r = real_abs(pick_real(b, pick(b, 2) ? 1 : REAL_BIG));
    vec *x0 = take(b, s->n, sizeof *x0);
    vec *x1 = take(b, s->n, sizeof *x1);
    real scale = pick(b, 2) ? 1 : REAL_BIG;
    for (int64_t k = 0; k < s->n; k++) {
        x0[k] = pick_vec(b, scale);
        x1[k] = pick(b, 4) ? pick_vec(b, scale) : x0[k];
    }
    s->x0 = x0;
    s->x1 = x1;
}

/* §2: x ± r, formed in twice the precision where there is one, lies in. */
static bool covers(real lo, real hi, real x, real r)
{
    return (double)lo <= (double)x - (double)r &&
           (double)hi >= (double)x + (double)r;
}

const char *prop_bounds(const struct bounds *s)
{
    for (int64_t k = 0; k < s->n; k++) {
        vec lo = s->lo[k], hi = s->hi[k], a = s->x0[k], b = s->x1[k];
        EXPECT(covers(lo.x, hi.x, a.x, s->r) && covers(lo.x, hi.x, b.x, s->r));
        EXPECT(covers(lo.y, hi.y, a.y, s->r) && covers(lo.y, hi.y, b.y, s->r));
        EXPECT(covers(lo.z, hi.z, a.z, s->r) && covers(lo.z, hi.z, b.z, s->r));
    }
    return NULL;
}
