/* SPDX-License-Identifier: Apache-2.0 */
/* Mutates JSON so that it stays JSON: numbers become limits; parts are removed,
 * doubled, exchanged or get another key. The words are those of
 * app/scenes/README.md. */
#include <stdlib.h>
#include <string.h>

#include <jansson.h>

#include "fuzz/damage.h"
#include "fuzz/files.h"

static const char *const words[] = {
#include "words.h"
};
enum { WORDS = sizeof words / sizeof *words };

/* A spot of the tree, and where it lies: in an object under a key, in a list at
 * an index, or, without parent, as the root. */
struct spot {
    json_t *parent, *node;
    const char *key;
    size_t index;
};

/* Finds part k of the tree in the order of its text. *k counts down; with *k =
 * -1 all parts are counted. False: there is no such part. */
static bool find(struct spot at, long *k, struct spot *found)
{
    struct spot in = {.parent = at.node};
    if ((*k)-- == 0) {
        *found = at;
        return true;
    }
    json_object_foreach(at.node, in.key, in.node)
    {
        if (find(in, k, found))
            return true;
    }
    in.key = NULL;
    json_array_foreach(at.node, in.index, in.node)
    {
        if (find(in, k, found))
            return true;
    }
    return false;
}

static struct spot any_part(struct bytes *b, json_t *root)
{
    struct spot found = {.node = root};
    long all = -1, k;
    find(found, &all, &found); /* counts down from -1 */
    k = (long)pick(b, (uint32_t)(-1 - all));
    find((struct spot){.node = root}, &k, &found);
    return found;
}

static void set_number(struct bytes *b, json_t *node)
{
    static const double some[] = {0,     1,    -1,    2,    0.5,  1e-6,  1e-9,
                                  1e-30, 1e6,  1e9,   1e18, 3,    4,     8,
                                  32,    64,   0.001, 1e4,  -1e6, 1e300, 360,
                                  90,    0.02, 0.1,   33,   5,    1e-4,  16};
    double value = some[pick(b, sizeof some / sizeof *some)];
    double old = json_number_value(node);
    switch (pick(b, 6)) {
    case 0:
        value = old * (pick(b, 2) ? 2 : 0.5);
        break;
    case 1:
        value = old + (pick(b, 2) ? 1 : -1);
        break;
    case 2:
        value = draw_any(b);
        break;
    case 3:
        value = -old;
        break;
    default:
        break;
    }
    json_real_set(node, value); /* unless it is no number, or not finite */
}

static json_t *any_value(struct bytes *b)
{
    json_t *number;
    switch (pick(b, 6)) {
    case 0:
        return json_string(words[pick(b, WORDS)]);
    case 1:
        return json_boolean(pick(b, 2));
    case 2:
        return json_array();
    case 3:
        return json_object();
    case 4:
        return json_null();
    default:
        number = json_real(draw_any(b)); /* NULL: it is not finite */
        return number ? number : json_real(0);
    }
}

/* Puts a value beside the part's place under this key, or at the list's end. */
static void append(json_t *to, const char *key, json_t *value)
{
    if (json_is_object(to))
        json_object_set_new(to, key, value);
    else if (json_is_array(to))
        json_array_append_new(to, value);
    else
        json_decref(value);
}

static void drop(const struct spot *part)
{
    if (json_is_object(part->parent))
        json_object_del(part->parent, part->key);
    else
        json_array_remove(part->parent, part->index);
}

/* Gives a part of an object another key. */
static void rename_part(struct bytes *b, const struct spot *part)
{
    const char *word = words[pick(b, WORDS)];
    if (!part->key || !strcmp(word, part->key))
        return;
    json_object_set(part->parent, word, part->node);
    json_object_del(part->parent, part->key);
}

/* Puts a copy of `from`, or any value, in the part's place, beside it or into
 * it; or removes the part. */
static void graft(struct bytes *b, const struct spot *part, const json_t *from)
{
    json_t *copy = pick(b, 4) ? json_deep_copy(from) : any_value(b);
    const char *key =
        part->key && pick(b, 2) ? part->key : words[pick(b, WORDS)];
    switch (part->parent ? pick(b, 4) : 3) {
    case 0:
        json_decref(copy);
        drop(part);
        break;
    case 1:
        append(part->parent, key, copy);
        break;
    case 2:
        if (part->key)
            json_object_set_new(part->parent, part->key, copy);
        else
            json_array_set_new(part->parent, part->index, copy);
        break;
    default:
        append(part->node, key, copy);
    }
}

static void change(struct bytes *b, json_t *root)
{
    struct spot part = any_part(b, root), from;
    switch (pick(b, 6)) {
    case 0:
        from = any_part(b, root);
        graft(b, &part, from.node);
        break;
    case 1:
        rename_part(b, &part);
        break;
    case 2:
        json_string_set(part.node, words[pick(b, WORDS)]);
        break;
    default: /* numbers are most of a scene */
        for (int k = 0; k < 8 && !json_is_real(part.node); k++)
            part = any_part(b, root);
        set_number(b, part.node);
    }
}

size_t json_mutate(uint8_t *data, size_t size, size_t most, uint64_t seed)
{
    struct bytes b = damage_choices(seed);
    json_t *root = NULL;
    if (pick(&b, 6))
        root = json_loadb((const char *)data, size,
                          JSON_DECODE_INT_AS_REAL | JSON_DECODE_ANY, NULL);
    for (uint32_t k = 1 + pick(&b, 4); root && k; k--)
        change(&b, root);
    size_t flags = JSON_COMPACT | JSON_ENCODE_ANY;
    size_t length = json_dumpb(root, NULL, 0, flags);
    if (length > 0 && length <= most)
        size = json_dumpb(root, (char *)data, most, flags);
    else
        size = fuzz_plain(data, size, most);
    json_decref(root);
    choices_free(&b);
    return size;
}
