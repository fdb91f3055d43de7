/* SPDX-License-Identifier: Apache-2.0 */
/* Reads the garments of a scene: cuts their patterns, and adds their panels and
 * seams to the definition. */
#include "app/base/app.h"
#include "app/base/file.h"
#include "app/scene/bodies.h"
#include "app/scene/cloth.h"
#include "app/scene/garment.h"

#include <stdlib.h>
#include <string.h>

/* The name of a cloth: the panel's, behind the garment's if it has one. */
static char *name_panel(struct json *json, const struct garment_key *key,
                        const char *panel)
{
    char text[256];
    snprintf(text, sizeof text, "%.120s%s%.120s", key->name ? key->name : "",
             key->name ? "." : "", panel);
    return pool_text(json->pool, text);
}

/* Makes the panels cloths, where the pattern places them. */
static int make_cloths(struct json *json, const struct garment *garment,
                       struct garment_key *key)
{
    struct scene *scene = json->user;
    key->cloths = garment->pattern->panels;
    key->cloth = pool_take(json->pool, (size_t)key->cloths, sizeof *key->cloth);
    if (!key->cloth)
        return no_memory();
    for (int k = 0; k < key->cloths; k++) {
        struct cloth *cloth = &key->cloth[k];
        drape_cloth *c = &cloth->out;
        drape_default_cloth(c);
        int status = panel_keep(json->pool, &garment->panel[k], cloth);
        if (status != APP_OK)
            return status;
        c->m = (int)cloth->particles[0];
        c->n = (int)cloth->particles[1];
        c->width = cloth->size[0];
        c->height = cloth->size[1];
        c->material = key->material;
        c->panel = &cloth->panel->panel;
        double(*x)[3] =
            pool_take(json->pool, (size_t)c->m * (size_t)c->n, sizeof *x);
        cloth->name = name_panel(json, key, garment->pattern->panel[k].name);
        if (!x || !cloth->name)
            return no_memory();
        for (int64_t p = 0; p < (int64_t)c->m * c->n; p++)
            for (int i = 0; i < 3; i++)
                x[p][i] = cloth->panel->placed[p][i] + key->at[i];
        c->x = (const double(*)[3])x;
        cloth->look = key->look;
        scene->particles += (double)c->m * c->n;
        if (scene->particles * PARTICLE_BYTES > scene->memory * 1e9)
            return json_refuse(json,
                               "%.0f particles so far need more than the "
                               "memory limit of %.3g GB",
                               scene->particles, scene->memory);
    }
    return APP_OK;
}

/* Copies a seam's points to the pool. */
static int keep_seam(struct json *json, const struct pattern_stitch *stitch,
                     const struct cut_seam *from, drape_seam *seam,
                     struct scene_seam *about)
{
    size_t n = (size_t)from->n;
    int32_t *particle = pool_take(json->pool, n, sizeof *particle);
    int32_t(*onto)[2] = pool_take(json->pool, n, sizeof *onto);
    double *part = pool_take(json->pool, n, sizeof *part);
    double *length = pool_take(json->pool, n, sizeof *length);
    if (!particle || !onto || !part || !length)
        return no_memory();
    for (size_t k = 0; k < n; k++) {
        particle[k] = from->point[k].particle;
        onto[k][0] = from->point[k].onto[0];
        onto[k][1] = from->point[k].onto[1];
        part[k] = from->point[k].part;
        length[k] = from->point[k].length;
    }
    *seam = (drape_seam){.cloth = {stitch->side[from->fine].panel,
                                   stitch->side[!from->fine].panel},
                         .n = from->n,
                         .particle = particle,
                         .onto = (const int32_t(*)[2])onto,
                         .part = part};
    about->length = length;
    return APP_OK;
}

