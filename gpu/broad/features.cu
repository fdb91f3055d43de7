/* SPDX-License-Identifier: Apache-2.0 */
/* Turns triangle pairs into vertex-face and edge-edge candidates, each exactly
 * once, on the device. spec/broad/features.md */
#include "gpu/base/cluster.cuh"
#include "gpu/broad/bvtt.cuh"

extern "C" {
#include "ref/broad/features.h"
}

/* §1: the first VF_BITS of a mask's bits are vertex-face pairs. */
enum { VF_BITS = 6, VF_MASK = (1 << VF_BITS) - 1 };
/* Words of gpu_words: the number of vertex-face and of edge-edge candidates;
 * the number of candidates written, 0 if the capacity is too small; the number
 * there are; the ticket of ends_last. */
enum { WORD_VF, WORD_EE, WORD_DONE, WORD_NEED, WORD_TICKET, WORDS };

/* Blocks of features_test_kernel on a multiprocessor, of which each thread has
 * two triangles in registers. */
enum { TESTS_AT_ONCE = REAL_BITS == 32 ? 3 : 1 };

/* The vertex numbers of a triangle. */
struct corners {
    int32_t v[3];
};

static __device__ struct corners corners_of(const struct features *s, int32_t t)
{
    struct corners c = {{s->tri[t][0], s->tri[t][1], s->tri[t][2]}};
    return c;
}

/* One triangle of a triangle pair; `own` holds the bits of tree.own. Loops over
 * its vertices are unrolled, so that all of it is in registers. */
template <class BOX> struct side {
    struct corners c;
    int own;
    BOX vertex[3], face;
};

template <class BOX>
static __device__ side<BOX> side_of(const struct features *s, int32_t t)
{
    side<BOX> f;
    f.c = corners_of(s, t);
    f.own = s->own[t];
    UNROLL
    for (int k = 0; k < 3; k++)
        f.vertex[k] = vertex_box<BOX>(s->x0, s->x1, f.c.v[k]);
    f.face = join(join(f.vertex[0], f.vertex[1]), f.vertex[2]);
    return f;
}

static __device__ bool has_vertex(const struct corners &f, int32_t v)
{
    return f.v[0] == v || f.v[1] == v || f.v[2] == v;
}

static __device__ bool pair_moves(const struct features *s, int32_t a,
                                  int32_t b)
{
    return s->n_moved == 0 || (s->moved[a] | s->moved[b]);
}

/* §5: whether vertices a and b are sewn together. */
static __device__ bool are_sewn(const struct features *s, int32_t a, int32_t b)
{
    for (int32_t k = s->start[a]; k < s->start[a + 1]; k++)
        if (s->sewn[k] == b)
            return true;
    return false;
}

/* §5: whether the pair of vertex v and face g is passed over. */
static __device__ bool sewn_vertex(const struct features *s, int32_t v,
                                   const struct corners &g)
{
    return are_sewn(s, v, g.v[0]) || are_sewn(s, v, g.v[1]) ||
           are_sewn(s, v, g.v[2]);
}

/* §4: likewise of edges a b and c d. */
static __device__ bool sewn_edges(const struct features *s, int32_t a,
                                  int32_t b, int32_t c, int32_t d)
{
    return are_sewn(s, a, c) || are_sewn(s, a, d) || are_sewn(s, b, c) ||
           are_sewn(s, b, d);
}

/* Tests the vertices of f against face g. Bit k of the result: vertex k and g
 * are a candidate. */
template <class BOX, bool SEWN>
static __device__ uint32_t test_vertices(const struct features *s, real reach,
                                         const side<BOX> &f, const side<BOX> &g)
{
    uint32_t mask = 0;
    UNROLL
    for (int k = 0; k < 3; k++) {
        int32_t v = f.c.v[k];
        if ((f.own >> k & 1) && !has_vertex(g.c, v) &&
            meets(f.vertex[k], g.face, reach) &&
            (pair_moves(s, v, g.c.v[0]) || pair_moves(s, g.c.v[1], g.c.v[2])) &&
            !(SEWN && sewn_vertex(s, v, g.c)))
            mask |= 1u << k;
    }
    return mask;
}

/* Tests edge (a, b), whose box is e, against the edges of g. Bit j of the
 * result: the edge and edge j are a candidate. */
