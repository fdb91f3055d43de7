/* SPDX-License-Identifier: Apache-2.0 */
/* drape audit: intersecting triangle pairs, counted by exact predicates. */
#include "app/base/file.h"
#include "app/read/crossings.h"
#include "app/read/json.h"
#include "app/scene/scene.h"
#include "app/tool/options.h"
#include "app/write/output.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

/* Several meshes merged into one; obstacles are group 0. */
struct merged {
    struct pool pool;
    struct mesh mesh;
    int32_t *group;
};

/* Appends a mesh. The arrays replaced by larger ones stay in the pool. */
static int append(struct merged *all, const struct mesh *more, int group)
{
    struct mesh *m = &all->mesh;
    int64_t nv = m->nv + more->nv, nt = m->nt + more->nt;
    if (nv > INT32_MAX || nt > INT32_MAX)
        return complain(APP_USAGE, "audit: more than 2^31 vertices");
    double(*x)[3] = pool_take(&all->pool, (size_t)nv + 1, sizeof *x);
    int32_t(*tri)[3] = pool_take(&all->pool, (size_t)nt + 1, sizeof *tri);
    int32_t *groups = pool_take(&all->pool, (size_t)nt + 1, sizeof *groups);
    if (!x || !tri || !groups)
        return complain(APP_FAILED, "audit: out of memory");
    for (int64_t k = 0; k < nv; k++)
        memcpy(x[k], k < m->nv ? m->x[k] : more->x[k - m->nv], sizeof x[k]);
    for (int64_t k = 0; k < nt; k++) {
        bool old = k < m->nt;
        for (int i = 0; i < 3; i++)
            tri[k][i] =
                old ? m->tri[k][i] : more->tri[k - m->nt][i] + (int32_t)m->nv;
        groups[k] = old ? all->group[k] : group;
    }
    *m = (struct mesh){nv, nt, x, tri};
    all->group = groups;
    return APP_OK;
}

static int append_file(struct merged *all, const char *path, int group)
{
    struct mesh mesh;
    int status = mesh_load(&all->pool, path, &mesh);
    return status == APP_OK ? append(all, &mesh, group) : status;
}

/* The world of a run with seams, which tells the pairs that they join. */
struct seams {
    char file[FILE_PATH]; /* of the scene; empty: it has no garments */
    struct scene scene;
    drape_world *world; /* NULL: there are no seams */
};

/* Names the scene of a run: what `drape sew` leaves beside its frames, or the
 * file that the report names. */
static bool name_scene(struct seams *seams, const char *directory,
                       const char *reported)
{
    if (!file_join(seams->file, directory, "sewn.json"))
        return false;
    if (!file_exists(seams->file))
        snprintf(seams->file, sizeof seams->file, "%s",
                 reported ? reported : "");
    json_t *root = file_exists(seams->file) ? json_parse(seams->file) : NULL;
    if (!json_object_get(root, "garments"))
        *seams->file = 0;
    json_decref(root);
    return true;
}

/* Makes the world where pairs are found first. */
static bool open_seams(struct seams *seams)
{
    struct overrides none = {"ref", -1, -1, -1, 0};
    bool quiet = app_quiet;
    if (!*seams->file || seams->world)
        return seams->world;
    app_quiet = true; /* notes on the pattern are no news */
    int status = scene_load(&seams->scene, seams->file);
    app_quiet = quiet;
    seams->scene.def.allow_intersecting = 1;
    if (status == APP_OK)
        status = scene_create(&seams->scene, &none, &seams->world);
    if (status != APP_OK) {
        complain(APP_OK,
                 "note: %s tells no seams, so pairs that they join count",
                 seams->file);
        *seams->file = 0;
    }
    return seams->world;
}

static void close_seams(struct seams *seams)
{
    drape_destroy(seams->world);
    scene_free(&seams->scene);
}

/* Finds the pairs of a mesh. seams: NULL where there can be none. */
static int find_pairs(const drape_mesh *mesh, struct seams *seams,
                      struct crossings *c)
{
    int status = crossings_find(mesh, c);
    if (status != APP_OK || !c->found || !seams)
        return status;
    if (open_seams(seams) && drape_triangles(seams->world) == mesh->nt)
        crossings_part(c, seams->world);
    return APP_OK;
}

/* Audits, and prints the result in one line that begins with `name`; quiet:
 * prints only if pairs were found. */
