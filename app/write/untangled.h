/* SPDX-License-Identifier: Apache-2.0 */
/* untangle.json: where bodies intersected, and what was parted. */
#ifndef APP_WRITE_UNTANGLED_H
#define APP_WRITE_UNTANGLED_H

#include "app/read/untangle.h"

/* Writes it into the folder; name: [parts]. false after one line. */
bool untangled_write(const struct untangling *u, const char *const *name,
                     const char *directory);

#endif
