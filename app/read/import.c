/* SPDX-License-Identifier: Apache-2.0 */
/* Reads meshes by assimp in a child process with limits, which sends the mesh
 * through a pipe: on damaged files assimp may abort, crash, hang or fill the
 * memory. */
#include "app/read/import.h"
#include "app/base/app.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

static const char *const endings[] = {"obj", "stl", "gltf", "glb",
                                      "dae", "fbx", NULL};

bool import_knows(const char *path)
{
    const char *dot = strrchr(path, '.');
    for (int k = 0; dot && endings[k]; k++)
        if (strcasecmp(dot + 1, endings[k]) == 0)
            return true;
    return false;
}

/* Limits of a child: enough for any valid file of this size. */
struct limits {
    double bytes;   /* of memory */
    double seconds; /* of CPU time; of wall time four times that */
};

static struct limits limits_of(const char *path)
{
    struct stat file;
    double size = stat(path, &file) == 0 ? (double)file.st_size : 0;
    return (struct limits){1e9 + 100 * size, 10 + 1e-5 * size};
}

/* Lowers a limit of the process; a limit that is lower already stays. */
static void lower(int resource, double soft, double hard)
{
    struct rlimit limit;
    if (getrlimit(resource, &limit) != 0)
        return;
    if ((double)limit.rlim_max > hard)
        limit.rlim_max = (rlim_t)hard;
    if ((double)limit.rlim_cur > soft)
        limit.rlim_cur = (rlim_t)soft;
    setrlimit(resource, &limit);
}

/* Returns the bytes of address space that the tool uses already, which count
 * for the child too. 0 if the system does not say. */
static double taken(void)
{
    double pages;
    FILE *stream = fopen("/proc/self/statm", "r");
    if (!stream || fscanf(stream, "%lf", &pages) != 1)
        pages = 0;
    if (stream)
        fclose(stream);
    return pages * (double)sysconf(_SC_PAGESIZE);
}

/* The child: sets its limits, silences its output, then reads the file. */
_Noreturn static void be_child(const char *path, const struct clip *clip,
                               struct limits limits, int out)
{
    double bytes = taken() + limits.bytes;
    lower(RLIMIT_CORE, 0, 0);
    lower(RLIMIT_AS, bytes, bytes);
    lower(RLIMIT_CPU, limits.seconds, limits.seconds + 1);
    signal(SIGALRM, SIG_DFL);
    alarm((unsigned)(4 * limits.seconds));
    int nothing = open("/dev/null", O_RDWR);
    for (int k = 0; k <= 2; k++)
        if (nothing < 0 || (k != out && dup2(nothing, k) < 0))
            _exit(1);
    import_child(path, clip ? clip->name : "", out);
}

/* Receives exactly size bytes; false if fewer come. */
static bool receive(int in, void *data, size_t size)
{
    char *at = data;
    while (size) {
        ssize_t got = read(in, at, size);
        if (got < 0 && errno == EINTR)
            continue;
        if (got <= 0)
            return false;
        at += got;
        size -= (size_t)got;
    }
    return true;
}

/* Receives the child's reply, which may be arbitrary bytes. Returns 1 for a
 * mesh or the text of an error, 0 for neither, -1 if memory ran out. */
static int take(struct pool *pool, int in, double most,
                struct import_reply *reply, struct mesh *mesh)
{
    if (!receive(in, reply, sizeof *reply) ||
        memcmp(reply->magic, IMPORT_MAGIC, sizeof reply->magic) != 0)
        return 0;
    reply->error[sizeof reply->error - 1] = 0;
    if (*reply->error)
        return 1;
    /* a child within its limit cannot send more than this */
    if (reply->nv < 0 || reply->nt < 0 || reply->nv > INT32_MAX ||
        reply->nt > INT32_MAX ||
        (double)reply->nv * sizeof *mesh->x +
                (double)reply->nt * sizeof *mesh->tri >
            most)
        return 0;
    size_t nv = (size_t)reply->nv, nt = (size_t)reply->nt;
    mesh->x = pool_take(pool, nv + 1, sizeof *mesh->x);
    mesh->tri = pool_take(pool, nt + 1, sizeof *mesh->tri);
    if (!mesh->x || !mesh->tri)
        return -1;
    mesh->nv = reply->nv;
    mesh->nt = reply->nt;
    return receive(in, mesh->x, nv * sizeof *mesh->x) &&
           receive(in, mesh->tri, nt * sizeof *mesh->tri);
}

/* Receives the frames of the animation. 1, 0 or -1 as take does. */
static int take_frames(struct pool *pool, int in, struct import_reply *reply,
                       const struct mesh *mesh, struct clip *clip)
{
    if (reply->frames < 0 || reply->frames > IMPORT_FRAMES)
        return 0;
    size_t n = (size_t)reply->frames * (size_t)mesh->nv;
    reply->clips[sizeof reply->clips - 1] = 0;
    snprintf(clip->others, sizeof clip->others, "%s",
             reply->several ? reply->clips : "");
    clip->dt = 1.0 / IMPORT_RATE;
    clip->frames = (int)reply->frames;
    clip->x = pool_take(pool, n + 1, sizeof *clip->x);
    return clip->x ? receive(in, clip->x, n * sizeof *clip->x) : -1;
}

/* Prints how a child ended that sent no mesh. */
static int explain(const char *path, struct limits limits, int end)
{
    const char *what = "cannot be read as a mesh: its reader";
    int number = WIFSIGNALED(end) ? WTERMSIG(end) : 0;
    if (number == SIGXCPU || number == SIGALRM)
        return complain(APP_USAGE, "%s: %s took more than %.0f s", path, what,
                        number == SIGALRM ? 4 * limits.seconds
                                          : limits.seconds);
    if (number)
        return complain(APP_USAGE, "%s: %s crashed (signal %d, %s)", path, what,
                        number, strsignal(number));
    return complain(APP_USAGE, "%s: %s ended with exit status %d and no mesh",
                    path, what, WEXITSTATUS(end));
}

static int refuse(const char *path, struct limits limits, const char *error)
{
    if (strstr(error, "bad_alloc"))
        return complain(APP_USAGE,
                        "%s: cannot be read as a mesh: its reader needs more "
                        "than %.0f MB",
                        path, limits.bytes / 1e6);
    return complain(APP_USAGE, "%s: cannot be read as a mesh: %s", path, error);
}

int import_load(struct pool *pool, const char *path, struct clip *clip,
                struct mesh *mesh)
{
    struct limits limits = limits_of(path);
    int way[2], end = 0;
    if (pipe(way) != 0)
        return complain(APP_FAILED, "%s: no pipe to its reader: %s", path,
                        strerror(errno));
    pid_t child = fork();
    if (child == 0) {
        close(way[0]);
        be_child(path, clip, limits, way[1]);
    }
    close(way[1]);
    if (child < 0) {
        close(way[0]);
        return complain(APP_FAILED, "%s: no process to read it: %s", path,
                        strerror(errno));
    }
    struct import_reply reply;
    int got = take(pool, way[0], limits.bytes, &reply, mesh);
    if (got > 0 && clip && !*reply.error)
        got = take_frames(pool, way[0], &reply, mesh, clip);
    close(way[0]);
    if (got < 0)
        kill(child, SIGKILL);
    while (waitpid(child, &end, 0) < 0 && errno == EINTR)
        continue;
    if (got < 0)
        return complain(APP_FAILED, "%s: out of memory", path);
    if (got == 0)
        return explain(path, limits, end);
    return *reply.error ? refuse(path, limits, reply.error) : APP_OK;
}
