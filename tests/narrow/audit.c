/* SPDX-License-Identifier: Apache-2.0 */
/* The generator, the properties and the tests of stage audit.
 * spec/narrow/audit.md */
#include "ref/narrow/audit.h"

#include <stdlib.h>

#include "oracle/oracle.h"
#include "oracle/rational.h"
#include "ref/narrow/tritri.h"
#include "tests/base/choices.h"
#include "tests/base/data.h"
#include "tests/narrow/ply.h"

const struct field fields_audit[] = {IN(audit, x, nv, 1),
                                     IN(audit, tri, nt, 1),
                                     IN(audit, group, nt, 1),
                                     SCRATCH(audit, key[0], nt, 1),
                                     SCRATCH(audit, key[1], nt, 1),
                                     SCRATCH(audit, order[0], nt, 1),
                                     SCRATCH(audit, order[1], nt, 1),
                                     SCRATCH(audit, node, n_nodes, 1),
                                     SCRATCH(audit, count, n_nodes, 1),
                                     OUT_USED(audit, pair, cap, 1, found),
                                     OUT(audit, degenerate, nt, 1),
                                     OUT_VALUE(audit, found),
                                     OUT_VALUE(audit, n_degenerate),
                                     FIELD_END};

struct mesh {
    int64_t nv, nt;
    vec *x;
    int32_t (*tri)[3];
};

static real power(int e)
{
    real r = 1;
    for (; e != 0; e += e < 0 ? 1 : -1)
        r *= e < 0 ? R(0.5) : R(2.0);
    return r;
}

static struct mesh take_mesh(struct bytes *b, int64_t nv, int64_t nt)
{
    struct mesh m = {nv, nt, NULL, NULL};
    m.x = take(b, nv, sizeof *m.x);
    m.tri = take(b, nt, sizeof *m.tri);
    return m;
}

static vec pick_lattice(struct bytes *b, uint32_t side)
{
    real x = (real)pick(b, side), y = (real)pick(b, side);
    return vec_make(x, y, (real)pick(b, side));
}

/* Makes a soup. Few triangles use any vertices; many triangles use vertices of
 * near numbers. The vertices are on a small lattice, in one plane, or have
 * adversarial coordinates. */
static struct mesh pick_soup(struct bytes *b, int64_t nt)
{
    bool few = nt <= 64;
    struct mesh m = take_mesh(b, nt / (1 + pick(b, 3)) + 4, nt);
    uint32_t side = few ? 3 + pick(b, 6) : 3, kind = pick(b, few ? 4 : 2);
    real scale = power((int)pick(b, 81) - 40);
    for (int64_t k = 0; k < m.nv; k++) {
        vec p = pick_lattice(b, side);
        if (!few)
            p = vec_add(p, vec_make((real)(k % 31), (real)(k / 31), 0));
        if (kind == 1)
            p.z = 5 * p.x - 3 * p.y;
        if (kind == 2)
            p = pick_vec(b, pick(b, 2) ? 1 : REAL_BIG);
        if (kind == 3)
            p = vec_add(p, pick_vec(b, R(0x1p-20)));
        m.x[k] = kind == 2 ? p : vec_scale(scale, p);
    }
    uint32_t near = few ? (uint32_t)m.nv : 4;
    for (int64_t t = 0; t < nt; t++) {
        int64_t from = pick(b, (uint32_t)m.nv);
        for (int j = 0; j < 3; j++)
            m.tri[t][j] = (int32_t)((from + pick(b, near)) % m.nv);
    }
    return m;
}

/* Mutates a grid once: moves a vertex onto another vertex, between two vertices
 * or at random, or folds the part beyond a line over or at a right angle. */
static void mutate(struct bytes *b, struct mesh m)
{
    uint32_t n = (uint32_t)m.nv, kind = pick(b, 5);
    vec *p = &m.x[pick(b, n)], q = m.x[pick(b, n)], r = m.x[pick(b, n)];
    if (kind == 0)
        *p = q;
    if (kind == 1)
        *p = vec_scale(R(0.5), vec_add(q, r));
    if (kind == 2)
        *p = vec_add(*p, pick_vec(b, 2));
    for (int64_t k = 0; k < m.nv && kind > 2; k++) {
        vec *x = &m.x[k];
        if (kind == 3 && x->x > q.x)
            x->x = 2 * q.x - x->x;
        if (kind == 4 && x->z > q.z)
            *x = vec_make(x->x, x->z - q.z, q.z);
    }
}

