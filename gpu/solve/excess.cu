/* SPDX-License-Identifier: Apache-2.0 */
/* Stage excess on the device: the part of the finest grid's operator that
 * couples no two free particles. spec/solve/multigrid.md §1 */
#include "gpu/run/merge.cuh"
#include "gpu/solve/coarsen.cuh"

/* Thread p owns particle p and writes excess[p], live[p] and rule[p]. */
KERNEL excess_kernel(const struct excess &s)
{
    ITEM(item, s.count);
    struct grid g = {s.m, s.n};
    struct place at = place_of(g, item);
    bool here = s.fixed[at.p];
    real mass = s.mass[at.p];
    sym e = {mass, 0, 0, mass, 0, mass};
    int live = 0;
    if (s.n_extra)
        e = add(e, s.extra[at.p]);
    for (int o = 0; o < SPRINGS; o++) {
        const sym *block = s.block + o * s.count;
        int di = forward_i(o), dj = forward_j(o), step = di + s.m * dj;
        if (within(g, at.i + di, at.j + dj)) {
            if (s.fixed[at.p + step])
                e = add(e, fetch(block + at.p));
            else if (!here)
                live |= 1 << o;
        }
        if (within(g, at.i - di, at.j - dj) && s.fixed[at.p - step])
            e = add(e, fetch(block + (at.p - step)));
    }
    s.excess[at.p] = here ? sym{0, 0, 0, 0, 0, 0} : e;
    s.live[at.p] = (uint8_t)live;
    s.rule[at.p] = rule_at(g, at, s.block, s.block + s.count);
}

int gpu_excess(struct gpu *g, struct excess *s)
{
    if (s->m < 1 || s->n < 1 || s->count != (int64_t)s->m * s->n ||
        s->n_blocks != SPRINGS * s->count ||
        (s->n_extra && s->n_extra != s->count))
        return DRAPE_EARG;
    MERGE(g, s->count, (*s), excess_kernel);
    return gpu_status(g);
}
