/* SPDX-License-Identifier: Apache-2.0 */
/* Contacts of whole surfaces: which of their pairs stage proximity keeps, and
 * with which normals. spec/contact/proximity.md §3 */
#include "tests/base/choices.h"
#include "tests/contact/proximity.h"

/* Lists the triangles around each of n vertices. start: [n + 1], start[0] is 0;
 * rim: [3·triangles]. */
static void list_one_rings(int32_t n, int triangles, const int32_t (*tri)[3],
                           int32_t *start, int32_t (*opposite)[2])
{
    int32_t at = 0;
    for (int32_t i = 0; i < n; i++) {
        for (int k = 0; k < 3 * triangles; k++)
            if (tri[k / 3][k % 3] == i) {
                opposite[at][0] = tri[k / 3][(k + 1) % 3];
                opposite[at++][1] = tri[k / 3][(k + 2) % 3];
            }
        start[i + 1] = at;
    }
}

/* §3.2: a prescribed plane of triangles, and free vertices above it */
enum { SIDE = 5, GROUND = SIDE * SIDE, FREE = 64, MESH = GROUND + FREE };
enum { TRIS = 2 * (SIDE - 1) * (SIDE - 1) };

struct ground {
    vec x[MESH], up;
    real w[MESH];
    uint16_t of[MESH];
    int32_t tri[TRIS][3], start[MESH + 1], opposite[3 * TRIS][2];
    struct surface surface;
};

/* A plane across `up`; each cell is cut along a diagonal that is picked. */
static void make_ground(struct bytes *b, struct ground *s)
{
    memset(s, 0, sizeof *s);
    s->surface = (struct surface){R(0.1), R(0.3)};
    vec n = vec_make(pick_uniform(b, -1, 1), 1, pick_uniform(b, -1, 1));
    s->up = vec_scale(1 / vec_length(n), n);
    vec e = vec_make(s->up.y, -s->up.x, 0);
    e = vec_scale(1 / vec_length(e), e);
    vec f = vec_cross(s->up, e);
    for (int i = 0; i < MESH; i++) {
        bool ground = i < GROUND;
        real a = ground ? (real)(i % SIDE) : pick_uniform(b, 1, 3);
        real c = ground ? (real)(i / SIDE) : pick_uniform(b, 1, 3);
        real h = ground ? 0 : pick_uniform(b, R(0.001), R(0.099));
        s->x[i] = vec_axpy(vec_axpy(vec_scale(a, e), c, f), h, s->up);
        s->w[i] = ground ? 0 : 1;
    }
    for (int k = 0; k < TRIS / 2; k++) {
        int32_t p = k % (SIDE - 1) + SIDE * (k / (SIDE - 1));
        int32_t c[4] = {p, p + 1, p + SIDE + 1, p + SIDE};
        int turn = (int)pick(b, 2);
        for (int j = 0; j < 6; j++)
            s->tri[2 * k + j / 3][j % 3] =
                c[(turn + (j < 3 ? j : (j - 1) % 4)) % 4];
    }
    list_one_rings(MESH, TRIS, (const int32_t(*)[3])s->tri, s->start,
                   s->opposite);
}

/* Every free vertex with every triangle, and every edge between neighbouring
 * free vertices with every side of a triangle. Returns the number of pairs. */
static int64_t pair_all(const struct ground *s, int32_t *pair, uint8_t *kind)
{
    int64_t n = 0;
    for (int32_t i = GROUND; i < MESH; i++)
        for (int t = 0; t < 4 * TRIS; t++) {
            const int32_t *f = s->tri[t / 4];
            int j = t % 4;
            int32_t edge[4] = {i, i + 1, f[j % 3], f[(j + 1) % 3]};
            int32_t face[4] = {i, f[0], f[1], f[2]};
            if (j < 3 && i + 1 == MESH)
                continue;
            memcpy(pair + 4 * n, j < 3 ? edge : face, sizeof face);
            kind[n++] = j < 3 ? CONTACT_EE : CONTACT_VF;
        }
    return n;
}

/* §3.2: however a plane is cut into triangles, the normals of contacts with it
 * are the plane's, gaps are heights, and no vertex is without a contact. */