/* Makes a seam of each stitch that has points. */
static int make_seams(struct json *json, const struct garment *garment,
                      struct garment_key *key)
{
    const struct pattern *pattern = garment->pattern;
    size_t room = (size_t)pattern->stitches + 1;
    key->seam = pool_take(json->pool, room, sizeof *key->seam);
    key->about = pool_take(json->pool, room, sizeof *key->about);
    bool *across = pool_take(json->pool, room, sizeof *across);
    if (!key->seam || !key->about || !across)
        return no_memory();
    int status = garment_across(garment, across);
    for (int k = 0; k < pattern->stitches && status == APP_OK; k++) {
        const struct pattern_stitch *stitch = &pattern->stitch[k];
        const struct pattern_side *a = stitch->side, *b = a + 1;
        struct scene_seam *about = &key->about[key->seams];
        struct cut_seam seam;
        char text[320];
        status = garment_seam(garment, stitch, &seam);
        snprintf(text, sizeof text, "%s %d to %s %d", key->cloth[a->panel].name,
                 a->edge, key->cloth[b->panel].name, b->edge);
        if (status == APP_OK && seam.n) {
            about->name = pool_text(json->pool, text);
            /* what is sewn from the start has no order */
            about->dart = !key->sewn && garment_is_dart(pattern, stitch);
            about->across = !key->sewn && across[k];
            about->around =
                !key->sewn && garment_is_around(garment, stitch, &seam);
            about->cell = garment->h;
            int longer = stitch->side[seam.longer].panel;
            status = panel_ease(json->pool, &garment->panel[longer].cut, &seam,
                                key->cloth[longer].panel);
        }
        if (status == APP_OK && seam.n) {
            status = about->name ? keep_seam(json, stitch, &seam,
                                             &key->seam[key->seams++], about)
                                 : no_memory();
        }
        cut_seam_free(&seam);
    }
    return status;
}

/* Puts the panels where a mesh has them that `drape sew` has written. */
static int put_on(struct json *json, struct garment_key *key)
{
    char path[FILE_PATH];
    struct mesh mesh = {0};
    int64_t at = 0, count = 0;
    int status = find_beside(json, "sewn", key->sewn, path);
    if (status == APP_OK)
        status = ply_load(json->pool, path, &mesh);
    for (int k = 0; k < key->cloths; k++)
        count += (int64_t)key->cloth[k].out.m * key->cloth[k].out.n;
    if (status == APP_OK && mesh.nv != count)
        status = json_refuse(json,
                             "sewn %s: it has %lld vertices, and the panels "
                             "have %lld particles: it is of another pattern "
                             "or cell",
                             key->sewn, (long long)mesh.nv, (long long)count);
    for (int k = 0; k < key->cloths && status == APP_OK; k++) {
        drape_cloth *c = &key->cloth[k].out;
        c->x = (const double(*)[3])(mesh.x + at);
        at += (int64_t)c->m * c->n;
    }
    return status;
}

static int make_garment(struct json *json, struct garment_key *key)
{
    char path[FILE_PATH];
    struct pattern *pattern = pool_take(json->pool, 1, sizeof *pattern);
    struct garment garment = {.pattern = pattern};
    if (!pattern)
        return no_memory();
    int status = find_beside(json, "pattern", key->pattern, path);
    if (status == APP_OK)
        status = pattern_load(json->pool, path, pattern);
    if (status == APP_OK)
        status = attach_check(json, pattern, &key->attach);
    if (status != APP_OK)
        return status;
    /* messages name the file for as long as the scene lives */
    pattern->file = pool_text(json->pool, path);
    status =
        pattern->file ? garment_cut(&garment, pattern, key->cell) : no_memory();
    if (status == APP_OK && !key->sewn) {
        garment_roll_up(&garment);
        garment_part(&garment);
    }
    if (status == APP_OK)
        status = make_cloths(json, &garment, key);
    if (status == APP_OK)
        status = make_seams(json, &garment, key);
    if (status == APP_OK)
        status = attach_garment(json, &garment, key);
    if (status == APP_OK && key->sewn)
        status = put_on(json, key);
    struct scene *scene = json->user;
    scene->unsewn |= !key->sewn && key->seams > 0;
    garment_free(&garment);
    return status;
}

static int read_garment(struct json *json, json_t *node, void *out)
{
#define GARMENT(name) offsetof(struct garment_key, name)
    static const struct json_key keys[] = {
        TEXT_KEY("pattern", GARMENT(pattern)),
        TEXT_KEY("name", GARMENT(name)),
        NUMBER_KEY("cell", GARMENT(cell), 1e-4, 0.1),
        NESTED_KEY("material", GARMENT(material), read_material),
        VECTOR_KEY("at", GARMENT(at), -1e6, 1e6, 3),
        TEXT_KEY("sewn", GARMENT(sewn)),
        NESTED_KEY("attach", GARMENT(attach), read_attach),
        NESTED_KEY("look", GARMENT(look), read_look),
        {0}};
    static const char *const at[] = {"at", NULL};
    struct garment_key *key = out;
    drape_cloth cloth;
    drape_default_cloth(&cloth);
    key->material = cloth.material;
    key->look = look_default();
    key->cell = 0.005;
    int status = json_fields(json, node, keys, key);
    if (status == APP_OK && key->sewn)
        json_idle(json, node, at, "the sewn mesh has its place");
    return status == APP_OK ? make_garment(json, key) : status;
}

