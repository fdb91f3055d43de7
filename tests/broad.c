/* SPDX-License-Identifier: Apache-2.0 */
/* The broad phase as a whole: against brute force, with and without cones,
 * over time. spec/25_broad.md */
#include "ref/narrow.h"
#include "tests/fabric.h"

/* Scene k of the test: cloths, holes, spheres, soups, by number. */
static void make_scene(struct fabric *f, int k)
{
    fabric_make(f, 4000, 8000, (uint64_t)k);
    enum fabric_shape shape = (enum fabric_shape)(k % FABRIC_SHAPES);
    int holes = k % 3 == 1 ? 3 : 0;
    fabric_cloth(f, 9 + k % 7, 8 + k % 11, shape, holes);
    if (k % 4 == 1)
        fabric_cloth(f, 2 + k % 9, 2, FABRIC_FLAT, 0);
    if (k % 4 == 2)
        fabric_cloth(f, 17, 16, FABRIC_WAVY, 4);
    if (k % 2)
        fabric_sphere(f, TREE_MOVING, 3 + k % 5, vec_make(R(0.5), R(0.1), 0),
                      R(0.3));
    if (k % 5 == 0) {
        fabric_soup(f, TREE_MOVING, 1 + 7 * k % 100, R(0.4));
        f->mesh[f->scene.meshes - 1].self = k % 2;
    }
    if (k % 3 != 2)
        fabric_sphere(f, TREE_STATIC, 4, vec_make(R(0.4), 0, R(0.5)), R(0.2));
}

static bool same(const struct fabric_pair *a, int64_t n,
                 const struct fabric_pair *b, int64_t m)
{
    for (int64_t k = 0; k < n && k < m; k++)
        if (fabric_compare(&a[k], &b[k]))
            return false;
    return n == m;
}

/* §2: neither missing, nor twice. Proximity and penetration, growing motion;
 * cones off. */
static const char *brute_scene(int k)
{
    struct fabric f;
    struct broad b;
    const char *failed = NULL;
    bool self = k % 6 != 5;
    make_scene(&f, k);
    if (broad_make(&b, &f.scene, self, &f.arena) != DRAPE_OK)
        failed = "broad_make failed";
    b.cones = false;
    for (int step = 0; step < 4 && !failed; step++) {
        real r = step % 2 ? R(0.01) : 0;
        real noise = step ? R(0.02) * (real)step : 0;
        int64_t n, m;
        /* Static meshes stay: the first query has them all. */
        fabric_move(&f, vec_make(0, R(-0.3), R(0.05)), noise);
        for (int32_t v = 0; v < f.scene.vertices; v++)
            if (f.scene.meshes > 1 &&
                f.mesh[f.scene.meshes - 1].class == TREE_STATIC &&
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
