/* SPDX-License-Identifier: Apache-2.0 */
/* The generator and the properties of stage features. spec/broad/features.md */
#include "ref/broad/features.h"
#include "tests/base/choices.h"
#include "tests/broad/fabric.h"

const struct field fields_features[] = {
    IN(features, x0, nv, 1),
    IN(features, x1, nv, 1),
    IN(features, moved, n_moved, 1),
    IN(features, tri, nt, 1),
    IN(features, own, nt, 1),
    IN(features, both, n, 1),
    IN(features, start, n_start, 1),
    IN(features, sewn, n_sewn, 1),
    SCRATCH(features, mask, n, 1),
    SCRATCH(features, sum, n, 2),
    OUT_USED(features, pair, cap, 1, n_pair),
    OUT_USED(features, kind, cap, 1, n_pair),
    OUT_VALUE(features, n_pair),
    OUT_VALUE(features, n_vf),
    FIELD_END};

/* §5: lists of some vertices. */
static void pick_sewn(struct bytes *b, struct features *s)
{
    enum { MOST = 4 };
    s->n_start = pick(b, 3) == 0 && !for_bench(b) ? s->nv + 1 : 0;
    int32_t *start = take(b, s->n_start, sizeof *start);
    int32_t *sewn = take(b, s->n_start * MOST, sizeof *sewn);
    for (int64_t v = 0; v + 1 < s->n_start; v++) {
        for (uint32_t k = pick(b, 3) ? 0 : pick(b, MOST); k > 0; k--)
            sewn[s->n_sewn++] = (int32_t)pick(b, (uint32_t)s->nv);
        start[v + 1] = (int32_t)s->n_sewn;
    }
    s->start = start;
    s->sewn = sewn;
}

void gen_features(struct bytes *b, struct features *s)
{
    struct fabric f;
    struct tree tree;
    struct tree_map map;
    fabric_choose(b, &f, &tree, &map);
    s->nv = f.scene.vertices;
    s->nt = f.scene.tris;
    s->x0 = f.x0;
    s->x1 = f.x1;
    s->tri = tree.tri;
    s->own = tree.own;
    /* Not -0: box_meets then calls some boxes near, by the order in which they
     * are joined, that are apart after t = 0. */
    s->r = pick(b, 2) ? 0 : real_abs(pick_real(b, R(0.1))) + 0;
    s->n_moved = pick(b, 2) ? s->nv : 0;
    uint8_t *moved = take(b, s->n_moved, 1);
    for (int64_t v = 0; v < s->n_moved; v++)
        moved[v] = pick(b, 4) == 0;
    s->moved = moved;
    /* Pairs of triangles that are near and far in the list of triangles. */
    int32_t(*both)[2] = take(b, 8 * s->nt, sizeof *both);
    for (int32_t t = 0; t < s->nt; t++)
        for (int32_t k = 1; k < 8 && t + k * k < s->nt; k++) {
            both[s->n][0] = t;
            both[s->n++][1] = t + k * k;
        }
    s->both = (const int32_t(*)[2])both;
    s->cap = pick(b, 8) ? 15 * s->n : s->n / 2;
    pick_sewn(b, s);
}

static bool ordered(const struct features *s, int64_t k)
{
    const int32_t *v = s->pair[k];
    return s->kind[k] == FEATURES_VF
               ? v[0] != v[1] && v[0] != v[2] && v[0] != v[3]
               : v[0] < v[1] && v[2] < v[3] && v[0] < v[2] && v[1] != v[2] &&
                     v[1] != v[3];
}

static bool meeting(const struct features *s, int64_t k)
{
    const int32_t *v = s->pair[k];
    bool vf = s->kind[k] == FEATURES_VF;
    struct box a = vf ? box_vertex(s->x0, s->x1, v[0])
                      : box_edge(s->x0, s->x1, v[0], v[1]);
    struct box b =
        vf ? box_face(s->x0, s->x1, v + 1) : box_edge(s->x0, s->x1, v[2], v[3]);
    return box_meets(&a, &b, box_reach(s->r));
}

