/* SPDX-License-Identifier: Apache-2.0 */
/* The scene of a world to which bodies are added, or from which they are
 * removed: core.h. */
#include "app/base/app.h"
#include "python/core/core.h"

#include <string.h>

/* What a scene has of the bodies of one kind: n of each. */
struct list {
    const void *body;
    size_t size; /* of one of them */
    char **name;
    struct look *look;
    int n;
};

static struct list list_of(const struct scene *scene, enum core_kind kind)
{
    const drape_def *def = &scene->def;
    if (kind == CORE_CLOTH)
        return (struct list){def->cloths, sizeof *def->cloths,
                             scene->cloth_name, scene->cloth_look,
                             def->n_cloths};
    return (struct list){def->obstacles, sizeof *def->obstacles,
                         scene->obstacle_name, scene->obstacle_look,
                         def->n_obstacles};
}

static void set_list(struct scene *scene, enum core_kind kind,
                     const struct list *list)
{
    drape_def *def = &scene->def;
    if (kind == CORE_CLOTH) {
        def->cloths = list->body;
        def->n_cloths = list->n;
        scene->cloth_name = list->name;
        scene->cloth_look = list->look;
    } else {
        def->obstacles = list->body;
        def->n_obstacles = list->n;
        scene->obstacle_name = list->name;
        scene->obstacle_look = list->look;
    }
}

/* Takes from a body the arrays of its caller, which the world has copied. */
static void forget(enum core_kind kind, void *body)
{
    if (kind == CORE_CLOTH) {
        drape_cloth *cloth = body;
        cloth->x = cloth->velocity = NULL;
        cloth->hole = cloth->cut = NULL;
        cloth->pins = NULL;
        cloth->panel = NULL;
    } else {
        drape_obstacle *obstacle = body;
        obstacle->x = obstacle->frame = NULL;
        obstacle->frame_time = NULL;
        obstacle->tri = NULL;
    }
}

/* Gives a cloth that was added a copy of where its panel is at rest. */
static bool keep_rest(struct scene *scene, const drape_panel *from,
                      drape_cloth *cloth)
{
    size_t n = (size_t)cloth->m * (size_t)cloth->n;
    drape_panel *panel = pool_take(&scene->pool, 1, sizeof *panel);
    double(*rest)[2] = pool_take(&scene->pool, n, sizeof *rest);
    if (!panel || !rest)
        return false;
    memcpy(rest, from->rest, n * sizeof *rest);
    panel->rest = (const double(*)[2])rest;
    cloth->panel = panel;
    return true;
}

/* Returns a copy of a list of n items with room for one more and a NULL. */
static void *longer(struct scene *scene, const void *list, int n, size_t size)
{
    void *to = pool_take(&scene->pool, (size_t)n + 2, size);
    if (to && n > 0)
        memcpy(to, list, (size_t)n * size);
    return to;
}

int core_add(struct scene *scene, enum core_kind kind, const void *body,
             const struct scene *from)
{
    struct list old = list_of(scene, kind), new = old;
    struct list last = from ? list_of(from, kind) : (struct list){0};
    char *all = longer(scene, old.body, old.n, old.size);
    new.name = longer(scene, old.name, old.n, sizeof *new.name);
    new.look = longer(scene, old.look, old.n, sizeof *new.look);
    const char *called = kind == CORE_CLOTH ? "cloth" : "obstacle";
    char *name = pool_text(&scene->pool, from ? last.name[last.n - 1] : called);
    if (!all || !new.name || !new.look || !name)
        return complain(APP_FAILED, "out of memory");
    char *added = all + (size_t)old.n * old.size;
    memcpy(added, body, old.size);
    forget(kind, added);
    const drape_panel *panel =
        kind == CORE_CLOTH ? ((const drape_cloth *)body)->panel : NULL;
    if (panel && !keep_rest(scene, panel, (drape_cloth *)added))
        return complain(APP_FAILED, "out of memory");
    new.body = all;
    new.name[old.n] = name;
    new.look[old.n] = from ? last.look[last.n - 1] : look_default();
    new.n++;
    set_list(scene, kind, &new);
    return APP_OK;
}

static void drop(void *list, int n, int k, size_t size)
{
    char *at = (char *)list + (size_t)k * size;
    memmove(at, at + size, (size_t)(n - k - 1) * size);
}

/* Takes the seams of cloth k away; those of cloths behind it follow them. */
static void drop_seams(struct scene *scene, int k)
{
    drape_def *def = &scene->def;
    drape_seam *seam = (drape_seam *)def->seams;
    int n = 0;
    for (int i = 0; i < def->n_seams; i++) {
        if (seam[i].cloth[0] == k || seam[i].cloth[1] == k)
            continue;
        scene->seam[n] = scene->seam[i];
        seam[n] = seam[i];
        for (int j = 0; j < 2; j++)
            seam[n].cloth[j] -= seam[n].cloth[j] > k;
        n++;
    }
    def->n_seams = n;
}

void core_remove(struct scene *scene, int body)
{
    int cloths = scene->def.n_cloths;
    enum core_kind kind = body < cloths ? CORE_CLOTH : CORE_OBSTACLE;
    int k = body < cloths ? body : body - cloths;
    struct list list = list_of(scene, kind);
    drop((void *)list.body, list.n, k, list.size);
    drop(list.name, list.n, k, sizeof *list.name);
    drop(list.look, list.n, k, sizeof *list.look);
    list.name[--list.n] = NULL;
    if (kind == CORE_CLOTH)
        drop_seams(scene, k);
    set_list(scene, kind, &list);
}
