/* SPDX-License-Identifier: Apache-2.0 */
/* Tests the broad phase as a whole: against brute force, with and without
 * cones, and over many steps. spec/broad/broad.md */
#include "ref/narrow/closest.h"
#include "ref/narrow/narrow.h"
#include "tests/broad/fabric.h"

static bool same(const struct fabric_pair *a, int64_t n,
                 const struct fabric_pair *b, int64_t m)
{
    for (int64_t k = 0; k < n && k < m; k++)
        if (fabric_compare(&a[k], &b[k]))
            return false;
    return n == m;
}

/* broad.md §2: with cones off, the candidates are those of brute force, none
 * missing and none twice, for proximity and for penetration under growing
 * motion. */
static const char *brute_scene(int k)
{
    struct fabric f;
    struct broad b;
    const char *failed = NULL;
    bool self = k % 6 != 5;
    fabric_scene(&f, k);
    if (broad_make(&b, &f.scene, self, &f.arena) != DRAPE_OK)
        failed = "broad_make failed";
    b.cones = false;
    for (int step = 0; step < 4 && !failed; step++) {
        real r = step % 2 ? R(0.01) : 0;
        real noise = step ? R(0.02) * (real)step : 0;
        int64_t n, m;
        /* Static meshes do not move: their boxes come from the first query. */
        fabric_move(&f, vec_make(0, R(-0.3), R(0.05)), noise);
        for (int32_t v = 0; v < f.scene.vertices; v++)
            if (f.scene.meshes > 1 &&
                f.mesh[f.scene.meshes - 1].kind == TREE_STATIC &&
                v >= f.mesh[f.scene.meshes - 1].base)
                f.x1[v] = f.x0[v];
        if (broad_query(&b, f.x0, f.x1, r, NULL) != DRAPE_OK)
            failed = "broad_query failed";
        struct fabric_pair *want = fabric_brute(&f, self, r, &n);
        struct fabric_pair *got = fabric_found(&f, &b, &m);
        if (!failed && !same(want, n, got, m))
            failed = "§2: candidates differ from brute force";
        ran(n);
    }
    fabric_free(&f);
    return failed;
}

const char *test_broad_brute(void)
{
    for (int k = 0; k < 30; k++) {
        const char *failed = brute_scene(k);
        if (failed)
            return failed;
    }
    return NULL;
}

static void corners(const vec *x, const struct fabric_pair *p, vec to[4])
{
    for (int k = 0; k < 4; k++)
        to[k] = x[p->v[k]];
}

static bool touches(const struct fabric *f, const struct fabric_pair *p)
{
    vec a[4], b[4];
    int tier;
    corners(f->x0, p, a);
    corners(f->x1, p, b);
    return (p->kind ? narrow_ee(a, b, &tier) : narrow_vf(a, b, &tier)) !=
           NARROW_MISS;
}

static double distance(const struct fabric *f, const struct fabric_pair *p)
{
    struct wide x[4];
    struct closest c;
    for (int k = 0; k < 4; k++) {
        vec a = f->x0[p->v[k]];
        struct wide w = {(double)a.x, (double)a.y, (double)a.z};
        x[k] = w;
    }
    if (p->kind)
        closest_ee(x, &c);
    else
        closest_vf(x, &c);
    return sqrt(c.length2);
}

/* How many pairs the cones left out, and whether some found pair touches: the
 * test fails without such cases. */
struct toll {
    int64_t left_out;
    bool touching;
};

/* spec/broad/cones.md §3: a pair that cones leave out neither touches (r = 0)
 * nor comes within r; a pair that is found is one that brute force finds. */
