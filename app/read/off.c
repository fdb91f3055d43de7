/* SPDX-License-Identifier: Apache-2.0 */
/* Reads OFF text files. This is a reader of our own, since assimp replaces an
 * index out of range by the last vertex, and aborts if faces are missing. */
#include "app/base/app.h"
#include "app/base/file.h"
#include "app/read/mesh.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The lines of the file without blank lines and comments. */
struct lines {
    const char *path;
    char *at, *end; /* the unread bytes; *end is 0 */
    long number;    /* of the line read last */
};

static int refuse(const struct lines *in, const char *what)
{
    return complain(APP_USAGE, "%s: line %ld: %s", in->path, in->number, what);
}

/* Returns the next line that is neither blank nor a comment; NULL at the end of
 * the file. */
static char *next_line(struct lines *in)
{
    while (in->at < in->end) {
        char *line = in->at;
        char *stop = memchr(line, '\n', (size_t)(in->end - line));
        in->at = stop ? stop + 1 : in->end;
        in->number++;
        if (stop)
            *stop = 0;
        line[strcspn(line, "#\r")] = 0;
        line += strspn(line, " \t");
        if (*line)
            return line;
    }
    return NULL;
}

/* Reads the next number of the line; NaN if there is none. */
static double next_number(char **line)
{
    char *end;
    double value = strtod(*line, &end);
    bool ended = *end == 0 || *end == ' ' || *end == '\t';
    if (end == *line || !ended)
        return NAN;
    *line = end;
    return value;
}

/* Reads an integer from 0 to most; -1 if there is none. */
static int64_t next_whole(char **line, int64_t most)
{
    double value = next_number(line);
    if (!(value >= 0 && value <= (double)most) || value != floor(value))
        return -1;
    return (int64_t)value;
}

/* OFF, with vertices' normals, colours or texture before it, and the counts
 * of vertices, faces and, perhaps, edges on the same line or the next. */
static int read_head(struct lines *in, int64_t *nv, int64_t *faces)
{
    char *line = next_line(in);
    if (line) {
        line += strncmp(line, "ST", 2) == 0 ? 2 : 0;
        line += *line == 'C';
        line += *line == 'N';
    }
    if (!line || strncmp(line, "OFF", 3) != 0)
        return refuse(in, "expected OFF");
    line += 3;
    line += strspn(line, " \t");
    if (!*line)
        line = next_line(in);
    *nv = line ? next_whole(&line, INT32_MAX) : -1;
    *faces = line ? next_whole(&line, INT32_MAX) : -1;
    if (*nv < 0 || *faces < 0)
        return refuse(in, "expected the numbers of vertices and faces");
    /* each vertex and each face takes bytes, so a false count is found here */
    if (*nv > in->end - in->at || *faces > in->end - in->at)
        return refuse(in, "more vertices and faces than the file has bytes");
    return APP_OK;
}

static int read_vertices(struct lines *in, struct mesh *mesh)
{
    for (int64_t k = 0; k < mesh->nv; k++) {
        char *line = next_line(in);
        if (!line)
            return refuse(in, "the file ends; expected a vertex");
        for (int i = 0; i < 3; i++) {
            mesh->x[k][i] = next_number(&line);
            if (!(fabs(mesh->x[k][i]) <= 0x1p60))
                return refuse(in, "expected three coordinates, |x| ≤ 2^60");
        }
    }
    return APP_OK;
}

/* Reads a polygon as a fan of triangles. Triangles beyond `room` are only
 * counted. */
static int read_face(struct lines *in, struct mesh *mesh, int64_t room)
{
    char *line = next_line(in);
    int64_t count = line ? next_whole(&line, INT32_MAX) : -1;
    int32_t ends[2]; /* its first vertex and the last one read */
    if (count < 0)
        return refuse(in, line ? "expected a face's number of vertices"
                               : "the file ends; expected a face");
    for (int64_t j = 0; j < count; j++) {
        int64_t index = next_whole(&line, mesh->nv - 1);
        if (index < 0)
            return complain(APP_USAGE,
                            "%s: line %ld: expected a face of %lld vertices, "
                            "each a whole number from 0 to %lld",
                            in->path, in->number, (long long)count,
                            (long long)mesh->nv - 1);
        if (j >= 2 && mesh->nt < room) {
            int32_t *t = mesh->tri[mesh->nt];
            t[0] = ends[0];
            t[1] = ends[1];
            t[2] = (int32_t)index;
        }
        mesh->nt += j >= 2;
        ends[j > 0] = (int32_t)index;
    }
    return APP_OK;
}

static int read_faces(struct lines *in, struct mesh *mesh, int64_t faces,
                      int64_t room)
{
    int status = APP_OK;
    mesh->nt = 0;
    for (int64_t k = 0; k < faces && status == APP_OK; k++)
        status = read_face(in, mesh, room);
    if (status == APP_OK && next_line(in))
        return refuse(in, "more lines than vertices and faces");
    return status;
}

static int read_mesh(struct pool *pool, struct lines *in, struct mesh *mesh)
{
    int64_t faces = 0;
    int status = read_head(in, &mesh->nv, &faces);
    if (status != APP_OK)
        return status;
    mesh->x = pool_take(pool, (size_t)mesh->nv + 1, sizeof *mesh->x);
    if (!mesh->x)
        return complain(APP_FAILED, "%s: out of memory", in->path);
    status = read_vertices(in, mesh);
    if (status != APP_OK)
        return status;
    /* reading cuts the lines, so the second pass needs a copy */
    size_t rest = (size_t)(in->end - in->at);
    char *again = pool_take(pool, rest + 1, 1);
    if (!again)
        return complain(APP_FAILED, "%s: out of memory", in->path);
    memcpy(again, in->at, rest);
    status = read_faces(in, mesh, faces, 0);
    if (status != APP_OK)
        return status;
    int64_t room = mesh->nt;
    mesh->tri = pool_take(pool, (size_t)room + 1, sizeof *mesh->tri);
    if (!mesh->tri)
        return complain(APP_FAILED, "%s: out of memory", in->path);
    in->at = again;
    in->end = again + rest;
    return read_faces(in, mesh, faces, room);
}

int off_load(struct pool *pool, const char *path, struct mesh *mesh)
{
    size_t size;
    char *text = file_read(path, &size);
    if (!text)
        return APP_USAGE;
    struct lines in = {.path = path, .at = text, .end = text + size};
    int status = read_mesh(pool, &in, mesh);
    free(text);
    return status;
}
