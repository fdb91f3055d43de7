/* SPDX-License-Identifier: Apache-2.0 */
/* seams.json: which cloths are panels, and the particles that their seams join.
 */
#ifndef APP_WRITE_SEAMS_H
#define APP_WRITE_SEAMS_H

#include "app/scene/scene.h"

/* Writes directory/seams.json, if the scene has seams. `whole` has all of them,
 * where the scene's definition is that of a stage of sewing; `attaches`: how
 * many of the scene's attachments hold in this run. false after one line. */
bool seams_write(const struct scene *scene, const drape_def *whole,
                 int attaches, const char *directory);

#endif
