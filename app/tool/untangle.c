/* SPDX-License-Identifier: Apache-2.0 */
/* drape untangle: lists where a start intersects, and parts it. */
#include "app/read/untangle.h"
#include "app/base/file.h"
#include "app/render/marks.h"
#include "app/scene/scene.h"
#include "app/tool/options.h"
#include "app/write/sewn.h"
#include "app/write/untangled.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

struct knots {
    struct untangling u;
    char **name;        /* [parts] of the bodies */
    int64_t *triangles; /* [parts + 1] the first of each */
    int64_t *first;     /* [parts + 1] vertices */
    bool *fixed;        /* [parts] */
    struct scene scene; /* of a scene */
    drape_world *world;
    json_t *root;
    const char *obstacle, *directory;
    int rounds, no_picture;
    struct pool pool;
};

/* Takes memory for so many bodies. */
static int take(struct knots *k, int parts)
{
    size_t n = (size_t)parts + 1;
    k->u.parts = parts;
    k->name = pool_take(&k->pool, n, sizeof *k->name);
    k->triangles = pool_take(&k->pool, n, sizeof *k->triangles);
    k->first = pool_take(&k->pool, n, sizeof *k->first);
    k->fixed = pool_take(&k->pool, n, sizeof *k->fixed);
    return k->name && k->triangles && k->first && k->fixed ? APP_OK
                                                           : no_memory();
}

/* Refuses to write into the folder of an input, as files would have its name or
 * those of what it reads. path: NULL: there is none. */
static int check_folder(const char *directory, const char *path)
{
    struct stat out, in;
    char folder[FILE_PATH];
    if (!path || stat(directory, &out) != 0)
        return APP_OK;
    const char *slash = strrchr(path, '/');
    snprintf(folder, sizeof folder, "%.*s", slash ? (int)(slash - path) + 1 : 1,
             slash ? path : ".");
    if (stat(folder, &in) != 0 || in.st_dev != out.st_dev ||
        in.st_ino != out.st_ino)
        return APP_OK;
    return complain(APP_USAGE,
                    "%s: is in %s, where it could be overwritten; give another "
                    "--out",
                    path, directory);
}

/* Reads meshes, the last of which is the obstacle, if one is given. */
static int load_meshes(struct knots *k, int count, char **path)
{
    int parts = count + (k->obstacle != NULL);
    struct mesh *mesh = pool_take(&k->pool, (size_t)parts, sizeof *mesh);
    if (!mesh)
        return no_memory();
    int status = take(k, parts);
    for (int p = 0; p < parts && status == APP_OK; p++) {
        const char *file = p < count ? path[p] : k->obstacle;
        status = mesh_load(&k->pool, file, &mesh[p]);
        if (status != APP_OK)
            return status;
        k->name[p] = pool_stem(&k->pool, file);
        k->fixed[p] = p >= count;
        k->first[p + 1] = k->first[p] + mesh[p].nv;
        k->triangles[p + 1] = k->triangles[p] + mesh[p].nt;
        if (!k->name[p])
            return no_memory();
        for (int q = 0; q < p; q++)
            if (strcmp(k->name[q], k->name[p]) == 0)
                return complain(APP_USAGE,
                                "%s: another mesh is called %s, too: what is "
                                "written of them would be one file",
                                file, k->name[p]);
        if (k->first[p + 1] > INT32_MAX || k->triangles[p + 1] > INT32_MAX / 3)
            return complain(APP_USAGE, "%s: more than 2^31 vertices or edges",
                            file);
    }
    if (status != APP_OK)
        return status;
    double(*x)[3] = pool_take(&k->pool, (size_t)k->first[parts] + 1, sizeof *x);
    int32_t(*tri)[3] =
        pool_take(&k->pool, (size_t)k->triangles[parts] + 1, sizeof *tri);
    if (!x || !tri)
        return no_memory();
    for (int p = 0; p < parts; p++) {
        memcpy(x + k->first[p], mesh[p].x, (size_t)mesh[p].nv * sizeof *x);
        for (int64_t t = 0; t < 3 * mesh[p].nt; t++)
            tri[k->triangles[p] + t / 3][t % 3] =
                mesh[p].tri[t / 3][t % 3] + (int32_t)k->first[p];
    }
    k->u.x = x;
    k->u.tri = (const int32_t(*)[3])tri;
    k->u.nt = k->triangles[parts];
    return APP_OK;
}

