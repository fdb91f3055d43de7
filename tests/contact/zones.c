/* SPDX-License-Identifier: Apache-2.0 */
/* Stage zones: generator and properties. spec/contact/zones.md */
#include "ref/contact/zones.h"

#include "ref/base/wide.h"
#include "tests/base/choices.h"

const struct field fields_zones[] = {IN(zones, pair, n, 4),
                                     IN(zones, w, nv, 1),
                                     IN(zones, x0, nv, 1),
                                     INOUT(zones, u, nv, 1),
                                     SCRATCH(zones, label, nv, 1),
                                     SCRATCH(zones, key, n4, 1),
                                     SCRATCH(zones, spare, n4, 1),
                                     SCRATCH(zones, sum, n4, 1),
                                     SCRATCH(zones, zone, n, 1),
                                     OUT_USED(zones, vertex, n4, 1, vertices),
                                     OUT_VALUE(zones, vertices),
                                     OUT_VALUE(zones, found),
                                     FIELD_END};

void gen_zones(struct bytes *b, struct zones *s)
{
    s->n = for_bench(b) ? 1 << 14 : pick_size(b);
    s->nv = 4 + s->n * (1 + pick(b, 8));
    s->n4 = 4 * s->n;
    s->dt = R(1.0) / 60;
    int32_t *pair = take(b, s->n4, sizeof *pair);
    real *w = take(b, s->nv, sizeof *w);
    vec *x0 = take(b, s->nv, sizeof *x0);
    s->u = take(b, s->nv, sizeof *s->u);
    uint32_t prescribed = pick(b, 3) ? 64 : 3;
    bool line = pick(b, 4) == 0;
    for (int64_t i = 0; i < s->nv; i++) {
        w[i] = pick(b, prescribed) ? pick_uniform(b, R(0.1), 1000) : 0;
        x0[i] = line ? vec_make(pick_real(b, 4), 1, 2) : pick_vec(b, 4);
        s->u[i] = pick_vec(b, 100);
    }
    for (int64_t k = 0; k < s->n4; k++) /* most pairs are local */
        pair[k] = (int32_t)((pick(b, 16) ? k / 4 * (s->nv / (s->n + 1)) +
                                               (int64_t)pick(b, 9)
                                         : (int64_t)choose(b)) %
                            s->nv);
    s->pair = pair;
    s->w = w;
    s->x0 = x0;
}

/* Finds the connected components by brute force: from each vertex that has no
 * zone yet. */
static int64_t count_zones(const struct zones *s, bool *in, int32_t *zone)
{
    int64_t found = 0;
    for (int64_t i = 0; i < s->nv; i++)
        zone[i] = -1;
    for (int64_t k = 0; k < s->n4; k++) {
        int32_t i = s->pair[k];
        in[i] |= s->w[i] > 0;
        if (!in[i] || zone[i] >= 0)
            continue;
        zone[i] = (int32_t)found++;
        for (bool more = true; more;) {
            more = false;
            for (int64_t j = 0; j < s->n4; j++) {
                const int32_t *v = s->pair + j / 4 * 4;
                for (int q = 0; q < 4; q++)
                    if (s->w[s->pair[j]] > 0 && zone[s->pair[j]] < 0 &&
                        s->w[v[q]] > 0 && zone[v[q]] == found - 1) {
                        zone[s->pair[j]] = (int32_t)found - 1;
                        more = true;
                    }
            }
        }
    }
    return found;
}

/* §3.1: members of one zone keep their distances. */
static const char *check_rigid(const struct zones *s, const int32_t *zone)
{
    for (int64_t k = 0; k + 1 < s->vertices; k++) {
        int32_t i = s->vertex[k], j = s->vertex[k + 1];
        if (zone[i] != zone[j])
            continue;
        vec d = vec_sub(s->x0[i], s->x0[j]);
        vec e = vec_axpy(d, s->dt, vec_sub(s->u[i], s->u[j]));
        real speed = vec_length(s->u[i]) + vec_length(s->u[j]);
        real bound = R(0x1p-17) * (8 + s->dt * speed);
        EXPECT(real_abs(vec_length(d) - vec_length(e)) <= bound);
    }
    return NULL;
}

const char *prop_zones(const struct zones *s)
{
    if (s->n > 300)
        return NULL;
    struct bytes b = {0};
    bool *in = take(&b, s->nv, sizeof *in);
    int32_t *zone = take(&b, s->nv, sizeof *zone);
    const char *failed = NULL;
    if (count_zones(s, in, zone) != s->found)
        failed = "§1: the number of zones";
    int64_t members = 0;
    for (int64_t i = 0; i < s->nv; i++) {
        members += in[i];
        if (!vec_sane(s->u[i]))
            failed = "§3: a velocity is not finite";
    }
    if (members != s->vertices)
        failed = "§1: the members of zones";
    if (!failed)
        failed = check_rigid(s, zone);
    choices_free(&b);
    return failed;
}

