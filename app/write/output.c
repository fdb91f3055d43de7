/* SPDX-License-Identifier: Apache-2.0 */
/* The frames and the point cache of a run. */
#include "app/write/output.h"
#include "app/base/app.h"
#include "app/write/contacts.h"

#include <stdlib.h>
#include <string.h>

/* Names the bodies of the views. */
static int make_parts(struct output *o, const struct scene *scene,
                      const drape_world *world)
{
    int cloths = scene->def.n_cloths - scene->hidden;
    int bodies = cloths + scene->def.n_obstacles;
    struct part *part = pool_take(&o->pool, (size_t)bodies + 1, sizeof *part);
    o->made = scene->def.cloths;
    o->stretch = pool_take(&o->pool, (size_t)cloths + 1, sizeof *o->stretch);
    if (!part || !o->stretch)
        return complain(APP_FAILED, "out of memory");
    for (int k = 0; k < bodies; k++) {
        int body = k < cloths ? k : k + scene->hidden;
        part[k].nv = drape_first_vertex(world, body + 1) -
                     drape_first_vertex(world, body);
        part[k].nt = drape_first_triangle(world, body + 1) -
                     drape_first_triangle(world, body);
        if (k < cloths) {
            part[k].name = scene->cloth_name[k];
            const drape_cloth *cloth = &scene->def.cloths[k];
            part[k].m = cloth->m;
            part[k].n = cloth->n;
            part[k].rest = cloth->panel ? cloth->panel->rest : NULL;
            part[k].size[0] = cloth->width;
            part[k].size[1] = cloth->height;
        } else {
            part[k].name = scene->obstacle_name[k - cloths];
        }
    }
    o->cloth_part = part;
    o->obstacle_part = part + cloths;
    o->cloths = cloths;
    o->n_obstacles = bodies - cloths;
    return APP_OK;
}

/* Makes cloth and obstacles separate meshes that share the scene's memory. */
static int make_views(struct output *o, const struct scene *scene,
                      const drape_world *world)
{
    int cloths = scene->def.n_cloths;
    struct mesh *all = &o->all;
    all->nv = drape_vertices(world);
    all->nt = drape_triangles(world);
    all->x = pool_take(&o->pool, (size_t)all->nv + 1, sizeof *all->x);
    all->tri = pool_take(&o->pool, (size_t)all->nt + 1, sizeof *all->tri);
    o->v = pool_take(&o->pool, (size_t)all->nv + 1, sizeof *o->v);
    if (!all->x || !all->tri || !o->v)
        return complain(APP_FAILED, "out of memory");
    if (drape_read_triangles(world, all->tri) != DRAPE_OK)
        return complain(APP_FAILED, "the triangles cannot be read");
    int64_t nv = drape_first_vertex(world, cloths);
    int64_t nt = drape_first_triangle(world, cloths);
    o->cloth = (struct mesh){
        drape_first_vertex(world, cloths - scene->hidden),
        drape_first_triangle(world, cloths - scene->hidden), all->x, all->tri};
    o->obstacles =
        (struct mesh){all->nv - nv, all->nt - nt, all->x + nv, all->tri + nt};
    for (int64_t k = 0; k < o->obstacles.nt; k++)
        for (int i = 0; i < 3; i++)
            o->obstacles.tri[k][i] -= (int32_t)nv;
    return make_parts(o, scene, world);
}

bool output_name(char path[FILE_PATH], const struct scene *scene,
                 const char *given)
{
    int length = given ? snprintf(path, FILE_PATH, "%s", given)
                       : snprintf(path, FILE_PATH, "%s.out", scene->name);
    for (char *p = path; *p && !given; p++)
        *p = *p == '/' || (unsigned char)*p < 32 || *p == 127 ? '_' : *p;
    /* file names are appended to the path */
    if (length > 0 && length < FILE_PATH - 100)
        return true;
    complain(APP_USAGE, "--out: the path is too long");
    return false;
}

/* Writes obstacles that do not move, once for all frames. */
static int write_still(struct output *o, const drape_world *world)
{
    if (!o->obstacles.nt || o->moving)
        return APP_OK;
    int status = drape_read(world, o->all.x, o->v);
    if (status != DRAPE_OK)
        return complain(APP_FAILED, "the obstacles: %s",
                        drape_status_text(status));
    bool good = ply_save(o->directory, "obstacles.ply", &o->obstacles, o->bits);
    if (good && o->obj)
        good = obj_save_parts(o->directory, "obstacles.obj", &o->obstacles,
                              o->obstacle_part, o->n_obstacles, o->bits);
    return good ? APP_OK : APP_FAILED;
}

/* Where a particle of a cloth is on its sheet at rest, m. */
static void put_at_rest(const struct part *part, int64_t k, double x[3])
{
    if (part->rest) {
        x[0] = part->rest[k][0];
        x[1] = part->rest[k][1];
    } else {
        x[0] = part->size[0] * (double)(k % part->m) / (part->m - 1);
        x[1] = part->size[1] * (double)(k / part->m) / (part->n - 1);
    }
    x[2] = 0;
}

/* Writes the cloths flat, as they are at rest, where one is a panel: only its
 * outline's particles are not where the grid in report.json has them. */
static int write_rest(struct output *o)
{
    bool panels = false;
    int64_t v = 0;
    for (int k = 0; k < o->cloths; k++)
        panels |= o->cloth_part[k].rest != NULL;
    if (!panels)
        return APP_OK;
    for (int k = 0; k < o->cloths; k++)
        for (int64_t i = 0; i < o->cloth_part[k].nv; i++)
            put_at_rest(&o->cloth_part[k], i, o->cloth.x[v++]);
    bool good = ply_save(o->directory, "rest.ply", &o->cloth, 64);
    return good ? APP_OK : APP_FAILED;
}

