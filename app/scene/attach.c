/* SPDX-License-Identifier: Apache-2.0 */
/* Attachments of a garment: reads which labels of its pattern hold it, and
 * finds the particles of the edges that have them. app/patterns/README.md §14
 */
#include "app/base/app.h"
#include "app/base/nearest.h"
#include "app/scene/cloth.h"
#include "app/scene/garment.h"
#include "app/scene/scene.h"

#include <math.h>
#include <string.h>

/* N/m, of what is soft: many times what a garment weighs, and light cotton
 * strains by 3 %. */
static const double soft = 30;
/* What GarmentCode calls the upper edge of skirts and trousers. */
static char waist[] = "lower_interface";

static const char *const places[] = {"body", "world", NULL};
static const char *const holds[] = {"soft", "hard", NULL};

static int read_one(struct json *json, json_t *node, void *out)
{
#define ATTACH(name) offsetof(struct attach_key, name)
    static const struct json_key keys[] = {
        TEXT_KEY("label", ATTACH(label)),
        CHOICE_KEY("to", ATTACH(world), places),
        CHOICE_KEY("hold", ATTACH(hard), holds),
        NUMBER_KEY("strength", ATTACH(strength), 1e-3, 1e6),
        NUMBER_KEY("until", ATTACH(until), 0, 1e6),
        {0}};
    static const char *const strength[] = {"strength", NULL};
    struct attach_key *key = out;
    *key = (struct attach_key){.strength = soft, .until = INFINITY};
    int status = json_fields(json, node, keys, key);
    if (status != APP_OK)
        return status;
    if (!key->label)
        return json_refuse(json, "expected label, of edges of the pattern");
    if (key->hard)
        json_idle(json, node, strength, "what is hard holds whatever pulls");
    return APP_OK;
}

int read_attach(struct json *json, json_t *node, void *out)
{
    struct attach_list *to = out;
    struct json_list list = {
        .read = read_one, .size = sizeof *to->key, .most = 100};
    int status = json_items(json, node, &list);
    to->key = list.items;
    to->count = list.count;
    to->given = true;
    return status;
}

/* Whether an edge of a panel is held by the key. Of itself a garment is held
 * where nothing is sewn to its waist. */
static bool is_held(const struct pattern_panel *panel, int edge,
                    const struct attach_key *key, bool given)
{
    const struct pattern_edge *e = edge < 0 ? NULL : &panel->edge[edge];
    return e && e->label && !strcmp(e->label, key->label) &&
           (given || e->stitch < 0);
}

/* Refuses a label that no edge has. */
static int check_label(struct json *json, const struct pattern *pattern,
                       const struct attach_key *key)
{
    struct nearest nearest = {.word = key->label};
    const char *other = NULL;
    for (int p = 0; p < pattern->panels; p++)
        for (int e = 0; e < pattern->panel[p].edges; e++) {
            const char *label = pattern->panel[p].edge[e].label;
            if (label && !strcmp(label, key->label))
                return APP_OK;
            if (label)
                nearest_try(&nearest, label);
            other = label ? label : other;
        }
    if (nearest.name)
        return json_refuse(json,
                           "attach: no edge of %s has the label \"%.60s\"; did "
                           "you mean \"%.60s\"?",
                           pattern->file, key->label, nearest.name);
    if (other)
        return json_refuse(json,
                           "attach: no edge of %s has the label \"%.60s\"; "
                           "one has \"%.60s\"",
                           pattern->file, key->label, other);
    return json_refuse(json,
                       "attach: no edge of %s has the label \"%.60s\", nor "
                       "any other",
                       pattern->file, key->label);
}

int attach_check(struct json *json, const struct pattern *pattern,
                 const struct attach_list *list)
{
    int status = APP_OK;
    for (int k = 0; k < list->count && status == APP_OK; k++)
        status = check_label(json, pattern, &list->key[k]);
    return status;
}

/* Takes out the particles that are sewn to a place between others that are
 * held: both would ask for the gap to be another one. */
static void free_sewn(struct garment_key *garment, uint8_t **held)
{
    for (int k = 0; k < garment->seams; k++) {
        const drape_seam *seam = &garment->seam[k];
        const uint8_t *place = held[seam->cloth[1]];
        for (int64_t p = 0; p < seam->n; p++)
            if (place[seam->onto[p][0]] && place[seam->onto[p][1]])
                held[seam->cloth[0]][seam->particle[p]] = 0;
    }
}