const char *test_proximity_flat(void)
{
    enum { PAIRS = 4 * TRIS * FREE };
    static int32_t pair[4 * PAIRS], at[PAIRS];
    static uint8_t kind[PAIRS];
    static struct contact contact[PAIRS];
    for (int k = 0; k < 20; k++) {
        struct bytes b = {.seed = (uint64_t)k, .size = -1};
        struct ground s;
        bool met[MESH] = {false};
        make_ground(&b, &s);
        struct proximity p = {.range = 1,
                              .nv = MESH,
                              .n = pair_all(&s, pair, kind),
                              .pair = pair,
                              .kind = kind,
                              .x = s.x,
                              .w = s.w,
                              .surfaces = {1, s.of, &s.surface},
                              .one_rings = {MESH + 1, 3 * TRIS, s.start,
                                            (const int32_t(*)[2])s.opposite},
                              .dt = R(0.01),
                              .at = at,
                              .cap = PAIRS,
                              .contact = contact};
        EXPECT(ref_proximity(&p) == DRAPE_OK);
        for (int64_t j = 0; j < p.found; j++) {
            const struct contact *c = &contact[j];
            vec gap = pair_sum(c->v, c->c, s.x);
            EXPECT((double)vec_dot(c->n, s.up) > 1 - 0x1p-22); /* 2^-14 off */
            EXPECT(fabs((double)(vec_dot(gap, s.up) - c->gap)) < 1e-4);
            met[c->v[0]] |= c->kind == CONTACT_VF;
        }
        for (int i = GROUND; i < MESH; i++)
            EXPECT(met[i]);
        choices_free(&b);
        ran(1);
    }
    return NULL;
}

/* §3.3: two free sheets of WIDE^2 vertices, one over the other */
enum { WIDE = 6, SHEET = WIDE * WIDE, BOTH = 2 * SHEET };
enum { CELLS = (WIDE - 1) * (WIDE - 1), HALF = 2 * CELLS };
enum { SIDES_OF = 3 * HALF };
enum { ALL = 2 * SHEET * HALF + SIDES_OF * SIDES_OF };

struct sheets {
    vec x[BOTH];
    real w[BOTH];
    uint16_t of[BOTH];
    int32_t tri[2 * HALF][3], start[BOTH + 1], opposite[6 * HALF][2];
    struct surface surface;
};

/* aside: how far the upper sheet is shifted, in cells; rough: how far vertices
 * may be off their plane. */
static void make_sheets(struct bytes *b, struct sheets *s, real aside,
                        real rough)
{
    memset(s, 0, sizeof *s);
    s->surface = (struct surface){R(0.3), R(0.3)};
    for (int i = 0; i < BOTH; i++) {
        int k = i % SHEET;
        real shift = i < SHEET ? 0 : aside, up = i < SHEET ? 0 : R(0.2);
        s->x[i] = vec_make((real)(k % WIDE) + shift,
                           up + rough * pick_uniform(b, -1, 1),
                           (real)(k / WIDE) + shift);
        s->w[i] = 1;
    }
    for (int32_t k = 0; k < 2 * CELLS; k++) {
        int32_t c = k % CELLS, p = k / CELLS * SHEET + c % (WIDE - 1) +
                                   WIDE * (c / (WIDE - 1));
        int32_t corner[2][3] = {{p, p + 1, p + WIDE},
                                {p + 1, p + WIDE + 1, p + WIDE}};
        memcpy(s->tri[2 * k], corner, sizeof corner);
    }
    list_one_rings(BOTH, 2 * HALF, (const int32_t(*)[3])s->tri, s->start,
                   s->opposite);
}

/* Every vertex with every triangle of the other sheet, and every pair of edges
 * of the two. An edge of two triangles is there twice. */
static int64_t pair_sheets(const struct sheets *s, int32_t *pair, uint8_t *kind)
{
    int64_t n = 0;
    for (int32_t i = 0; i < BOTH; i++)
        for (int t = i < SHEET ? HALF : 0; t < (i < SHEET ? 2 * HALF : HALF);
             t++) {
            kind[n] = CONTACT_VF;
            pair[4 * n] = i;
            memcpy(pair + 4 * n++ + 1, s->tri[t], sizeof s->tri[t]);
        }
    for (int a = 0; a < SIDES_OF; a++)
        for (int b = 0; b < SIDES_OF; b++) {
            const int32_t *f = s->tri[a / 3], *g = s->tri[HALF + b / 3];
            int32_t v[4] = {f[a % 3], f[(a + 1) % 3], g[b % 3], g[(b + 1) % 3]};
            kind[n] = CONTACT_EE;
            memcpy(pair + 4 * n++, v, sizeof v);
        }
    return n;
}

