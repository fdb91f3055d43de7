/* SPDX-License-Identifier: Apache-2.0 */
/* Projected Jacobi with mass splitting: all passes of a call are one kernel.
 * spec/contact/contacts.md */
#include "gpu/base/cooperative.cuh"
#include "gpu/contact/contacts.cuh"
#include "gpu/contact/incidence.cuh"

/* Below RANK_CONTACTS contacts for each block of a thread-block cluster, one
 * cluster solves them, as its barriers are cheap, of no more blocks than have
 * RANK_LEAST contacts each. Beyond that a cooperative launch uses the whole
 * device. GROUP_THREADS, WARPS: of a block. */
#ifdef __CUDACC__
enum { RANK_LEAST = 256, RANK_CONTACTS = 2048 };
enum { GROUP_THREADS = 1024, WARPS = 32 };
#else
enum { RANK_LEAST = 3, RANK_CONTACTS = 10 };
enum { GROUP_THREADS = 64, WARPS = 32 }; /* WARPS: of all ranks */
#endif

/* Runs ACT for n items and then synchronises all threads. */
template <bool GRID, void ACT(const struct mass_splitting &, int64_t)>
static __device__ void pass(const struct mass_splitting &m, int64_t n)
{
    EACH_OF_GROUP(k, n)
    ACT(m, k);
    group_sync<GRID>();
}

/* Calls act for each vertex in contact, with the sum of its pushes; warps take
 * turns at the long lists. */
template <class ACT>
static __device__ void each_vertex(const struct mass_splitting &m, int64_t n,
                                   ACT act)
{
    EACH_OF_GROUP(k, n)
    if (!is_long(m.s, m.s.vertex[k]))
        act(find_pushed<false>(m, k));
    int warps = group_ranks() * rank_threads() / WARP;
    for (int l = group_item() / WARP; l < (int)*m.n_longer; l += warps)
        act(find_pushed<true>(m, m.longer[l]));
}

static __device__ real momentum(int age)
{
    return (real)age / ((real)age + 3);
}

/* §3: the normal part. The first pass of an iteration writes `over`; all
 * threads read it after the barrier of that pass, and the next write to it
 * comes after the barrier of the last pass. */
template <bool GRID>
static __device__ void solve_normal(struct mass_splitting &m, int64_t n,
                                    int64_t touched)
{
    for (int t = 0, age = 0; t < m.s.iterations; t++) {
        real beta = momentum(age);
        EACH_OF_GROUP(k, n)
        find_lack(m, k, t, beta);
        group_sync<GRID>();
        bool over = *m.over == t + 1;
        age = over ? age / 2 : age + 1;
        m.s.keep = t + 1 < m.s.iterations ? momentum(age) : R(0.0);
        if (over) {
            m.s.keep /= beta;
            pass<GRID, shrink_lookahead>(m, n);
        } else
            pass<GRID, push_normal>(m, n);
        each_vertex(m, touched,
                    [&](struct pushed_vertex p) { apply_normal(m, p, over); });
        group_sync<GRID>();
    }
}

template <bool GRID>
KERNEL contacts_kernel(struct mass_splitting m, const int64_t *words)
{
    int64_t n = words[INCIDENCE_BAD] ? 0 : m.s.n;
    int64_t touched = words[INCIDENCE_BAD] ? 0 : words[INCIDENCE_VERTICES];
    __shared__ vec row[WARPS][WARP];
    m.row = row[threadIdx.x / WARP];
    m.s.keep = 0;
    pass<GRID, first_parts>(m, touched);
    pass<GRID, begin>(m, n);
    solve_normal<GRID>(m, n, touched);
    pass<GRID, find_friction>(m, n);
    for (int t = 0; t < m.s.iterations; t++) {
        pass<GRID, push_tangent>(m, n);
        each_vertex(m, touched,
                    [&](struct pushed_vertex p) { apply(m, m.s.u, p); });
        group_sync<GRID>();
    }
    pass<GRID, find_total>(m, n);
    each_vertex(m, touched,
                [&](struct pushed_vertex p) { apply(m, m.s.v, p); });
}

int gpu_contacts(struct gpu *g, struct contacts *s)
{
    if (s->iterations < 0 || s->nv1 != s->nv + 1 || s->n4 != 4 * s->n ||
        s->n4 > INT32_MAX)
        return DRAPE_EARG;
    struct incidence by = {s->nv,    s->n,    s->w,      s->contact,
                           s->start, s->item, s->vertex, 0};
    int64_t *words = gpu_words(g);
    struct mass_splitting m = {};
    m.s = *s;
    m.slot = gpu_incidence(g, &by, words); /* §1 */
    m.over = words + INCIDENCE_WORDS;
    m.n_longer = (unsigned long long *)m.over + 1;
    m.longer =
        (int32_t *)gpu_scratch(g, SLOT_STAGE, s->nv + 1, sizeof(int64_t));
    m.pushed = (struct pushed *)gpu_scratch(g, SLOT_STAGE + 3, s->n4,
                                            sizeof *m.pushed);
    gpu_clear(g, m.pushed, (size_t)s->n4 * sizeof *m.pushed);
    gpu_clear(g, s->vertex_awake, (size_t)s->nv);
    if (s->n < in_ranks(g, RANK_CONTACTS))
        LAUNCH_RANKS(g, ranks_for(s->n, RANK_LEAST, g->ranks), GROUP_THREADS, 0,
                     contacts_kernel<false>, m, words);
    else
        LAUNCH_COOPERATIVE(g, 1, GROUP_THREADS, contacts_kernel<true>, m,
                           words);
    const int64_t *seen = gpu_read_back(g, INCIDENCE_WORDS + 1);
    s->vertices = seen[INCIDENCE_VERTICES];
    return seen[INCIDENCE_BAD] ? DRAPE_EARG : gpu_status(g);
}