/* §4: momentum p, energy e, and the scale of rounding. */
static void momentum(const struct zones *s, struct wide *p, double *e,
                     double *scale)
{
    *p = wide_make(0, 0, 0);
    *e = *scale = 0;
    for (int64_t i = 0; i < s->nv; i++) {
        struct wide v = wide_of(s->u[i]);
        double m = 1 / (double)s->w[i];
        *p = wide_axpy(*p, m, v);
        *e += 0.5 * m * wide_dot(v, v);
        *scale += m * sqrt(wide_dot(v, v));
    }
}

static const char *conserve(struct bytes *b)
{
    struct zones s = {0};
    double e0, e1, scale0, scale1;
    struct wide p0, p1;
    gen_zones(b, &s);
    for (int64_t i = 0; i < s.nv; i++)
        ((real *)s.w)[i] = pick_uniform(b, R(0.5), 50);
    s.label = take(b, s.nv, sizeof *s.label);
    s.key = take(b, s.n4, sizeof *s.key);
    s.spare = take(b, s.n4, sizeof *s.spare);
    s.sum = take(b, s.n4, sizeof *s.sum);
    s.zone = take(b, s.n, sizeof *s.zone);
    s.vertex = take(b, s.n4, sizeof *s.vertex);
    momentum(&s, &p0, &e0, &scale0);
    EXPECT(ref_zones(&s) == DRAPE_OK);
    momentum(&s, &p1, &e1, &scale1);
    struct wide d = wide_sub(p1, p0);
    double eps = REAL_BITS == 32 ? 0x1p-24 : 0x1p-53;
    EXPECT(sqrt(wide_dot(d, d)) <= 64 * eps * (scale0 + scale1));
    EXPECT(e1 <= e0 * (1 + 256 * eps));
    return NULL;
}

const char *test_zones_conserve(void)
{
    for (int k = 0; k < 100; k++) {
        struct bytes b = {.seed = (uint64_t)k, .size = 1 + k};
        const char *failed = conserve(&b);
        choices_free(&b);
        if (failed)
            return failed;
        ran(1);
    }
    return NULL;
}

/* §3.4: a plate turns by h about its moving centre; vertices in one zone with
 * the plate keep their distances from its corners. */
static const char *follow(struct bytes *b)
{
    enum { NV = 8, N = 2 };
    static const int32_t pair[4 * N] = {4, 0, 1, 2, 5, 4, 2, 3};
    static const real w[NV] = {0, 0, 0, 0, 1, 2, 3, 4};
    int32_t label[NV], vertex[4 * N];
    struct key key[4 * N], spare[4 * N];
    struct zone_sum sum[4 * N];
    struct zone zone[N];
    vec x0[NV], u[NV], x1[NV];
    vec h = vec_scale(R(0.5), pick_vec(b, 1)), way = pick_vec(b, 2);
    real dt = R(0.01), f = 2 / (1 + vec_dot(h, h));
    for (int k = 0; k < NV; k++) {
        vec r = vec_make(k & 1 ? 1 : -1, k & 2 ? 1 : -1, 0);
        if (k >= 4)
            r = pick_vec(b, 2);
        vec turn = vec_cross(h, r);
        vec d = vec_axpy(way, f, vec_add(turn, vec_cross(h, turn)));
        x0[k] = vec_add(r, vec_make(3, 2, 1));
        u[k] = k < 4 ? vec_scale(1 / dt, d) : pick_vec(b, 50);
    }
    struct zones s = {.nv = NV,
                      .n = N,
                      .pair = pair,
                      .w = w,
                      .x0 = x0,
                      .dt = dt,
                      .u = u,
                      .n4 = 4 * N,
                      .label = label,
                      .key = key,
                      .spare = spare,
                      .sum = sum,
                      .zone = zone,
                      .vertex = vertex};
    EXPECT(ref_zones(&s) == DRAPE_OK && s.found == 1 && s.vertices == 2);
    for (int k = 0; k < NV; k++)
        x1[k] = vec_axpy(x0[k], dt, u[k]);
    for (int k = 4; k < 6; k++)
        for (int j = 0; j < 4; j++) {
            real d0 = vec_length(vec_sub(x0[k], x0[j]));
            real d1 = vec_length(vec_sub(x1[k], x1[j]));
            EXPECT(real_abs(d1 - d0) <= (REAL_BITS == 32 ? R(3e-5) : R(1e-13)));
        }
    return NULL;
}

const char *test_zones_follow(void)
{
    for (int k = 0; k < 200; k++) {
        struct bytes b = {.seed = (uint64_t)k, .size = -1};
        const char *failed = follow(&b);
        choices_free(&b);
        if (failed)
            return failed;
        ran(1);
    }
    return NULL;
}
