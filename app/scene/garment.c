/* SPDX-License-Identifier: Apache-2.0 */
/* Cuts the panels of a sewing pattern, and says of each what cannot be cut, or
 * not as drawn. */
#include "app/scene/garment.h"
#include "app/base/app.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A strap of fewer cells is told of. */
enum { FEW = 3 };
/* Chords stay within this part of a cell of their curves. */
static const double chord_error = 1e-3;

/* The file's number of the edge at this place of the loop. */
static int number(const struct garment_panel *p, int place)
{
    return p->number[place];
}

static int refuse_crossing(const struct garment *g,
                           const struct garment_panel *p,
                           const struct outline_pair *pair)
{
    double unit = g->pattern->unit;
    int a = number(p, pair->edge[0]), b = number(p, pair->edge[1]);
    if (a == b)
        return complain(APP_USAGE,
                        "%s: panel %s: edge %d crosses or touches itself near "
                        "(%.4g, %.4g)",
                        g->pattern->file, p->panel->name, a, pair->x[0] * unit,
                        pair->x[1] * unit);
    return complain(APP_USAGE,
                    "%s: panel %s: edges %d and %d cross or touch near "
                    "(%.4g, %.4g)",
                    g->pattern->file, p->panel->name, a, b, pair->x[0] * unit,
                    pair->x[1] * unit);
}

/* Refuses a strap narrower than a cell. */
static int check_width(const struct garment *g, struct garment_panel *p)
{
    if (outline_narrow(&p->outline, FEW * g->h, &p->strap, &p->gap) ==
        OUTLINE_MEMORY)
        return no_memory();
    if (!(p->strap.width < g->h * (1 - 1e-9)))
        return APP_OK;
    return complain(APP_USAGE,
                    "%s: panel %s: the strap between edges %d and %d is %.3g "
                    "mm wide, which is less than a cell of %.3g mm",
                    g->pattern->file, p->panel->name,
                    number(p, p->strap.edge[0]), number(p, p->strap.edge[1]),
                    1e3 * p->strap.width, 1e3 * g->h);
}

/* Tells of straps of few cells, and of gaps that cells may close. */
static void tell_width(const struct garment *g, const struct garment_panel *p)
{
    const char *file = g->pattern->file, *name = p->panel->name;
    if (p->strap.width < INFINITY)
        complain(APP_OK,
                 "%s: panel %s: the strap between edges %d and %d is %.2g "
                 "cells wide",
                 file, name, number(p, p->strap.edge[0]),
                 number(p, p->strap.edge[1]), p->strap.width / g->h);
    if (p->gap.width < g->h)
        complain(APP_OK,
                 "%s: panel %s: the gap between edges %d and %d is %.2g cells "
                 "wide, and may not be cut there",
                 file, name, number(p, p->gap.edge[0]),
                 number(p, p->gap.edge[1]), p->gap.width / g->h);
}

/* The edge that is nearest to a point. */
static int nearest_edge(const struct garment_panel *p, const double x[2])
{
    double best = INFINITY, near[2];
    int edge = 0;
    for (int k = 0; k < p->outline.n; k++) {
        double d =
            segment_distance(x, p->outline.x[k], p->outline.x[k + 1], near);
        if (d < best) {
            best = d;
            edge = p->outline.of[k];
        }
    }
    return number(p, edge);
}

static int refuse_cut(const struct garment *g, const struct garment_panel *p,
                      enum cut_status status, const double x[2])
{
    const char *file = g->pattern->file, *name = p->panel->name;
    double unit = g->pattern->unit;
    switch (status) {
    case CUT_NONE:
        return complain(APP_USAGE,
                        "%s: panel %s: no cell of %.3g mm fits into it", file,
                        name, 1e3 * g->h);
    case CUT_APART:
        return complain(APP_USAGE,
                        "%s: panel %s: by cells of %.3g mm it falls apart at "
                        "(%.4g, %.4g), where edge %d is",
                        file, name, 1e3 * g->h, x[0] * unit, x[1] * unit,
                        nearest_edge(p, x));
    case CUT_LARGE:
        return complain(APP_USAGE,
                        "%s: panel %s: cells of %.3g mm are too many; at most "
                        "%d particles a panel",
                        file, name, 1e3 * g->h, CUT_MOST);
    default:
        return no_memory();
    }
}

bool garment_ends(const struct garment_panel *panel, int place, int32_t end[2])
{
    end[0] = panel->cut.corner[place];
    end[1] = panel->cut.corner[(place + 1) % panel->edges];
    return end[0] != end[1];
}

