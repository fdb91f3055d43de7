/* SPDX-License-Identifier: Apache-2.0 */
/* parted.json: where parts of bodies gave way to each other. */
#ifndef APP_WRITE_PARTED_H
#define APP_WRITE_PARTED_H

#include "app/scene/scene.h"

/* Writes directory/parted.json, if anything gave way: a row a region and frame.
 * false after one line. */
bool parted_write(const struct scene *scene, const char *directory);

#endif