static int audit(const struct merged *all, const char *name, int list,
                 bool quiet, struct seams *seams, struct crossings *f)
{
    drape_mesh mesh = {.nv = all->mesh.nv,
                       .nt = all->mesh.nt,
                       .x = (const double(*)[3])all->mesh.x,
                       .tri = (const int32_t(*)[3])all->mesh.tri,
                       .group = all->group};
    int status = find_pairs(&mesh, seams, f);
    if (status == APP_OK && (!quiet || f->found)) {
        printf("%s: %" PRId64 " triangles, %" PRId64 " intersecting pairs",
               name, all->mesh.nt, f->found);
        if (f->degenerate)
            printf(", %" PRId64 " degenerate triangles", f->degenerate);
        printf("\n");
    }
    for (int64_t k = 0; status == APP_OK && list && k < f->found; k++)
        printf("%d %d\n", (int)f->pair[k][0], (int)f->pair[k][1]);
    crossings_free(f);
    return status;
}

/* A run's bodies by its report, and the obstacles' files in its folder. */
struct run {
    const char *directory;
    bool reported;              /* the run has a report */
    int obstacles;              /* their number by the report */
    int64_t cloth, all;         /* numbers of vertices by the report */
    char names[512];            /* of the obstacles */
    bool moving, still, listed; /* files of obstacles; list the pairs */
    struct seams seams;
};

static int64_t get_count(json_t *node, const char *name)
{
    json_t *item = json_object_get(node, name);
    bool good = json_is_number(item) && json_number_value(item) >= 0 &&
                json_number_value(item) <= INT32_MAX;
    return good ? (int64_t)json_number_value(item) : 0;
}

static void read_bodies(struct run *run, json_t *root)
{
    json_t *body;
    size_t k;
    run->cloth = run->all = get_count(root, "vertices");
    json_array_foreach(json_object_get(root, "bodies"), k, body)
    {
        const char *kind = json_string_value(json_object_get(body, "kind"));
        const char *name = json_string_value(json_object_get(body, "name"));
        size_t length = strlen(run->names);
        if (!kind || strcmp(kind, "obstacle") != 0)
            continue;
        if (run->obstacles++ == 0)
            run->cloth = get_count(body, "first_vertex");
        snprintf(run->names + length, sizeof run->names - length, "%s%s",
                 length ? ", " : "", name ? name : "?");
    }
}

/* Reads the report and finds the obstacles' files, before frames are read. */
static int look(struct run *run)
{
    char path[FILE_PATH];
    int count;
    if (!file_join(path, run->directory, "frames"))
        return APP_USAGE;
    int *moving = folder_list(path, "obstacles", "ply", &count);
    if (!moving)
        return APP_FAILED;
    free(moving);
    run->moving = count > 0;
    if (!file_join(path, run->directory, "obstacles.ply"))
        return APP_USAGE;
    run->still = file_exists(path);
    if (!file_join(path, run->directory, "report.json"))
        return APP_USAGE;
    run->reported = file_exists(path);
    json_t *root = run->reported ? json_parse(path) : NULL;
    if (run->reported && !root)
        return APP_USAGE;
    read_bodies(run, root);
    bool named = name_scene(&run->seams, run->directory,
                            json_string_value(json_object_get(root, "file")));
    json_decref(root);
    if (!named)
        return APP_USAGE;
    if (run->reported || run->moving || run->still)
        return APP_OK;
    return complain(APP_USAGE,
                    "%s: neither report.json nor obstacles are here, so "
                    "obstacles that the run may have had cannot be tested",
                    run->directory);
}

/* Appends the obstacles at the time of frame k. */
static int load_obstacles(struct merged *all, const struct run *run, int k)
{
    char path[FILE_PATH];
    bool made = run->moving ? output_path(path, run->directory, "obstacles", k)
                            : file_join(path, run->directory, "obstacles.ply");
    if (!made)
        return APP_USAGE;
    if (!file_exists(path)) {
        if (run->reported && !run->obstacles)
            return APP_OK;
        return complain(APP_USAGE,
                        "%s: is not there, so in frame %d cloth was not tested "
                        "against the obstacles (%s)",
                        path, k, *run->names ? run->names : "unknown");
    }
    int64_t before = all->mesh.nv;
    int status = append_file(all, path, 0);
    if (status != APP_OK || !run->reported ||
        all->mesh.nv - before == run->all - run->cloth)
        return status;
    return complain(APP_USAGE,
                    "%s: has %" PRId64 " vertices; expected %" PRId64
                    ", as report.json says of the obstacles",
                    path, all->mesh.nv - before, run->all - run->cloth);
}

