/* SPDX-License-Identifier: Apache-2.0 */
/* Sewing patterns in GarmentCode's JSON: the file, its units, its panels and
 * their order. */
#include "app/read/pattern.h"
#include "app/base/app.h"
#include "app/read/json.h"

#include <math.h>
#include <string.h>

enum { PANELS = 1000 };
/* m: the size of a panel, beyond which the unit is wrong, and its outline's
 * length. */
static const double smallest = 0.005, largest = 20, longest = 1000;

struct properties {
    double unit;
    int absolute; /* of curvature_coords */
};

static const char *const coords[] = {"relative", "absolute", NULL};
static const struct json_key property_keys[] = {
    NUMBER_KEY("units_in_meter", offsetof(struct properties, unit), 0.001, 1e6),
    CHOICE_KEY("curvature_coords", offsetof(struct properties, absolute),
               coords),
    {0}};

int pattern_members(struct json *json, json_t *node,
                    const struct json_key *keys, void *base,
                    const char *const *needed)
{
    for (; json_is_object(node) && *needed; needed++) {
        json_t *item = json_object_get(node, *needed);
        if (!item || json_is_null(item))
            return json_refuse(json, "has no \"%s\"", *needed);
    }
    return json_fields(json, node, keys, base);
}

static void scale(struct pattern_panel *panel, double by)
{
    for (int i = 0; i < 3; i++)
        panel->at[i] *= by;
    for (int k = 0; k < panel->vertices; k++)
        for (int i = 0; i < 2; i++)
            panel->vertex[k][i] *= by;
    for (int k = 0; k < panel->edges; k++) {
        struct curve *curve = &panel->edge[k].curve;
        for (int i = 0; i < 2; i++) {
            curve->a[i] *= by;
            curve->b[i] *= by;
            curve->c[i] *= by;
            curve->d[i] *= by;
            for (int p = 0; p < curve->points; p++)
                curve->point[p][i] *= by;
        }
    }
}

/* Refuses a panel whose size is no garment's. */
static int check_size(struct json *json, const struct pattern_panel *panel,
                      double unit)
{
    enum { POINTS = 16 }; /* an edge, as curves may leave the vertices far */
    double size = 0, length = 0, x[2];
    for (int k = 0; k < POINTS * panel->edges; k++) {
        const double *first = panel->outline[0].a;
        curve_point(&panel->outline[k / POINTS], (double)(k % POINTS) / POINTS,
                    x);
        size = fmax(size, fmax(fabs(x[0] - first[0]), fabs(x[1] - first[1])));
    }
    for (int k = 0; k < panel->edges; k++)
        length += curve_length(&panel->outline[k]);
    if (length > longest)
        return json_refuse(json,
                           "its outline is %.3g m long, expected %g at "
                           "most",
                           length, longest);
    if (size >= smallest && size <= largest)
        return APP_OK;
    return json_refuse(json,
                       "is %.3g m large, expected %g to %g m; is "
                       "units_in_meter %g right?",
                       size, smallest, largest, unit);
}

static int read_panels(struct json *json, json_t *node, void *out)
{
    struct pattern *pattern = out;
    const struct properties *properties = json->user;
    const char *name;
    json_t *item;
    size_t count = json_object_size(node);
    if (!json_is_object(node) || count < 1 || count > PANELS)
        return json_refuse(json, "expected an object of 1 to %d panels",
                           PANELS);
    pattern->panel = pool_take(json->pool, count, sizeof *pattern->panel);
    if (!pattern->panel)
        return complain(APP_FAILED, "out of memory");
    json_object_foreach(node, name, item)
    {
        struct pattern_panel *panel = &pattern->panel[pattern->panels++];
        size_t length = json_enter(json, ".%s", name);
        panel->name = pool_text(json->pool, name);
        if (!panel->name)
            return complain(APP_FAILED, "out of memory");
        int status =
            pattern_read_panel(json, item, panel, properties->absolute);
        if (status == APP_OK) {
            scale(panel, 1 / properties->unit);
            status = pattern_close(json, panel);
        }
        if (status == APP_OK)
            status = check_size(json, panel, properties->unit);
        if (status != APP_OK)
            return status;
        json_leave(json, length);
    }
    return APP_OK;
}

/* Moves the panel of that name to place k; the others keep their order. */
static bool move_to(struct pattern *pattern, const char *name, int k)
{
    int from = k;
    while (from < pattern->panels &&
           strcmp(pattern->panel[from].name, name) != 0)
        from++;
    if (from == pattern->panels)
        return false;
    struct pattern_panel panel = pattern->panel[from];
    for (; from > k; from--)
        pattern->panel[from] = pattern->panel[from - 1];
    pattern->panel[k] = panel;
    return true;
}

/* The order in which the file lists its panels; those that it leaves out come
 * after them. Fillers of other programs are null. */
static int read_order(struct json *json, json_t *node, void *out)
{
    struct pattern *pattern = out;
    json_t *item;
    size_t k;
    int place = 0;
    if (!json_is_array(node))
        return json_refuse(json, "expected a list of names");
    json_array_foreach(node, k, item)
    {
        size_t length = json_enter(json, "[%d]", (int)k);
        const char *name = json_string_value(item);
        if (!name && !json_is_null(item))
            return json_refuse(json, "expected the name of a panel");
        if (name && !move_to(pattern, name, place++))
            return json_refuse(json, "\"%.60s\" is no panel, or is named twice",
                               name);
        json_leave(json, length);
    }
    return APP_OK;
}

static int read_stitches(struct json *json, json_t *node, void *out)
{
    return pattern_read_stitches(json, node, out);
}

/* The panels' order comes before the stitches, which count panels. */
static int read_pattern(struct json *json, json_t *node, void *out)
{
    static const char *const needed[] = {"panels", NULL};
    static const struct json_key keys[] = {
        NESTED_KEY("panels", 0, read_panels),
        NESTED_KEY("panel_order", 0, read_order),
        NESTED_KEY("stitches", 0, read_stitches),
        {0}};
    return pattern_members(json, node, keys, out, needed);
}

static int read_properties(struct json *json, json_t *node, void *out)
{
    (void)out;
    return json_fields(json, node, property_keys, json->user);
}

int pattern_load(struct pool *pool, const char *path, struct pattern *pattern)
{
    static const char *const needed[] = {"pattern", NULL};
    static const struct json_key keys[] = {
        NESTED_KEY("properties", 0, read_properties),
        NESTED_KEY("pattern", 0, read_pattern),
        {0}};
    struct properties properties = {0};
    struct json json = {.file = path,
                        .where = "$",
                        .pool = pool,
                        .user = &properties,
                        .foreign = true};
    *pattern = (struct pattern){.file = path};
    json_t *root = json_parse(path);
    if (!root)
        return APP_USAGE;
    json_t *unit =
        json_object_get(json_object_get(root, "properties"), "units_in_meter");
    properties.unit = 100;
    bool told = unit && !json_is_null(unit);
    bool scene =
        !json_object_get(root, needed[0]) && json_object_get(root, "cloths");
    int status =
        scene ? complain(APP_USAGE,
                         "%s: is a scene, which `drape run` takes; expected a "
                         "sewing pattern of GarmentCode",
                         path)
              : pattern_members(&json, root, keys, pattern, needed);
    pattern->unit = properties.unit;
    json_decref(root);
    if (status == APP_OK && !told)
        complain(APP_OK,
                 "%s: has no units_in_meter; its lengths are taken for "
                 "centimetres",
                 path);
    return status;
}
