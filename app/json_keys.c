/* SPDX-License-Identifier: Apache-2.0 */
/* Checks that an object's keys are those of its table. */
#include "app/app.h"
#include "app/json.h"

#include <stdio.h>
#include <string.h>

enum { LONGEST = 32 };

/* Returns the edit distance of two words (Levenshtein 1966); LONGEST if a word
 * is longer than any key. */
static int distance(const char *a, const char *b)
{
    int m = (int)strlen(a), n = (int)strlen(b), row[LONGEST + 1];
    if (m > LONGEST || n > LONGEST)
        return LONGEST;
    for (int j = 0; j <= n; j++)
        row[j] = j;
    for (int i = 1; i <= m; i++) {
        int corner = row[0];
        row[0] = i;
        for (int j = 1; j <= n; j++) {
            int changed = corner + (a[i - 1] != b[j - 1]);
            corner = row[j];
            int added = (row[j] < row[j - 1] ? row[j] : row[j - 1]) + 1;
            row[j] = changed < added ? changed : added;
        }
    }
    return row[n];
}

/* Refuses a key that is not in the table. The message names the nearest key if
 * its edit distance is at most two, else all keys. */
static int refuse_key(const struct json *json, const char *name,
                      const struct json_key *keys)
{
    char names[512] = "";
    const char *nearest = NULL;
    int least = 3;
    for (const struct json_key *key = keys; key->name; key++) {
        size_t length = strlen(names);
        snprintf(names + length, sizeof names - length, "%s%s",
                 key == keys ? "" : ", ", key->name);
        int d = distance(name, key->name);
        if (d < least && d < (int)strlen(key->name)) {
            least = d;
            nearest = key->name;
        }
    }
    if (nearest)
        return json_refuse(json, "unknown key \"%.60s\"; did you mean \"%s\"?",
                           name, nearest);
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
