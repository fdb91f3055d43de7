/* SPDX-License-Identifier: Apache-2.0 */
/* Reads the header of a PLY file. */
#include "app/base/app.h"
#include "app/read/ply.h"

#include <stdio.h>
#include <string.h>

static const char *const types[PLY_TYPES][2] = {
    {"char", "int8"},     {"uchar", "uint8"},   {"short", "int16"},
    {"ushort", "uint16"}, {"int", "int32"},     {"uint", "uint32"},
    {"float", "float32"}, {"double", "float64"}};

static int find_type(const char *name)
{
    for (int k = 0; k < PLY_TYPES; k++)
        if (!strcmp(name, types[k][0]) || !strcmp(name, types[k][1]))
            return k;
    return -1;
}

/* Reads the next line of the header; false at the end of the file. */
static bool next_line(struct ply *r, char line[256])
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
        return p->count_type >= 0 && p->count_type < PLY_FLOAT && p->type >= 0;
    }
    return sscanf(line, "property %31s %31s", a, p->name) == 2 &&
           (p->type = find_type(a)) >= 0;
}

/* Reads one line of the header; false if it is invalid. */
static bool read_header_line(struct ply *r, const char *line)
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

/* Whether vertices have this coordinate exactly once, as a plain number. */
static bool has_axis(const struct element *e, const char *axis)
{
    int count = 0;
    for (int k = 0; k < e->properties; k++)
        if (strcmp(e->property[k].name, axis) == 0)
            count += e->property[k].count_type < 0 ? 1 : 2;
    return count == 1;
}

/* Checks the whole header after reading. */
static int check_head(const struct ply *r)
{
    int vertices = 0;
    if (r->format == FORMATLESS)
        return complain(APP_USAGE, "%s: expected a line format in the header",
                        r->path);
    for (int k = 0; k < r->elements; k++) {
        const struct element *e = &r->element[k];
        if (strcmp(e->name, "vertex") != 0)
            continue;
        vertices++;
        if (!has_axis(e, "x") || !has_axis(e, "y") || !has_axis(e, "z"))
            return complain(APP_USAGE,
                            "%s: expected vertices with properties x, y and "
                            "z, each once and no list",
                            r->path);
    }
    if (vertices != 1)
        return complain(APP_USAGE, "%s: expected one element vertex, found %d",
                        r->path, vertices);
    return APP_OK;
}

int ply_head(struct ply *r)
{
    char line[256];
    if (!next_line(r, line) || strcmp(line, "ply") != 0)
        return complain(APP_USAGE, "%s: line 1: expected ply", r->path);
    for (int number = 2; next_line(r, line); number++) {
        if (strcmp(line, "end_header") == 0)
            return check_head(r);
        if (!read_header_line(r, line))
            return complain(APP_USAGE, "%s: line %d: not a PLY header line",
                            r->path, number);
    }
    return complain(APP_USAGE, "%s: expected end_header", r->path);
}
