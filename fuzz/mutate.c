/* SPDX-License-Identifier: Apache-2.0 */
/* Mutates JSON so that it stays JSON: numbers become limits; parts are removed,
 * doubled, exchanged or get another key. The words are those of
 * app/scenes/README.md. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cjson/cJSON.h>

#include "fuzz/damage.h"
#include "fuzz/files.h"

static const char *const words[] = {
#include "words.h"
};
enum { WORDS = sizeof words / sizeof *words };

/* Returns part k of the tree in the order of its text. *k counts down; with *k
 * = -1 all parts are counted. */
static cJSON *find(cJSON *node, long *k)
{
    if ((*k)-- == 0)
        return node;
    for (cJSON *item = node->child; item; item = item->next) {
        cJSON *found = find(item, k);
        if (found)
            return found;
    }
    return NULL;
}

static cJSON *any_part(struct bytes *b, cJSON *root)
{
    long all = -1, k;
    find(root, &all); /* counts down from -1 */
    k = (long)pick(b, (uint32_t)(-1 - all));
    return find(root, &k);
}

static void set_number(struct bytes *b, cJSON *node)
{
    static const double some[] = {0,     1,    -1,    2,    0.5,  1e-6,  1e-9,
                                  1e-30, 1e6,  1e9,   1e18, 3,    4,     8,
                                  32,    64,   0.001, 1e4,  -1e6, 1e300, 360,
                                  90,    0.02, 0.1,   33,   5,    1e-4,  16};
    double value = some[pick(b, sizeof some / sizeof *some)];
    switch (pick(b, 6)) {
    case 0:
        value = node->valuedouble * (pick(b, 2) ? 2 : 0.5);
        break;
    case 1:
        value = node->valuedouble + (pick(b, 2) ? 1 : -1);
        break;
    case 2:
        value = draw_any(b);
        break;
    case 3:
        value = -node->valuedouble;
        break;
    default:
        break;
    }
    if (cJSON_IsNumber(node))
        cJSON_SetNumberValue(node, value);
}

static cJSON *any_value(struct bytes *b)
{
    switch (pick(b, 6)) {
    case 0:
        return cJSON_CreateString(words[pick(b, WORDS)]);
    case 1:
        return cJSON_CreateBool((int)pick(b, 2));
    case 2:
        return cJSON_CreateArray();
    case 3:
        return cJSON_CreateObject();
    case 4:
        return cJSON_CreateNull();
    default:
        return cJSON_CreateNumber(draw_any(b));
    }
}

static void set_text(struct bytes *b, cJSON *node)
{
    if (cJSON_IsString(node))
        cJSON_SetValuestring(node, words[pick(b, WORDS)]);
}

/* Gives a part of an object another key. */
static void rename_part(struct bytes *b, cJSON *node)
{
    const char *word = words[pick(b, WORDS)];
    size_t size = strlen(word) + 1;
    char *name = node->string ? cJSON_malloc(size) : NULL;
    if (!name)
        return;
    memcpy(name, word, size);
    cJSON_free(node->string);
    node->string = name;
}

/* Returns the list or object that holds the part, or NULL. */
static cJSON *parent_of(cJSON *root, const cJSON *part)
{
    for (cJSON *item = root->child; item; item = item->next) {
        cJSON *found = item == part ? root : parent_of(item, part);
        if (found)
            return found;
    }
    return NULL;
}

/* Puts a copy of `from`, or any value, in the part's place, beside it or into
 * it; or removes the part. */
static void graft(struct bytes *b, cJSON *root, cJSON *part, const cJSON *from)
{
    cJSON *parent = parent_of(root, part);
    cJSON *copy = pick(b, 4) ? cJSON_Duplicate(from, 1) : any_value(b);
    const char *key =
        part->string && pick(b, 2) ? part->string : words[pick(b, WORDS)];
    char name[64];
    snprintf(name, sizeof name, "%s", key);
    switch (parent ? pick(b, 4) : 3) {
    case 0:
        cJSON_Delete(copy);
        cJSON_Delete(cJSON_DetachItemViaPointer(parent, part));
        return;
    case 1:
        if (cJSON_IsObject(parent))
            cJSON_AddItemToObject(parent, name, copy);
        else
            cJSON_AddItemToArray(parent, copy);
        return;
    case 2:
        if (cJSON_IsObject(parent)) {
            cJSON_Delete(cJSON_DetachItemViaPointer(parent, part));
            cJSON_AddItemToObject(parent, name, copy);
        } else {
            cJSON_ReplaceItemViaPointer(parent, part, copy);
        }
        return;
    default:
        if (cJSON_IsObject(part))
            cJSON_AddItemToObject(part, name, copy);
        else if (cJSON_IsArray(part))
            cJSON_AddItemToArray(part, copy);
        else
            cJSON_Delete(copy);
    }
}

static void change(struct bytes *b, cJSON *root)
{
    cJSON *part = any_part(b, root);
    switch (pick(b, 6)) {
    case 0:
        graft(b, root, part, any_part(b, root));
        break;
    case 1:
        rename_part(b, part);
        break;
    case 2:
        set_text(b, part);
        break;
    default: /* numbers are most of a scene */
        for (int k = 0; k < 8 && !cJSON_IsNumber(part); k++)
            part = any_part(b, root);
        set_number(b, part);
    }
}

size_t json_mutate(uint8_t *data, size_t size, size_t most, uint64_t seed)
{
    struct bytes b = damage_choices(seed);
    char *text = malloc(size + 1);
    cJSON *root = NULL;
    if (text && pick(&b, 6)) {
        memcpy(text, data, size);
        text[size] = 0;
        root = cJSON_Parse(text);
    }
    free(text);
    for (uint32_t k = 1 + pick(&b, 4); root && k; k--)
        change(&b, root);
    text = root ? cJSON_PrintUnformatted(root) : NULL;
    size_t length = text ? strlen(text) : 0;
    if (text && length <= most) {
        for (size = 0; size < length; size++)
            data[size] = (uint8_t)text[size];
    } else {
        size = fuzz_plain(data, size, most);
    }
    cJSON_free(text);
    cJSON_Delete(root);
    choices_free(&b);
    return size;
}
