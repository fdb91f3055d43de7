/* SPDX-License-Identifier: Apache-2.0 */
/* JSON objects read by tables of keys. */
#include "app/read/json.h"
#include "app/base/app.h"
#include "app/base/file.h"
#include "app/base/nearest.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int json_choice(const char *const *choices, const char *text)
{
    for (int k = 0; choices[k]; k++)
        if (strcmp(choices[k], text) == 0)
            return k;
    return -1;
}

/* Reads a number in lo … hi; whole: it must have no fraction. */
static int read_number(struct json *json, json_t *node,
                       const struct json_key *key, double *out)
{
    bool whole = key->type == KEY_INTEGER;
    const char *what = whole ? "a whole number" : "a number";
    if (!json_is_number(node))
        return json_refuse(json, "expected %s from %.15g to %.15g", what,
                           key->lo, key->hi);
    double value = json_number_value(node);
    if (!(value >= key->lo && value <= key->hi) ||
        (whole && value != floor(value)))
        return json_refuse(json, "%.15g: expected %s from %.15g to %.15g",
                           value, what, key->lo, key->hi);
    *out = value;
    return APP_OK;
}

static int read_vector(struct json *json, json_t *node,
                       const struct json_key *key, double *out)
{
    if (!json_is_array(node) || json_array_size(node) != (size_t)key->count)
        return json_refuse(json, "expected a list of %d numbers", key->count);
    for (int k = 0; k < key->count; k++) {
        size_t length = json_enter(json, "[%d]", k);
        int status =
            read_number(json, json_array_get(node, (size_t)k), key, &out[k]);
        if (status != APP_OK)
            return status;
        json_leave(json, length);
    }
    return APP_OK;
}

/* The choice that a word of other programs goes by here, or NULL. */
static const char *meant(const char *const *choices, const char *word)
{
    const char *name, *in;
    for (int k = 0; (name = hint_name(word, &k, &in)) != NULL;)
        if (json_choice(choices, name) >= 0)
            return name;
    return NULL;
}

static int read_choice(struct json *json, json_t *node,
                       const struct json_key *key, int *out)
{
    char names[256] = "";
    const char *text = json_is_string(node) ? json_string_value(node) : "";
    struct nearest nearest = {.word = text};
    for (int k = 0; key->choices[k]; k++) {
        size_t length = strlen(names);
        nearest_try(&nearest, key->choices[k]);
        snprintf(names + length, sizeof names - length, "%s\"%s\"",
                 k ? ", " : "", key->choices[k]);
    }
    if (!json_is_string(node))
        return json_refuse(json, "expected one of %s", names);
    *out = json_choice(key->choices, text);
    const char *name = meant(key->choices, text);
    name = name ? name : nearest.name;
    if (*out < 0 && name)
        return json_refuse(json, "\"%s\": did you mean \"%s\"?", text, name);
    if (*out < 0)
        return json_refuse(json, "\"%s\": expected one of %s", text, names);
    return APP_OK;
}

static int read_text(struct json *json, json_t *node, char **out)
{
    if (!json_is_string(node) || !json_string_value(node)[0])
        return json_refuse(json, "expected a text that is not empty");
    *out = pool_text(json->pool, json_string_value(node));
    return *out ? APP_OK : complain(APP_FAILED, "out of memory");
}

int json_value(struct json *json, json_t *node, const struct json_key *key,
               void *out)
{
    double number = 0;
    switch (key->type) {
    case KEY_NUMBER:
        return read_number(json, node, key, out);
    case KEY_INTEGER: {
        int status = read_number(json, node, key, &number);
        if (status == APP_OK)
            *(int *)out = (int)number;
        return status;
    }
    case KEY_BOOLEAN:
        if (!json_is_boolean(node))
            return json_refuse(json, "expected true or false");
        *(int *)out = json_is_true(node);
        return APP_OK;
    case KEY_VECTOR:
        return read_vector(json, node, key, out);
    case KEY_CHOICE:
        return read_choice(json, node, key, out);
    case KEY_TEXT:
        return read_text(json, node, out);
    case KEY_NESTED:
        break;
    }
    return key->read(json, node, out);
}