/* Makes the scene, and takes its bodies as they are at time 0. */
static int load_scene(struct knots *k, const char *file)
{
    struct overrides none = {"ref", -1, -1, -1, 1};
    struct scene *scene = &k->scene;
    k->root = json_parse(file);
    if (!k->root)
        return APP_USAGE;
    int status = scene_load(scene, file);
    if (status == APP_OK)
        status = scene_create(scene, &none, &k->world);
    int cloths = scene->def.n_cloths, parts = cloths + scene->def.n_obstacles;
    if (status == APP_OK)
        status = take(k, parts);
    if (status != APP_OK)
        return status;
    k->u.nt = drape_triangles(k->world);
    int64_t nv = drape_vertices(k->world);
    k->u.x = pool_take(&k->pool, (size_t)nv + 1, sizeof *k->u.x);
    int32_t(*tri)[3] = pool_take(&k->pool, (size_t)k->u.nt + 1, sizeof *tri);
    if (!k->u.x || !tri)
        return no_memory();
    if (drape_read(k->world, k->u.x, NULL) != DRAPE_OK ||
        drape_read_triangles(k->world, tri) != DRAPE_OK)
        return complain(APP_FAILED, "%s: the start cannot be read", file);
    k->u.tri = (const int32_t(*)[3])tri;
    k->u.world = k->world;
    for (int p = 0; p < parts; p++) {
        int64_t *last = &k->triangles[p + 1];
        k->fixed[p] = p >= cloths;
        k->name[p] = p < cloths ? scene->cloth_name[p]
                                : scene->obstacle_name[p - cloths];
        k->first[p + 1] =
            p + 1 < parts ? drape_first_vertex(k->world, p + 1) : nv;
        for (*last = k->triangles[p];
             *last < k->u.nt && tri[*last][0] < k->first[p + 1];)
            ++*last;
    }
    return APP_OK;
}

/* Prints a region. */
static void tell(const struct knots *k, const struct tangle *row, int number,
                 const char *how)
{
    const char *a = k->name[row->body[0]], *b = k->name[row->body[1]];
    bool same = row->body[0] == row->body[1];
    say("%d: %s through %s, %" PRId64 " pairs, %.3g cm long, around (%.3g, "
        "%.3g, %.3g) m%s\n",
        number, a, same ? "itself" : b, row->pairs, 1e2 * row->length,
        (row->lo[0] + row->hi[0]) / 2, (row->lo[1] + row->hi[1]) / 2,
        (row->lo[2] + row->hi[2]) / 2, how);
}

/* Writes a part of the mesh, of bodies from a to before b. */
static bool save(const struct knots *k, int a, int b, const char *name)
{
    int64_t v = k->first[a], t = k->triangles[a], nt = k->triangles[b] - t;
    struct mesh mesh = {k->first[b] - v, nt, k->u.x + v,
                        malloc(((size_t)nt + 1) * sizeof *mesh.tri)};
    if (!mesh.tri) {
        no_memory();
        return false;
    }
    for (int64_t i = 0; i < 3 * nt; i++)
        mesh.tri[i / 3][i % 3] = k->u.tri[t + i / 3][i % 3] - (int32_t)v;
    bool good = ply_save(k->directory, name, &mesh, 64);
    free(mesh.tri);
    return good;
}