/* What the contacts have to be, by distances of all pairs: the least distance
 * of each vertex to the other sheet, and of the two sheets. near: out, the
 * pairs that are nearer than their thickness. */
static const char *check_least(const struct sheets *s,
                               const struct proximity *p, int64_t *near)
{
    double least[BOTH + 1], found[BOTH + 1];
    for (int i = 0; i <= BOTH; i++)
        least[i] = found[i] = (double)s->surface.thickness;
    for (int64_t k = 0; k < p->n; k++) {
        struct wide x[4];
        for (int j = 0; j < 4; j++)
            x[j] = wide_of(s->x[p->pair[4 * k + j]]);
        bool face = p->kind[k] == CONTACT_VF;
        double d = pair_distance(x, p->kind[k]);
        if (face)
            least[p->pair[4 * k]] = fmin(d, least[p->pair[4 * k]]);
        least[BOTH] = fmin(d, least[BOTH]);
        *near += d < (double)s->surface.thickness;
    }
    for (int64_t k = 0; k < p->found; k++) {
        const struct contact *c = &p->contact[k];
        if (c->kind == CONTACT_VF)
            found[c->v[0]] = fmin((double)c->gap, found[c->v[0]]);
        found[BOTH] = fmin((double)c->gap, found[BOTH]);
    }
    for (int i = 0; i <= BOTH; i++)
        EXPECT(fabs(found[i] - least[i]) <= 0x1p-20); /* §2.1: L < 4 */
    return NULL;
}

/* The contacts of two sheets, in memory that the next call uses again. */
static int find_sheets(const struct sheets *s, struct proximity *p)
{
    static int32_t pair[4 * ALL], at[ALL];
    static uint8_t kind[ALL];
    static struct contact contact[ALL];
    *p = (struct proximity){.range = 1,
                            .nv = BOTH,
                            .n = pair_sheets(s, pair, kind),
                            .pair = pair,
                            .kind = kind,
                            .x = s->x,
                            .w = s->w,
                            .surfaces = {1, s->of, &s->surface},
                            .one_rings = {BOTH + 1, 6 * HALF, s->start,
                                          (const int32_t(*)[2])s->opposite},
                            .dt = R(0.01),
                            .at = at,
                            .cap = ALL,
                            .contact = contact};
    return ref_proximity(p);
}

/* §3.3, §3.4: dropped pairs are not missed: each vertex keeps a contact with
 * the nearest point of the other sheet, and the nearest points of the two
 * sheets are a contact, while most pairs that are near are none. */
const char *test_proximity_free(void)
{
    for (int k = 0; k < 20; k++) {
        struct bytes b = {.seed = (uint64_t)k, .size = -1};
        struct sheets s;
        struct proximity p;
        int64_t near = 0;
        make_sheets(&b, &s, R(0.37), pick(&b, 3) ? R(0.09) : 0);
        EXPECT(find_sheets(&s, &p) == DRAPE_OK);
        const char *failed = check_least(&s, &p, &near);
        if (failed)
            return failed;
        EXPECT(3 * p.found < 2 * near);
        choices_free(&b);
        ran(1);
    }
    return NULL;
}

/* §3.4: of flat sheets that lie on each other vertex by vertex, each vertex has
 * one contact, and nothing else is one. */
const char *test_proximity_places(void)
{
    struct bytes b = {.seed = 1, .size = -1};
    struct sheets s;
    struct proximity p;
    int met[BOTH] = {0};
    int64_t near = 0;
    make_sheets(&b, &s, 0, 0);
    EXPECT(find_sheets(&s, &p) == DRAPE_OK);
    for (int64_t k = 0; k < p.found; k++) {
        EXPECT(p.contact[k].kind == CONTACT_VF);
        met[p.contact[k].v[0]]++;
    }
    for (int i = 0; i < BOTH; i++)
        EXPECT(met[i] == 1);
    choices_free(&b);
    ran(1);
    return check_least(&s, &p, &near);
}

