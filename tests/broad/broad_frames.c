/* SPDX-License-Identifier: Apache-2.0 */
/* Tests the broad phase on public frames whose touching pairs are known
 * exactly: every touching pair is a candidate. spec/broad/broad.md §2 */
#include <stdio.h>
#include <stdlib.h>

#include "tests/base/data.h"
#include "tests/broad/fabric.h"
#include "tests/narrow/ply.h"

/* Marks the vertices of every `every`-th line of hits.txt. Returns the number
 * of lines. */
static int64_t mark_hits(const char *path, int every, uint8_t *mark)
{
    char kind[8];
    int32_t v[4];
    int64_t n = 0;
    FILE *f = fopen(path, "r");
    for (; f &&
           fscanf(f, "%7s %d %d %d %d", kind, &v[0], &v[1], &v[2], &v[3]) == 5;
         n++)
        for (int k = 0; k < 4 && n % every == 0; k++)
            mark[v[k]] = 1;
    if (f)
        fclose(f);
    return n;
}

static void sort2(int32_t *a, int32_t *b)
{
    int32_t low = *a < *b ? *a : *b, high = *a < *b ? *b : *a;
    *a = low;
    *b = high;
}

/* Brings a pair to one form, whichever order its primitives and vertices
 * have. */
static void normalise(struct fabric_pair *p)
{
    int32_t *v = p->v;
    if (p->kind == 0) {
        sort2(&v[1], &v[2]);
        sort2(&v[2], &v[3]);
        sort2(&v[1], &v[2]);
        return;
    }
    sort2(&v[0], &v[1]);
    sort2(&v[2], &v[3]);
    if (v[0] > v[2]) {
        struct fabric_pair q = {1, {v[2], v[3], v[0], v[1]}};
        *p = q;
    }
}

/* Counts the lines of hits.txt that are not among n sorted candidates. */
static int64_t count_missing(const char *path, int every,
                             const struct fabric_pair *got, int64_t n)
{
    char kind[8];
    struct fabric_pair p;
    int64_t line = 0, missing = 0;
    FILE *f = fopen(path, "r");
    for (; f && fscanf(f, "%7s %d %d %d %d", kind, &p.v[0], &p.v[1], &p.v[2],
                       &p.v[3]) == 5;
         line++) {
        p.kind = kind[0] == 'e';
        normalise(&p);
        missing += line % every == 0 &&
                   !bsearch(&p, got, (size_t)n, sizeof p, fabric_compare);
    }
    if (f)
        fclose(f);
    return missing;
}

struct frame {
    struct ply at[2];
    struct fabric f;
    struct broad b;
    char hits[512];
    int64_t lines, n;
    bool good;
};

/* Queries the triangles around the marked vertices, as one mesh against
 * itself. */
static void query_frame(struct frame *u, const uint8_t *mark)
{
    struct ply *p = &u->at[0];
    fabric_make(&u->f, p->nv, p->nt, 1);
    struct tree_scene *s = &u->f.scene;
    u->f.mesh[0].kind = TREE_MOVING;
    u->f.mesh[0].self = true;
    s->meshes = 1;
    s->vertices = p->nv;
    for (int32_t t = 0; t < p->nt; t++) {
        const int32_t *g = p->tri[t];
        if (mark[g[0]] | mark[g[1]] | mark[g[2]])
            memcpy(u->f.tri[s->tris++], g, sizeof u->f.tri[0]);
    }
    u->f.mesh[0].tris = s->tris;
    memcpy(u->f.x0, p->x, (size_t)p->nv * sizeof *p->x);
    u->good = broad_make(&u->b, s, true, &u->f.arena) == DRAPE_OK &&
              broad_query(&u->b, p->x, u->at[1].x, 0, NULL) == DRAPE_OK;
}

static const char *frame_hits(const char *name, int every)
{
    struct frame u = {.good = false};
    char path[512];
    int64_t missing = 0;
    for (int k = 0; k < 2; k++) {
        snprintf(path, sizeof path, "%s/ccd/frames/%s/t%d.ply", data_home(),
                 name, k);
        u.good = ply_read(path, &u.at[k]) && (k == 0 || u.good);
    }
    snprintf(u.hits, sizeof u.hits, "%s/ccd/frames/%s/hits.txt", data_home(),
             name);
    uint8_t *mark = calloc((size_t)u.at[0].nv + 1, 1);
    if (u.good && mark) {
        u.lines = mark_hits(u.hits, every, mark);
        query_frame(&u, mark);
        struct fabric_pair *got = fabric_found(&u.f, &u.b, &u.n);
        for (int64_t k = 0; k < u.n; k++)
            normalise(&got[k]);
        qsort(got, (size_t)u.n, sizeof *got, fabric_compare);
        missing = count_missing(u.hits, every, got, u.n);
        fabric_free(&u.f);
    }
    free(mark);
    ply_free(&u.at[0]);
    ply_free(&u.at[1]);
    EXPECT(u.good && u.lines > 0);
    EXPECT(missing == 0);
    ran(u.lines / every);
    return NULL;
}

/* Every line of hits.txt is among the candidates: all lines of the small frame;
 * a sample of the large frames' lines, or all where DRAPE_SOAK is set.
 * cloth-funnel has binary64 coordinates, so the 32-bit build tests another
 * scene in its place. */
const char *test_broad_frames(void)
{
    int every = getenv("DRAPE_SOAK") ? 1 : 64;
    const char *failed = NULL;
    FILE *f = data_open("ccd/frames/cloth-funnel/hits.txt");
    if (!f)
        return skip("no ccd/frames in DRAPE_DATA" FETCHED);
    fclose(f);
    if (REAL_BITS == 64)
        failed = frame_hits("cloth-funnel", 1);
    if (!failed)
        failed = frame_hits("cloth-ball", every);
    return failed ? failed : frame_hits("n-body-simulation", every);
}
