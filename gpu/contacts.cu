/* SPDX-License-Identifier: Apache-2.0 */
/* Mass-splitting projected Jacobi. spec/34_contacts.md */
#include "gpu/contacts.cuh"
#include "gpu/incidence.cuh"
#include "gpu/team.cuh"

/* Below so many contacts one team makes all passes, as launches would take
 * longer; TEAM_BLOCK: the threads of a rank. */
#ifdef __CUDACC__
enum { TEAM_CONTACTS = 1 << 16, TEAM_BLOCK = 1024 };
#else
enum { TEAM_CONTACTS = 40, TEAM_BLOCK = 64 };
#endif

/* ---- One launch a pass ---- */

typedef void act(const struct contacts &, int64_t);

/* Thread k owns contact k. Nothing where a contact names no vertex. */
template <act ACT>
static __global__ void __launch_bounds__(GPU_BLOCK)
    contacts_each_kernel(struct contacts s, const int64_t *words)
{
    ITEM(k, s.n);
    if (!words[INCIDENCE_BAD])
        ACT(s, k);
}

/* Thread k owns vertex[k]. */
template <act ACT>
static __global__ void __launch_bounds__(GPU_BLOCK)
    contacts_vertex_kernel(struct contacts s, const int64_t *words)
{
    ITEM(k, s.n4);
    if (!words[INCIDENCE_BAD] && k < words[INCIDENCE_VERTICES])
        ACT(s, k);
}

static void launch(struct gpu *g, const struct contacts *s,
                   const int64_t *words)
{
    int64_t n = s->n, touched = s->nv < s->n4 ? s->nv : s->n4;
    LAUNCH(g, touched, contacts_vertex_kernel<stay>, *s, words);
    LAUNCH(g, n, contacts_each_kernel<begin>, *s, words);
    for (int t = 0; t < s->iterations; t++) {
        if (t > 0)
            LAUNCH(g, n, contacts_each_kernel<find_lack>, *s, words);
        LAUNCH(g, touched, contacts_vertex_kernel<split>, *s, words);
        LAUNCH(g, n, contacts_each_kernel<push_normal>, *s, words);
        LAUNCH(g, touched, contacts_vertex_kernel<apply_normal>, *s, words);
    }
    LAUNCH(g, n, contacts_each_kernel<find_friction>, *s, words);
    LAUNCH(g, touched, contacts_vertex_kernel<split>, *s, words);
    for (int t = 0; t < s->iterations; t++) {
        LAUNCH(g, n, contacts_each_kernel<push_tangent>, *s, words);
        LAUNCH(g, touched, contacts_vertex_kernel<apply_tangent>, *s, words);
    }
    LAUNCH(g, n, contacts_each_kernel<end>, *s, words);
    LAUNCH(g, touched, contacts_vertex_kernel<apply_all>, *s, words);
}

/* ---- All passes by one team ---- */

/* A pass, and a barrier after it. */
template <act ACT>
static __device__ void pass(const struct contacts &s, int64_t n)
{
    EACH_OF_TEAM(k, n)
    ACT(s, k);
    team_sync(false);
}

/* The passes of launch(). */
static __global__ void __launch_bounds__(TEAM_BLOCK)
    contacts_team_kernel(struct contacts s, const int64_t *words)
{
    int64_t n = words[INCIDENCE_BAD] ? 0 : s.n;
    int64_t touched = words[INCIDENCE_BAD] ? 0 : words[INCIDENCE_VERTICES];
    pass<stay>(s, touched);
    pass<begin>(s, n);
    for (int t = 0; t < s.iterations; t++) {
        if (t > 0)
            pass<find_lack>(s, n);
        pass<split>(s, touched);
        pass<push_normal>(s, n);
        pass<apply_normal>(s, touched);
    }
    pass<find_friction>(s, n);
    pass<split>(s, touched);
    for (int t = 0; t < s.iterations; t++) {
        pass<push_tangent>(s, n);
        pass<apply_tangent>(s, touched);
    }
    pass<end>(s, n);
    pass<apply_all>(s, touched);
}

int gpu_contacts(struct gpu *g, struct contacts *s)
{
    if (s->iterations < 0 || s->nv1 != s->nv + 1 || s->n4 != 4 * s->n ||
        s->n4 > INT32_MAX)
        return DRAPE_EARG;
    struct incidence by = {s->nv,    s->n,    s->w,      s->contact,
                           s->start, s->item, s->vertex, 0};
    int64_t *words = gpu_words(g);
    gpu_incidence(g, &by, words); /* §1 */
    gpu_clear(g, s->stirred, (size_t)s->nv);
    if (s->n < TEAM_CONTACTS)
        LAUNCH_TEAM(g, TEAM_BLOCK, 0, contacts_team_kernel, *s, words);
    else
        launch(g, s, words);
    const int64_t *seen = gpu_read_words(g, INCIDENCE_WORDS);
    s->vertices = seen[INCIDENCE_VERTICES];
    return seen[INCIDENCE_BAD] ? DRAPE_EARG : gpu_status(g);
}
