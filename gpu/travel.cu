/* SPDX-License-Identifier: Apache-2.0 */
/* How far candidates move beside one another. spec/26_travel.md */
#include "gpu/contact.cuh"
#include "gpu/largest.cuh"

#include "ref/travel.h"

enum { BAD, MOST, WORDS };

/* Thread k owns candidate k: reads its vertices at both ends; the words by
 * marks that all set alike and by the largest. Any order. */
static __global__ void __launch_bounds__(GPU_BLOCK)
    travel_kernel(struct travel s, int64_t *words)
{
    ITEM(k, s.n);
    int32_t v[4];
    load_pair(s.pair, k, v);
    if (!in_range(v, s.nv) || s.kind[k] > CONTACT_EE) {
        words[BAD] = 1;
        return;
    }
    vec d[4];
    UNROLL
    for (int j = 0; j < 4; j++)
        d[j] = sub(s.x1[v[j]], s.x0[v[j]]);
    bool edges = s.kind[k] == CONTACT_EE;
    real way = 0;
    UNROLL
    for (int a = 0; a < 2; a++)
        UNROLL
    for (int b = 1; b < 4; b++) {
        vec apart = sub(d[a], d[b]);
        if (a < (edges ? 2 : 1) && b >= (edges ? 2 : 1))
            way = most(way, dot(apart, apart));
    }
    note_largest(&words[MOST], way);
}

int gpu_travel(struct gpu *g, struct travel *s)
{
    int64_t *words = gpu_words(g);
    LAUNCH(g, s->n, travel_kernel, *s, words);
    const int64_t *seen = gpu_read_words(g, WORDS);
    if (seen[BAD])
        return DRAPE_EARG;
    s->most = largest_of(&seen[MOST]);
    return gpu_status(g);
}