int json_fields(struct json *json, json_t *node, const struct json_key *keys,
                void *base)
{
    if (!json_is_object(node))
        return json_refuse(json, "expected an object { … }");
    int status = json->foreign ? APP_OK : json_check_keys(json, node, keys);
    for (; status == APP_OK && keys->name; keys++) {
        json_t *item = json_object_get(node, keys->name);
        if (!item || (json->foreign && json_is_null(item)))
            continue;
        size_t length = json_enter(json, ".%s", keys->name);
        status = json_value(json, item, keys, (char *)base + keys->offset);
        if (status == APP_OK)
            json_leave(json, length);
    }
    return status;
}

int json_items(struct json *json, json_t *node, struct json_list *list)
{
    size_t count = json_array_size(node), k;
    if (!json_is_array(node) || count > (size_t)list->most)
        return json_refuse(json, "expected a list of at most %d", list->most);
    list->items = pool_take(json->pool, count + 1, list->size);
    if (!list->items)
        return complain(APP_FAILED, "out of memory");
    list->count = (int)count;
    json_t *item;
    json_array_foreach(node, k, item)
    {
        size_t length = json_enter(json, "[%d]", (int)k);
        int status =
            list->read(json, item, (char *)list->items + k * list->size);
        if (status != APP_OK)
            return status;
        json_leave(json, length);
    }
    return APP_OK;
}

static void write_value(FILE *out, const struct json_key *key, const void *at)
{
    const double *number = at;
    const int *whole = at;
    switch (key->type) {
    case KEY_NUMBER:
        fprintf(out, "%.17g", *number);
        break;
    case KEY_INTEGER:
        fprintf(out, "%d", *whole);
        break;
    case KEY_BOOLEAN:
        fputs(*whole ? "true" : "false", out);
        break;
    case KEY_VECTOR:
        for (int k = 0; k < key->count; k++)
            fprintf(out, "%s%.17g", k ? ", " : "[", number[k]);
        fputc(']', out);
        break;
    case KEY_CHOICE:
        fprintf(out, "\"%s\"", key->choices[*whole]);
        break;
    case KEY_TEXT:
    case KEY_NESTED:
        break;
    }
}

void json_write(FILE *out, const struct json_key *keys, const void *base)
{
    const char *before = "{";
    for (; keys->name; keys++) {
        if (keys->type == KEY_TEXT || keys->type == KEY_NESTED)
            continue;
        fprintf(out, "%s\"%s\": ", before, keys->name);
        write_value(out, keys, (const char *)base + keys->offset);
        before = ", ";
    }
    fputc('}', out);
}

/* Why a text cannot be JSON, whatever it holds; NULL: it can. */
static const char *is_foreign(const char *text, size_t size)
{
    if (size == 0)
        return "empty, where JSON is expected";
    if (strncmp(text, "#usda", 5) == 0 || strncmp(text, "PXR-USDC", 8) == 0)
        return "is a USD file, which drape writes (drape export) and cannot "
               "read yet (spec/limits.md); expected JSON";
    return NULL;
}

json_t *json_parse_text(const char *text, size_t size, const char *file)
{
    static const char mark[] =
        "\xef\xbb\xbf"; /* of UTF-8, which may begin it */
    const char *foreign = is_foreign(text, size);
    json_error_t error;
    if (file_is_utf16(text, size, file))
        return NULL;
    if (foreign) {
        complain(APP_USAGE, "%s: %s", file, foreign);
        return NULL;
    }
    size_t skipped = strncmp(text, mark, 3) == 0 ? 3 : 0;
    json_t *root = json_loadb(text + skipped, size - skipped,
                              JSON_REJECT_DUPLICATES | JSON_DECODE_ANY |
                                  JSON_DECODE_INT_AS_REAL,
                              &error);
    if (!root && json_error_code(&error) == json_error_out_of_memory)
        complain(APP_FAILED, "out of memory");
    else if (!root)
        complain(APP_USAGE, "%s: line %d, column %d: %s", file, error.line,
                 error.column, error.text);
    return root;
}

json_t *json_parse(const char *file)
{
    size_t size;
    char *text = file_read(file, &size);
    if (!text)
        return NULL;
    json_t *root = json_parse_text(text, size, file);
    free(text);
    return root;
}
