/* SPDX-License-Identifier: Apache-2.0 */
/* Frames of obstacles that deform: numbered mesh files and point caches. */
#include "app/base/app.h"
#include "app/base/file.h"
#include "app/scene/bodies.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MOST = 1000000 }; /* frames */
/* A mesh is where the first frame is, if no vertex is further from it, m. */
static const double same_place = 1e-4;

static int read_time(struct json *json, json_t *node, void *out)
{
    static const struct json_key time = NUMBER_KEY("times", 0, -1e6, 1e6);
    return json_value(json, node, &time, out);
}

static int read_times(struct json *json, json_t *node, void *out)
{
    struct sequence *s = out;
    struct json_list list = {
        .read = read_time, .size = sizeof(double), .most = MOST};
    int status = json_items(json, node, &list);
    s->times = list.items;
    s->n_times = list.count;
    if (status == APP_OK && list.count == 0)
        return json_refuse(json, "expected a time a frame");
    for (int k = 1; k < list.count && status == APP_OK; k++) {
        if (s->times[k] > s->times[k - 1])
            continue;
        size_t length = json_enter(json, "[%d]", k);
        status =
            json_refuse(json, "%.15g: expected more than %.15g: times ascend",
                        s->times[k], s->times[k - 1]);
        json_leave(json, length);
    }
    return status;
}

/* Whether a text has one %d, or %04d, and no other %. */
static bool is_numbered(const char *files)
{
    const char *percent = strchr(files, '%');
    const char *d =
        percent ? percent + 1 + strspn(percent + 1, "0123456789") : NULL;
    return d && d - percent <= 4 && *d == 'd' && !strchr(d, '%');
}

static const char *const betweens[] = {"linear", "cubic", NULL};

int read_sequence(struct json *json, json_t *node, void *out)
{
    static const struct json_key keys[] = {
        TEXT_KEY("files", offsetof(struct sequence, files)),
        TEXT_KEY("file", offsetof(struct sequence, file)),
        INTEGER_KEY("first", offsetof(struct sequence, first), 0, 1e9),
        INTEGER_KEY("count", offsetof(struct sequence, count), 1, MOST),
        NUMBER_KEY("dt", offsetof(struct sequence, dt), 1e-6, 1e6),
        NESTED_KEY("times", 0, read_times),
        CHOICE_KEY("between", offsetof(struct sequence, between), betweens),
        NUMBER_KEY("lead", offsetof(struct sequence, lead), 0, 1e6),
        {0}};
    static const char *const dt[] = {"dt", NULL};
    static const char *const numbers[] = {"first", "count", NULL};
    struct sequence *s = out;
    s->dt = 1.0 / 60;
    s->first = -1;
    int status = json_fields(json, node, keys, s);
    if (status != APP_OK)
        return status;
    if (s->files && s->file)
        return json_refuse(json,
                           "expected either files with count, or the file "
                           "of a point cache (.pc2)");
    if (!s->file && (!s->files || !is_numbered(s->files)))
        return json_refuse(json,
                           "expected files with one %%d or %%04d in the name");
    if (s->times)
        json_idle(json, node, dt, "there are times");
    if (s->file)
        json_idle(json, node, numbers, "a point cache knows its frames");
    return APP_OK;
}

/* The name of the file of this number. */
static void name_file(const struct sequence *s, int number,
                      char name[FILE_PATH])
{
    const char *percent = strchr(s->files, '%');
    int width = atoi(percent + 1);
    snprintf(name, FILE_PATH, "%.*s%0*d%s", (int)(percent - s->files), s->files,
             width, number, strchr(percent, 'd') + 1);
}

/* Finds out where a series begins and ends, where it is not said: it begins at
 * file 0, or 1 if there is none, and its files follow each other. */
static void count_files(const struct json *json, struct sequence *s)
{
    char name[FILE_PATH];
    if (s->first < 0) {
        name_file(s, 0, name);
        s->first = s->count || has_mesh(json, name) ? 0 : 1;
    }
    for (int k = 0; !s->count; k++) {
        name_file(s, s->first + k, name);
        if (k == MOST || !has_mesh(json, name))
            s->count = k > 1 ? k : 1; /* the first is read, and missed */
    }
}