/* Returns `count` items with room for `more` behind them. */
static void *grow(struct pool *pool, const void *from, int count, int more,
                  size_t size)
{
    char *to = pool_take(pool, (size_t)(count + more) + 1, size);
    if (to && count)
        memcpy(to, from, (size_t)count * size);
    return to;
}

/* Adds the cloths of a garment to the scene. */
static int add_cloths(struct pool *pool, struct scene *scene,
                      const struct garment_key *key)
{
    int n = scene->def.n_cloths, more = key->cloths;
    drape_cloth *to = grow(pool, scene->def.cloths, n, more, sizeof *to);
    char **name = grow(pool, scene->cloth_name, n, more, sizeof *name);
    struct look *look = grow(pool, scene->cloth_look, n, more, sizeof *look);
    int **pins = grow(pool, scene->pin_from, n, more, sizeof *pins);
    if (!to || !name || !look || !pins)
        return no_memory();
    for (int k = 0; k < more; k++) {
        to[n + k] = key->cloth[k].out;
        name[n + k] = key->cloth[k].name;
        look[n + k] = key->cloth[k].look;
    }
    scene->def.cloths = to;
    scene->def.n_cloths = n + more;
    scene->cloth_name = name;
    scene->cloth_look = look;
    scene->pin_from = pins;
    return APP_OK;
}

/* Adds the seams of a garment whose first cloth is `first`. */
static int add_seams(struct pool *pool, struct scene *scene,
                     const struct garment_key *key, int first)
{
    int n = scene->def.n_seams, more = key->seams;
    drape_seam *to = grow(pool, scene->def.seams, n, more, sizeof *to);
    struct scene_seam *about = grow(pool, scene->seam, n, more, sizeof *about);
    if (!to || !about)
        return no_memory();
    for (int k = 0; k < more; k++) {
        to[n + k] = key->seam[k];
        to[n + k].cloth[0] += first;
        to[n + k].cloth[1] += first;
        about[n + k] = key->about[k];
    }
    scene->def.seams = to;
    scene->def.n_seams = n + more;
    scene->seam = about;
    return APP_OK;
}

/* Adds what of a garment is held, whose first cloth is `first`. */
static int add_attaches(struct pool *pool, struct scene *scene,
                        const struct garment_key *key, int first)
{
    int n = scene->attaches, more = key->helds;
    struct scene_attach *to = grow(pool, scene->attach, n, more, sizeof *to);
    if (!to)
        return no_memory();
    for (int k = 0; k < more; k++) {
        to[n + k] = key->held[k];
        to[n + k].cloth += first;
    }
    scene->attach = to;
    scene->attaches = n + more;
    return APP_OK;
}

int read_garments(struct json *json, json_t *node, void *out)
{
    struct scene *scene = out;
    struct json_list list = {
        .read = read_garment, .size = sizeof(struct garment_key), .most = 100};
    int status = json_items(json, node, &list);
    const struct garment_key *key = list.items;
    if (status != APP_OK)
        return status;
    scene->garment_cloth =
        pool_take(json->pool, (size_t)list.count + 1, sizeof(int));
    scene->garment_sewn = pool_take(json->pool, (size_t)list.count + 1, 1);
    if (!scene->garment_cloth || !scene->garment_sewn)
        return no_memory();
    for (int k = 0; k < list.count && status == APP_OK; k++) {
        int first = scene->def.n_cloths;
        scene->garment_cloth[k] = first;
        scene->garment_sewn[k] = key[k].sewn;
        status = add_cloths(json->pool, scene, &key[k]);
        if (status == APP_OK)
            status = add_seams(json->pool, scene, &key[k], first);
        if (status == APP_OK)
            status = add_attaches(json->pool, scene, &key[k], first);
        scene->garment_cloth[++scene->garments] = scene->def.n_cloths;
    }
    return status;
}
