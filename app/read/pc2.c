/* SPDX-License-Identifier: Apache-2.0 */
/* Reads point caches (.pc2): the places of a mesh's vertices, frame by frame,
 * as Blender, 3ds Max and drape itself write them. */
#include "app/base/app.h"
#include "app/base/file.h"
#include "app/read/mesh.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { HEAD = 32, POINT = 12, FRAMES = 1 << 24 };

static uint32_t read_word(const char *at)
{
    const unsigned char *b = (const unsigned char *)at;
    return (uint32_t)b[0] | (uint32_t)b[1] << 8 | (uint32_t)b[2] << 16 |
           (uint32_t)b[3] << 24;
}

static double read_float(const char *at)
{
    uint32_t bits = read_word(at);
    float value;
    memcpy(&value, &bits, sizeof value);
    return (double)value;
}

/* Checks what the head says against the mesh and the size of the file. */
static int check_head(const char *path, const char *head, size_t size,
                      int64_t nv)
{
    if (size < HEAD || memcmp(head, "POINTCACHE2", 12) != 0 ||
        read_word(head + 12) != 1)
        return complain(APP_USAGE, "%s: not a point cache of version 1 (.pc2)",
                        path);
    uint32_t points = read_word(head + 16), frames = read_word(head + 28);
    double rate = read_float(head + 24);
    if (points != (uint64_t)nv)
        return complain(APP_USAGE, "%s: has %lu vertices, its mesh %lld", path,
                        (unsigned long)points, (long long)nv);
    if (frames < 1 || frames > FRAMES)
        return complain(APP_USAGE, "%s: has %lu frames, expected 1 to 2^24",
                        path, (unsigned long)frames);
    if (!(rate > 0 && rate <= 1e6))
        return complain(APP_USAGE,
                        "%s: its frames are %g apart, expected above 0", path,
                        rate);
    uint64_t bytes = (uint64_t)POINT * points * frames;
    if (size - HEAD != bytes)
        return complain(
            APP_USAGE,
            "%s: %llu bytes of frames, expected %llu for %lu frames "
            "of %lu vertices",
            path, (unsigned long long)(size - HEAD), (unsigned long long)bytes,
            (unsigned long)frames, (unsigned long)points);
    return APP_OK;
}

static int read_frames(struct pool *pool, const char *path, const char *data,
                       int64_t nv, int room, struct clip *clip)
{
    int frames = (int)read_word(data + 28);
    clip->frames = room + frames;
    clip->dt = read_float(data + 24);
    clip->x = pool_take(pool, (size_t)(clip->frames * nv), sizeof *clip->x);
    if (!clip->x)
        return complain(APP_FAILED, "%s: out of memory", path);
    int64_t n = frames * nv;
    double(*x)[3] = clip->x + room * nv;
    for (int64_t k = 0; k < 3 * n; k++) {
        double a = read_float(data + HEAD + 4 * k);
        if (!(fabs(a) <= 0x1p60))
            return complain(APP_USAGE,
                            "%s: frame %lld, vertex %lld: a coordinate is not "
                            "finite or beyond 2^60",
                            path, (long long)(k / 3 / nv),
                            (long long)(k / 3 % nv));
        x[k / 3][k % 3] = a;
    }
    return APP_OK;
}

int pc2_load(struct pool *pool, const char *path, int64_t nv, int room,
             struct clip *clip)
{
    size_t size;
    char *data = file_read(path, &size);
    if (!data)
        return APP_USAGE;
    int status = check_head(path, data, size, nv);
    if (status == APP_OK)
        status = read_frames(pool, path, data, nv, room, clip);
    free(data);
    return status;
}
