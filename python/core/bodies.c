/* SPDX-License-Identifier: Apache-2.0 */
/* The scene of a world to which bodies are added, or from which they are
 * removed: core.h. */
#include "app/app.h"
#include "python/core/core.h"

#include <string.h>

/* Returns a copy of a list of n items with room for one more and a NULL. */
static void *longer(struct scene *scene, const void *list, int n, size_t size)
{
    void *to = pool_take(&scene->pool, (size_t)n + 2, size);
    if (to && n > 0)
        memcpy(to, list, (size_t)n * size);
    return to;
}

/* Puts a name and a look behind n others: those of `from`, or else the kind's.
 */
static bool label(struct scene *scene, char ***names, struct look **looks,
                  int n, const char *name, const struct look *look)
{
    char **all = longer(scene, *names, n, sizeof *all);
    struct look *look_of = longer(scene, *looks, n, sizeof *look_of);
    char *copy = pool_text(&scene->pool, name);
    if (!all || !look_of || !copy)
        return false;
    all[n] = copy;
    look_of[n] = look ? *look : look_default();
    *names = all;
    *looks = look_of;
    return true;
}

int core_add_cloth(struct scene *scene, const drape_cloth *cloth,
                   const struct scene *from)
{
    drape_def *def = &scene->def;
    int n = def->n_cloths, last = from ? from->def.n_cloths - 1 : 0;
    drape_cloth *all = longer(scene, def->cloths, n, sizeof *all);
    if (!all || !label(scene, &scene->cloth_name, &scene->cloth_look, n,
                       from ? from->cloth_name[last] : "cloth",
                       from ? &from->cloth_look[last] : NULL))
        return complain(APP_FAILED, "out of memory");
    all[n] = *cloth; /* the world has copied what it points to */
    all[n].x = all[n].velocity = NULL;
    all[n].hole = all[n].cut = NULL;
    all[n].pins = NULL;
    def->cloths = all;
    def->n_cloths++;
    return APP_OK;
}

int core_add_obstacle(struct scene *scene, const drape_obstacle *obstacle,
                      const struct scene *from)
{
    drape_def *def = &scene->def;
    int n = def->n_obstacles, last = from ? from->def.n_obstacles - 1 : 0;
    drape_obstacle *all = longer(scene, def->obstacles, n, sizeof *all);
    if (!all || !label(scene, &scene->obstacle_name, &scene->obstacle_look, n,
                       from ? from->obstacle_name[last] : "obstacle",
                       from ? &from->obstacle_look[last] : NULL))
        return complain(APP_FAILED, "out of memory");
    all[n] = *obstacle;
    all[n].x = all[n].frame = NULL;
    all[n].tri = NULL;
    def->obstacles = all;
    def->n_obstacles++;
    return APP_OK;
}

static void drop(void *list, int n, int k, size_t size)
{
    char *at = (char *)list + (size_t)k * size;
    memmove(at, at + size, (size_t)(n - k - 1) * size);
}

void core_remove(struct scene *scene, int body)
{
    drape_def *def = &scene->def;
    int n = def->n_cloths, o = body - n, m = def->n_obstacles;
    if (o < 0) {
        drop((void *)def->cloths, n, body, sizeof *def->cloths);
        drop(scene->cloth_name, n, body, sizeof *scene->cloth_name);
        drop(scene->cloth_look, n, body, sizeof *scene->cloth_look);
        scene->cloth_name[n - 1] = NULL;
        def->n_cloths--;
    } else {
        drop((void *)def->obstacles, m, o, sizeof *def->obstacles);
        drop(scene->obstacle_name, m, o, sizeof *scene->obstacle_name);
        drop(scene->obstacle_look, m, o, sizeof *scene->obstacle_look);
        scene->obstacle_name[m - 1] = NULL;
        def->n_obstacles--;
    }
}