static const char *left_out(struct fabric *f, const struct broad *b, real r,
                            struct toll *toll)
{
    int64_t n, m, at = 0;
    struct fabric_pair *want = fabric_brute(f, true, r, &n);
    struct fabric_pair *got = fabric_found(f, b, &m);
    for (int64_t k = 0; k < n; k++) {
        if (at < m && !fabric_compare(&want[k], &got[at])) {
            toll->touching |= !toll->touching && !r && touches(f, &want[k]);
            at++;
            continue;
        }
        toll->left_out++;
        if (r == 0 && touches(f, &want[k]))
            return "cones §3: a pair that touches was left out";
        if (r > 0 && !(distance(f, &want[k]) > (double)r))
            return "cones §3: a pair within r was left out";
    }
    ran(n);
    arena_give(&f->arena, want);
    arena_give(&f->arena, got);
    return at == m ? NULL : "a pair was invented or came twice";
}

/* The motions of the steps: rest, a fast fall, small noise, large noise, a
 * quarter turn, and a fold that closes on itself. */
enum { MOTIONS = 6 };

static void move(struct fabric *f, int motion)
{
    static const real noise[MOTIONS] = {0, 0, R(0.003), R(0.05), 0, 0};
    real fall = motion == 1 ? -3 : motion == 2 ? R(0.5) : 0;
    fabric_move(f, vec_make(0, fall, 0), noise[motion]);
    for (int32_t v = 0; v < f->scene.vertices; v++) {
        vec x = f->x0[v];
        if (motion == 4)
            f->x1[v] = vec_make(-x.y, x.x, x.z);
        if (motion == 5)
            f->x1[v] = vec_make(R(0.9) - x.x, x.y + x.x * R(0.01), x.z);
    }
}

const char *test_broad_cones(void)
{
    struct toll toll = {0, false};
    const char *failed = NULL;
    for (int k = 0; k < FABRIC_SHAPES * MOTIONS * 2 && !failed; k++) {
        struct fabric f;
        struct broad b;
        enum fabric_shape shape = (enum fabric_shape)(k % FABRIC_SHAPES);
        fabric_make(&f, 2000, 4000, (uint64_t)k);
        fabric_cloth(&f, 20, 13, shape, k % 2 ? 1 : 0);
        if (k % 4 == 3)
            fabric_cloth(&f, 12, 14, FABRIC_WAVY, 0);
        move(&f, k / FABRIC_SHAPES % MOTIONS);
        if (broad_make(&b, &f.scene, true, &f.arena) != DRAPE_OK ||
            broad_query(&b, f.x0, f.x1, 0, NULL) != DRAPE_OK)
            failed = "the query failed";
        if (!failed)
            failed = left_out(&f, &b, 0, &toll);
        real r = k % 3 ? R(0.004) : R(0.02);
        if (!failed && broad_query(&b, f.x0, f.x0, r, NULL) != DRAPE_OK)
            failed = "the query failed";
        if (!failed)
            failed = left_out(&f, &b, r, &toll);
        fabric_free(&f);
    }
    if (failed)
        return failed;
    EXPECT(toll.left_out > 0 && toll.touching);
    return NULL;
}

/* spec/broad/broad.md §3: a flat cloth that falls 50 cells as one piece has no
 * self-collision work, and a wavy cloth has no candidates. */
const char *test_broad_trap(void)
{
    for (int shape = FABRIC_FLAT; shape <= FABRIC_WAVY; shape++) {
        struct fabric f;
        struct broad b;
        fabric_make(&f, 101 * 101, 20000, 1);
        fabric_cloth(&f, 101, 101, (enum fabric_shape)shape, 0);
        fabric_move(&f, vec_make(R(0.1), R(-0.5), 0), 0);
        int status = broad_make(&b, &f.scene, true, &f.arena);
        if (status == DRAPE_OK)
            status = broad_query(&b, f.x0, f.x1, 0, NULL);
        int64_t looked = b.front_visited + b.visited, n = b.n;
        bool all = b.n_front > 0 && b.front_visited >= b.n_front;
        fabric_free(&f);
        EXPECT(status == DRAPE_OK);
        EXPECT(all); /* each pair of the front was looked at and counted */
        EXPECT(n == 0);
        EXPECT(looked <= 2 || shape != FABRIC_FLAT);
        EXPECT(looked <= 200);
        ran(1);
    }
    return NULL;
}

