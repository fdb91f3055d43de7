/* SPDX-License-Identifier: Apache-2.0 */
/* A cloth that is a panel of a sewing pattern: reads its key, cuts it, and
 * places it. app/patterns/README.md */
#include "app/base/app.h"
#include "app/base/file.h"
#include "app/scene/bodies.h"
#include "app/scene/cloth.h"
#include "app/scene/garment.h"

#include <string.h>

struct panel_key {
    char *pattern, *name;
    double cell;
};

int find_beside(struct json *json, const char *what, const char *name,
                char path[FILE_PATH])
{
    const struct scene *scene = json->user;
    char folder[FILE_PATH];
    if (!name)
        return json_refuse(json, "expected %s", what);
    strcpy(folder, scene->file);
    char *slash = strrchr(folder, '/');
    strcpy(slash ? slash + (slash == folder) : folder, slash ? "" : ".");
    bool good = name[0] == '/'
                    ? snprintf(path, FILE_PATH, "%s", name) < FILE_PATH
                    : file_join(path, folder, name);
    if (!good || !file_exists(path))
        return json_refuse(json, "%s %s: no such file", what, name);
    return APP_OK;
}

/* The panel of this name; a pattern of one needs none. */
static int find_panel(struct json *json, const struct pattern *pattern,
                      const char *name, struct pattern_panel **panel)
{
    for (int k = 0; k < pattern->panels; k++)
        if (name ? !strcmp(pattern->panel[k].name, name)
                 : pattern->panels == 1) {
            *panel = &pattern->panel[k];
            return APP_OK;
        }
    return name ? json_refuse(json, "name: %s has no panel %s", pattern->file,
                              name)
                : json_refuse(json, "expected name, as %s has %d panels",
                              pattern->file, pattern->panels);
}

/* The file's numbers of the edges that a particle is on: two at a corner. */
static void find_edges(const struct garment_panel *p, struct cloth_panel *to)
{
    const struct cut *cut = &p->cut;
    for (int64_t k = 0; k < (int64_t)cut->m * cut->n; k++) {
        int on = cut->kind[k] == CUT_BORDER && cut->chord[k] >= 0
                     ? p->number[p->outline.of[cut->chord[k]]]
                     : -1;
        to->edge[k][0] = to->edge[k][1] = on;
    }
    for (int k = 0; k < p->edges; k++) {
        int32_t *at = to->edge[cut->corner[k]];
        at[0] = p->number[k];
        at[1] = p->number[(k + p->edges - 1) % p->edges];
    }
}

int panel_keep(struct pool *pool, const struct garment_panel *p,
               struct cloth *cloth)
{
    const struct cut *cut = &p->cut;
    size_t n = (size_t)cut->m * (size_t)cut->n;
    size_t cells = (size_t)(cut->m - 1) * (size_t)(cut->n - 1);
    double(*rest)[2] = pool_take(pool, n, sizeof *rest);
    double(*x)[3] = pool_take(pool, n, sizeof *x);
    uint8_t *cell = pool_take(pool, cells, 1);
    struct cloth_panel *to = pool_take(pool, 1, sizeof *to);
    if (to) {
        to->there = pool_take(pool, n, 1);
        to->edge = pool_take(pool, n, sizeof *to->edge);
    }
    if (!rest || !x || !cell || !to || !to->there || !to->edge)
        return complain(APP_FAILED, "out of memory");
    memcpy(cell, cut->cell, cells);
    for (size_t k = 0; k < n; k++) {
        for (int i = 0; i < 2; i++)
            rest[k][i] = cut->x[k][i] - cut->at[i];
        garment_stand(p, cut->x[k], x[k]);
    }
    for (size_t k = 0; k < cells; k++) {
        int32_t at[4];
        int corners = cut_corners(cut, (int64_t)k, at);
        for (int i = 0; i < corners; i++)
            to->there[at[i]] = 1;
    }
    find_edges(p, to);
    to->panel = (drape_panel){.rest = (const double(*)[2])rest, .cell = cell};
    to->cell = cell;
    to->placed = (const double(*)[3])x;
    memcpy(to->at, cut->at, sizeof to->at);
    to->edges = p->panel->edges;
    cloth->panel = to;
    cloth->particles[0] = cut->m;
    cloth->particles[1] = cut->n;
    cloth->size[0] = cut->h * (cut->m - 1);
    cloth->size[1] = cut->h * (cut->n - 1);
    return APP_OK;
}

