/* SPDX-License-Identifier: Apache-2.0 */
/* Reads PLY files, text or binary in either byte order. This is a reader of our
 * own, since assimp keeps neither binary64 nor the order of vertices. */
#include "app/read/ply.h"
#include "app/base/app.h"
#include "app/base/file.h"
#include "app/read/mesh.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const int sizes[PLY_TYPES] = {1, 1, 2, 2, 4, 4, 4, 8};

/* Records the first fault of the item that is being read. */
static void lacks_number(struct ply *r)
{
    if (!r->wrong)
        complain(APP_USAGE,
                 "%s: %s %lld: the file ends, or is not a number, where one "
                 "was expected",
                 r->path, r->in->name, (long long)r->item);
    r->wrong = true;
}

/* Reads the next binary number as binary64, exactly for all types. */
static double read_binary(struct ply *r, int type)
{
    int size = sizes[type];
    if (r->end - r->at < size) {
        lacks_number(r);
        return 0;
    }
    uint64_t bits = 0;
    for (int k = 0; k < size; k++) {
        int place = r->format == LITTLE ? k : size - 1 - k;
        bits |= (uint64_t)(unsigned char)r->at[k] << 8 * place;
    }
    r->at += size;
    uint32_t half = (uint32_t)bits;
    float single;
    double value;
    memcpy(&single, &half, sizeof single);
    memcpy(&value, &bits, sizeof value);
    if (type >= PLY_FLOAT)
        return type == PLY_FLOAT ? (double)single : value;
    bool negative = type % 2 == 0 && bits >> (8 * size - 1);
    return (double)bits - (negative ? (double)((uint64_t)1 << 8 * size) : 0);
}

static double read_number(struct ply *r, int type)
{
    if (r->format != TEXT)
        return read_binary(r, type);
    char *end;
    /* the text of a float means the nearest float; a zero ends the bytes */
    double value =
        type == PLY_FLOAT ? (double)strtof(r->at, &end) : strtod(r->at, &end);
    if (end == r->at)
        lacks_number(r);
    r->at = end;
    return value;
}

/* Reads the length of a list, 0 if it is invalid; 1 for a plain property. */
static int read_count(struct ply *r, const struct property *p)
{
    static const double most[PLY_FLOAT] = {127,   255,        32767,
                                           65535, 2147483646, 2147483646};
    if (p->count_type < 0)
        return 1;
    double count = read_number(r, p->count_type);
    if (count >= 0 && count <= most[p->count_type] && count == floor(count))
        return (int)count;
    if (!r->wrong)
        complain(APP_USAGE,
                 "%s: %s %lld: %.15g: expected the length of a list, a whole "
                 "number from 0 to %.0f",
                 r->path, r->in->name, (long long)r->item, count,
                 most[p->count_type]);
    r->wrong = true;
    return 0;
}

static void read_vertex(struct ply *r, const struct element *e, double x[3])
{
    for (int k = 0; k < e->properties && !r->wrong; k++) {
        const struct property *p = &e->property[k];
        int count = read_count(r, p);
        for (int j = 0; j < count && !r->wrong; j++) {
            double value = read_number(r, p->type);
            int axis = p->name[0] - 'x';
            if (axis >= 0 && axis < 3 && !p->name[1])
                x[axis] = value;
        }
    }
}

/* Reads the index of a vertex; 0 if it is invalid. */
static int32_t read_index(struct ply *r, const struct property *p,
                          const struct mesh *mesh)
{
    double value = read_number(r, p->type);
    if (value >= 0 && value < (double)mesh->nv && value == floor(value))
        return (int32_t)value;
    if (!r->wrong)
        complain(APP_USAGE,
                 "%s: face %lld: vertex %.15g: expected a whole number from 0 "
                 "to %lld",
                 r->path, (long long)r->item, value, (long long)mesh->nv - 1);
    r->wrong = true;
    return 0;
}

/* Reads a polygon as a fan of triangles. Triangles beyond `room` are only
 * counted. */
