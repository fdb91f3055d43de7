/* SPDX-License-Identifier: Apache-2.0 */
/* A run's checkpoint: the reports of its steps and the library's state. */
#ifndef APP_CHECKPOINT_H
#define APP_CHECKPOINT_H

#include "app/report.h"

/* Writes directory/checkpoint.drape. app_exit after one line. */
int checkpoint_save(const char *directory, const struct report *report,
                    const drape_world *world);
/* Brings report and world to where the file left them. */
int checkpoint_load(const char *path, struct report *report,
                    drape_world *world);

#endif
