/* SPDX-License-Identifier: Apache-2.0 */
/* Fabrics by name, as scenes call them. */
#ifndef APP_FABRICS_H
#define APP_FABRICS_H

#include "app/json.h"

/* Reads a fabric's name into the drape_material at out, all but its damping. An
 * unknown name is refused with all that are known. */
int read_fabric(struct json *json, const cJSON *node, void *out);

#endif
