/* SPDX-License-Identifier: Apache-2.0 */
/* JSON objects read by tables of keys. */
#include "app/json.h"
#include "app/app.h"
#include "app/file.h"

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
static int read_number(struct json *json, const cJSON *node,
                       const struct json_key *key, double *out)
{
    bool whole = key->type == JSON_INTEGER;
    const char *what = whole ? "a whole number" : "a number";
    if (!cJSON_IsNumber(node))
        return json_refuse(json, "expected %s from %.15g to %.15g", what,
                           key->lo, key->hi);
    double value = node->valuedouble;
    if (!(value >= key->lo && value <= key->hi) ||
        (whole && value != floor(value)))
        return json_refuse(json, "%.15g: expected %s from %.15g to %.15g",
                           value, what, key->lo, key->hi);
    *out = value;
    return APP_OK;
}

static int read_vector(struct json *json, const cJSON *node,
                       const struct json_key *key, double *out)
{
    if (!cJSON_IsArray(node) || cJSON_GetArraySize(node) != key->count)
        return json_refuse(json, "expected a list of %d numbers", key->count);
    int k = 0;
    const cJSON *item;
    cJSON_ArrayForEach(item, node)
    {
        size_t length = json_enter(json, "[%d]", k);
        int status = read_number(json, item, key, &out[k++]);
        if (status != APP_OK)
            return status;
        json_leave(json, length);
    }
    return APP_OK;
}

static int read_choice(struct json *json, const cJSON *node,
                       const struct json_key *key, int *out)
{
    char names[256] = "";
    for (int k = 0; key->choices[k]; k++) {
        size_t length = strlen(names);
        snprintf(names + length, sizeof names - length, "%s\"%s\"",
                 k ? ", " : "", key->choices[k]);
    }
    if (!cJSON_IsString(node))
        return json_refuse(json, "expected one of %s", names);
    *out = json_choice(key->choices, node->valuestring);
    if (*out < 0)
        return json_refuse(json, "\"%s\": expected one of %s",
                           node->valuestring, names);
    return APP_OK;
}

static int read_text(struct json *json, const cJSON *node, char **out)
{
    if (!cJSON_IsString(node) || !node->valuestring[0])
        return json_refuse(json, "expected a text that is not empty");
    *out = pool_text(json->pool, node->valuestring);
    return *out ? APP_OK : complain(APP_FAILED, "out of memory");
}

int json_value(struct json *json, const cJSON *node, const struct json_key *key,
               void *out)
{
    double number = 0;
    switch (key->type) {
    case JSON_NUMBER:
        return read_number(json, node, key, out);
    case JSON_INTEGER: {
        int status = read_number(json, node, key, &number);
        if (status == APP_OK)
            *(int *)out = (int)number;
        return status;
    }
    case JSON_BOOLEAN:
        if (!cJSON_IsBool(node))
            return json_refuse(json, "expected true or false");
        *(int *)out = cJSON_IsTrue(node);
        return APP_OK;
    case JSON_VECTOR:
        return read_vector(json, node, key, out);
    case JSON_CHOICE:
        return read_choice(json, node, key, out);
    case JSON_TEXT:
        return read_text(json, node, out);
    case JSON_NESTED:
        break;
    }
    return key->read(json, node, out);
}

int json_object(struct json *json, const cJSON *node,
                const struct json_key *keys, void *base)
{
    if (!cJSON_IsObject(node))
        return json_refuse(json, "expected an object { … }");
    int status = json_check_keys(json, node, keys);
    for (; status == APP_OK && keys->name; keys++) {
        const cJSON *item = cJSON_GetObjectItemCaseSensitive(node, keys->name);
        if (!item)
            continue;
        size_t length = json_enter(json, ".%s", keys->name);
        status = json_value(json, item, keys, (char *)base + keys->offset);
        if (status == APP_OK)
            json_leave(json, length);
    }
    return status;
}

int json_array(struct json *json, const cJSON *node, struct json_list *list)
{
    int count = cJSON_IsArray(node) ? cJSON_GetArraySize(node) : -1;
    if (count < 0 || count > list->most)
        return json_refuse(json, "expected a list of at most %d", list->most);
    list->items = pool_take(json->pool, (size_t)count + 1, list->size);
    if (!list->items)
        return complain(APP_FAILED, "out of memory");
    list->count = count;
    int k = 0;
    const cJSON *item;
    cJSON_ArrayForEach(item, node)
    {
        size_t length = json_enter(json, "[%d]", k);
        int status = list->read(json, item,
                                (char *)list->items + (size_t)k * list->size);
        if (status != APP_OK)
            return status;
        json_leave(json, length);
        k++;
    }
    return APP_OK;
}

static void write_value(FILE *out, const struct json_key *key, const void *at)
{
    const double *number = at;
    const int *whole = at;
    switch (key->type) {
    case JSON_NUMBER:
        fprintf(out, "%.17g", *number);
        break;
    case JSON_INTEGER:
        fprintf(out, "%d", *whole);
        break;
    case JSON_BOOLEAN:
        fputs(*whole ? "true" : "false", out);
        break;
    case JSON_VECTOR:
        for (int k = 0; k < key->count; k++)
            fprintf(out, "%s%.17g", k ? ", " : "[", number[k]);
        fputc(']', out);
        break;
    case JSON_CHOICE:
        fprintf(out, "\"%s\"", key->choices[*whole]);
        break;
    case JSON_TEXT:
    case JSON_NESTED:
        break;
    }
}

void json_write(FILE *out, const struct json_key *keys, const void *base)
{
    const char *before = "{";
    for (; keys->name; keys++) {
        if (keys->type == JSON_TEXT || keys->type == JSON_NESTED)
            continue;
        fprintf(out, "%s\"%s\": ", before, keys->name);
        write_value(out, keys, (const char *)base + keys->offset);
        before = ", ";
    }
    fputc('}', out);
}

cJSON *json_parse_text(const char *text, size_t size, const char *file)
{
    const char *end = NULL;
    cJSON *root = cJSON_ParseWithOpts(text, &end, 1);
    if (root && strlen(text) == size)
        return root;
    int line = 1;
    for (const char *p = text; p < end; p++)
        line += *p == '\n';
    cJSON_Delete(root);
    if (size == 0)
        complain(APP_USAGE, "%s: empty, where JSON is expected", file);
    else
        complain(APP_USAGE, "%s: line %d: not JSON here", file, line);
    return NULL;
}

cJSON *json_parse(const char *file)
{
    size_t size;
    char *text = file_read(file, &size);
    if (!text)
        return NULL;
    cJSON *root = json_parse_text(text, size, file);
    free(text);
    return root;
}