/* Makes a row of the particles of a panel that are held as key number `mark` -
 * 1 says. Of those that follow each other no two are neighbours on the grid, as
 * contact passes over what lies along a seam (spec/seam/seam.md §5). */
static int keep_row(struct json *json, struct garment_key *garment, int k,
                    const uint8_t *held, int mark)
{
    const struct cloth *cloth = &garment->cloth[k];
    const struct attach_key *key = &garment->attach.key[mark - 1];
    struct scene_attach *row = &garment->held[garment->helds];
    int m = cloth->out.m, n = cloth->out.n;
    for (int64_t p = 0; p < (int64_t)m * n; p++)
        row->n += held[p] == mark;
    if (!row->n)
        return APP_OK;
    char text[320];
    snprintf(text, sizeof text, "%s %s", cloth->name, key->label);
    row->name = pool_text(json->pool, text);
    row->particle =
        pool_take(json->pool, (size_t)row->n, sizeof *row->particle);
    if (!row->name || !row->particle)
        return no_memory();
    int64_t at = 0;
    for (int turn = 0; turn < 4; turn++)
        for (int j = turn / 2; j < n; j += 2)
            for (int i = turn % 2; i < m; i += 2)
                if (held[i + (int64_t)m * j] == mark)
                    row->particle[at++] = i + m * j;
    row->cloth = k;
    row->world = key->world;
    row->strength = key->hard ? 0 : key->strength;
    row->until = key->until;
    garment->helds++;
    return APP_OK;
}

/* Marks the particles of panel k on edges of the label. Returns the length of
 * these, m. */
static double mark_edges(const struct garment *garment, int k,
                         const struct attach_list *list, int mark,
                         const struct cloth_panel *cut, uint8_t *held)
{
    const struct pattern_panel *panel = &garment->pattern->panel[k];
    const struct attach_key *key = &list->key[mark - 1];
    int64_t count = (int64_t)garment->panel[k].cut.m * garment->panel[k].cut.n;
    double length = 0;
    for (int e = 0; e < panel->edges; e++)
        if (is_held(panel, e, key, list->given))
            length += curve_length(&panel->edge[e].curve);
    for (int64_t p = 0; p < count; p++)
        if (cut->there[p] && !held[p] &&
            (is_held(panel, cut->edge[p][0], key, list->given) ||
             is_held(panel, cut->edge[p][1], key, list->given)))
            held[p] = (uint8_t)mark;
    return length;
}

int attach_garment(struct json *json, const struct garment *garment,
                   struct garment_key *key)
{
    struct attach_list *list = &key->attach;
    if (!list->given) {
        list->key = pool_take(json->pool, 1, sizeof *list->key);
        if (!list->key)
            return no_memory();
        *list->key = (struct attach_key){
            .label = waist, .strength = soft, .until = INFINITY};
        list->count = 1;
    }
    int panels = garment->pattern->panels;
    size_t rows = (size_t)panels * (size_t)list->count;
    uint8_t **held = pool_take(json->pool, (size_t)panels, sizeof *held);
    double *length = pool_take(json->pool, rows + 1, sizeof *length);
    key->held = pool_take(json->pool, rows + 1, sizeof *key->held);
    if (!held || !length || !key->held)
        return no_memory();
    for (int k = 0; k < panels; k++) {
        const struct cut *cut = &garment->panel[k].cut;
        held[k] = pool_take(json->pool, (size_t)cut->m * (size_t)cut->n, 1);
        if (!held[k])
            return no_memory();
    }
    for (int a = 0; a < list->count; a++)
        for (int k = 0; k < panels; k++)
            length[a * panels + k] = mark_edges(garment, k, list, a + 1,
                                                key->cloth[k].panel, held[k]);
    free_sewn(key, held);
    for (int a = 0; a < list->count; a++)
        for (int k = 0; k < panels; k++) {
            int before = key->helds;
            int status = keep_row(json, key, k, held[k], a + 1);
            if (status != APP_OK)
                return status;
            if (key->helds > before)
                key->held[before].spacing =
                    length[a * panels + k] / (double)key->held[before].n;
        }
    return APP_OK;
}