static void read_polygon(struct ply *r, const struct property *p,
                         struct mesh *mesh, int64_t room)
{
    int count = read_count(r, p);
    int32_t ends[2]; /* its first vertex and the last one read */
    for (int j = 0; j < count && !r->wrong; j++) {
        int32_t index = read_index(r, p, mesh);
        if (j >= 2 && mesh->nt < room) {
            int32_t *t = mesh->tri[mesh->nt];
            t[0] = ends[0];
            t[1] = ends[1];
            t[2] = index;
        }
        mesh->nt += j >= 2;
        ends[j > 0] = index;
    }
}

static void read_face(struct ply *r, const struct element *e, struct mesh *mesh,
                      int64_t room)
{
    for (int k = 0; k < e->properties && !r->wrong; k++) {
        const struct property *p = &e->property[k];
        if (strncmp(p->name, "vertex_ind", 10) == 0) {
            read_polygon(r, p, mesh, room);
            continue;
        }
        int count = read_count(r, p);
        for (int j = 0; j < count && !r->wrong; j++)
            read_number(r, p->type);
    }
}

/* Checks that only white space follows; else the header's counts are wrong. */
static void check_end(struct ply *r)
{
    const char *at = r->at;
    while (at < r->end && (*at == ' ' || (*at >= '\t' && *at <= '\r')))
        at++;
    if (r->wrong || at == r->end)
        return;
    complain(APP_USAGE, "%s: goes on behind what its header counts", r->path);
    r->wrong = true;
}

/* Reads all elements; triangles beyond `room` are only counted. */
static void read_body(struct ply *r, struct mesh *mesh, int64_t room)
{
    double ignored[3];
    mesh->nt = 0;
    for (int k = 0; k < r->elements; k++) {
        const struct element *e = r->in = &r->element[k];
        bool vertex = !strcmp(e->name, "vertex");
        bool face = !strcmp(e->name, "face");
        int64_t count = e->properties ? e->count : 0;
        for (r->item = 0; r->item < count && !r->wrong; r->item++)
            if (face)
                read_face(r, e, mesh, room);
            else
                read_vertex(r, e, vertex ? mesh->x[r->item] : ignored);
    }
    check_end(r);
}

static int read_mesh(struct pool *pool, struct ply *r, struct mesh *mesh)
{
    int status = ply_head(r);
    if (status != APP_OK)
        return status;
    for (int k = 0; k < r->elements; k++)
        if (strcmp(r->element[k].name, "vertex") == 0)
            mesh->nv = r->element[k].count;
    /* a vertex takes at least three bytes, so a false count is found here */
    if (mesh->nv > r->end - r->at)
        return complain(APP_USAGE, "%s: ends before its %lld vertices", r->path,
                        (long long)mesh->nv);
    mesh->x = pool_take(pool, (size_t)mesh->nv + 1, sizeof *mesh->x);
    if (!mesh->x)
        return complain(APP_FAILED, "%s: out of memory", r->path);
    const char *body = r->at;
    read_body(r, mesh, 0);
    if (r->wrong)
        return APP_USAGE;
    int64_t room = mesh->nt;
    mesh->tri = pool_take(pool, (size_t)room + 1, sizeof *mesh->tri);
    if (!mesh->tri)
        return complain(APP_FAILED, "%s: out of memory", r->path);
    r->at = body;
    read_body(r, mesh, room);
    return APP_OK;
}

int ply_load(struct pool *pool, const char *path, struct mesh *mesh)
{
    size_t size;
    char *text = file_read(path, &size);
    struct ply *r = calloc(1, sizeof *r);
    int status = text ? APP_FAILED : APP_USAGE;
    if (text && r) {
        *r = (struct ply){.path = path, .at = text, .end = text + size};
        status = read_mesh(pool, r, mesh);
    } else if (text) {
        complain(APP_FAILED, "%s: out of memory", path);
    }
    free(r);
    free(text);
    return status;
}
