/* SPDX-License-Identifier: Apache-2.0 */
/* Small scenes for tests of the broad phase (grids, soups of random triangles,
 * spheres), and brute force. */
#ifndef TESTS_FABRIC_H
#define TESTS_FABRIC_H

#include "ref/broad/broad.h"
#include "ref/broad/bvtt.h"
#include "tests/base/harness.h"

enum { FABRIC_MESHES = 8 };

/* A scene under construction; its memory comes from an arena. */
struct fabric {
    struct arena arena;
    struct tree_scene scene;
    struct tree_mesh mesh[FABRIC_MESHES];
    int32_t (*tri)[3];
    vec *x0, *x1;
    int32_t cap_v, cap_t;
    uint64_t seed;
};

/* How a grid lies in space. */
enum fabric_shape {
    FABRIC_FLAT,
    FABRIC_WAVY,
    FABRIC_ROLLED,   /* a spiral of several turns */
    FABRIC_FOLDED,   /* folded twice onto itself */
    FABRIC_CRUMPLED, /* every particle displaced by about a cell */
    FABRIC_SHAPES
};

/* The fields of a struct tree t that is a member of a stage's struct. */
#define FABRIC_TREE(X, t)                                                      \
    IN(X, t.first, t.n, 1), IN(X, t.parent, t.n, 1), IN(X, t.count, t.n, 1),   \
        IN(X, t.level, t.n, 1), IN(X, t.rank, t.n, 1), IN(X, t.mesh, t.n, 1),  \
        IN(X, t.order, t.n_tri, 1), IN(X, t.tri, t.n_tri, 1),                  \
        IN(X, t.own, t.n_tri, 1), IN(X, t.place, t.n_cloth, 1),                \
        IN(X, t.range, t.n_range, 1)
/* The fields of a struct bvtt that is the member `in` of a stage's struct. */
#define FABRIC_BVTT(X)                                                         \
    FABRIC_TREE(X, in.tree), IN(X, in.box, in.tree.n, 1),                      \
        IN(X, in.clear, in.tree.n_cloth, 1)

/* A candidate in a form that can be sorted and compared. */
struct fabric_pair {
    int32_t kind, v[4];
};

void fabric_make(struct fabric *f, int32_t vertices, int32_t tris,
                 uint64_t seed);
void fabric_free(struct fabric *f);
/* Returns a random number, uniform in [-1, 1]. */
real fabric_random(struct fabric *f);
/* Adds a cloth of unit size. About one cell in `holes` lacks one or both
 * triangles; 0 means no holes. */
void fabric_cloth(struct fabric *f, int32_t m, int32_t n,
                  enum fabric_shape shape, int holes);
/* Adds a mesh of another class: a closed sphere of 4 k (k - 1) triangles. */
void fabric_sphere(struct fabric *f, int kind, int32_t k, vec centre,
                   real radius);
/* Adds a soup of random triangles. */
void fabric_soup(struct fabric *f, int kind, int32_t tris, real size);
/* Makes scene k ≥ 0, of cloths, holes, spheres and soups. Scene 7 has no
 * cloth. */
void fabric_scene(struct fabric *f, int k);
/* Sets x1 = x0 + common + noise · random. */
void fabric_move(struct fabric *f, vec common, real noise);

/* Makes a scene from the stream of choices with about pick_size triangles, or
 * for the benchmark a 101 × 101 cloth over 20,000 triangles. The harness owns
 * the memory. */
void fabric_choose(struct bytes *b, struct fabric *f, struct tree *tree,
                   struct tree_map *map);
/* The inputs of front and walk: boxes and cones of a scene's motion, and root
 * pairs. */
struct fabric_walk {
    struct fabric f;
    struct bvtt in;
    uint8_t *stir;
    int32_t (*root)[2];
    int64_t roots;
};
void fabric_walk(struct bytes *b, struct fabric_walk *w);
/* Returns the boxes of the tree for the motion from f->x0 to f->x1, by
 * ref_refit. */
struct box *fabric_boxes(struct bytes *b, const struct fabric *f,
                         const struct tree *tree, uint8_t *stir);

/* Returns all candidates by brute force, sorted, in the arena's memory. */
struct fabric_pair *fabric_brute(struct fabric *f, bool self, real r,
                                 int64_t *n);
/* Returns the candidates of a broad phase, sorted. */
struct fabric_pair *fabric_found(struct fabric *f, const struct broad *b,
                                 int64_t *n);
int fabric_compare(const void *a, const void *b);

#endif
