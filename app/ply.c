/* SPDX-License-Identifier: Apache-2.0 */
/* PLY, text or binary of either byte order, in our own reader: it keeps
 * binary64 and the order of vertices, which assimp does not. */
#include "app/app.h"
#include "app/file.h"
#include "app/mesh.h"

#include <stdlib.h>
#include <string.h>

enum { PROPERTIES = 64, ELEMENTS = 16 };
enum format { TEXT, LITTLE, BIG };
struct property {
    char name[32];
    int type, count_type; /* -1: not a list */
};
struct element {
    char name[32];
    int64_t count;
    int properties;
    struct property property[PROPERTIES];
};
struct reader {
    const char *path, *at, *end; /* the unread bytes */
    enum format format;
    int elements;
    struct element element[ELEMENTS];
    bool short_of; /* the file ended, or is no number, where one should be */
};

static const struct {
    const char *name, *other;
    int size;
} types[] = {{"char", "int8", 1},     {"uchar", "uint8", 1},
             {"short", "int16", 2},   {"ushort", "uint16", 2},
             {"int", "int32", 4},     {"uint", "uint32", 4},
             {"float", "float32", 4}, {"double", "float64", 8}};
enum { TYPES = 8 };

static int find_type(const char *name)
{
    for (int k = 0; k < TYPES; k++)
        if (!strcmp(name, types[k].name) || !strcmp(name, types[k].other))
            return k;
    return -1;
}

