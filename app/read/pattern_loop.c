/* SPDX-License-Identifier: Apache-2.0 */
/* Joins the edges of a panel to its outline, counter-clockwise, in whatever
 * order and direction the file has them. */
#include "app/base/app.h"
#include "app/read/json.h"
#include "app/read/pattern.h"

#include <math.h>

/* The edges that meet in each vertex. */
struct meeting {
    int count, edge[2];
};

/* Refuses a vertex in which not two edges meet. */
static int check_vertex(struct json *json, const struct meeting *meeting,
                        int vertex)
{
    int edge = meeting->edge[0];
    if (meeting->count == 1)
        return json_refuse(json,
                           "the outline is open: edge %d ends in vertex %d, "
                           "where no other edge does",
                           edge, vertex);
    if (meeting->count > 2)
        return json_refuse(json,
                           "%d edges meet in vertex %d, edges %d and %d among "
                           "them; expected 2",
                           meeting->count, vertex, edge, meeting->edge[1]);
    return APP_OK;
}

static int find_meetings(struct json *json, const struct pattern_panel *panel,
                         struct meeting *meeting)
{
    for (int k = 0; k < panel->edges; k++)
        for (int end = 0; end < 2; end++) {
            struct meeting *at = &meeting[panel->edge[k].end[end]];
            if (at->count < 2)
                at->edge[at->count] = k;
            at->count++;
        }
    for (int k = 0; k < panel->vertices; k++) {
        int status = check_vertex(json, &meeting[k], k);
        if (status != APP_OK)
            return status;
    }
    return APP_OK;
}

/* Walks from edge 0 along its direction. Returns how many edges it passed. */
static int walk(struct pattern_panel *panel, const struct meeting *meeting)
{
    int edge = 0, count = 0;
    bool back = false;
    do {
        panel->loop[count++] = (struct pattern_turn){edge, back};
        int vertex = panel->edge[edge].end[back ? 0 : 1];
        const struct meeting *at = &meeting[vertex];
        edge = at->edge[0] == edge ? at->edge[1] : at->edge[0];
        back = panel->edge[edge].end[0] != vertex;
    } while (edge != 0 && count < panel->edges);
    return count;
}

/* Copies the curves in the order of the loop. Returns the area inside. */
static double lay(struct pattern_panel *panel)
{
    double area = 0;
    for (int k = 0; k < panel->edges; k++) {
        struct curve *curve = &panel->outline[k];
        *curve = panel->edge[panel->loop[k].edge].curve;
        if (panel->loop[k].back)
            curve_reverse(curve);
        area += curve_area(curve);
    }
    return area;
}

static void turn_round(struct pattern_panel *panel)
{
    for (int i = 0, j = panel->edges - 1; i <= j; i++, j--) {
        struct pattern_turn a = panel->loop[i], b = panel->loop[j];
        panel->loop[i] = (struct pattern_turn){b.edge, !b.back};
        panel->loop[j] = (struct pattern_turn){a.edge, !a.back};
    }
}

int pattern_close(struct json *json, struct pattern_panel *panel)
{
    size_t edges = (size_t)panel->edges;
    struct meeting *meeting =
        pool_take(json->pool, (size_t)panel->vertices + 1, sizeof *meeting);
    panel->loop = pool_take(json->pool, edges, sizeof *panel->loop);
    panel->outline = pool_take(json->pool, edges, sizeof *panel->outline);
    if (!meeting || !panel->loop || !panel->outline)
        return complain(APP_FAILED, "out of memory");
    int status = find_meetings(json, panel, meeting);
    if (status != APP_OK)
        return status;
    int passed = walk(panel, meeting);
    if (passed < panel->edges) {
        bool seen = true;
        int left = 0;
        for (int k = 0; seen; k++) {
            left = k;
            seen = false;
            for (int j = 0; j < passed; j++)
                seen |= panel->loop[j].edge == k;
        }
        return json_refuse(json,
                           "edge %d is not of the outline that edge 0 is of; "
                           "a panel has one outline",
                           left);
    }
    double area = lay(panel);
    if (area < 0) {
        turn_round(panel);
        area = lay(panel);
    }
    if (!(area > 1e-8))
        return json_refuse(json,
                           "the outline encloses %.3g m², which is no "
                           "panel",
                           area);
    return APP_OK;
}
