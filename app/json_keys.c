/* SPDX-License-Identifier: Apache-2.0 */
/* Checks that an object's keys are those of its table. */
#include "app/app.h"
#include "app/json.h"
#include "app/nearest.h"

#include <stdio.h>
#include <string.h>

/* Refuses a key that is not in the table. The message names the nearest key if
 * one is near, else all keys. */
static int refuse_key(const struct json *json, const char *name,
                      const struct json_key *keys)
{
    char names[512] = "";
    struct nearest nearest = {.word = name};
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

int json_check_keys(const struct json *json, const cJSON *node,
                    const struct json_key *keys)
{
    const cJSON *item, *other;
    cJSON_ArrayForEach(item, node)
    {
        const struct json_key *key = keys;
        while (key->name && strcmp(key->name, item->string) != 0)
            key++;
        if (!key->name)
            return refuse_key(json, item->string, keys);
        for (other = item->next; other; other = other->next)
            if (strcmp(other->string, item->string) == 0)
                return json_refuse(json, "key \"%s\" is there twice",
                                   item->string);
    }
    return APP_OK;
}
