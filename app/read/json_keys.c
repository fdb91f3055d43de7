/* SPDX-License-Identifier: Apache-2.0 */
/* Checks that an object's keys are those of its table, and that they have an
 * effect. */
#include "app/base/app.h"
#include "app/base/nearest.h"
#include "app/read/json.h"

#include <stdio.h>
#include <string.h>

static bool has(const struct json_key *keys, const char *name)
{
    while (keys->name && strcmp(keys->name, name) != 0)
        keys++;
    return keys->name;
}

/* Refuses a word that other programs have for a key of the table or of an
 * object in it, or for what drape cannot do. APP_OK: the word is none of these.
 */
static int refuse_word(const struct json *json, const char *word,
                       const struct json_key *keys)
{
    const char *name, *in, *what = hint_missing(word);
    for (int k = 0; (name = hint_name(word, &k, &in)) != NULL;) {
        if (has(keys, name))
            return json_refuse(json, "unknown key \"%s\"; did you mean \"%s\"?",
                               word, name);
        if (in && has(keys, in))
            return json_refuse(
                json, "unknown key \"%s\"; did you mean \"%s\" in \"%s\"?",
                word, name, in);
    }
    return what ? json_refuse(json,
                              "unknown key \"%s\": drape cannot %s yet "
                              "(spec/limits.md)",
                              word, what)
                : APP_OK;
}

/* Refuses a key that is not in the table. The message names the key that was
 * probably meant, or all keys. */
static int refuse_key(const struct json *json, const char *name,
                      const struct json_key *keys)
{
    char names[512] = "";
    struct nearest nearest = {.word = name};
    int status = refuse_word(json, name, keys);
    if (status != APP_OK)
        return status;
    for (const struct json_key *key = keys; key->name; key++) {
        size_t length = strlen(names);
        snprintf(names + length, sizeof names - length, "%s%s",
                 key == keys ? "" : ", ", key->name);
        nearest_try(&nearest, key->name);
    }
    if (nearest.name)
        return json_refuse(json, "unknown key \"%.60s\"; did you mean \"%s\"?",
                           name, nearest.name);
    return json_refuse(json, "unknown key \"%.60s\"; expected one of %s", name,
                       names);
}

int json_check_keys(const struct json *json, json_t *node,
                    const struct json_key *keys)
{
    const char *name;
    json_t *item;
    json_object_foreach(node, name, item)
    {
        if (!has(keys, name))
            return refuse_key(json, name, keys);
    }
    return APP_OK;
}

void json_idle(const struct json *json, json_t *node, const char *const *names,
               const char *why)
{
    for (; *names; names++)
        if (json_object_get(node, *names))
            complain(APP_OK, "%s: %s.%s: note: has no effect: %s", json->file,
                     json->where, *names, why);
}
