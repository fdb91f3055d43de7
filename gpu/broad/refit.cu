/* SPDX-License-Identifier: Apache-2.0 */
/* Refits the boxes of the BVH on the device, level by level.
 * spec/broad/refit.md */
#include "gpu/broad/bvtt.cuh"
#include "gpu/broad/nodes.cuh"
#include "gpu/broad/refit.cuh"

struct fit {
    struct refit s;
    int classes; /* number of classes that are refitted */
    int64_t *word;
};

/* Thread k owns vertex k and sets REFIT_BAD to 1 if a position is bad. */
KERNEL refit_check_kernel(const struct refit &s, int64_t *word)
{
    ITEM(k, s.nv);
    if ((s.n_moved == 0 || s.moved[k]) && (!sane(s.x0[k]) || !sane(s.x1[k])))
        word[REFIT_BAD] = 1;
}

/* §4: whether a vertex of leaf a has moved. */
static __device__ bool leaf_stirs(const struct refit *s, int32_t a)
{
    const struct tree *t = &s->tree;
    const int32_t *order = t->order + t->first[a];
    int n = t->count[a];
    uint8_t any = s->n_moved == 0;
    for (int k = 0; k < n && s->n_moved; k++) {
        const int32_t *f = t->tri[order[k]];
        any |= s->moved[f[0]] | s->moved[f[1]] | s->moved[f[2]];
    }
    return any;
}

static __device__ bool inner_stirs(const struct refit *s, int32_t a)
{
    const uint8_t *below = s->stir + s->tree.first[a];
    uint8_t any = s->n_moved == 0;
    for (int k = 0; k < s->tree.count[a] && !any; k++)
        any = below[k];
    return any;
}

/* §1: the box of a leaf joins the vertices of its triangles. */
static __device__ void fit_leaf(const struct refit *s, int32_t a)
{
    const struct tree *t = &s->tree;
    const int32_t *order = t->order + t->first[a];
    int n = t->count[a];
    struct box b = face_box<struct box>(s->x0, s->x1, t->tri[order[0]]);
    for (int k = 1; k < n; k++)
        b = join(b, face_box<struct box>(s->x0, s->x1, t->tri[order[k]]));
    put_as<word16>(&s->box[a], b);
}

/* §1: the box of an inner node joins the boxes of its children. */
static __device__ void fit_inner(const struct refit *s, int32_t a)
{
    int32_t c = s->tree.first[a];
    int n = s->tree.count[a];
    struct box b = fetch_as<word16>(&s->box[c]);
    for (int k = 1; k < n; k++)
        b = join(b, fetch_as<word16>(&s->box[c + k]));
    put_as<word16>(&s->box[a], b);
}

/* Each thread owns nodes of level l and writes their stir and box. The level
 * below must be complete. All threads of a block of BVTT_BLOCK call this. */
static __device__ void fit_level(const struct fit *f, int l)
{
    const struct refit *s = &f->s;
    uint32_t made = 0, total;
    EACH_NODE(a, s->tree, f->classes, l)
    {
        bool still = a >= s->tree.range[TREE_STATIC * s->tree.levels];
        bool stirs = !still && (l ? inner_stirs(s, a) : leaf_stirs(s, a));
        s->stir[a] = stirs;
        if (!still && !stirs && !s->every)
            continue;
        if (l)
            fit_inner(s, a);
        else
            fit_leaf(s, a);
        made++;
    }
    block_scan((int)threadIdx.x, made, &total);
    if (threadIdx.x == 0)
        word_add(&f->word[REFIT_MADE], total);
}

KERNEL refit_level_kernel(const struct fit &f, int l)
{
    if (!f.word[REFIT_BAD])
        fit_level(&f, l);
}

/* One block refits level l and all levels above, one after another. */
KERNEL refit_top_kernel(const struct fit &f, int l)
{
    for (; l < f.s.tree.levels && !f.word[REFIT_BAD]; l++) {
        fit_level(&f, l);
        __syncthreads();
    }
}

void gpu_refit_queue(struct gpu *g, const struct refit *s, int64_t *words)
{
    struct fit f = {*s, s->all ? TREE_CLASSES : (int)TREE_STATIC, words};
    int64_t n = s->tree.n;
    int top = level_top(n, s->tree.levels);
    LAUNCH(g, s->nv, refit_check_kernel, *s, words);
    for (int l = 0; l < top && n > 0; l++)
        LAUNCH_BLOCKS(g, blocks_of(level_threads(n, l)), BVTT_BLOCK,
                      refit_level_kernel, f, l);
    LAUNCH_BLOCKS(g, top < s->tree.levels, BVTT_BLOCK, refit_top_kernel, f,
                  top);
}

int gpu_refit(struct gpu *g, struct refit *s)
{
    gpu_refit_queue(g, s, gpu_words(g));
    const int64_t *seen = gpu_read_back(g, REFIT_WORDS);
    s->made = seen[REFIT_BAD] ? 0 : seen[REFIT_MADE];
    if (gpu_status(g) != DRAPE_OK)
        return gpu_status(g);
    return seen[REFIT_BAD] ? DRAPE_EDATA : DRAPE_OK;
}
