/* SPDX-License-Identifier: Apache-2.0 */
/* The boxes of the tree's nodes, level by level. spec/20_refit.md */
#include "gpu/nodes.cuh"

/* What the kernels read: classes that are refitted, and the word that says
 * that a position is bad, upon which nothing is written. */
struct fit {
    struct refit s;
    int classes;
    const int64_t *bad;
};

/* Thread k owns vertex k: sets *bad, to 1 whoever does. */
static __global__ void __launch_bounds__(GPU_BLOCK)
    refit_check_kernel(int64_t nv, const vec *x0, const vec *x1, int64_t *bad)
{
    ITEM(k, nv);
    if (!sane(x0[k]) || !sane(x1[k]))
        *bad = 1;
}

/* §1 of a leaf: over the vertices of its triangles. */
static __device__ void fit_leaf(const struct refit *s, int32_t a)
{
    const struct tree *t = &s->tree;
    const int32_t *order = t->order + t->first[a];
    int n = t->count[a];
    struct box b = {};
    uint8_t stir = s->n_moved == 0;
    for (int k = 0; k < n; k++) {
        const int32_t *f = t->tri[order[k]];
        struct box face = face_box(s->x0, s->x1, f);
        b = k ? join(b, face) : face;
        if (s->n_moved)
            stir |= s->moved[f[0]] | s->moved[f[1]] | s->moved[f[2]];
    }
    put_as<word16>(&s->box[a], b);
    s->stir[a] = stir;
}

/* §1 of an inner node: over its children. */
static __device__ void fit_inner(const struct refit *s, int32_t a)
{
    int32_t c = s->tree.first[a];
    int n = s->tree.count[a];
    struct box b = fetch_as<word16>(&s->box[c]);
    uint8_t stir = s->stir[c];
    for (int k = 1; k < n; k++) {
        b = join(b, fetch_as<word16>(&s->box[c + k]));
        stir |= s->stir[c + k];
    }
    put_as<word16>(&s->box[a], b);
    s->stir[a] = stir;
}

/* A thread owns every so-many-th leaf: writes its box and stir. */
static __global__ void __launch_bounds__(GPU_BLOCK)
    refit_leaves_kernel(struct fit f)
{
    if (*f.bad)
        return;
    EACH_NODE(a, f.s.tree, f.classes, 0)
    fit_leaf(&f.s, a);
}

/* The same of nodes of level l, of which the level below is written. */
static __global__ void __launch_bounds__(GPU_BLOCK)
    refit_level_kernel(struct fit f, int l)
{
    if (*f.bad)
        return;
    EACH_NODE(a, f.s.tree, f.classes, l)
    fit_inner(&f.s, a);
}

/* One block: the levels from l up, each when the one below is written. */
static __global__ void __launch_bounds__(GPU_BLOCK)
    refit_top_kernel(struct fit f, int l)
{
    bool good = !*f.bad;
    for (; l < f.s.tree.levels; l++) {
        if (good)
            EACH_NODE(a, f.s.tree, f.classes, l)
        fit_inner(&f.s, a);
        __syncthreads();
    }
}

int gpu_refit(struct gpu *g, struct refit *s)
{
    int64_t *bad = gpu_words(g);
    struct fit f = {*s, s->all ? TREE_CLASSES : (int)TREE_STATIC, bad};
    int64_t n = s->tree.n;
    int top = level_top(n, s->tree.levels);
    LAUNCH(g, s->nv, refit_check_kernel, s->nv, s->x0, s->x1, bad);
    LAUNCH(g, n, refit_leaves_kernel, f);
    for (int l = 1; l < top; l++)
        LAUNCH(g, level_threads(n, l), refit_level_kernel, f, l);
    LAUNCH_BLOCKS(g, top < s->tree.levels, GPU_BLOCK, refit_top_kernel, f, top);
    int64_t failed = gpu_read_words(g, 1)[0];
    if (gpu_status(g) != DRAPE_OK)
        return gpu_status(g);
    return failed ? DRAPE_EDATA : DRAPE_OK;
}