/* Makes a flat, rough or oblique cloth and mutates it. */
static struct mesh pick_grid(struct bytes *b, int64_t nt)
{
    int64_t rows = 1 + (int64_t)pick(b, 20), t = 0;
    int64_t columns = (nt / 2 + rows) / rows;
    struct mesh m = take_mesh(b, (rows + 1) * (columns + 1), nt);
    uint32_t rough = pick(b, 3), tilt = pick(b, 3);
    for (int64_t k = 0; k < m.nv; k++) {
        real i = (real)(k % (columns + 1)), j = (real)(k / (columns + 1));
        real y = rough == 0   ? 0
                 : rough == 1 ? (real)pick(b, 2)
                              : pick_uniform(b, 0, 1);
        m.x[k] = vec_make(i, y + (real)tilt * (i + R(0.3) * j), j);
    }
    for (int64_t c = 0; t < nt; c++) {
        int32_t a = (int32_t)(c % columns + c / columns * (columns + 1));
        int32_t d = a + (int32_t)columns + 1;
        const int32_t v[2][3] = {{a, a + 1, d + 1}, {a, d + 1, d}};
        for (int j = 0; j < 2 && t < nt; j++, t++)
            memcpy(m.tri[t], v[j], sizeof v[j]);
    }
    for (uint32_t k = pick(b, 6); k > 0; k--)
        mutate(b, m);
    return m;
}

/* Makes the benchmark's mesh: a wavy cloth of 20,000 triangles just above an
 * obstacle of 20,000 triangles. Nothing intersects. */
static struct mesh bench_mesh(struct bytes *b)
{
    enum { SIDE = 101, HALF = SIDE * SIDE };
    struct mesh m = take_mesh(b, 2 * HALF, 40000);
    for (int k = 0; k < 2 * HALF; k++) {
        real i = (real)(k % SIDE), j = (real)(k / SIDE % SIDE);
        real u = i / 50 - 1, v = j / 50 - 1;
        real y = u * u * (1 - v) - v * v * u + pick_uniform(b, 0, R(0.004));
        m.x[k] = vec_make(u, k < HALF ? y + R(0.005) : y, v);
    }
    for (int64_t t = 0; t < m.nt; t++) {
        int64_t c = t % 20000 / 2, of = t / 20000 * HALF;
        int32_t a = (int32_t)(of + c % (SIDE - 1) + c / (SIDE - 1) * SIDE);
        m.tri[t][0] = a;
        m.tri[t][1] = t % 2 ? a + SIDE + 1 : a + 1;
        m.tri[t][2] = t % 2 ? a + SIDE : a + SIDE + 1;
    }
    return m;
}

static void set_mesh(struct audit *s, struct mesh m)
{
    s->nv = m.nv;
    s->nt = m.nt;
    s->x = m.x;
    s->tri = (const int32_t(*)[3])m.tri;
    s->n_nodes = ref_audit_nodes(m.nt);
    s->cap = m.nt * (m.nt - 1) / 2;
}

void gen_audit(struct bytes *b, struct audit *s)
{
    bool bench = for_bench(b);
    int64_t nt = bench ? 0 : pick_size(b);
    set_mesh(s, bench        ? bench_mesh(b)
                : pick(b, 2) ? pick_soup(b, nt)
                             : pick_grid(b, nt));
    if (bench)
        s->cap = 1024;
    else if (pick(b, 8) == 0)
        s->cap = (int64_t)pick(b, 1 + (uint32_t)s->cap);
    int32_t *group = take(b, s->nt, sizeof *group);
    uint32_t groups = 1 + pick(b, 3);
    for (int64_t t = 0; t < s->nt; t++)
        group[t] = bench        ? t < 20000
                   : groups > 1 ? (int32_t)pick(b, groups)
                                : 1;
    s->group = group;
    s->across = !bench && pick(b, 4) == 0;
}

static struct face face_of(const struct audit *s, int64_t t)
{
    struct face f;
    for (int j = 0; j < 3; j++) {
        f.v[j] = s->tri[t][j];
        vec x = s->x[f.v[j]];
        point p = {(double)x.x, (double)x.y, (double)x.z};
        memcpy(f.p[j], p, sizeof p);
    }
    return f;
}

