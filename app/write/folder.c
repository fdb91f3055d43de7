/* SPDX-License-Identifier: Apache-2.0 */
/* A run's folder: finds and removes the files of runs. */
#include "app/write/folder.h"
#include "app/base/app.h"
#include "app/write/lock.h"

#include <dirent.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* Returns the number in a file's name, or -1 if the name has none. */
static int file_number(const char *name, const char *body, const char *end)
{
    char expected[64];
    size_t length = strlen(body);
    if (strncmp(name, body, length) || name[length] != '_')
        return -1;
    long k = strtol(name + length + 1, NULL, 10);
    snprintf(expected, sizeof expected, "%s_%04ld.%s", body, k, end);
    return k >= 0 && k <= 1000000 && !strcmp(name, expected) ? (int)k : -1;
}

static int ascending(const void *a, const void *b)
{
    return *(const int *)a - *(const int *)b;
}

/* Returns the numbers of a directory's matching files. NULL: out of memory. */
static int *read_numbers(DIR *directory, const char *body, const char *end,
                         int *count)
{
    int room = 64, *number = malloc((size_t)room * sizeof *number);
    struct dirent *entry;
    while (directory && number && (entry = readdir(directory)) != NULL) {
        int k = file_number(entry->d_name, body, end);
        if (k < 0)
            continue;
        number[(*count)++] = k;
        if (*count < room)
            continue;
        int *larger = realloc(number, 2 * (size_t)room * sizeof *number);
        if (!larger)
            free(number);
        number = larger;
        room *= 2;
    }
    return number;
}

int *folder_list(const char *path, const char *body, const char *end,
                 int *count)
{
    *count = 0;
    DIR *directory = opendir(path);
    if (!directory && errno != ENOENT && errno != ENOTDIR) {
        complain(APP_FAILED, "%s: cannot be read: %s", path, strerror(errno));
        return NULL;
    }
    int *number = read_numbers(directory, body, end, count);
    if (directory)
        closedir(directory);
    if (number)
        qsort(number, (size_t)*count, sizeof *number, ascending);
    else
        complain(APP_FAILED, "%s: out of memory", path);
    return number;
}

/* All files that `run`, `sew` and `render` write, numbered and single. */
static const struct kind {
    const char *folder, *body, *end;
    bool frame; /* the number is a frame's */
} kinds[] = {
    {"frames", "cloth", "ply", true},     {"frames", "cloth", "obj", true},
    {"frames", "obstacles", "ply", true}, {"frames", "obstacles", "obj", true},
    {"frames", "contacts", "ply", true},  {"pictures", "frame", "png", true},
    {"pictures", "film", "png", false},   {"pictures", "front", "png", true},
    {"pictures", "back", "png", true},    {".", "sewn", "ply", false}};
static const char *const results[] = {
    "report.json", "obstacles.ply",    "cloth.pc2",     "trace.csv",
    "film.mp4",    "checkpoint.drape", "obstacles.obj", "sew.json",
    "sewn.json",   "parted.json",      "rest.ply",      "seams.json"};
enum { KINDS = 10, FILM_PICTURES = 6, RESULTS = 12, FILM = 4, CHECKPOINT = 5 };

static int remove_file(const char *directory, const char *name)
{
    char path[FILE_PATH];
    if (!file_join(path, directory, name))
        return APP_USAGE;
    if (remove(path) == 0 || errno == ENOENT)
        return APP_OK;
    return complain(APP_FAILED, "%s: cannot be removed: %s", path,
                    strerror(errno));
}

/* Removes the files of this kind whose number is at least `from`. */
static int remove_kind(const char *path, const struct kind *kind, int from)
{
    char folder[FILE_PATH], name[64];
    int count, status = APP_OK;
    if (!file_join(folder, path, kind->folder))
        return APP_USAGE;
    int *number = folder_list(folder, kind->body, kind->end, &count);
    if (!number)
        return APP_FAILED;
    for (int k = 0; k < count && status == APP_OK; k++) {
        snprintf(name, sizeof name, "%s_%04d.%s", kind->body, number[k],
                 kind->end);
        if (number[k] >= from)
            status = remove_file(folder, name);
    }
    free(number);
    return status;
}

