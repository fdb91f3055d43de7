/* SPDX-License-Identifier: Apache-2.0 */
/* A PLY file as its header describes it. */
#ifndef APP_READ_PLY_H
#define APP_READ_PLY_H

#include <stdbool.h>
#include <stdint.h>

enum { PROPERTIES = 64, ELEMENTS = 16 };
enum format { FORMATLESS, TEXT, LITTLE, BIG };
struct property {
    char name[32];
    int type, count_type; /* of ply_size; count_type -1: not a list */
};
struct element {
    char name[32];
    int64_t count;
    int properties;
    struct property property[PROPERTIES];
};
struct ply {
    const char *path, *at, *end; /* the unread bytes; *end is 0 */
    enum format format;
    int elements;
    struct element element[ELEMENTS];
    /* Where the body is read, and whether it is wrong there. */
    const struct element *in;
    int64_t item;
    bool wrong;
};

/* The types char, uchar, short, ushort, int, uint, float and double. */
enum { PLY_FLOAT = 6, PLY_TYPES = 8 };

/* Reads up to the line end_header: APP_OK, or APP_USAGE after one line. The
 * vertices then have x, y and z, each once and no list. */
int ply_head(struct ply *r);

#endif