/* Finds the cells that have two particles next to each other around them.
 * Returns how many there are. */
static int find_cells(const struct cut *cut, const int32_t end[2],
                      int64_t found[2])
{
    int i = end[0] % cut->m, j = end[0] / cut->m, n = 0;
    for (int k = 0; k < 4; k++) {
        int a = i - k % 2, b = j - k / 2;
        int64_t cell = a + (int64_t)(cut->m - 1) * b;
        int32_t at[4];
        if (a < 0 || b < 0 || a > cut->m - 2 || b > cut->n - 2)
            continue;
        int corners = cut_corners(cut, cell, at);
        for (int c = 0; c < corners; c++) {
            int32_t next = at[(c + 1) % corners];
            if ((at[c] == end[0] && next == end[1]) ||
                (at[c] == end[1] && next == end[0]))
                found[n++] = cell;
        }
    }
    return n;
}

/* Whether a cell has no corner that points inwards, as its edges must not cross
 * when they are shortened. */
static bool is_convex(const struct cut *cut, int64_t cell)
{
    int32_t at[4];
    int corners = cut_corners(cut, cell, at);
    bool convex = true;
    for (int k = 0; k < corners; k++)
        convex &= cut_part(cut, (const int32_t[]){at[k], at[(k + 1) % corners],
                                                  at[(k + 2) % corners]}) > 0;
    return convex;
}

int panel_ease(struct pool *pool, const struct cut *cut,
               const struct cut_seam *seam, struct cloth_panel *panel)
{
    int n = panel->panel.n_eases;
    drape_ease *to = pool_take(pool, (size_t)(n + seam->eases) + 1, sizeof *to);
    if (!to)
        return no_memory();
    if (n)
        memcpy(to, panel->panel.eases, (size_t)n * sizeof *to);
    for (int k = 0; k < seam->eases; k++) {
        const struct cut_ease *e = &seam->ease[k];
        int64_t cell[2];
        int cells = find_cells(cut, e->end, cell);
        bool convex = cells > 0; /* else the border goes round another way */
        for (int c = 0; c < cells; c++)
            convex = convex && is_convex(cut, cell[c]);
        if (!convex)
            continue;
        for (int c = 0; c < cells; c++)
            if (cut->cell[cell[c]] == CUT_REGULAR)
                panel->cell[cell[c]] = CUT_RISING;
        to[n++] = (drape_ease){{e->end[0], e->end[1]}, e->ratio};
    }
    panel->panel.eases = to;
    panel->panel.n_eases = n;
    return APP_OK;
}

int read_panel(struct json *json, json_t *node, void *out)
{
    static const struct json_key keys[] = {
        TEXT_KEY("pattern", offsetof(struct panel_key, pattern)),
        TEXT_KEY("name", offsetof(struct panel_key, name)),
        NUMBER_KEY("cell", offsetof(struct panel_key, cell), 1e-4, 0.1),
        {0}};
    struct panel_key key = {.cell = 0.005};
    struct pattern pattern;
    struct garment garment = {0};
    struct pattern_panel *panel = NULL;
    char path[FILE_PATH];
    int status = json_fields(json, node, keys, &key);
    if (status == APP_OK)
        status = find_beside(json, "pattern", key.pattern, path);
    if (status == APP_OK)
        status = pattern_load(json->pool, path, &pattern);
    if (status != APP_OK)
        return status;
    status = find_panel(json, &pattern, key.name, &panel);
    if (status != APP_OK)
        return status;
    struct pattern one = pattern;
    one.panels = 1;
    one.panel = panel;
    one.stitches = 0;
    status = garment_cut(&garment, &one, key.cell);
    if (status == APP_OK)
        status = panel_keep(json->pool, &garment.panel[0], out);
    garment_free(&garment);
    return status;
}
