/* SPDX-License-Identifier: Apache-2.0 */
/* JSON objects read by tables of keys: an unknown or repeated key, a wrong
 * type or a number out of its range is refused with its place in the file
 * and what was expected there. */
#ifndef APP_JSON_H
#define APP_JSON_H

#include "app/pool.h"

#include <cjson/cJSON.h>
#include <stddef.h>
#include <stdio.h>

struct json {
    const char *file;
    char where[256];   /* the path of the value being read, as $.a[0].b */
    struct pool *pool; /* owns the texts that are read */
    void *user;        /* for the readers of nested values */
};

enum json_type {
    JSON_NUMBER,  /* double, lo … hi */
    JSON_INTEGER, /* int, lo … hi */
    JSON_BOOLEAN, /* int, 0 or 1 */
    JSON_VECTOR,  /* double[count], each lo … hi */
    JSON_CHOICE,  /* int, index of the text in choices */
    JSON_TEXT,    /* char *, not empty */
    JSON_NESTED   /* any value, read by read() */
};

/* Reads one value to `out`, which is base + offset of the key's row. Returns
 * APP_OK or the exit code. */
typedef int json_reader(struct json *json, const cJSON *node, void *out);

struct json_key {
    const char *name; /* NULL ends a table */
    enum json_type type;
    size_t offset;
    double lo, hi;
    int count;                  /* of a vector */
    const char *const *choices; /* NULL-terminated */
    json_reader *read;
};

#define NUMBER_KEY(key, at, least, most)                                       \
    {                                                                          \
        .name = key, .type = JSON_NUMBER, .offset = at, .lo = least,           \
        .hi = most                                                             \
    }
#define INTEGER_KEY(key, at, least, most)                                      \
    {                                                                          \
        .name = key, .type = JSON_INTEGER, .offset = at, .lo = least,          \
        .hi = most                                                             \
    }
#define VECTOR_KEY(key, at, least, most, n)                                    \
    {                                                                          \
        .name = key, .type = JSON_VECTOR, .offset = at, .lo = least,           \
        .hi = most, .count = n                                                 \
    }
#define BOOLEAN_KEY(key, at)                                                   \
    {                                                                          \
        .name = key, .type = JSON_BOOLEAN, .offset = at                        \
    }
#define TEXT_KEY(key, at)                                                      \
    {                                                                          \
        .name = key, .type = JSON_TEXT, .offset = at                           \
    }
#define CHOICE_KEY(key, at, names)                                             \
    {                                                                          \
        .name = key, .type = JSON_CHOICE, .offset = at, .choices = names       \
    }
#define NESTED_KEY(key, at, reader)                                            \
    {                                                                          \
        .name = key, .type = JSON_NESTED, .offset = at, .read = reader         \
    }

/* Reads one value of the key's type and range to `out`. */
int json_value(struct json *json, const cJSON *node, const struct json_key *key,
               void *out);
/* Reads an object's keys in the table's order; an absent key leaves its field
 * unchanged. */
int json_object(struct json *json, const cJSON *node,
                const struct json_key *keys, void *base);
/* Reads a list of at most `most` items by read(…, items + k·size). The items
 * are zeroed memory of the pool. */
struct json_list {
    json_reader *read;
    size_t size;
    int most;
    void *items; /* out */
    int count;   /* out */
};
int json_array(struct json *json, const cJSON *node, struct json_list *list);

/* Writes a table's numbers, booleans, vectors and choices as an object. */
void json_write(FILE *out, const struct json_key *keys, const void *base);

/* Returns the index of a text in a NULL-terminated table, or -1. */
int json_choice(const char *const *choices, const char *text);

/* Prints one line "file: path: …" on standard error. Returns APP_USAGE. */
#if defined(__GNUC__)
__attribute__((format(printf, 2, 3)))
#endif
int json_refuse(const struct json *json, const char *format, ...);

/* Checks that each key of the object is in the table and occurs once; else
 * APP_USAGE. */
int json_check_keys(const struct json *json, const cJSON *node,
                    const struct json_key *keys);

/* Appends one level to the path; returns the length to cut it back to. */
#if defined(__GNUC__)
__attribute__((format(printf, 2, 3)))
#endif
size_t
json_enter(struct json *json, const char *format, ...);
void json_leave(struct json *json, size_t length);

/* Parses a file. Returns NULL after one line that names file and line. The
 * caller deletes the result with cJSON_Delete. */
cJSON *json_parse(const char *file);
/* The same of a text of `size` bytes, ended by 0, which messages call `file`.
 */
cJSON *json_parse_text(const char *text, size_t size, const char *file);

#endif