template <class BOX, bool SEWN>
static __device__ uint32_t test_edge(const struct features *s, real reach,
                                     int32_t a, int32_t b, const BOX &e,
                                     const side<BOX> &g)
{
    uint32_t mask = 0;
    UNROLL
    for (int j = 0; j < 3; j++) {
        int next = j < 2 ? j + 1 : 0;
        int32_t c = g.c.v[j], d = g.c.v[next];
        if ((g.own >> (3 + j) & 1) && a != c && a != d && b != c && b != d &&
            meets(e, join(g.vertex[j], g.vertex[next]), reach) &&
            (pair_moves(s, a, b) || pair_moves(s, c, d)) &&
            !(SEWN && sewn_edges(s, a, b, c, d)))
            mask |= 1u << j;
    }
    return mask;
}

/* Tests the edges of f against the edges of g. Bit 3 i + j of the result: edge
 * i of f and edge j of g are a candidate. An edge whose box does not meet the
 * other face's box meets none of its edges, as they lie in that box. */
template <class BOX, bool SEWN>
static __device__ uint32_t test_edges(const struct features *s, real reach,
                                      const side<BOX> &f, const side<BOX> &g)
{
    uint32_t mask = 0;
    UNROLL
    for (int i = 0; i < 3; i++) {
        int next = i < 2 ? i + 1 : 0;
        BOX e = join(f.vertex[i], f.vertex[next]);
        if ((f.own >> (3 + i) & 1) && g.own >> 3 && meets(e, g.face, reach))
            mask |= test_edge<BOX, SEWN>(s, reach, f.c.v[i], f.c.v[next], e, g)
                    << (3 * i);
    }
    return mask;
}

/* The mask of the candidates of a pair of triangles, §1. */
template <class BOX, bool SEWN>
static __device__ uint32_t mask_of(const struct features *s, real reach,
                                   struct duo e)
{
    if (!(s->own[e.a] | s->own[e.b]))
        return 0;
    side<BOX> f = side_of<BOX>(s, e.a), g = side_of<BOX>(s, e.b);
    return test_vertices<BOX, SEWN>(s, reach, f, g) |
           test_vertices<BOX, SEWN>(s, reach, g, f) << 3 |
           test_edges<BOX, SEWN>(s, reach, f, g) << VF_BITS;
}

/* Block k owns 256 triangle pairs from 256 k on. It writes their masks and its
 * numbers of candidates: sum[k] vertex-face, sum[blocks + k] edge-edge. The
 * block that ends last scans the sums into the places where each block begins
 * to write. */
template <class BOX, bool SEWN>
KERNEL features_test_kernel(const struct features &s, real reach, int64_t *word)
{
    int64_t k = (int64_t)blockIdx.x * BVTT_BLOCK + threadIdx.x;
    uint32_t mask = 0, total;
    if (k < s.n) {
        mask = mask_of<BOX, SEWN>(&s, reach, fetch_duo(&s.both[k]));
        s.mask[k] = (uint16_t)mask;
    }
    uint32_t vf = (uint32_t)__popc(mask & VF_MASK);
    uint32_t ee = (uint32_t)__popc(mask >> VF_BITS);
    block_scan((int)threadIdx.x, vf | ee << 16, &total);
    if (threadIdx.x == 0) {
        s.sum[blockIdx.x] = total & 0xffff;
        s.sum[blocks_of(s.n) + blockIdx.x] = total >> 16;
        word_add(&word[WORD_VF], total & 0xffff);
        word_add(&word[WORD_EE], total >> 16);
    }
    if (!ends_last((unsigned *)&word[WORD_TICKET], blocks_of(s.n)))
        return;
    int64_t all = word[WORD_VF] + word[WORD_EE];
    if (all <= s.cap)
        scan_blocks(s.sum, 2 * blocks_of(s.n));
    if (threadIdx.x == 0) {
        word[WORD_DONE] = all <= s.cap ? all : 0;
        word[WORD_NEED] = all;
    }
}

/* Four vertex numbers, moved as one 16-byte word. */
struct quad {
    int32_t v[4];
};

/* §3: puts the smaller vertex of each edge first, then the edge with the
 * smaller first vertex. The edges share no vertex. */
static __device__ struct quad ordered(int32_t a, int32_t b, int32_t c,
                                      int32_t d)
{
    struct quad e = {{min_of(a, b), max_of(a, b), min_of(c, d), max_of(c, d)}};
    struct quad turned = {{e.v[2], e.v[3], e.v[0], e.v[1]}};
    return e.v[0] > e.v[2] ? turned : e;
}