/* Tells of edges that have no length in cells, and of the corners that no cell
 * reaches. */
static void tell_lost(const struct garment *g, const struct garment_panel *p)
{
    const char *file = g->pattern->file, *name = p->panel->name;
    for (int k = 0; k < p->edges; k++) {
        int32_t end[2];
        int edge = number(p, k), stitch = p->panel->edge[edge].stitch;
        double length = 1e3 * curve_length(&p->curve[k]);
        if (!garment_ends(p, k, end) && stitch >= 0)
            complain(APP_OK,
                     "%s: panel %s: edge %d, %.2g mm long, is too short for "
                     "cells, and with it goes stitch %d",
                     file, name, edge, length, stitch);
        else if (end[0] == end[1])
            complain(APP_OK,
                     "%s: panel %s: edge %d, %.2g mm long, is too short for "
                     "cells",
                     file, name, edge, length);
        if (p->cut.kind[end[0]] == CUT_OUT)
            complain(APP_OK,
                     "%s: panel %s: no cell reaches the corner where edge %d "
                     "meets edge %d",
                     file, name, number(p, (k + p->edges - 1) % p->edges),
                     edge);
    }
}

static bool lay_panel(struct garment *g, struct garment_panel *p)
{
    size_t edges = (size_t)p->panel->edges;
    p->edges = p->panel->edges;
    p->curve = pool_take(&g->pool, edges, sizeof *p->curve);
    p->number = pool_take(&g->pool, edges, sizeof *p->number);
    if (!p->curve || !p->number)
        return false;
    memcpy(p->curve, p->panel->outline, edges * sizeof *p->curve);
    for (int k = 0; k < p->edges; k++)
        p->number[k] = p->panel->loop[k].edge;
    return true;
}

/* Whether an edge can be closed up: three are left, and none beside it is as
 * short, whose middle would be another place. */
static bool may_close(const struct garment_panel *p, int place, double h)
{
    int before = place > 0 ? place - 1 : p->edges - 1;
    int after = place + 1 < p->edges ? place + 1 : 0;
    return p->edges > 3 && curve_length(&p->curve[before]) >= h &&
           curve_length(&p->curve[after]) >= h;
}

/* Takes an edge out of the outline, whose chords then close the gap. */
static void close_edge(struct garment_panel *p, int place)
{
    size_t left = (size_t)(p->edges - place - 1);
    memmove(p->curve + place, p->curve + place + 1, left * sizeof *p->curve);
    memmove(p->number + place, p->number + place + 1, left * sizeof *p->number);
    p->edges--;
}

static void close_stitch(struct garment *g, int k)
{
    const struct pattern_stitch *stitch = &g->pattern->stitch[k];
    struct garment_panel *p[2];
    double length[2];
    int place[2];
    bool may = stitch->side[0].panel != stitch->side[1].panel;
    garment_lengths(g->pattern, stitch, length);
    for (int s = 0; s < 2; s++) {
        p[s] = &g->panel[stitch->side[s].panel];
        place[s] = garment_find_edge(p[s], stitch->side[s].edge);
        may = may && length[s] < g->h && may_close(p[s], place[s], g->h);
    }
    if (!may)
        return;
    close_edge(p[0], place[0]);
    close_edge(p[1], place[1]);
    complain(APP_OK,
             "%s: stitch %d, of edge %d of panel %s, %.2g mm long, is shorter "
             "than a cell, and is closed up",
             g->pattern->file, k, stitch->side[0].edge, p[0]->panel->name,
             1e3 * length[0]);
}

/* Lays the outlines of all panels. A stitch whose sides are both shorter than a
 * cell is closed up: app/patterns/README.md §2. */
static int lay_outlines(struct garment *garment)
{
    for (int k = 0; k < garment->pattern->panels; k++) {
        garment->panel[k].panel = &garment->pattern->panel[k];
        if (!lay_panel(garment, &garment->panel[k]))
            return no_memory();
    }
    for (int k = 0; k < garment->pattern->stitches; k++)
        close_stitch(garment, k);
    return APP_OK;
}