static bool on_line(const point t[3])
{
    return !ref_orient2_integer(t[0], t[1], t[2], 0, 1) &&
           !ref_orient2_integer(t[0], t[1], t[2], 1, 2) &&
           !ref_orient2_integer(t[0], t[1], t[2], 2, 0);
}

/* §1.2 by an independent method: rational arithmetic and clipping. */
static bool crosses(struct face f, struct face g)
{
    double p[2][3][3];
    int shared = 0;
    bool used[2][3] = {{false}};
    for (int i = 0; i < 9; i++)
        if (f.v[i / 3] == g.v[i % 3] && !used[0][i / 3] && !used[1][i % 3]) {
            memcpy(p[0][shared], f.p[i / 3], sizeof f.p[0]);
            memcpy(p[1][shared++], f.p[i / 3], sizeof f.p[0]);
            used[0][i / 3] = used[1][i % 3] = true;
        }
    int n[2] = {shared, shared};
    for (int i = 0; i < 6; i++)
        if (!used[i / 3][i % 3])
            memcpy(p[i / 3][n[i / 3]++], i < 3 ? f.p[i] : g.p[i - 3],
                   sizeof f.p[0]);
    return orc_triangles((const double(*)[3])p[0], (const double(*)[3])p[1],
                         shared);
}

/* §1.3: whether triangles a and b are compared. */
static bool compared(const struct audit *s, int64_t a, int64_t b)
{
    bool first = s->group[a] != 0, second = s->group[b] != 0;
    return s->across ? first != second : first || second;
}

const char *prop_audit(const struct audit *s)
{
    int64_t degenerate = 0, at = 0;
    for (int64_t t = 0; t < s->nt; t++) { /* §1.1 */
        struct face f = face_of(s, t);
        EXPECT(s->degenerate[t] == on_line((const double(*)[3])f.p));
        degenerate += s->degenerate[t];
    }
    EXPECT(s->n_degenerate == degenerate && s->found <= s->cap);
    for (int64_t k = 0; k < s->found; k++) { /* §1.3, §1.4 */
        const int32_t *p = s->pair[k];
        EXPECT(p[0] >= 0 && p[0] < p[1] && p[1] < s->nt);
        EXPECT(compared(s, p[0], p[1]));
        EXPECT(k == 0 || p[-2] < p[0] || (p[-2] == p[0] && p[-1] < p[1]));
    }
    /* §4.2: the tree leaves no pair out. */
    for (int64_t a = 0; a < s->nt && s->nt <= 300; a++)
        for (int64_t b = a + 1; b < s->nt; b++) {
            struct face f = face_of(s, a), g = face_of(s, b);
            struct plane of_f = ref_plane(&f);
            bool hit = compared(s, a, b) && !s->degenerate[a] &&
                       !s->degenerate[b] && ref_tritri(&f, &of_f, &g);
            bool listed =
                at < s->found && s->pair[at][0] == a && s->pair[at][1] == b;
            EXPECT(hit == listed);
            if (s->nt <= 16 && orc_present() && compared(s, a, b))
                EXPECT(hit == crosses(f, g));
            at += listed;
        }
    EXPECT(s->nt > 300 || at == s->found);
    return NULL;
}

/* Allocates scratch and outputs of s. Freeing s->pair frees all of them. */
static void *allocate(struct audit *s)
{
    size_t nt = (size_t)s->nt + 1, nodes = (size_t)s->n_nodes + 1;
    size_t pairs = (size_t)s->cap + 1;
    size_t bytes = nt * 28 + nodes * (sizeof *s->node + 8) + pairs * 8;
    char *p = malloc(bytes), *all = p;
    if (!p)
        abort();
    s->node = (void *)p, p += nodes * sizeof *s->node;
    s->count = (void *)p, p += nodes * 8;
    s->key[0] = (void *)p, p += nt * 8;
    s->key[1] = (void *)p, p += nt * 8;
    s->pair = (void *)p, p += pairs * 8;
    s->order[0] = (void *)p, p += nt * 4;
    s->order[1] = (void *)p, p += nt * 4;
    s->degenerate = (void *)p;
    return all;
}

/* Compares with the pairs of an oracle; -1 pairs means that the oracle does not
 * apply. */
static const char *same(const struct audit *s, int64_t found,
                        int64_t degenerate, int32_t (*pair)[2])
{
    if (found < 0)
        return NULL;
    EXPECT(found == s->found && degenerate == s->n_degenerate);
    for (int64_t k = 0; k < found; k++)
        EXPECT(pair[k][0] == s->pair[k][0] && pair[k][1] == s->pair[k][1]);
    ran(1);
    return NULL;
}