/* Writes the meshes, and the scene if all its cloths are of garments. */
static bool put_meshes(struct knots *k, const char *file)
{
    const struct scene *scene = &k->scene;
    bool good = true;
    char name[FILE_PATH];
    for (int p = 0; p < k->u.parts && good && !k->world; p++) {
        snprintf(name, sizeof name, "%.4000s.ply", k->name[p]);
        good = k->fixed[p] || save(k, p, p + 1, name);
    }
    if (!k->world)
        return good;
    for (int g = 0; g < scene->garments && good; g++) {
        snprintf(name, sizeof name, "sewn_%04d.ply", g);
        good =
            save(k, scene->garment_cloth[g], scene->garment_cloth[g + 1], name);
    }
    int others =
        scene->garments ? scene->garment_cloth[0] : scene->def.n_cloths;
    for (int p = 0; p < others && good; p++) {
        snprintf(name, sizeof name, "cloth_%04d.ply", p);
        good = save(k, p, p + 1, name);
    }
    sewn_name_files(k->root, file);
    return good &&
           (others || sewn_put_scene(k->root, k->directory, "start.json"));
}

/* Lists what intersects, parts it, and writes how that went. */
static int work(struct knots *k, const char *file)
{
    struct untangling *u = &k->u;
    size_t nv = (size_t)k->first[u->parts];
    double(*was)[3] = pool_take(&k->pool, nv + 1, sizeof *was);
    if (!was)
        return no_memory();
    memcpy(was, u->x, nv * sizeof *was);
    u->first = k->first;
    u->fixed = k->fixed;
    u->rounds = k->rounds;
    u->pool = &k->pool;
    int status = untangle(u);
    if (status != APP_OK)
        return status;
    for (int r = 0; r < u->found.count; r++)
        tell(k, &u->found.row[r], r + 1,
             !u->rounds               ? ""
             : u->found.row[r].parted ? ": parted"
                                      : ": not parted");
    if (!file_make_directory(k->directory) ||
        !untangled_write(u, (const char *const *)k->name, k->directory) ||
        (k->rounds && !put_meshes(k, file)))
        return APP_FAILED;
    if (!k->no_picture && u->found.count)
        status = marks_draw(u, (const double(*)[3])was, k->directory);
    int64_t before = 0, after = 0;
    for (int r = 0; r < u->found.count; r++)
        before += u->found.row[r].pairs;
    for (int r = 0; r < u->left.count; r++)
        after += u->left.row[r].pairs;
    say("%s: %d regions with %" PRId64
        " pairs; after %d rounds %d with %" PRId64 "\n",
        k->directory, u->found.count, before, u->made, u->left.count, after);
    return status != APP_OK ? status : u->left.count ? APP_FINDINGS : APP_OK;
}

/* Whether a file is a scene, by its ending. */
static bool is_scene(const char *path)
{
    const char *dot = strrchr(path, '.');
    return dot && strcmp(dot, ".json") == 0;
}

int command_untangle(int argc, char **argv)
{
    struct knots k = {.rounds = 200, .directory = "untangled"};
    const struct option_row options[] = {
        TEXT_OPTION("--obstacle", &k.obstacle),
        TEXT_OPTION("--out", &k.directory),
        INT_OPTION("--rounds", &k.rounds, 0, 100000),
        FLAG_OPTION("--no-picture", &k.no_picture),
        {0}};
    int positional;
    int status = options_read(options, argc, argv, &positional);
    if (status != APP_OK)
        return status;
    bool scene = positional && is_scene(argv[0]);
    if (positional < 1 || (scene && (positional > 1 || k.obstacle)))
        return complain(APP_USAGE,
                        "untangle: expected MESH… or one SCENE.json");
    status = check_folder(k.directory, k.obstacle);
    for (int p = 0; p < positional && status == APP_OK; p++)
        status = check_folder(k.directory, argv[p]);
    if (status == APP_OK)
        status =
            scene ? load_scene(&k, argv[0]) : load_meshes(&k, positional, argv);
    if (status == APP_OK)
        status = work(&k, argv[0]);
    drape_destroy(k.world);
    if (scene)
        scene_free(&k.scene);
    json_decref(k.root);
    pool_free(&k.pool);
    return status;
}