int output_open(struct output *o, const struct scene *scene,
                const drape_world *world, const char *directory,
                const struct claim *claim)
{
    o->bits = scene->def.precision;
    for (int k = 0; k < scene->def.n_obstacles; k++)
        o->moving |= scene->def.obstacles[k].motion >= 0 ||
                     scene->def.obstacles[k].frames > 0;
    strcpy(o->directory, directory);
    if (!file_join(o->frames, directory, "frames"))
        return APP_USAGE;
    int status = lock_take(&o->lock, directory);
    if (status == APP_OK)
        status = folder_prepare(directory, claim);
    if (status == APP_OK && !file_make_directory(o->frames))
        status = APP_FAILED;
    if (status == APP_OK)
        status = make_views(o, scene, world);
    if (status == APP_OK)
        status = write_rest(o);
    return status == APP_OK ? write_still(o, world) : status;
}

void output_close(struct output *output)
{
    pool_free(&output->pool);
    lock_release(&output->lock);
}

bool output_path(char path[FILE_PATH], const char *directory, const char *body,
                 int k)
{
    char name[64];
    snprintf(name, sizeof name, "frames/%s_%04d.ply", body, k);
    return file_join(path, directory, name);
}

static bool write_obj(const struct output *o, int k)
{
    char name[64];
    snprintf(name, sizeof name, "obstacles_%04d.obj", k);
    if (o->obstacles.nt && o->moving &&
        !obj_save_parts(o->frames, name, &o->obstacles, o->obstacle_part,
                        o->n_obstacles, o->bits))
        return false;
    snprintf(name, sizeof name, "cloth_%04d.obj", k);
    return obj_save_parts(o->frames, name, &o->cloth, o->cloth_part, o->cloths,
                          o->bits);
}

int output_frame(struct output *o, drape_world *world, int k)
{
    char name[64];
    if (k % o->every)
        return APP_OK;
    int status = drape_read(world, o->all.x, o->v);
    if (status != DRAPE_OK)
        return complain(APP_FAILED, "frame %d: %s", k,
                        drape_status_text(status));
    stretch_look(o->stretch, o->made, o->cloth_part, o->cloths, &o->cloth, k);
    /* the cloth's PLY comes last: it shows that the frame is complete */
    snprintf(name, sizeof name, "obstacles_%04d.ply", k);
    if (o->obstacles.nt && o->moving &&
        !ply_save(o->frames, name, &o->obstacles, o->bits))
        return APP_FAILED;
    if (o->obj && !write_obj(o, k))
        return APP_FAILED;
    if (o->contacts)
        status =
            contacts_save(world, o->frames, k, (const double(*)[3])o->all.x);
    if (status != APP_OK)
        return status;
    snprintf(name, sizeof name, "cloth_%04d.ply", k);
    bool good = ply_save(o->frames, name, &o->cloth, o->bits);
    return good ? APP_OK : APP_FAILED;
}

int *output_frames(const char *directory, int *count)
{
    char frames[FILE_PATH];
    if (!file_join(frames, directory, "frames"))
        return NULL;
    int *frame = folder_list(frames, "cloth", "ply", count);
    if (frame && *count == 0) {
        complain(APP_USAGE, "%s: no frames/cloth_0000.ply here", directory);
        free(frame);
        return NULL;
    }
    return frame;
}

/* The cache's numbers are little-endian. */
static void put(FILE *out, const void *value)
{
    uint32_t bits;
    memcpy(&bits, value, sizeof bits);
    for (int k = 0; k < 4; k++)
        fputc((int)(bits >> (8 * k) & 255), out);
}

/* Samples are `every` frames apart. */
static void put_header(FILE *out, int32_t points, int every, int32_t samples)
{
    const int32_t version = 1;
    const float start = 0, rate = (float)every;
    fwrite("POINTCACHE2", 12, 1, out);
    put(out, &version);
    put(out, &points);
    put(out, &start);
    put(out, &rate);
    put(out, &samples);
}

/* Writes one sample: a frame's positions. */
static int put_frame(const struct output *o, FILE *out, int k)
{
    char path[FILE_PATH];
    struct pool pool = {0};
    struct mesh mesh = {0};
    if (!output_path(path, o->directory, "cloth", k))
        return APP_USAGE;
    int status = ply_load(&pool, path, &mesh);
    if (status == APP_OK && mesh.nv != o->cloth.nv)
        status = complain(APP_FAILED, "%s: a frame of another scene", path);
    for (int64_t j = 0; status == APP_OK && j < mesh.nv; j++)
        for (int i = 0; i < 3; i++) {
            float value = (float)mesh.x[j][i];
            put(out, &value);
        }
    pool_free(&pool);
    return status;
}

int output_cache(const struct output *o, int last)
{
    struct file file;
    char path[FILE_PATH];
    for (int k = 0; k <= last; k += o->every) {
        if (!output_path(path, o->directory, "cloth", k))
            return APP_FAILED;
        if (!file_exists(path)) {
            complain(0, "note: no cloth.pc2, because frame %d is not in %s", k,
                     o->frames);
            return APP_OK;
        }
    }
    if (!file_open(&file, o->directory, "cloth.pc2"))
        return APP_FAILED;
    put_header(file.stream, (int32_t)o->cloth.nv, o->every,
               last / o->every + 1);
    for (int k = 0; k <= last; k += o->every) {
        int status = put_frame(o, file.stream, k);
        if (status != APP_OK) {
            file_drop(&file);
            return status;
        }
    }
    return file_close(&file) ? APP_OK : APP_FAILED;
}
