/* SPDX-License-Identifier: Apache-2.0 */
/* Files read whole, and files that appear whole or not at all. */
#include "app/file.h"
#include "app/app.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* Reads until the end, growing as it goes: a pipe has no size. */
static char *read_all(FILE *stream, size_t *size)
{
    size_t room = 1 << 16, used = 0;
    char *data = malloc(room + 1);
    while (data) {
        used += fread(data + used, 1, room - used, stream);
        if (used < room)
            break;
        room *= 2;
        char *larger = realloc(data, room + 1);
        if (!larger)
            free(data);
        data = larger;
    }
    if (data)
        data[used] = 0;
    *size = used;
    return data;
}

char *file_read(const char *path, size_t *size)
{
    if (file_is_directory(path)) {
        complain(APP_USAGE, "%s: is a directory; expected a file", path);
        return NULL;
    }
    FILE *stream = fopen(path, "rb");
    if (!stream) {
        complain(APP_USAGE, "%s: %s", path, strerror(errno));
        return NULL;
    }
    char *data = read_all(stream, size);
    if (!data) {
        complain(APP_FAILED, "%s: out of memory", path);
    } else if (ferror(stream)) {
        complain(APP_USAGE, "%s: cannot be read", path);
        free(data);
        data = NULL;
    }
    fclose(stream);
    return data;
}

bool file_exists(const char *path)
{
    struct stat status;
    return stat(path, &status) == 0;
}

bool file_is_directory(const char *path)
{
    struct stat status;
    return stat(path, &status) == 0 && S_ISDIR(status.st_mode);
}

bool file_join(char path[FILE_PATH], const char *directory, const char *name)
{
    int length = snprintf(path, FILE_PATH, "%s/%s", directory, name);
    if (length > 0 && length < FILE_PATH)
        return true;
    complain(APP_USAGE, "%.60s…: the path is too long", directory);
    return false;
}

bool file_open(struct file *file, const char *directory, const char *name)
{
    char part[512];
    snprintf(part, sizeof part, ".%.480s.part", name);
    if (!file_join(file->path, directory, name) ||
        !file_join(file->part, directory, part))
        return false;
    file->stream = fopen(file->part, "wb");
    if (!file->stream)
        complain(APP_FAILED, "%s: %s", file->part, strerror(errno));
    return file->stream != NULL;
}

void file_drop(struct file *file)
{
    if (!file->stream)
        return;
    fclose(file->stream);
    file->stream = NULL;
    remove(file->part);
}

bool file_close(struct file *file)
{
    errno = 0;
    bool good = fflush(file->stream) == 0 && !ferror(file->stream);
    /* Only what has reached the disk may take the file's name. */
    good = good && fsync(fileno(file->stream)) == 0;
    int why = errno;
    if (fclose(file->stream) != 0 && good) {
        good = false;
        why = errno;
    }
    file->stream = NULL;
    if (good && rename(file->part, file->path) == 0)
        return true;
    if (good)
        why = errno;
    remove(file->part);
    complain(APP_FAILED, "%s: cannot write: %s", file->path,
             why ? strerror(why) : "the disk took only a part");
    return false;
}

bool file_make_directory(const char *path)
{
    char part[FILE_PATH];
    if (strlen(path) >= sizeof part) {
        complain(APP_USAGE, "%.60s…: the path is too long", path);
        return false;
    }
    strcpy(part, path);
    for (char *p = part + 1; *p; p++)
        if (*p == '/') {
            *p = 0;
            mkdir(part, 0777);
            *p = '/';
        }
    if (mkdir(part, 0777) == 0 || file_is_directory(path))
        return true;
    complain(APP_FAILED, "%s: %s", path, strerror(errno));
    return false;
}
