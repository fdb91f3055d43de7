/* SPDX-License-Identifier: Apache-2.0 */
/* A panel of a sewing pattern: its vertices, its edges and their curves. */
#include "app/base/app.h"
#include "app/read/json.h"
#include "app/read/pattern.h"

#include <limits.h>
#include <math.h>
#include <string.h>

enum { VERTICES = 10000 };
/* Lengths in the file's unit, and angles. */
static const double far = 1e7;

const char *const pattern_types[] = {"line",   "quadratic", "cubic",
                                     "circle", "polyline",  NULL};

/* What the readers of a panel share. */
struct reading {
    struct pattern_panel *panel;
    bool absolute; /* control points are places, not parts of the chord */
};

/* What curvature says, for the readers of its parts. */
struct curvature {
    int type; /* of curve_names */
    json_t *params;
};

static const char *const curve_names[] = {"quadratic", "cubic", "circle",
                                          "polyline", NULL};

/* A label; an empty one is none. */
static int read_label(struct json *json, json_t *node, void *out)
{
    const char *text = json_string_value(node);
    if (!text)
        return json_refuse(json, "expected a text");
    *(char **)out = *text ? pool_text(json->pool, text) : NULL;
    return !*text || *(char **)out ? APP_OK
                                   : complain(APP_FAILED, "out of memory");
}

static int read_point(struct json *json, json_t *node, void *out)
{
    const struct json_key key = {
        .type = KEY_VECTOR, .lo = -far, .hi = far, .count = 2};
    return json_value(json, node, &key, out);
}

static int read_vertices(struct json *json, json_t *node, void *out)
{
    struct pattern_panel *panel = out;
    struct json_list list = {read_point, sizeof *panel->vertex, VERTICES, NULL,
                             0};
    int status = json_items(json, node, &list);
    panel->vertex = list.items;
    panel->vertices = list.count;
    return status;
}

/* Whether two places are more apart than rounding leaves one. */
static bool is_apart(const double a[2], const double b[2])
{
    return plane_length(b[0] - a[0], b[1] - a[1]) >
           1e-9 * (1 + plane_length(a[0], a[1]) + plane_length(b[0], b[1]));
}

/* The two ends of an edge: numbers of vertices. */
static int read_ends(struct json *json, json_t *node, void *out)
{
    struct pattern_edge *edge = out;
    const struct pattern_panel *panel =
        ((const struct reading *)json->user)->panel;
    const struct json_key key = {
        .type = KEY_INTEGER, .lo = 0, .hi = panel->vertices - 1};
    if (!json_is_array(node) || json_array_size(node) != 2)
        return json_refuse(json, "expected the numbers of two vertices");
    for (int k = 0; k < 2; k++) {
        size_t length = json_enter(json, "[%d]", k);
        int status = json_value(json, json_array_get(node, (size_t)k), &key,
                                &edge->end[k]);
        if (status != APP_OK)
            return status;
        json_leave(json, length);
    }
    const double *a = panel->vertex[edge->end[0]];
    const double *b = panel->vertex[edge->end[1]];
    memcpy(edge->curve.a, a, sizeof edge->curve.a);
    memcpy(edge->curve.b, b, sizeof edge->curve.b);
    if (!is_apart(a, b))
        return json_refuse(json,
                           "the edge has no length: both ends are at "
                           "(%.6g, %.6g)",
                           a[0], a[1]);
    return APP_OK;
}

/* A control point; a relative one is in parts of the chord, along it and to
 * its left. */
static int read_control(struct json *json, json_t *node,
                        const struct curve *curve, double out[2])
{
    const struct reading *reading = json->user;
    double given[2];
    int status = read_point(json, node, given);
    if (status != APP_OK)
        return status;
    double dx = curve->b[0] - curve->a[0], dy = curve->b[1] - curve->a[1];
    bool absolute = reading->absolute;
    out[0] = absolute ? given[0] : curve->a[0] + given[0] * dx - given[1] * dy;
    out[1] = absolute ? given[1] : curve->a[1] + given[0] * dy + given[1] * dx;
    if (!(plane_length(out[0], out[1]) <= 10 * far))
        return json_refuse(json, "the control point is too far away");
    return APP_OK;
}

static int read_bezier(struct json *json, json_t *params, struct curve *curve,
                       int count)
{
    if (!json_is_array(params) || json_array_size(params) != (size_t)count)
        return json_refuse(json, "expected a list of %d control point%s", count,
                           count > 1 ? "s" : "");
    curve->type = count == 1 ? CURVE_QUADRATIC : CURVE_CUBIC;
    for (int k = 0; k < count; k++) {
        size_t length = json_enter(json, "[%d]", k);
        int status = read_control(json, json_array_get(params, (size_t)k),
                                  curve, k ? curve->d : curve->c);
        if (status != APP_OK)
            return status;
        json_leave(json, length);
    }
    return APP_OK;
}

