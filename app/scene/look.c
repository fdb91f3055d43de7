/* SPDX-License-Identifier: Apache-2.0 */
/* How a body looks in pictures. */
#include "app/scene/look.h"

struct look look_default(void)
{
    return (struct look){{-1, -1, -1}, {-1, -1, -1}, -1, 1};
}

int read_look(struct json *json, json_t *node, void *out)
{
    static const struct json_key keys[] = {
        VECTOR_KEY("colour", offsetof(struct look, colour), 0, 1, 3),
        VECTOR_KEY("inside", offsetof(struct look, inside), 0, 1, 3),
        NUMBER_KEY("gloss", offsetof(struct look, gloss), 0, 1),
        BOOLEAN_KEY("check", offsetof(struct look, check)),
        {0}};
    return json_fields(json, node, keys, out);
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
static bool restore(json_t *item, double *out)
{
    if (!item)
        return true;
    if (!json_is_number(item) ||
        !(json_number_value(item) >= 0 && json_number_value(item) <= 1))
        return false;
    *out = json_number_value(item);
    return true;
}

static bool restore_colour(json_t *list, double out[3])
{
    if (list && json_array_size(list) != 3)
        return false;
    bool good = true;
    for (int i = 0; list && i < 3; i++)
        good = good && restore(json_array_get(list, (size_t)i), &out[i]);
    return good;
}

bool look_restore(json_t *node, struct look *look)
{
    *look = look_default();
    look->check = !json_is_false(json_object_get(node, "check"));
    return restore_colour(json_object_get(node, "colour"), look->colour) &&
           restore_colour(json_object_get(node, "inside"), look->inside) &&
           restore(json_object_get(node, "gloss"), &look->gloss);
}