/* Removes the incomplete files of writers that were killed. */
static int remove_parts(const char *path, const char *folder)
{
    char directory[FILE_PATH];
    int status = APP_OK;
    if (!file_join(directory, path, folder))
        return APP_USAGE;
    DIR *open = opendir(directory);
    struct dirent *entry;
    while (open && status == APP_OK && (entry = readdir(open)) != NULL) {
        const char *name = entry->d_name, *end = strrchr(name, '.');
        bool ours = false;
        for (int k = 0; k < KINDS; k++)
            ours |= !strncmp(name + 1, kinds[k].body, strlen(kinds[k].body));
        for (int k = 0; k < RESULTS; k++)
            ours |= !strncmp(name + 1, results[k], strlen(results[k]));
        if (ours && name[0] == '.' && end && !strcmp(end, ".part"))
            status = remove_file(directory, name);
    }
    if (open)
        closedir(open);
    return status;
}

/* Whether the directory's report.json belongs to the run `id`. */
static bool is_own(const char *directory, const char *id)
{
    char path[FILE_PATH], head[256], there[64] = "";
    if (!file_join(path, directory, "report.json"))
        return false;
    FILE *stream = file_is_regular(path) ? fopen(path, "rb") : NULL;
    size_t length = stream ? fread(head, 1, sizeof head - 1, stream) : 0;
    if (stream)
        fclose(stream);
    head[length] = 0;
    return sscanf(head, "{ \"drape\": \"%*[^\"]\", \"id\": \"%63[^\"]\"",
                  there) == 1 &&
           !strcmp(there, id);
}

/* *holds: whether the directory has files of a run. For a resumed run a
 * checkpoint alone does not count. Returns app_exit. */
static int look(const char *directory, bool resumed, bool *holds)
{
    char path[FILE_PATH];
    *holds = false;
    for (int k = 0; k < RESULTS; k++)
        if (!(k == CHECKPOINT && resumed))
            *holds |=
                file_join(path, directory, results[k]) && file_exists(path);
    for (int k = 0; k < KINDS; k++) {
        int count;
        if (!file_join(path, directory, kinds[k].folder))
            return APP_USAGE;
        int *number = folder_list(path, kinds[k].body, kinds[k].end, &count);
        if (!number)
            return APP_FAILED;
        *holds |= count > 0;
        free(number);
    }
    return APP_OK;
}

/* Whether two paths name one file. */
static bool is_same(const char *a, const char *b)
{
    struct stat one, two;
    return a && stat(a, &one) == 0 && stat(b, &two) == 0 &&
           one.st_dev == two.st_dev && one.st_ino == two.st_ino;
}

/* Removes all files of another run, except the checkpoint that this run resumes
 * from. */
static int clear(const char *directory, const char *checkpoint)
{
    char pictures[FILE_PATH], path[FILE_PATH];
    int status = APP_OK;
    for (int k = 0; k < KINDS && status == APP_OK; k++)
        status = remove_kind(directory, &kinds[k], 0);
    for (int k = 0; k < RESULTS && status == APP_OK; k++)
        if (file_join(path, directory, results[k]) &&
            !is_same(checkpoint, path))
            status = remove_file(directory, results[k]);
    if (status == APP_OK && file_join(pictures, directory, "pictures"))
        rmdir(pictures); /* fails, as it should, if it has other files */
    return status;
}

static int refuse(const char *path, const char *whose)
{
    return complain(APP_USAGE,
                    "%s: holds %s run; give another --out, or --force to "
                    "remove that run",
                    path, whose);
}

int folder_empty(const char *path)
{
    bool holds = false;
    int status = lock_is_free(path);
    if (status == APP_OK)
        status = look(path, false, &holds);
    return status == APP_OK && holds ? refuse(path, "a") : status;
}

int folder_clear_film(const char *path)
{
    int status = remove_kind(path, &kinds[FILM_PICTURES], 0);
    return status == APP_OK ? remove_file(path, results[FILM]) : status;
}

int folder_prepare(const char *path, const struct claim *claim)
{
    static const char *const folders[] = {".", "frames", "pictures"};
    bool own = claim->checkpoint && is_own(path, claim->id), holds;
    int status = look(path, claim->checkpoint != NULL, &holds);
    if (status == APP_OK && holds && !own && !claim->force)
        return refuse(path, claim->checkpoint ? "another" : "a");
    for (int k = 0; k < 3 && status == APP_OK; k++)
        status = remove_parts(path, folders[k]);
    for (int k = 0; k < KINDS && status == APP_OK && own; k++)
        if (kinds[k].frame)
            status = remove_kind(path, &kinds[k], claim->last + 1);
    if (status == APP_OK && own)
        status = folder_clear_film(path);
    if (status == APP_OK && holds && !own)
        status = clear(path, claim->checkpoint);
    return status;
}
