/* SPDX-License-Identifier: Apache-2.0 */
/* A lock on a folder: one run at a time may write there. */
#include "app/write/lock.h"
#include "app/base/app.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static const char name[] = ".drape.lock";

/* Whether the path still names the open file. A process that releases a lock
 * removes the lock's file, and a lock on a removed file excludes nobody. */
static bool is_named(int descriptor, const char *path)
{
    struct stat mine, named;
    return fstat(descriptor, &mine) == 0 && stat(path, &named) == 0 &&
           mine.st_dev == named.st_dev && mine.st_ino == named.st_ino;
}

static int refuse(const char *path, int why)
{
    if (why == EACCES || why == EAGAIN)
        return complain(APP_USAGE,
                        "%s: another run is writing into this folder", path);
    return complain(APP_FAILED, "%s: cannot be locked: %s", path,
                    strerror(why));
}

int lock_is_free(const char *path)
{
    struct flock whole = {.l_type = F_WRLCK, .l_whence = SEEK_SET};
    char file[FILE_PATH];
    if (!file_join(file, path, name))
        return APP_USAGE;
    int descriptor = open(file, O_RDWR | O_CLOEXEC);
    if (descriptor < 0)
        return APP_OK;
    bool held =
        fcntl(descriptor, F_GETLK, &whole) == 0 && whole.l_type != F_UNLCK;
    close(descriptor);
    return held ? refuse(path, EAGAIN) : APP_OK;
}

int lock_take(struct lock *l, const char *path)
{
    if (!file_join(l->file, path, name))
        return APP_USAGE;
    if (!file_make_directory(path))
        return APP_FAILED;
    while (!l->held) {
        struct flock whole = {.l_type = F_WRLCK, .l_whence = SEEK_SET};
        l->descriptor = open(l->file, O_RDWR | O_CREAT | O_CLOEXEC, 0666);
        if (l->descriptor < 0)
            return complain(APP_FAILED, "%s: cannot write here: %s", path,
                            strerror(errno));
        if (fcntl(l->descriptor, F_SETLK, &whole) != 0) {
            int why = errno;
            close(l->descriptor);
            return refuse(path, why);
        }
        l->held = is_named(l->descriptor, l->file);
        if (!l->held)
            close(l->descriptor);
    }
    return APP_OK;
}

void lock_release(struct lock *l)
{
    if (!l->held)
        return;
    remove(l->file);
    close(l->descriptor);
    l->held = false;
}