static __device__ int32_t pick(const struct corners &f, int k)
{
    return k == 0 ? f.v[0] : k == 1 ? f.v[1] : f.v[2];
}

/* Returns the four vertices of feature pair k. */
static __device__ struct quad vertices(const struct corners &f,
                                       const struct corners &g, int k)
{
    if (k < VF_BITS) {
        struct corners face = k < 3 ? g : f;
        int32_t v = k < 3 ? pick(f, k) : pick(g, k - 3);
        return {{v, face.v[0], face.v[1], face.v[2]}};
    }
    int i = (k - VF_BITS) / 3, j = (k - VF_BITS) - 3 * i;
    return ordered(pick(f, i), pick(f, i < 2 ? i + 1 : 0), pick(g, j),
                   pick(g, j < 2 ? j + 1 : 0));
}

/* The threads of the block set n kinds. */
static __device__ void put_kinds(uint8_t *to, uint32_t n, int kind)
{
    for (uint32_t i = threadIdx.x; i < n; i += BVTT_BLOCK)
        to[i] = (uint8_t)kind;
}

/* Block k owns the same triangle pairs and writes their candidates at its two
 * places. One scan went over both halves of sum, so all edge-edge candidates
 * come after all vertex-face candidates. */
KERNEL features_emit_kernel(const struct features &s, const int64_t *word)
{
    if (!word[WORD_DONE])
        return;
    int64_t k = (int64_t)blockIdx.x * BVTT_BLOCK + threadIdx.x;
    uint32_t mask = k < s.n ? s.mask[k] : 0, total;
    uint32_t vf = (uint32_t)__popc(mask & VF_MASK);
    uint32_t ee = (uint32_t)__popc(mask >> VF_BITS);
    uint32_t before = block_scan((int)threadIdx.x, vf | ee << 16, &total);
    int64_t at[2] = {s.sum[blockIdx.x], s.sum[blocks_of(s.n) + blockIdx.x]};
    put_kinds(s.kind + at[0], total & 0xffff, FEATURES_VF);
    put_kinds(s.kind + at[1], total >> 16, FEATURES_EE);
    if (!mask)
        return;
    at[0] += before & 0xffff;
    at[1] += before >> 16;
    struct duo e = fetch_duo(&s.both[k]);
    struct corners f = corners_of(&s, e.a), g = corners_of(&s, e.b);
    for (; mask; mask &= mask - 1) {
        int c = __popc((mask & -mask) - 1); /* the lowest bit */
        int64_t to = c < VF_BITS ? at[0]++ : at[1]++;
        struct quad v = vertices(f, g, c);
        put_as<word16>((struct quad *)(void *)&s.pair[to], v);
    }
}

template <class BOX, bool SEWN>
static void launch_test(struct gpu *g, const struct features *s, int64_t *word)
{
    LAUNCH_PARTS(g, blocks_of(s->n), BVTT_BLOCK, TESTS_AT_ONCE,
                 (features_test_kernel<BOX, SEWN>), *s, reach_of(s->r), word);
}

int gpu_features(struct gpu *g, struct features *s)
{
    int64_t blocks = blocks_of(s->n);
    s->n_pair = s->n_vf = 0;
    if (!(s->r >= 0 && s->r <= REAL_BIG))
        return DRAPE_EDATA;
    int64_t *word = gpu_words(g);
    bool still = s->x0 == s->x1, sewn = s->n_start > 0;
    auto launch = still && sewn ? launch_test<struct still_box, true>
                  : still       ? launch_test<struct still_box, false>
                  : sewn        ? launch_test<struct box, true>
                                : launch_test<struct box, false>;
    launch(g, s, word);
    LAUNCH_PARTS(g, blocks, BVTT_BLOCK, 1, features_emit_kernel, *s, word);
    const int64_t *seen = gpu_read_back(g, WORDS);
    if (gpu_status(g) != DRAPE_OK)
        return gpu_status(g);
    s->need = seen[WORD_VF] + seen[WORD_EE];
    if (s->need > s->cap)
        return DRAPE_EFULL;
    s->n_pair = s->need;
    s->n_vf = seen[WORD_VF];
    return gpu_status(g);
}
