/* SPDX-License-Identifier: Apache-2.0 */
/* Checks JSON by RFC 8259 with unique keys, as jansson reads it. */
#include <jansson.h>

#include "fuzz/files.h"

bool strict_json(const char *text, size_t size)
{
    json_t *root = json_loadb(text, size,
                              JSON_REJECT_DUPLICATES | JSON_DECODE_ANY |
                                  JSON_DECODE_INT_AS_REAL,
                              NULL);
    bool good = root != NULL;
    json_decref(root);
    return good;
}
