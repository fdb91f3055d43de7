/* SPDX-License-Identifier: Apache-2.0 */
/* Small results of kernels (words), and their readback by the host, for real
 * and emulated devices. gpu/run/launch.cuh, spec/gpu.md §6 */
#include "gpu/run/batch.cuh"

static int64_t *cleared(struct gpu *g, bool late, int64_t *words, int n)
{
    if (!g->clean[late])
        gpu_clear(g, words, (size_t)n * sizeof *words);
    g->clean[late] = false;
    return words;
}

int64_t *gpu_words(struct gpu *g)
{
    return cleared(g, false, g->words, GPU_WORDS);
}

int64_t *gpu_late_words(struct gpu *g)
{
    memset(g->late, 0, sizeof g->late);
    return cleared(g, true, g->words + GPU_WORDS, GPU_LATE);
}

const int64_t *gpu_late_seen(const struct gpu *g)
{
    return g->late_seen;
}

/* Updates late_seen after a readback. If a readback clears the words on the
 * device, their values are added to g->late first, so that nothing is lost. */
static void keep_late(struct gpu *g, bool wiped)
{
    for (int k = 0; k < GPU_LATE; k++) {
        g->late_seen[k] = g->late[k] + g->seen[GPU_WORDS + k];
        g->late[k] = wiped ? g->late_seen[k] : g->late[k];
    }
}

/* Thread k shows word k to the host. */
KERNEL show_kernel(int64_t *words, int64_t *seen, bool clear)
{
    ITEM(k, (int64_t)GPU_ALL_WORDS);
    seen[k] = words[k];
    words[k] = clear ? 0 : words[k];
}

static void read_back(struct gpu *g, bool clear)
{
    if (g->together) {
        LAUNCH(g, (int64_t)GPU_ALL_WORDS, show_kernel, g->words, g->seen,
               clear);
        gpu_batch_meet(g);
    } else if (!g->failed)
        gpu_read_back_now(g, clear);
    if (g->failed)
        memset(g->seen, 0, GPU_ALL_WORDS * sizeof *g->seen);
    keep_late(g, clear);
}

/* Reads all words whatever n is, since reading fewer takes as long. */
const int64_t *gpu_read_back(struct gpu *g, int)
{
    read_back(g, true);
    g->clean[0] = g->clean[1] = !g->failed;
    return g->seen;
}

const int64_t *gpu_read_back_keep(struct gpu *g, int)
{
    read_back(g, false);
    return g->seen;
}
