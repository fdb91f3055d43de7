/* SPDX-License-Identifier: Apache-2.0 */
/* Writes a mesh in the format that the output's name says. */
#ifndef APP_WRITE_EXPORT_H
#define APP_WRITE_EXPORT_H

#include "app/read/mesh.h"

/* Checks that a file of this name can be written: APP_OK, or APP_USAGE after
 * one line. "-" stands for PLY on standard output. */
int export_check(const char *path);
/* Writes the mesh to a name that export_check accepts. The file appears whole
 * or not at all. Returns app_exit; a failure prints one line. */
int export_save(const char *path, const struct mesh *mesh);

#endif
