/* SPDX-License-Identifier: Apache-2.0 */
/* Tests the narrow phase on public frames whose touching pairs are all
 * known. */
#include "ref/narrow/narrow.h"

#include <stdio.h>
#include <stdlib.h>

#include "tests/base/data.h"
#include "tests/narrow/soak.h"
#include "tests/narrow/sweep.h"

/* The pairs of a scene, decided one by one. */
struct asked {
    const struct frames *f;
    struct soak row;
};

static void ask(void *user, int kind, const int32_t v[4])
{
    struct asked *a = user;
    struct query q = {.kind = kind};
    for (int k = 0; k < 8; k++)
        q.x[k / 4][k % 4] = a->f->at[k / 4].x[v[k % 4]];
    soak_decide(&a->row, &q);
}

/* No pair of hits.txt is missed. As many candidates touch as hits.txt has
 * lines, so none is invented. */
static const char *check_scene(const char *name, int parts)
{
    struct frames f = {.from = 0};
    struct asked hits = {.f = &f}, all = {.f = &f};
    int64_t lines;
    if (!frames_read(name, &f)) {
        frames_free(&f);
        return "a frame cannot be read";
    }
    frames_slab(&f, parts);
    int64_t inside = frames_hits(&f, name, ask, &hits, &lines);
    bool swept = frames_sweep(&f, ask, &all);
    frames_free(&f);
    EXPECT(swept && lines > 0 && hits.row.touching == lines);
    EXPECT(inside > 0 && all.row.queries > inside);
    all.row.invented = all.row.touching - inside; /* because none is missed */
    if (getenv("DRAPE_SOAK"))
        soak_print(name, &all.row);
    EXPECT(all.row.invented == 0);
    ran(all.row.queries);
    return NULL;
}

/* cloth-funnel has binary64 coordinates, which rounding would change; the other
 * scenes have binary32. Tests a slab of the large scenes, or all 38 million
 * candidates where DRAPE_SOAK is set. */
const char *test_narrow_frames(void)
{
    bool all = getenv("DRAPE_SOAK");
    FILE *f = data_open("ccd/frames/cloth-ball/hits.txt");
    if (!f)
        return skip("no ccd/frames in DRAPE_DATA" FETCHED);
    fclose(f);
    if (all) {
        printf("\n### All candidates of the shared frames, binary%d\n\n",
               REAL_BITS);
        soak_head();
    }
    if (REAL_BITS == 64)
        return check_scene("cloth-funnel", 0);
    const char *failed = check_scene("cloth-ball", all ? 0 : 8);
    return failed ? failed : check_scene("n-body-simulation", all ? 0 : 64);
}