static int cut_panel(const struct garment *g, struct garment_panel *p)
{
    struct outline_pair pair;
    double x[2] = {0, 0};
    if (!outline_make(&p->outline, p->curve, p->edges, chord_error * g->h,
                      g->h))
        return no_memory();
    enum outline_answer crosses = outline_crosses(&p->outline, &pair);
    if (crosses == OUTLINE_MEMORY)
        return no_memory();
    if (crosses == OUTLINE_YES)
        return refuse_crossing(g, p, &pair);
    int status = check_width(g, p);
    if (status != APP_OK)
        return status;
    enum cut_status cut = cut_make(&p->cut, &p->outline, g->h, x);
    return cut == CUT_OK ? APP_OK : refuse_cut(g, p, cut, x);
}

int garment_cut(struct garment *garment, const struct pattern *pattern,
                double h)
{
    *garment = (struct garment){.pattern = pattern, .h = h};
    garment->panel = calloc((size_t)pattern->panels, sizeof *garment->panel);
    if (!garment->panel)
        return no_memory();
    int status = lay_outlines(garment);
    for (int k = 0; k < pattern->panels && status == APP_OK; k++)
        status = cut_panel(garment, &garment->panel[k]);
    /* a refusal stands alone */
    for (int k = 0; k < pattern->panels && status == APP_OK; k++) {
        tell_width(garment, &garment->panel[k]);
        tell_lost(garment, &garment->panel[k]);
    }
    return status;
}

void garment_free(struct garment *garment)
{
    for (int k = 0; garment->panel && k < garment->pattern->panels; k++) {
        outline_free(&garment->panel[k].outline);
        cut_free(&garment->panel[k].cut);
    }
    free(garment->panel);
    garment->panel = NULL;
    pool_free(&garment->pool);
}

void garment_count(const struct garment_panel *panel, int *count)
{
    const struct cut *cut = &panel->cut;
    for (int k = 0; k < panel->panel->edges; k++)
        count[k] = 0;
    for (int k = 0; k < panel->edges; k++) {
        int32_t end[2];
        bool there = garment_ends(panel, k, end);
        count[number(panel, k)] = (there && cut->kind[end[0]] == CUT_CORNER) +
                                  (there && cut->kind[end[1]] == CUT_CORNER);
    }
    for (int64_t p = 0; p < (int64_t)cut->m * cut->n; p++)
        if (cut->kind[p] == CUT_BORDER)
            count[number(panel, panel->outline.of[cut->chord[p]])]++;
}

void garment_lengths(const struct pattern *pattern,
                     const struct pattern_stitch *stitch, double length[2])
{
    for (int k = 0; k < 2; k++) {
        const struct pattern_panel *panel =
            &pattern->panel[stitch->side[k].panel];
        length[k] = curve_length(&panel->edge[stitch->side[k].edge].curve);
    }
}

int garment_find_edge(const struct garment_panel *panel, int edge)
{
    int place = panel->edges - 1;
    while (place >= 0 && panel->number[place] != edge)
        place--;
    return place;
}

bool garment_is_clockwise(const struct pattern_panel *panel)
{
    int place = 0;
    while (panel->loop[place].edge != 0)
        place++;
    return panel->loop[place].back;
}

bool garment_runs_back(const struct garment *garment,
                       const struct pattern_stitch *stitch)
{
    /* Round their panels as the file goes, seen from the right side, one edge
     * begins where the other ends. */
    bool same =
        garment_is_clockwise(garment->panel[stitch->side[0].panel].panel) ==
        garment_is_clockwise(garment->panel[stitch->side[1].panel].panel);
    return same != stitch->turned;
}

int garment_seam(const struct garment *garment,
                 const struct pattern_stitch *stitch, struct cut_seam *seam)
{
    struct cut_side side[2];
    *seam = (struct cut_seam){0};
    for (int k = 0; k < 2; k++) {
        const struct garment_panel *p = &garment->panel[stitch->side[k].panel];
        int32_t end[2];
        int place = garment_find_edge(p, stitch->side[k].edge);
        if (place < 0 || !garment_ends(p, place, end))
            return APP_OK;
        side[k] = (struct cut_side){&p->cut, &p->outline, place, false};
    }
    side[1].back = garment_runs_back(garment, stitch);
    return cut_seam_make(seam, side) ? APP_OK : no_memory();
}

bool garment_is_dart(const struct pattern *pattern,
                     const struct pattern_stitch *stitch)
{
    const struct pattern_side *a = &stitch->side[0], *b = &stitch->side[1];
    const struct pattern_panel *panel = &pattern->panel[a->panel];
    if (a->panel != b->panel)
        return false;
    const int *p = panel->edge[a->edge].end, *q = panel->edge[b->edge].end;
    return p[0] == q[0] || p[0] == q[1] || p[1] == q[0] || p[1] == q[1];
}