static bool stirred(const struct features *s, const int32_t v[4])
{
    bool any = s->n_moved == 0;
    for (int k = 0; k < 4 && s->n_moved; k++)
        any = any || s->moved[v[k]];
    return any;
}

/* §5: whether one of the first n of four vertices is sewn to another one. */
static bool joined(const struct features *s, const int32_t v[4], int n)
{
    for (int i = 0; i < n && s->n_start; i++)
        for (int32_t k = s->start[v[i]]; k < s->start[v[i] + 1]; k++)
            for (int j = n; j < 4; j++)
                if (s->sewn[k] == v[j])
                    return true;
    return false;
}

/* Counts the feature pairs that a pair of triangles represents, one by one. */
static int64_t count_pair(const struct features *s, const int32_t both[2])
{
    int64_t count = 0;
    for (int side = 0; side < 2; side++) {
        const int32_t *f = s->tri[both[side]], *g = s->tri[both[!side]];
        for (int k = 0; k < 3; k++) {
            int32_t v[4] = {f[k], g[0], g[1], g[2]};
            struct box a = box_vertex(s->x0, s->x1, v[0]);
            struct box b = box_face(s->x0, s->x1, g);
            count += s->own[both[side]] >> k & 1 && v[0] != v[1] &&
                     v[0] != v[2] && v[0] != v[3] && stirred(s, v) &&
                     !joined(s, v, 1) && box_meets(&a, &b, box_reach(s->r));
        }
    }
    const int32_t *f = s->tri[both[0]], *g = s->tri[both[1]];
    for (int k = 0; k < 9; k++) {
        int i = k / 3, j = k % 3;
        int32_t v[4] = {f[i], f[(i + 1) % 3], g[j], g[(j + 1) % 3]};
        struct box a = box_edge(s->x0, s->x1, v[0], v[1]);
        struct box b = box_edge(s->x0, s->x1, v[2], v[3]);
        count += s->own[both[0]] >> (3 + i) & s->own[both[1]] >> (3 + j) & 1 &&
                 v[0] != v[2] && v[0] != v[3] && v[1] != v[2] && v[1] != v[3] &&
                 stirred(s, v) && !joined(s, v, 2) &&
                 box_meets(&a, &b, box_reach(s->r));
    }
    return count;
}

/* §1 to §3: the number of candidates is right; each meets, shares no vertex and
 * is in order; vertex-face comes before edge-edge. */
const char *prop_features(const struct features *s)
{
    int64_t count = 0;
    for (int64_t k = 0; k < s->n; k++)
        count += count_pair(s, s->both[k]);
    EXPECT(count == s->n_pair && s->n_vf <= s->n_pair);
    for (int64_t k = 0; k < s->n_pair; k++) {
        EXPECT(s->kind[k] == (k < s->n_vf ? FEATURES_VF : FEATURES_EE));
        EXPECT(ordered(s, k) && meeting(s, k) && stirred(s, s->pair[k]));
    }
    return NULL;
}

/* A stage that is refused or needs more room reports no candidate: the second
 * also says how much room. */
const char *test_features_refused(void)
{
    int full = 0;
    for (uint64_t k = 0; k < 40; k++) {
        struct bytes b = {.seed = k, .size = 33};
        struct features s = {0};
        gen_features(&b, &s);
        s.mask = take(&b, s.n, sizeof *s.mask);
        s.sum = take(&b, 2 * bvtt_blocks(s.n) + 2, sizeof *s.sum);
        s.cap = 0;
        s.n_pair = s.n_vf = -1;
        int status = ref_features(&s);
        full += status == DRAPE_EFULL;
        EXPECT(status == (s.need > 0 ? DRAPE_EFULL : DRAPE_OK));
        EXPECT(s.n_pair == 0 && s.n_vf == 0);
        for (int wrong = 0; wrong < 3; wrong++) {
            s.r = wrong == 0 ? -1 : wrong == 1 ? (real)NAN : 2 * REAL_BIG;
            s.n_pair = s.n_vf = -1;
            EXPECT(ref_features(&s) == DRAPE_EDATA);
            EXPECT(s.n_pair == 0 && s.n_vf == 0);
        }
        choices_free(&b);
        ran(1);
    }
    EXPECT(full > 20);
    return NULL;
}
