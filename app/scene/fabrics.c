/* SPDX-License-Identifier: Apache-2.0 */
/* Fabrics by name: the table of app/scene/fabrics.def, and its list. */
#include "app/scene/fabrics.h"
#include "app/base/app.h"
#include "app/base/nearest.h"

#include <drape.h>
#include <string.h>

static const struct fabric {
    const char *name;
    drape_material material;
    const char *what, *source;
} fabrics[] = {
#define FABRIC(name_, density_, stretch_, shear_, bend_, thickness_,           \
               friction_, what_, source_)                                      \
    {.name = name_,                                                            \
     .material = {.density = density_,                                         \
                  .stretch = stretch_,                                         \
                  .shear = shear_,                                             \
                  .bend = bend_,                                               \
                  .thickness = thickness_,                                     \
                  .friction = friction_},                                      \
     .what = what_,                                                            \
     .source = source_},
#include "app/scene/fabrics.def"
#undef FABRIC
};
enum { FABRICS = sizeof fabrics / sizeof *fabrics };

int read_fabric(struct json *json, json_t *node, void *out)
{
    drape_material *material = out;
    const char *text = json_string_value(node);
    char names[512] = "";
    struct nearest nearest = {.word = text};
    if (!text)
        return json_refuse(json, "expected the name of a fabric");
    for (int k = 0; k < FABRICS; k++) {
        size_t length = strlen(names);
        snprintf(names + length, sizeof names - length, "%s%s", k ? ", " : "",
                 fabrics[k].name);
        nearest_try(&nearest, fabrics[k].name);
        if (strcmp(fabrics[k].name, text) != 0)
            continue;
        double damping = material->damping; /* nobody measured it */
        *material = fabrics[k].material;
        material->damping = damping;
        return APP_OK;
    }
    if (nearest.name)
        return json_refuse(json,
                           "unknown fabric \"%.60s\"; did you mean \"%s\"?",
                           text, nearest.name);
    return json_refuse(json, "unknown fabric \"%.60s\"; expected one of %s",
                       text, names);
}

const char *fabric_at(int k, drape_material *out, const char **what)
{
    if (k < 0 || k >= FABRICS)
        return NULL;
    double damping = out->damping;
    *out = fabrics[k].material;
    out->damping = damping;
    *what = fabrics[k].what;
    return fabrics[k].name;
}

const char *fabric_source(int k)
{
    return fabrics[k].source;
}