/* §1: five vertices on a grid; the first four are a pair. */
struct five {
    int place[5][3]; /* steps of the grid */
    uint8_t kind;    /* enum contact_kind */
    bool free[2];    /* the sides */
};

/* Finds the contact of the pair, which two triangles are beside; its thickness
 * is more than any distance. step: m, of the grid around the origin. Returns
 * the number of contacts, or an error. */
static int64_t find_contact(const struct five *s, real origin, real step,
                            struct contact *c)
{
    static const int32_t pair[4] = {0, 1, 2, 3};
    static const int32_t tri[2][2][3] = {{{1, 2, 3}, {2, 1, 4}},
                                         {{0, 1, 4}, {2, 3, 4}}};
    static const uint16_t of[5];
    const struct surface surface = {16 * step, 0};
    int32_t at, start[6] = {0}, opposite[6][2];
    vec x[5];
    real w[5];
    for (int i = 0; i < 5; i++) {
        const int *k = s->place[i];
        x[i] = vec_axpy(vec_make(origin, origin, origin), step,
                        vec_make((real)k[0], (real)k[1], (real)k[2]));
        w[i] = s->free[i > (s->kind == CONTACT_EE)] ? 1 : 0;
    }
    list_one_rings(5, 2, tri[s->kind], start, opposite);
    struct proximity p = {
        .range = 1,
        .nv = 5,
        .n = 1,
        .pair = pair,
        .kind = &s->kind,
        .x = x,
        .w = w,
        .surfaces = {1, of, &surface},
        .one_rings = {6, 6, start, (const int32_t(*)[2])opposite},
        .dt = 1,
        .at = &at,
        .cap = 1,
        .contact = c};
    int status = ref_proximity(&p);
    return status == DRAPE_OK ? p.found : status;
}

/* Pairs that were once dropped: the first away from the origin, the second
 * where squares underflow. */
static const struct five once_dropped[] = {
    {{{0, -1, 4}, {-2, -3, -3}, {-3, -3, -2}, {2, -2, 3}, {-3, 4, -4}},
     CONTACT_VF,
     {true, false}},
    {{{0, 3, 2}, {1, 1, 1}, {-1, -2, 4}, {1, 2, 1}, {3, -2, -1}},
     CONTACT_EE,
     {false, true}},
};

static void pick_five(struct bytes *b, struct five *s)
{
    for (int i = 0; i < 15; i++)
        s->place[i / 3][i % 3] = (int)pick(b, 9) - 4;
    s->kind = (uint8_t)pick(b, 2);
    s->free[0] = pick(b, 2) != 0;
    s->free[1] = pick(b, 2) != 0;
}

/* §2.4, §2.5: a pair and the surface around it, all on a grid, have the same
 * contact wherever they are and however large. Nothing but the grid's step
 * changes: differences of the coordinates and powers of two are exact. */
const char *test_proximity_moved(void)
{
    enum { GIVEN = sizeof once_dropped / sizeof *once_dropped };
    const real fine = REAL_BITS == 32 ? R(0x1p-21) : R(0x1p-50);
    const real tiny = REAL_BITS == 32 ? R(0x1p-100) : R(0x1p-180);
    const real origin[3] = {1, -1, 0}, step[3] = {fine, fine, tiny};
    struct bytes b = {.seed = 1, .size = -1};
    for (int k = 0; k < 4000; k++) {
        struct five s;
        struct contact c, other;
        pick_five(&b, &s);
        if (k < GIVEN)
            s = once_dropped[k];
        int64_t found = find_contact(&s, 0, 1, &c);
        EXPECT(k < GIVEN ? found == 1 : found >= 0);
        for (int j = 0; j < 3; j++) {
            EXPECT(find_contact(&s, origin[j], step[j], &other) == found);
            if (found == 0)
                continue;
            EXPECT(!memcmp(other.c, c.c, sizeof c.c));
            EXPECT(!memcmp(&other.n, &c.n, sizeof c.n));
            EXPECT(other.gap == step[j] * c.gap);
        }
        ran(1);
    }
    choices_free(&b);
    return NULL;
}
