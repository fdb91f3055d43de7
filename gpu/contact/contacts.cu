/* SPDX-License-Identifier: Apache-2.0 */
/* Projected Jacobi with mass splitting: all passes of a call are one kernel.
 * spec/contact/contacts.md */
#include "gpu/base/crowd.cuh"
#include "gpu/contact/contacts.cuh"
#include "gpu/contact/incidence.cuh"

/* Below RANK_CONTACTS contacts a block of a thread-block cluster (team), one
 * cluster solves them, as its barriers are cheap; above, a cooperative launch
 * uses the whole device (crowd). TEAM_BLOCK: threads of a block. */
#ifdef __CUDACC__
enum { RANK_CONTACTS = 2048, TEAM_BLOCK = 1024 };
#else
enum { RANK_CONTACTS = 10, TEAM_BLOCK = 64 };
#endif

/* Runs ACT for n items and then synchronises all threads. */
template <bool CROWD, void ACT(const struct mass_splitting &, int64_t)>
static __device__ void pass(const struct mass_splitting &m, int64_t n)
{
    EACH_OF_TEAM(k, n)
    ACT(m, k);
    meet<CROWD>();
}

static __device__ real momentum(int age)
{
    return (real)age / ((real)age + 3);
}

/* §3: the normal part. The first pass of an iteration writes `over`; all
 * threads read it after the barrier of that pass, and the next write to it
 * comes after the barrier of the last pass. */
template <bool CROWD>
static __device__ void solve_normal(struct mass_splitting &m, int64_t n,
                                    int64_t touched)
{
    for (int t = 0, age = 0; t < m.s.iterations; t++) {
        real beta = momentum(age);
        EACH_OF_TEAM(k, n)
        find_lack(m, k, t, beta);
        meet<CROWD>();
        bool over = *m.over == t + 1;
        age = over ? age / 2 : age + 1;
        m.s.keep = t + 1 < m.s.iterations ? momentum(age) : R(0.0);
        if (over) {
            m.s.keep /= beta;
            pass<CROWD, shrink_lookahead>(m, n);
        } else
            pass<CROWD, push_normal>(m, n);
        EACH_OF_TEAM(k, touched)
        apply_normal(m, k, over);
        meet<CROWD>();
    }
}

template <bool CROWD>
static __global__ void __launch_bounds__(TEAM_BLOCK)
    contacts_kernel(struct mass_splitting m, const int64_t *words)
{
    int64_t n = words[INCIDENCE_BAD] ? 0 : m.s.n;
    int64_t touched = words[INCIDENCE_BAD] ? 0 : words[INCIDENCE_VERTICES];
    m.s.keep = 0;
    pass<CROWD, first_parts>(m, touched);
    pass<CROWD, begin>(m, n);
    solve_normal<CROWD>(m, n, touched);
    pass<CROWD, find_friction>(m, n);
    for (int t = 0; t < m.s.iterations; t++) {
        pass<CROWD, push_tangent>(m, n);
        pass<CROWD, apply_tangent>(m, touched);
    }
    pass<CROWD, find_total>(m, n);
    pass<CROWD, apply_all>(m, touched);
}

int gpu_contacts(struct gpu *g, struct contacts *s)
{
    if (s->iterations < 0 || s->nv1 != s->nv + 1 || s->n4 != 4 * s->n ||
        s->n4 > INT32_MAX)
        return DRAPE_EARG;
    struct incidence by = {s->nv,    s->n,    s->w,      s->contact,
                           s->start, s->item, s->vertex, 0};
    int64_t *words = gpu_words(g);
    struct mass_splitting m = {*s, gpu_incidence(g, &by, words), NULL,
                               words + INCIDENCE_WORDS}; /* §1 */
    m.pushed = (struct pushed *)gpu_scratch(g, SLOT_STAGE + 3, s->n4,
                                            sizeof *m.pushed);
    gpu_clear(g, m.pushed, (size_t)s->n4 * sizeof *m.pushed);
    gpu_clear(g, s->stirred, (size_t)s->nv);
    if (s->n < (int64_t)g->ranks * RANK_CONTACTS)
        LAUNCH_TEAM(g, TEAM_BLOCK, 0, contacts_kernel<false>, m, words);
    else
        LAUNCH_CROWD(g, 1, TEAM_BLOCK, contacts_kernel<true>, m, words);
    const int64_t *seen = gpu_read_words(g, INCIDENCE_WORDS + 1);
    s->vertices = seen[INCIDENCE_VERTICES];
    return seen[INCIDENCE_BAD] ? DRAPE_EARG : gpu_status(g);
}
