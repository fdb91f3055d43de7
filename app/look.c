/* SPDX-License-Identifier: Apache-2.0 */
/* How a body looks in pictures. */
#include "app/look.h"

struct look look_default(void)
{
    return (struct look){{-1, -1, -1}, {-1, -1, -1}, -1, 1};
}

int read_look(struct json *json, const cJSON *node, void *out)
{
    static const struct json_key keys[] = {
        VECTOR_KEY("colour", offsetof(struct look, colour), 0, 1, 3),
        VECTOR_KEY("inside", offsetof(struct look, inside), 0, 1, 3),
        NUMBER_KEY("gloss", offsetof(struct look, gloss), 0, 1),
        BOOLEAN_KEY("check", offsetof(struct look, check)),
        {0}};
    return json_object(json, node, keys, out);
}

static void put_colour(FILE *out, const char *name, const double c[3])
{
    if (c[0] >= 0)
        fprintf(out, "\"%s\": [%.17g, %.17g, %.17g], ", name, c[0], c[1], c[2]);
}

void look_write(FILE *out, const struct look *look)
{
    fputc('{', out);
    put_colour(out, "colour", look->colour);
    put_colour(out, "inside", look->inside);
    if (look->gloss >= 0)
        fprintf(out, "\"gloss\": %.17g, ", look->gloss);
    fprintf(out, "\"check\": %s}", look->check ? "true" : "false");
}

/* Reads a number of 0 … 1; a missing one stays. */
static bool restore(const cJSON *item, double *out)
{
    if (!item)
        return true;
    if (!cJSON_IsNumber(item) ||
        !(item->valuedouble >= 0 && item->valuedouble <= 1))
        return false;
    *out = item->valuedouble;
    return true;
}

static bool restore_colour(const cJSON *list, double out[3])
{
    if (list && cJSON_GetArraySize(list) != 3)
        return false;
    bool good = true;
    for (int i = 0; list && i < 3; i++)
        good = good && restore(cJSON_GetArrayItem(list, i), &out[i]);
    return good;
}

bool look_restore(const cJSON *node, struct look *look)
{
    *look = look_default();
    look->check =
        !cJSON_IsFalse(cJSON_GetObjectItemCaseSensitive(node, "check"));
    return restore_colour(cJSON_GetObjectItemCaseSensitive(node, "colour"),
                          look->colour) &&
           restore_colour(cJSON_GetObjectItemCaseSensitive(node, "inside"),
                          look->inside) &&
           restore(cJSON_GetObjectItemCaseSensitive(node, "gloss"),
                   &look->gloss);
}