static const char *against_cgal(struct bytes *b, struct audit *s)
{
    void *memory = allocate(s);
    double(*x)[3] = take(b, s->nv, sizeof *x);
    int32_t(*pair)[2] = take(b, s->cap, sizeof *pair);
    bool all = true;
    for (int64_t k = 0; k < s->nv; k++) {
        x[k][0] = (double)s->x[k].x;
        x[k][1] = (double)s->x[k].y;
        x[k][2] = (double)s->x[k].z;
    }
    for (int64_t t = 0; t < s->nt && s->group; t++)
        all &= s->group[t] != 0;
    int64_t degenerate, found;
    const double(*p)[3] = (const double(*)[3])x;
    const char *what = ref_audit(s) == DRAPE_OK ? NULL : "audit failed";
    found = orc_self_pairs(s->nv, p, s->nt, s->tri, s->group, s->cap, pair,
                           &degenerate);
    what = what ? what : same(s, found, degenerate, pair);
    found =
        all ? orc_self_pmp(s->nv, p, s->nt, s->tri, s->cap, pair, &degenerate)
            : -1;
    what = what ? what : same(s, found, degenerate, pair);
    free(memory);
    return what;
}

/* §1.4: the pairs are CGAL's, on soups and on mutated cloths. */
const char *test_audit_cgal(void)
{
    if (!orc_present())
        return skip(NO_ORACLES);
    const char *what = NULL;
    for (int k = 0; k < 120 && !what; k++) {
        struct bytes b = {.seed = (uint64_t)k, .size = k < 110 ? 1 + k : 1000};
        struct audit s = {0};
        gen_audit(&b, &s);
        s.across = 0; /* the oracle has no such option */
        s.cap = s.nt * (s.nt - 1) / 2;
        what = against_cgal(&b, &s);
        choices_free(&b);
    }
    return what;
}

/* As test_audit_cgal, on whole statues and frames, some of which intersect
 * themselves. */
const char *test_audit_shared(void)
{
    static const char *const files[] = {"models/lion_20k.ply",
                                        "ccd/frames/cloth-funnel/t0.ply",
                                        "ccd/frames/cloth-funnel/t1.ply"};
    const char *what = NULL;
    if (!orc_present())
        return skip(NO_ORACLES);
    for (size_t k = 0; k < sizeof files / sizeof *files && !what; k++) {
        struct bytes b = {.size = 0};
        struct ply p;
        char path[512];
        snprintf(path, sizeof path, "%s/%s", data_home(), files[k]);
        if (!ply_read(path, &p)) {
            ply_free(&p);
            return skip("no models or ccd/frames in DRAPE_DATA" FETCHED);
        }
        struct audit s = {0};
        struct mesh m = {p.nv, p.nt, p.x, p.tri};
        set_mesh(&s, m);
        s.cap = 1 << 16;
        what = against_cgal(&b, &s);
        choices_free(&b);
        ply_free(&p);
    }
    return what;
}

/* Too small a capacity gives the count and then suffices with that count; bad
 * input is refused. */
const char *test_audit_status(void)
{
    vec x[6];
    const int32_t tri[2][3] = {{0, 1, 2}, {3, 4, 5}};
    for (int k = 0; k < 6; k++)
        x[k] = vec_make(k % 3 == 1, k % 3 == 2, 0);
    struct audit s = {.nv = 6, .nt = 2, .x = x, .tri = tri};
    s.n_nodes = ref_audit_nodes(s.nt);
    s.cap = 1;
    void *memory = allocate(&s);
    s.cap = 0;
    int full = ref_audit(&s);
    int64_t needed = s.found;
    s.cap = needed;
    int good = ref_audit(&s);
    bool pair = s.found == 1 && s.pair[0][0] == 0 && s.pair[0][1] == 1;
    s.nv = 5;
    int range = ref_audit(&s);
    s.nv = 6;
    x[3].y = 2 * REAL_BIG;
    int big = ref_audit(&s);
    x[3].y = (real)NAN;
    int nan = ref_audit(&s);
    free(memory);
    EXPECT(full == DRAPE_EFULL && needed == 1);
    EXPECT(good == DRAPE_OK && pair);
    EXPECT(range == DRAPE_EARG && big == DRAPE_EDATA && nan == DRAPE_EDATA);
    ran(5);
    return NULL;
}