/* Loads frame k of a run: the cloths, and the obstacles at that time. */
static int load_frame(struct merged *all, const struct run *run, int k)
{
    char path[FILE_PATH];
    if (!output_path(path, run->directory, "cloth", k))
        return APP_USAGE;
    int status = append_file(all, path, 1);
    if (status != APP_OK)
        return status;
    if (run->reported && all->mesh.nv != run->cloth)
        return complain(APP_USAGE,
                        "%s: has %" PRId64 " vertices; expected %" PRId64
                        ", as report.json says of the cloths",
                        path, all->mesh.nv, run->cloth);
    return load_obstacles(all, run, k);
}

static int audit_frame(struct run *run, int k, struct crossings *f)
{
    char path[FILE_PATH];
    struct merged all = {0};
    if (!output_path(path, run->directory, "cloth", k))
        return APP_USAGE;
    int status = load_frame(&all, run, k);
    if (status == APP_OK)
        status = audit(&all, path, run->listed, true, &run->seams, f);
    pool_free(&all.pool);
    return status;
}

static int audit_run(const char *directory, int list)
{
    int64_t sum = 0, bad = 0, sewn = 0;
    int count;
    struct run run = {.directory = directory, .listed = list};
    int *frame = output_frames(directory, &count);
    if (!frame)
        return APP_USAGE;
    int status = look(&run);
    for (int k = 0; k < count && status == APP_OK; k++) {
        struct crossings f = {0};
        status = audit_frame(&run, frame[k], &f);
        sum += f.found;
        bad += f.found > 0;
        sewn += f.sewn;
    }
    free(frame);
    close_seams(&run.seams);
    if (status != APP_OK)
        return status;
    printf("%s: %d frames, %" PRId64 " of them with intersecting pairs, "
           "%" PRId64 " pairs",
           directory, count, bad, sum);
    if (sewn)
        printf("; %" PRId64 " that a seam joins", sewn);
    printf("\n");
    return sum ? APP_FINDINGS : APP_OK;
}

static int audit_meshes(int count, char **path, const char *obstacle, int list)
{
    struct merged all = {0};
    struct crossings f = {0};
    int status = APP_OK;
    for (int k = 0; k < count && status == APP_OK; k++)
        status = append_file(&all, path[k], k + 1);
    if (status == APP_OK && obstacle)
        status = append_file(&all, obstacle, 0);
    if (status == APP_OK)
        status =
            audit(&all, count > 1 ? "all" : path[0], list, false, NULL, &f);
    pool_free(&all.pool);
    return status == APP_OK && f.found ? APP_FINDINGS : status;
}

/* Whether a file is of a format that the Python package alone reads. */
static bool is_beyond(const char *path)
{
    static const char *const ending[] = {".usd",  ".usda", ".usdc",
                                         ".usdz", ".abc",  ".npz"};
    const char *dot = strrchr(path, '.');
    for (size_t k = 0; dot && k < sizeof ending / sizeof ending[0]; k++)
        if (strcasecmp(dot, ending[k]) == 0)
            return true;
    return false;
}

/* Whether frames of another program are audited, by what options_read has
 * left. */
static bool is_frames(int count, char **path, const char *obstacle)
{
    bool found = obstacle && is_beyond(obstacle);
    for (int k = 0; k < count; k++)
        found = found || is_beyond(path[k]);
    return found;
}

int command_audit(int argc, char **argv)
{
    int list = 0, frames = 0, between = 0, positional;
    const char *obstacle = NULL;
    const struct option_row options[] = {FLAG_OPTION("--list", &list),
                                         FLAG_OPTION("--frames", &frames),
                                         FLAG_OPTION("--between", &between),
                                         TEXT_OPTION("--obstacle", &obstacle),
                                         {0}};
    char **given = calloc((size_t)argc + 1, sizeof *given);
    if (!given)
        return complain(APP_FAILED, "out of memory");
    for (int k = 0; k < argc; k++)
        given[k] = argv[k];
    int status = options_read(options, argc, argv, &positional);
    if (status == APP_OK && positional > 0 &&
        (frames || between || is_frames(positional, argv, obstacle)))
        status = become_python("audit-frames", argc, given);
    free(given);
    if (status != APP_OK)
        return status;
    if (positional < 1)
        return complain(APP_USAGE, "audit: expected MESH… or DIR");
    if (positional == 1 && !obstacle && file_is_directory(argv[0]))
        return audit_run(argv[0], list);
    return audit_meshes(positional, argv, obstacle, list);
}