static uint64_t hash_result(const struct broad *b)
{
    size_t n = (size_t)b->n;
    uint64_t h = hash_bytes(HASH_START, &b->n, sizeof b->n);
    if (b->n_front)
        h = hash_bytes(h, b->front.data, (size_t)b->n_front * 8);
    h = n ? hash_bytes(h, broad_pairs(b), n * 16) : h;
    return n ? hash_bytes(h, broad_kinds(b), n) : h;
}

/* spec/broad/front.md §3: neither the front nor the stream of candidates
 * depends on where the front was before. */
static const char *front_steps(int k)
{
    struct fabric f;
    struct broad kept;
    const char *failed = NULL;
    fabric_scene(&f, k);
    if (broad_make(&kept, &f.scene, true, &f.arena) != DRAPE_OK)
        failed = "broad_make failed";
    for (int step = 0; step < 20 && !failed; step++) {
        struct broad fresh;
        real r = step % 3 == 2 ? R(0.01) : 0;
        real noise = step % 4 ? R(0.002) : R(0.05);
        fabric_move(&f, vec_make(0, R(-0.05), R(0.02)), noise);
        for (int32_t c = 0; c < f.scene.meshes; c++)
            for (int32_t v = f.mesh[c].base; v < f.scene.vertices; v++)
                if (f.mesh[c].kind == TREE_STATIC)
                    f.x1[v] = f.x0[v];
        const vec *x1 = r > 0 ? f.x0 : f.x1;
        if (broad_query(&kept, f.x0, x1, r, NULL) != DRAPE_OK ||
            broad_make(&fresh, &f.scene, true, &f.arena) != DRAPE_OK)
            return "a query failed";
        /* Both broad phases have the tree of the first state. */
        fresh.tree = kept.tree;
        fresh.map = kept.map;
        if (broad_query(&fresh, f.x0, x1, r, NULL) != DRAPE_OK)
            return "a query failed";
        if (hash_result(&kept) != hash_result(&fresh))
            failed = "front §3: it depends on the steps before";
        if (fresh.walked != fresh.visited || fresh.visited < fresh.n_both / 16)
            failed = "the walk visited other pairs than it counted";
        for (int32_t v = 0; v < f.scene.vertices && step % 3 == 0; v++)
            f.x0[v] = f.x1[v];
        ran(1);
    }
    fabric_free(&f);
    return failed;
}

const char *test_broad_fronts(void)
{
    for (int k = 0; k < 7; k++) {
        const char *failed = front_steps(k);
        if (failed)
            return failed;
    }
    return NULL;
}

/* Gives some vertices of cloth and of moving meshes a new end position, and
 * flags them. */
static void move_some(struct fabric *f, uint8_t *moved)
{
    memset(moved, 0, (size_t)f->scene.vertices);
    for (int c = 0; c < f->scene.meshes; c++) {
        const struct tree_mesh *m = &f->mesh[c];
        const int32_t *v = f->tri[m->first_tri];
        for (int32_t k = 0; k < 3 * m->tris && m->kind != TREE_STATIC; k++)
            if (!moved[v[k]] && fabric_random(f) > R(0.99)) {
                moved[v[k]] = 1;
                f->x1[v[k]] = vec_axpy(f->x1[v[k]], R(0.1),
                                       vec_make(fabric_random(f), 1, 0));
            }
    }
}

/* spec/broad/features.md §4: with `moved` the candidates are exactly those of
 * which a vertex moved, and all boxes are as after a full refit. */
