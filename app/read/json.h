/* SPDX-License-Identifier: Apache-2.0 */
/* JSON objects read by tables of keys: an unknown key, a wrong type or a number
 * out of its range is refused with its path in the file and what was expected
 * there; a text that is not JSON, or in which an object has a key twice, with
 * its line and column. The JSON itself is jansson's. */
#ifndef APP_READ_JSON_H
#define APP_READ_JSON_H

#include "app/base/pool.h"

#include <jansson.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

struct json {
    const char *file;
    char where[256];   /* the path of the value being read, as $.a[0].b */
    struct pool *pool; /* owns the texts that are read */
    void *user;        /* for the readers of nested values */
    bool foreign;      /* a file of another program, which has keys of its own
                          and writes null for what is absent */
};

enum key_type {
    KEY_NUMBER,  /* double, lo … hi */
    KEY_INTEGER, /* int, lo … hi */
    KEY_BOOLEAN, /* int, 0 or 1 */
    KEY_VECTOR,  /* double[count], each lo … hi */
    KEY_CHOICE,  /* int, index of the text in choices */
    KEY_TEXT,    /* char *, not empty */
    KEY_NESTED   /* any value, read by read() */
};

/* Reads one value to `out`, which is base + offset of the key's row. Returns
 * APP_OK or the exit code. */
typedef int json_reader(struct json *json, json_t *node, void *out);

struct json_key {
    const char *name; /* NULL ends a table */
    enum key_type type;
    size_t offset;
    double lo, hi;
    int count;                  /* of a vector */
    const char *const *choices; /* NULL-terminated */
    json_reader *read;
};

#define NUMBER_KEY(key, at, least, most)                                       \
    {                                                                          \
        .name = key, .type = KEY_NUMBER, .offset = at, .lo = least, .hi = most \
    }
#define INTEGER_KEY(key, at, least, most)                                      \
    {                                                                          \
        .name = key, .type = KEY_INTEGER, .offset = at, .lo = least,           \
        .hi = most                                                             \
    }
#define VECTOR_KEY(key, at, least, most, n)                                    \
    {                                                                          \
        .name = key, .type = KEY_VECTOR, .offset = at, .lo = least,            \
        .hi = most, .count = n                                                 \
    }
#define BOOLEAN_KEY(key, at)                                                   \
    {                                                                          \
        .name = key, .type = KEY_BOOLEAN, .offset = at                         \
    }
#define TEXT_KEY(key, at)                                                      \
    {                                                                          \
        .name = key, .type = KEY_TEXT, .offset = at                            \
    }
#define CHOICE_KEY(key, at, names)                                             \
    {                                                                          \
        .name = key, .type = KEY_CHOICE, .offset = at, .choices = names        \
    }
#define NESTED_KEY(key, at, reader)                                            \
    {                                                                          \
        .name = key, .type = KEY_NESTED, .offset = at, .read = reader          \
    }

/* Reads one value of the key's type and range to `out`. */
int json_value(struct json *json, json_t *node, const struct json_key *key,
               void *out);
/* Reads an object's keys in the table's order; an absent key leaves its field
 * unchanged. Of a foreign file other keys are left alone, and a key that is
 * null is absent. */
int json_fields(struct json *json, json_t *node, const struct json_key *keys,
                void *base);
/* Reads a list of at most `most` items by read(…, items + k·size). The items
 * are zeroed memory of the pool. */
struct json_list {
    json_reader *read;
    size_t size;
    int most;
    void *items; /* out */
    int count;   /* out */
};
int json_items(struct json *json, json_t *node, struct json_list *list);

/* Writes a table's numbers, booleans, vectors and choices as an object. */
void json_write(FILE *out, const struct json_key *keys, const void *base);

/* Returns the index of a text in a NULL-terminated table, or -1. */
int json_choice(const char *const *choices, const char *text);

/* Prints one line "file: path: …" on standard error. Returns APP_USAGE. */
#if defined(__GNUC__)
__attribute__((format(printf, 2, 3)))
#endif
int json_refuse(const struct json *json, const char *format, ...);

/* Prints a note for each of these keys, NULL-terminated, that the object has:
 * it has no effect, and why. */
void json_idle(const struct json *json, json_t *node, const char *const *names,
               const char *why);

/* Checks that each key of the object is in the table; else APP_USAGE. */
int json_check_keys(const struct json *json, json_t *node,
                    const struct json_key *keys);

/* Appends one level to the path; returns the length to cut it back to. */
#if defined(__GNUC__)
__attribute__((format(printf, 2, 3)))
#endif
size_t
json_enter(struct json *json, const char *format, ...);
void json_leave(struct json *json, size_t length);

/* Parses a file. Returns NULL after one line that names file and place. The
 * caller gives the result back by json_decref. */
json_t *json_parse(const char *file);
/* The same of a text of `size` bytes, ended by 0, which messages call `file`.
 */
json_t *json_parse_text(const char *text, size_t size, const char *file);

#endif
