/* SPDX-License-Identifier: Apache-2.0 */
/* Reads whole files, and writes files that appear complete or not at all. */
#include "app/base/file.h"
#include "app/base/app.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* Milliseconds that a process has to come and write to a pipe. */
enum { PATIENCE = 1000 };

/* Returns the first byte of a pipe, or EOF if no process writes to the pipe. A
 * writer may take its time: while there is one, reading waits. */
static int first_of_pipe(int descriptor)
{
    struct pollfd there = {.fd = descriptor, .events = POLLIN};
    unsigned char byte;
    poll(&there, 1, PATIENCE);
    ssize_t got = read(descriptor, &byte, 1);
    if (got < 0 && (errno == EAGAIN || errno == EINTR)) {
        fcntl(descriptor, F_SETFL, 0);
        do
            got = read(descriptor, &byte, 1);
        while (got < 0 && errno == EINTR);
    }
    return got == 1 ? byte : EOF;
}

/* Makes an open file a stream. Returns NULL after one line. */
static FILE *stream_of(int descriptor, const char *path)
{
    struct stat status;
    const char *why = NULL;
    int first = 0;
    if (fstat(descriptor, &status) != 0)
        why = strerror(errno);
    else if (S_ISDIR(status.st_mode))
        why = "is a directory; expected a file";
    else if (!S_ISREG(status.st_mode) && !S_ISFIFO(status.st_mode))
        why = "is a device; expected a file";
    else if (S_ISFIFO(status.st_mode))
        first = first_of_pipe(descriptor);
    if (first == EOF)
        why = "is a pipe that no process writes to";
    fcntl(descriptor, F_SETFL, 0); /* from now on, reading waits */
    FILE *stream = why ? NULL : fdopen(descriptor, "rb");
    if (!stream)
        complain(APP_USAGE, "%s: %s", path, why ? why : strerror(errno));
    else if (S_ISFIFO(status.st_mode))
        ungetc(first, stream);
    return stream;
}

FILE *file_stream(const char *path)
{
    /* without O_NONBLOCK, opening a pipe waits for a writer */
    int how = O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC;
    bool standard = strcmp(path, "-") == 0;
    int descriptor = standard ? dup(STDIN_FILENO) : open(path, how);
    if (descriptor < 0) {
        complain(APP_USAGE, "%s: %s", path, strerror(errno));
        return NULL;
    }
    FILE *stream = stream_of(descriptor, path);
    if (!stream)
        close(descriptor);
    return stream;
}

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

bool file_is_utf16(const char *text, size_t size, const char *path)
{
    bool is =
        size > 1 && (memcmp(text, "\xff\xfe", 2) == 0 ||
                     memcmp(text, "\xfe\xff", 2) == 0 || !text[0] != !text[1]);
    if (is)
        complain(APP_USAGE, "%s: is in UTF-16; expected a text in UTF-8", path);
    return is;
}

char *file_read(const char *path, size_t *size)
{
    FILE *stream = file_stream(path);
    if (!stream)
        return NULL;
    char *data = read_all(stream, size);
    if (!data) {
        complain(APP_FAILED, "%s: out of memory", path);
    } else if (ferror(stream)) {
        complain(APP_USAGE, "%s: cannot be read: %s", path, strerror(errno));
        free(data);
        data = NULL;
    } else if (file_is_utf16(data, *size, path)) {
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

bool file_is_regular(const char *path)
{
    struct stat status;
    return stat(path, &status) == 0 && S_ISREG(status.st_mode);
}

bool file_join(char path[FILE_PATH], const char *directory, const char *name)
{
    int length = snprintf(path, FILE_PATH, "%s/%s", directory, name);
    if (length > 0 && length < FILE_PATH)
        return true;
    complain(APP_USAGE, "%.60s…: the path is too long", directory);
    return false;
}

/* Creates the temporary file. Its name has this process's id in it, so no other
 * writer uses the same name. A file of a killed process may exist under the
 * name; then the next name is tried. */
static FILE *open_part(struct file *file, const char *directory,
                       const char *name)
{
    for (int k = 0; k < 100; k++) {
        char part[256];
        snprintf(part, sizeof part, ".%.200s.%ld-%d.part", name, (long)getpid(),
                 k);
        if (!file_join(file->part, directory, part))
            return NULL;
        int flags = O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC;
        int descriptor = open(file->part, flags, 0666);
        FILE *stream = descriptor < 0 ? NULL : fdopen(descriptor, "wb");
        if (stream)
            return stream;
        if (descriptor >= 0) {
            close(descriptor);
            remove(file->part);
            errno = ENOMEM;
        }
        if (errno != EEXIST)
            break;
    }
    complain(APP_FAILED, "%s: cannot write: %s", file->path, strerror(errno));
    return NULL;
}

bool file_open(struct file *file, const char *directory, const char *name)
{
    file->stream = NULL;
    if (!file_join(file->path, directory, name))
        return false;
    file->stream = open_part(file, directory, name);
    /* a write that fails before the file is closed leaves its reason in errno
     */
    errno = 0;
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
    int before = errno;
    errno = 0;
    bool good = fflush(file->stream) == 0 && !ferror(file->stream);
    /* the file gets its name only after its data has reached the disk */
    good = good && fsync(fileno(file->stream)) == 0;
    int why = errno || good ? errno : before;
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

/* Makes one folder, whose parent exists. false after one line. */
static bool make_one(const char *path)
{
    if (mkdir(path, 0777) == 0)
        return true;
    int why = errno;
    if (file_is_directory(path))
        return true;
    complain(APP_FAILED, "%s: cannot make this folder: %s", path,
             strerror(why == EEXIST ? ENOTDIR : why));
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
    bool good = true;
    for (char *p = part + 1; *part && *p && good; p++)
        if (*p == '/') {
            *p = 0;
            good = make_one(part);
            *p = '/';
        }
    return good && make_one(part);
}
