/* SPDX-License-Identifier: Apache-2.0 */
/* Fabrics by name, as scenes call them. */
#ifndef APP_SCENE_FABRICS_H
#define APP_SCENE_FABRICS_H

#include "app/read/json.h"

#include <drape.h>

/* Reads a fabric's name into the drape_material at out, all but its damping. An
 * unknown name is refused with all that are known. */
int read_fabric(struct json *json, json_t *node, void *out);

/* The name of fabric k, whose numbers it copies to *out but for the damping,
 * and what it is; NULL behind the last. */
const char *fabric_at(int k, drape_material *out, const char **what);
/* Where the numbers of fabric k are from. */
const char *fabric_source(int k);

#endif
