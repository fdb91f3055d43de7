/* SPDX-License-Identifier: Apache-2.0 */
/* The points of a seam: which particle of one edge is held to which place on
 * the other. app/patterns/README.md §8. */
#include "app/base/cut.h"

#include <stdlib.h>

/* A particle of an edge and its place, 0 … 1 of the edge's length. */
struct place {
    double at;
    int32_t particle;
};
struct line {
    struct place *place; /* [n], ascending */
    int n;
    double length; /* m */
};

static int compare(const void *a, const void *b)
{
    const struct place *p = a, *q = b;
    if (p->at != q->at)
        return p->at < q->at ? -1 : 1;
    return (p->particle > q->particle) - (p->particle < q->particle);
}

/* The length of the outline from its first chord to a particle on it. */
static double along(const struct cut_side *side, int32_t p)
{
    const struct outline *o = side->outline;
    int32_t c = side->cut->chord[p];
    const double *x = side->cut->x[p], *a = o->x[c];
    return o->s[c] + plane_length(x[0] - a[0], x[1] - a[1]);
}

/* Finds the particles of an edge that cells have. false: no memory. */
static bool find_line(const struct cut_side *side, struct line *line)
{
    const struct cut *cut = side->cut;
    const struct outline *o = side->outline;
    int64_t count = (int64_t)cut->m * cut->n;
    int32_t first = o->first[side->edge], last = o->first[side->edge + 1];
    double from = o->s[first];
    int32_t end[2] = {cut->corner[side->edge],
                      cut->corner[(side->edge + 1) % o->edges]};
    line->length = o->s[last] - from;
    size_t room = 2;
    for (int64_t p = 0; p < count; p++)
        room += cut->kind[p] == CUT_BORDER;
    line->place = malloc(room * sizeof *line->place);
    if (!line->place)
        return false;
    for (int k = 0; k < 2; k++)
        if (cut->kind[end[k]] == CUT_CORNER && end[0] != end[1])
            line->place[line->n++] = (struct place){k, end[k]};
    for (int64_t p = 0; p < count; p++) {
        if (cut->kind[p] != CUT_BORDER || cut->chord[p] < first ||
            cut->chord[p] >= last)
            continue;
        double at = (along(side, (int32_t)p) - from) / line->length;
        line->place[line->n++] = (struct place){at, (int32_t)p};
    }
    for (int k = 0; side->back && k < line->n; k++)
        line->place[k].at = 1 - line->place[k].at;
    qsort(line->place, (size_t)line->n, sizeof *line->place, compare);
    return true;
}

/* Holds a particle to the other edge. false: to itself, as at a dart's tip, or
 * further than half a spacing behind the last particle of an edge whose corner
 * no cell reaches: two would be held to that one, which no pull closes. */
static bool hold(const struct line *to, bool same, const struct place *at,
                 struct cut_point *out)
{
    const struct place *q = to->place;
    double reach = to->n > 1 ? 0.5 / to->n : 0;
    if (!to->n || at->at < q[0].at - reach || at->at > q[to->n - 1].at + reach)
        return false;
    int k = 0;
    while (k + 2 < to->n && q[k + 1].at <= at->at)
        k++;
    int next = k + 1 < to->n ? k + 1 : k;
    double gap = q[next].at - q[k].at;
    double part = gap > 0 ? (at->at - q[k].at) / gap : 0;
    /* rounding must not tie a particle to a second one */
    part = part < 1e-6 ? 0 : part > 1 - 1e-6 ? 1 : part;
    *out = (struct cut_point){.particle = at->particle,
                              .onto = {q[k].particle, q[next].particle},
                              .part = part};
    if (part == 0)
        out->onto[1] = out->onto[0];
    if (part == 1)
        out->onto[0] = out->onto[1];
    return !same ||
           (out->onto[0] != at->particle && out->onto[1] != at->particle);
}

static bool make(struct cut_seam *seam, const struct line line[2], bool same)
{
    seam->fine = line[1].n > line[0].n;
    const struct line *fine = &line[seam->fine], *to = &line[!seam->fine];
    seam->point = malloc(((size_t)fine->n + 1) * sizeof *seam->point);
    if (!seam->point)
        return false;
    for (int k = 0; k < fine->n; k++) {
        struct cut_point *point = &seam->point[seam->n];
        if (!hold(to, same, &fine->place[k], point))
            continue;
        int before = k ? k - 1 : 0, after = k + 1 < fine->n ? k + 1 : k;
        point->at = fine->place[k].at;
        point->length =
            fine->length * (fine->place[after].at - fine->place[before].at) / 2;
        seam->n++;
    }
    return true;
}

/* What both sides differ by is eased where that is a strain of more than this:
 * less is what a seam of light cotton bears with 1 N/m. */
static const double slight = 1e-3;
/* The greatest ease that drape_ease takes. The seam pulls the rest together. */
static const double most = 0.5;

/* Eases the edges of the longer side. */
static bool ease(struct cut_seam *seam, const struct line line[2])
{
    seam->longer = line[1].length > line[0].length;
    const struct line *from = &line[seam->longer];
    double ratio = line[!seam->longer].length / from->length;
    if (!(ratio < 1 - slight))
        return true;
    seam->ease = malloc((size_t)from->n * sizeof *seam->ease);
    for (int k = 0; seam->ease && k + 1 < from->n; k++)
        seam->ease[seam->eases++] = (struct cut_ease){
            {from->place[k].particle, from->place[k + 1].particle},
            ratio > most ? ratio : most};
    return seam->ease;
}

bool cut_seam_make(struct cut_seam *seam, const struct cut_side side[2])
{
    struct line line[2] = {{0}, {0}};
    *seam = (struct cut_seam){0};
    bool good = find_line(&side[0], &line[0]) && find_line(&side[1], &line[1]);
    if (good && line[0].n > 1 && line[1].n > 1)
        good = make(seam, line, side[0].cut == side[1].cut) && ease(seam, line);
    free(line[0].place);
    free(line[1].place);
    return good;
}

void cut_seam_free(struct cut_seam *seam)
{
    free(seam->point);
    free(seam->ease);
    *seam = (struct cut_seam){0};
}