/* Loads the mesh of a file into frame k; the first is also the mesh. */
static int load_frame(struct json *json, const char *name, int k,
                      struct clip *clip, struct mesh *mesh)
{
    char path[FILE_PATH];
    struct mesh here;
    int status = find_mesh(json, name, path);
    if (status == APP_OK)
        status = mesh_load_plain(json->pool, path, &here);
    if (status != APP_OK)
        return status;
    if (k == 0) {
        *mesh = here;
        clip->x = pool_take(json->pool, (size_t)clip->frames * (size_t)here.nv,
                            sizeof *clip->x);
        if (!clip->x)
            return complain(APP_FAILED, "out of memory");
    }
    if (here.nv != mesh->nv || here.nt != mesh->nt)
        return json_refuse(json,
                           "%s: another number of vertices or "
                           "triangles than the first",
                           name);
    if (memcmp(here.tri, mesh->tri, (size_t)mesh->nt * sizeof *mesh->tri) != 0)
        return json_refuse(json, "%s: other triangles than the first", name);
    memcpy(clip->x + (size_t)k * (size_t)mesh->nv, here.x,
           (size_t)mesh->nv * sizeof *clip->x);
    return APP_OK;
}

/* Loads the files of a series, behind the mesh that is led to their first. */
static int load_files(struct json *json, const struct sequence *s,
                      const char *led, struct clip *clip, struct mesh *mesh)
{
    char name[FILE_PATH];
    int room = led ? 1 : 0;
    clip->frames = room + s->count;
    clip->dt = s->dt;
    int status = led ? load_frame(json, led, 0, clip, mesh) : APP_OK;
    for (int k = 0; k < s->count && status == APP_OK; k++) {
        name_file(s, s->first + k, name);
        status = load_frame(json, name, room + k, clip, mesh);
    }
    return status == APP_OK ? mesh_merge(s->files, mesh, clip) : status;
}

/* Loads a point cache and the mesh that it moves. */
static int load_cache(struct json *json, const struct sequence *s,
                      const char *name, struct clip *clip, struct mesh *mesh)
{
    char path[FILE_PATH];
    int room = s->lead > 0;
    if (!mesh_ordered(name))
        return json_refuse(json,
                           "%s: expected .ply or .off: the frames of a point "
                           "cache are in the order of the mesh's vertices, "
                           "which these files keep",
                           name);
    int status = find_mesh(json, name, path);
    if (status == APP_OK)
        status = mesh_load_plain(json->pool, path, mesh);
    if (status == APP_OK)
        status = find_mesh(json, s->file, path);
    if (status == APP_OK)
        status = pc2_load(json->pool, path, mesh->nv, room, clip);
    if (status == APP_OK && room)
        memcpy(clip->x, mesh->x, (size_t)mesh->nv * sizeof *clip->x);
    clip->dt *= s->dt;
    return status;
}

/* Puts the frames behind the mesh that goes to the first of them, unless it is
 * there. */
static int lead(struct json *json, const struct sequence *s, int64_t nv,
                drape_obstacle *out)
{
    const double(*mesh)[3] = out->frame, (*first)[3] = mesh + nv;
    double most = 0, (*times) = NULL;
    for (int64_t k = 0; k < nv; k++)
        for (int i = 0; i < 3; i++)
            most = fmax(most, fabs(first[k][i] - mesh[k][i]));
    if (most <= same_place) {
        out->frame = first;
        out->frames--;
        return APP_OK;
    }
    times = pool_take(json->pool, (size_t)out->frames, sizeof *times);
    if (!times)
        return complain(APP_FAILED, "out of memory");
    for (int k = 1; k < out->frames; k++)
        times[k] =
            s->lead + (s->times ? s->times[k - 1] : (k - 1) * out->frame_dt);
    times[0] = times[1] - s->lead;
    out->frame_time = times;
    return APP_OK;
}

int sequence_load(struct json *json, struct sequence *s, const char *name,
                  const struct placement *placement, struct mesh *mesh,
                  drape_obstacle *out)
{
    struct clip clip = {0};
    int room = s->lead > 0;
    if (!name && (room || !s->files))
        return json_refuse(
            json, "frames.%s: expected the mesh beside it that %s",
            s->files ? "lead" : "file",
            s->files ? "goes to the first frame" : "the point cache moves");
    if (s->files)
        count_files(json, s);
    int status = s->files ? load_files(json, s, room ? name : NULL, &clip, mesh)
                          : load_cache(json, s, name, &clip, mesh);
    if (status != APP_OK || !clip.x)
        return status;
    if (s->times && s->n_times != clip.frames - room)
        return json_refuse(json, "frames.times: %d times of %d frames",
                           s->n_times, clip.frames - room);
    mesh_place_frames(clip.x, mesh->nv, clip.frames, placement);
    out->frames = clip.frames;
    out->between = s->between;
    out->frame_dt = clip.dt;
    out->frame_time = s->times;
    out->frame = (const double(*)[3])clip.x;
    return room ? lead(json, s, mesh->nv, out) : APP_OK;
}