static const char *moved_round(struct fabric *f, struct broad *b,
                               struct broad *fresh, uint8_t *moved)
{
    int64_t n, m, at = 0;
    move_some(f, moved);
    EXPECT(broad_query(fresh, f->x0, f->x1, 0, NULL) == DRAPE_OK);
    struct fabric_pair *all = fabric_found(f, fresh, &n);
    b->refitted = b->kept = 0;
    EXPECT(broad_query(b, f->x0, f->x1, 0, moved) == DRAPE_OK);
    struct fabric_pair *some = fabric_found(f, b, &m);
    for (int64_t i = 0; i < n; i++) {
        const int32_t *v = all[i].v;
        if (!(moved[v[0]] | moved[v[1]] | moved[v[2]] | moved[v[3]]))
            continue;
        EXPECT(at < m && !fabric_compare(&all[i], &some[at]));
        at++;
    }
    EXPECT(at == m);
    EXPECT(!memcmp(b->box, fresh->box, (size_t)b->tree.n * sizeof *b->box));
    EXPECT(b->refitted + b->kept == b->tree.n);
    EXPECT(b->tree.n < 100 || b->kept > b->refitted);
    ran(m);
    return NULL;
}

const char *test_broad_moved(void)
{
    const char *failed = NULL;
    for (int k = 0; k < 12 && !failed; k++) {
        struct fabric f;
        struct broad b, fresh;
        fabric_scene(&f, k);
        fabric_move(&f, vec_make(0, R(-0.05), 0), R(0.02));
        uint8_t *moved = arena_take(&f.arena, ARENA_OTHER, f.scene.vertices, 1);
        if (broad_make(&b, &f.scene, true, &f.arena) != DRAPE_OK ||
            broad_make(&fresh, &f.scene, true, &f.arena) != DRAPE_OK ||
            broad_query(&b, f.x0, f.x1, 0, NULL) != DRAPE_OK)
            failed = "the scene was not made";
        for (int round = 0; round < 4 && !failed; round++)
            failed = moved_round(&f, &b, &fresh, moved);
        fabric_free(&f);
    }
    return failed;
}

/* Returns the coordinate of a point that reaches 0 + r·side at t = k / 8
 * exactly. All numbers are on a lattice, so nothing is rounded before the
 * overlap test. */
static real approach(int k, int speed, int side, real r, bool end)
{
    return (real)((end ? 8 - k : -k) * speed) + r * (real)side;
}

static bool points_meet(const int k[3], const int speed[3], const int side[3],
                        real r, real scale)
{
    real c[2][3];
    for (int e = 0; e < 2; e++)
        for (int d = 0; d < 3; d++)
            c[e][d] = scale * approach(k[d], speed[d], side[d], r, e == 1);
    /* Far from the origin, but still exact. */
    vec at = vec_make(scale * 1024, scale * -512, scale * 4096);
    struct box a = box_point(at, at);
    struct box b = box_point(vec_add(at, vec_make(c[0][0], c[0][1], c[0][2])),
                             vec_add(at, vec_make(c[1][0], c[1][1], c[1][2])));
    return box_meets(&a, &b, box_reach(scale * r)) &&
           box_meets(&b, &a, box_reach(scale * r));
}

/* spec/broad/refit.md §3: boxes that are within r at one single time meet;
 * boxes that are within r on each axis, but at times an eighth apart, do
 * not. */
const char *test_broad_boxes(void)
{
    struct fabric f;
    fabric_make(&f, 1, 1, 3);
    for (int n = 0; n < 20000; n++) {
        int k[3], speed[3], side[3];
        real r = n % 3 ? R(0.5) * (real)(n % 5) : 0;
        real scale = n % 2 ? 1 : R(0x1p-40);
        k[0] = k[1] = k[2] = n % 9;
        for (int d = 0; d < 3; d++) {
            speed[d] = (int)(100 * fabric_random(&f));
            side[d] = fabric_random(&f) < 0 ? -1 : 1;
        }
        EXPECT(points_meet(k, speed, side, r, scale));
        /* Within r on x only at k / 8, and on y only an eighth later. */
        speed[0] = speed[1] = 40;
        k[0] = n % 8;
        k[1] = n % 8 + 1;
        EXPECT(!points_meet(k, speed, side, 0, scale));
        ran(2);
    }
    fabric_free(&f);
    return NULL;
}
