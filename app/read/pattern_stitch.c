/* SPDX-License-Identifier: Apache-2.0 */
/* The stitches of a sewing pattern: which edge is sewn to which. */
#include "app/base/app.h"
#include "app/base/nearest.h"
#include "app/read/json.h"
#include "app/read/pattern.h"

#include <string.h>

enum { STITCHES = 10000 };

static int read_panel_name(struct json *json, json_t *node, void *out)
{
    const struct pattern *pattern = json->user;
    const char *name = json_string_value(node);
    struct nearest nearest = {.word = name};
    if (!name)
        return json_refuse(json, "expected the name of a panel");
    for (int k = 0; k < pattern->panels; k++) {
        if (strcmp(pattern->panel[k].name, name) == 0) {
            ((struct pattern_side *)out)->panel = k;
            return APP_OK;
        }
        nearest_try(&nearest, pattern->panel[k].name);
    }
    if (nearest.name)
        return json_refuse(json,
                           "there is no panel \"%.60s\"; did you mean \"%s\"?",
                           name, nearest.name);
    return json_refuse(json, "there is no panel \"%.60s\"", name);
}

static int read_edge_number(struct json *json, json_t *node, void *out)
{
    const struct pattern *pattern = json->user;
    struct pattern_side *side = out;
    const struct pattern_panel *panel = &pattern->panel[side->panel];
    const struct json_key key = {.type = KEY_INTEGER, .lo = 0, .hi = 1e9};
    int status = json_value(json, node, &key, &side->edge);
    if (status == APP_OK && side->edge >= panel->edges)
        return json_refuse(json, "%d: panel %s has edges 0 to %d", side->edge,
                           panel->name, panel->edges - 1);
    return status;
}

/* A side of stitch k. An edge is a side of one stitch at most. */
static int read_side(struct json *json, json_t *node, struct pattern_side *side,
                     int k)
{
    static const char *const needed[] = {"panel", "edge", NULL};
    static const struct json_key keys[] = {
        NESTED_KEY("panel", 0, read_panel_name),
        NESTED_KEY("edge", 0, read_edge_number),
        {0}};
    const struct pattern *pattern = json->user;
    int status = pattern_members(json, node, keys, side, needed);
    if (status != APP_OK)
        return status;
    const struct pattern_panel *panel = &pattern->panel[side->panel];
    struct pattern_edge *edge = &panel->edge[side->edge];
    if (edge->stitch >= 0)
        return json_refuse(json,
                           "edge %d of panel %s is a side of stitch %d "
                           "already",
                           side->edge, panel->name, edge->stitch);
    edge->stitch = k;
    return APP_OK;
}

/* Two sides, and as a third item, if there is one, "right_wrong". */
static int read_stitch(struct json *json, json_t *node, void *out)
{
    struct pattern *pattern = json->user;
    struct pattern_stitch *stitch = out;
    size_t count = json_array_size(node);
    if (!json_is_array(node) || count < 2 || count > 3)
        return json_refuse(json, "expected a list of two sides, each a panel "
                                 "and an edge");
    for (size_t k = 0; k < 2; k++) {
        size_t length = json_enter(json, "[%d]", (int)k);
        int status = read_side(json, json_array_get(node, k), &stitch->side[k],
                               pattern->stitches);
        if (status != APP_OK)
            return status;
        json_leave(json, length);
    }
    json_t *third = json_array_get(node, 2);
    const char *text = json_string_value(third);
    if (count == 3 && !json_is_null(third) &&
        (!text || (strcmp(text, "right_wrong") != 0 &&
                   strcmp(text, "right_right") != 0))) {
        json_enter(json, "[2]");
        return json_refuse(json, "expected \"right_wrong\"");
    }
    stitch->turned = text && strcmp(text, "right_wrong") == 0;
    pattern->stitches++;
    return APP_OK;
}

int pattern_read_stitches(struct json *json, json_t *node,
                          struct pattern *pattern)
{
    void *user = json->user;
    struct json_list list = {read_stitch, sizeof *pattern->stitch, STITCHES,
                             NULL, 0};
    json->user = pattern;
    int status = json_items(json, node, &list);
    json->user = user;
    pattern->stitch = list.items;
    return status;
}