/* The points of a polyline between its ends. */
static int read_polyline(struct json *json, json_t *params, struct curve *curve)
{
    size_t count = json_array_size(params);
    if (!json_is_array(params) || !count || count > VERTICES)
        return json_refuse(json, "expected a list of 1 to %d points", VERTICES);
    curve->point = pool_take(json->pool, count, sizeof *curve->point);
    if (!curve->point)
        return complain(APP_FAILED, "out of memory");
    curve->type = CURVE_POLYLINE;
    for (size_t k = 0; k < count; k++) {
        size_t length = json_enter(json, "[%d]", (int)k);
        int status = read_control(json, json_array_get(params, k), curve,
                                  curve->point[k]);
        if (status != APP_OK)
            return status;
        json_leave(json, length);
    }
    curve->points = (int)count;
    for (int k = 0; k <= curve->points; k++) {
        const double *a = curve_corner(curve, k);
        const double *b = curve_corner(curve, k + 1);
        if (!is_apart(a, b))
            return json_refuse(json,
                               "corners %d and %d are one place, (%.6g, %.6g)",
                               k, k + 1, a[0], a[1]);
    }
    return APP_OK;
}

/* An arc's radius, whether it is the large one of the two arcs through both
 * ends, and whether it runs counter-clockwise. */
static int read_circle(struct json *json, json_t *params, struct curve *curve)
{
    const struct json_key key = {.type = KEY_NUMBER, .lo = 0, .hi = far};
    const struct json_key flag = {.type = KEY_INTEGER, .lo = 0, .hi = 1};
    double radius;
    int flags[2];
    if (!json_is_array(params) || json_array_size(params) != 3)
        return json_refuse(json, "expected a radius and two flags");
    for (int k = 0; k < 3; k++) {
        json_t *item = json_array_get(params, (size_t)k);
        size_t length = json_enter(json, "[%d]", k);
        int status = APP_OK;
        if (k && json_is_boolean(item))
            flags[k - 1] = json_is_true(item);
        else
            status = k ? json_value(json, item, &flag, &flags[k - 1])
                       : json_value(json, item, &key, &radius);
        if (status != APP_OK)
            return status;
        json_leave(json, length);
    }
    if (!curve_arc(curve, radius, flags[0], flags[1]))
        return json_refuse(
            json, "a circle of radius %.6g has no chord of %.6g", radius,
            plane_length(curve->b[0] - curve->a[0], curve->b[1] - curve->a[1]));
    return APP_OK;
}

static int read_params(struct json *json, json_t *node, void *out)
{
    (void)json;
    ((struct curvature *)out)->params = node;
    return APP_OK;
}

static int read_curvature(struct json *json, json_t *node, void *out)
{
    static const char *const needed[] = {"type", "params", NULL};
    static const struct json_key keys[] = {
        CHOICE_KEY("type", offsetof(struct curvature, type), curve_names),
        NESTED_KEY("params", 0, read_params),
        {0}};
    struct curve *curve = &((struct pattern_edge *)out)->curve;
    struct curvature curvature = {0};
    if (json_is_array(node)) {
        /* as files were written before there were types */
        curve->type = CURVE_QUADRATIC;
        return read_control(json, node, curve, curve->c);
    }
    int status = pattern_members(json, node, keys, &curvature, needed);
    if (status != APP_OK)
        return status;
    size_t length = json_enter(json, ".params");
    if (curvature.type == 3)
        status = read_polyline(json, curvature.params, curve);
    else if (curvature.type == 2)
        status = read_circle(json, curvature.params, curve);
    else
        status = read_bezier(json, curvature.params, curve, curvature.type + 1);
    if (status == APP_OK)
        json_leave(json, length);
    return status;
}

static int read_edge(struct json *json, json_t *node, void *out)
{
    static const char *const needed[] = {"endpoints", NULL};
    static const struct json_key keys[] = {
        NESTED_KEY("endpoints", 0, read_ends),
        NESTED_KEY("curvature", 0, read_curvature),
        NESTED_KEY("label", offsetof(struct pattern_edge, label), read_label),
        {0}};
    ((struct pattern_edge *)out)->stitch = -1;
    return pattern_members(json, node, keys, out, needed);
}

static int read_edges(struct json *json, json_t *node, void *out)
{
    struct pattern_panel *panel = out;
    struct json_list list = {read_edge, sizeof *panel->edge, VERTICES, NULL, 0};
    int status = json_items(json, node, &list);
    panel->edge = list.items;
    panel->edges = list.count;
    if (status == APP_OK && panel->edges < 2)
        return json_refuse(json, "expected at least 2 edges");
    return status;
}

int pattern_read_panel(struct json *json, json_t *node,
                       struct pattern_panel *panel, bool absolute)
{
    static const char *const needed[] = {"vertices", "edges", NULL};
    static const struct json_key keys[] = {
        NESTED_KEY("vertices", 0, read_vertices),
        NESTED_KEY("edges", 0, read_edges),
        VECTOR_KEY("translation", offsetof(struct pattern_panel, at), -1e7, 1e7,
                   3),
        VECTOR_KEY("rotation", offsetof(struct pattern_panel, turn), -1e7, 1e7,
                   3),
        NESTED_KEY("label", offsetof(struct pattern_panel, label), read_label),
        {0}};
    struct reading reading = {panel, absolute};
    void *user = json->user;
    json->user = &reading;
    int status = pattern_members(json, node, keys, panel, needed);
    json->user = user;
    return status;
}