/* The next binary number as binary64: exact for all types. */
static double read_binary(struct reader *r, int type)
{
    int size = types[type].size;
    if (r->end - r->at < size) {
        r->short_of = true;
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
    if (type >= 6)
        return type == 6 ? (double)single : value;
    bool negative = type % 2 == 0 && bits >> (8 * size - 1);
    return (double)bits - (negative ? (double)((uint64_t)1 << 8 * size) : 0);
}

static double read_number(struct reader *r, int type)
{
    if (r->format != TEXT)
        return read_binary(r, type);
    char *end;
    /* A float's text means the nearest float. The file ends in a zero. */
    double value =
        type == 6 ? (double)strtof(r->at, &end) : strtod(r->at, &end);
    if (end == r->at)
        r->short_of = true;
    r->at = end;
    return value;
}

/* Cuts the next line off the header; false at the end of the file. */
static bool next_line(struct reader *r, char line[256])
{
    const char *stop = memchr(r->at, '\n', (size_t)(r->end - r->at));
    if (!stop)
        return false;
    size_t n = (size_t)(stop - r->at);
    n = n < 255 ? n : 255;
    memcpy(line, r->at, n);
    while (n && line[n - 1] == '\r')
        n--;
    line[n] = 0;
    r->at = stop + 1;
    return true;
}

static bool read_property(struct element *e, const char *line)
{
    if (e->properties == PROPERTIES)
        return false;
    struct property *p = &e->property[e->properties++];
    char a[32], b[32];
    p->count_type = -1;
    if (sscanf(line, "property list %31s %31s %31s", a, b, p->name) == 3) {
        p->count_type = find_type(a);
        p->type = find_type(b);
        return p->count_type >= 0 && p->count_type < 6 && p->type >= 0;
    }
    return sscanf(line, "property %31s %31s", a, p->name) == 2 &&
           (p->type = find_type(a)) >= 0;
}

/* One line of the header; false if it makes no sense. */
static bool read_header_line(struct reader *r, const char *line)
{
    struct element *e = &r->element[r->elements];
    char text[32];
    long long count;
    if (!strncmp(line, "comment", 7) || !strncmp(line, "obj_info", 8))
        return true;
    if (sscanf(line, "format %31s", text) == 1) {
        r->format = !strcmp(text, "ascii")                  ? TEXT
                    : !strcmp(text, "binary_little_endian") ? LITTLE
                                                            : BIG;
        return r->format != BIG || !strcmp(text, "binary_big_endian");
    }
    if (sscanf(line, "element %31s %lld", text, &count) == 2) {
        if (r->elements == ELEMENTS || count < 0 || count > INT32_MAX)
            return false;
        strcpy(e->name, text);
        e->count = count;
        r->elements++;
        return true;
    }
    return r->elements > 0 && read_property(e - 1, line);
}

static int read_header(struct reader *r)
{
    char line[256];
    if (!next_line(r, line) || strcmp(line, "ply") != 0)
        return complain(APP_USAGE, "%s: line 1: expected ply", r->path);
    for (int number = 2; next_line(r, line); number++) {
        if (strcmp(line, "end_header") == 0)
            return APP_OK;
        if (!read_header_line(r, line))
            return complain(APP_USAGE, "%s: line %d: not a PLY header line",
                            r->path, number);
    }
    return complain(APP_USAGE, "%s: expected end_header", r->path);
}

/* The length of a list, 0 where it makes no sense; 1 for a plain property. */
static int read_count(struct reader *r, const struct property *p)
{
    if (p->count_type < 0)
        return 1;
    double count = read_number(r, p->count_type);
    if (count >= 0 && count < INT32_MAX)
        return (int)count;
    r->short_of = true;
    return 0;
}

static void read_vertex(struct reader *r, const struct element *e, double x[3])
{
    for (int k = 0; k < e->properties && !r->short_of; k++) {
        const struct property *p = &e->property[k];
        int count = read_count(r, p);
        for (int j = 0; j < count && !r->short_of; j++) {
            double value = read_number(r, p->type);
            int axis = p->name[0] - 'x';
            if (axis >= 0 && axis < 3 && !p->name[1])
                x[axis] = value;
        }
    }
}

/* A polygon becomes a fan; tri grows to hold it. */
static void read_face(struct reader *r, const struct element *e,
                      struct mesh *mesh, int64_t *room)
{
    for (int k = 0; k < e->properties && !r->short_of; k++) {
        const struct property *p = &e->property[k];
        bool face = !strncmp(p->name, "vertex_ind", 10);
        int count = read_count(r, p);
        int32_t first = 0, last = 0;
        for (int j = 0; j < count && !r->short_of; j++) {
            double value = read_number(r, p->type);
            int32_t index =
                value >= 0 && value < INT32_MAX ? (int32_t)value : -1;
            if (face && j >= 2 && mesh->nt < *room) {
                int32_t *t = mesh->tri[mesh->nt];
                t[0] = first;
                t[1] = last;
                t[2] = index;
            }
            mesh->nt += face && j >= 2;
            first = j ? first : index;
            last = index;
        }
    }
}

/* Reads all elements; triangles beyond `room` are only counted. */
static void read_body(struct reader *r, struct mesh *mesh, int64_t room)
{
    double ignored[3];
    mesh->nt = 0;
    for (int k = 0; k < r->elements; k++) {
        const struct element *e = &r->element[k];
        bool vertex = !strcmp(e->name, "vertex");
        bool face = !strcmp(e->name, "face");
        int64_t count = e->properties ? e->count : 0;
        for (int64_t j = 0; j < count && !r->short_of; j++)
            if (face)
                read_face(r, e, mesh, &room);
            else
                read_vertex(r, e, vertex ? mesh->x[j] : ignored);
    }
}

static int read_mesh(struct pool *pool, struct reader *r, struct mesh *mesh)
{
    int status = read_header(r);
    if (status != APP_OK)
        return status;
    for (int k = 0; k < r->elements; k++) {
        if (strcmp(r->element[k].name, "vertex") != 0)
            continue;
        if (mesh->nv)
            return complain(APP_USAGE, "%s: vertices are there twice", r->path);
        mesh->nv = r->element[k].count;
    }
    /* A vertex takes at least six bytes: a count that lies is caught here. */
    if (mesh->nv > r->end - r->at)
        return complain(APP_USAGE, "%s: ends before its %lld vertices", r->path,
                        (long long)mesh->nv);
    mesh->x = pool_take(pool, (size_t)mesh->nv + 1, sizeof *mesh->x);
    const char *body = r->at;
    if (mesh->x)
        read_body(r, mesh, 0);
    int64_t room = mesh->nt;
    mesh->tri = pool_take(pool, (size_t)room + 1, sizeof *mesh->tri);
    if (!mesh->x || !mesh->tri)
        return complain(APP_FAILED, "%s: out of memory", r->path);
    r->at = body;
    if (!r->short_of)
        read_body(r, mesh, room);
    if (r->short_of)
        return complain(APP_USAGE,
                        "%s: ends, or is not a number, where one "
                        "was expected",
                        r->path);
    return APP_OK;
}

int ply_load(struct pool *pool, const char *path, struct mesh *mesh)
{
    size_t size;
    char *text = file_read(path, &size);
    struct reader *r = calloc(1, sizeof *r);
    int status = APP_USAGE;
    if (text && r) {
        *r = (struct reader){.path = path, .at = text, .end = text + size};
        status = read_mesh(pool, r, mesh);
    }
    free(r);
    free(text);
    return status;
}
