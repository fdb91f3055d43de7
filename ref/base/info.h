/* SPDX-License-Identifier: Apache-2.0 */
/* The text of drape_info. */
#ifndef REF_INFO_H
#define REF_INFO_H

#include "spec/drape.h"

/* Returns drape_info's text, static. It lives in gpu/, which knows whether the
 * build has a device. */
const char *gpu_info(void);
#define WORLD_INFO(gpu)                                                        \
    "drape " DRAPE_VERSION                                                     \
    "\nbackend ref: binary32, binary64\nbackend gpu: " gpu                     \
    "\ncertificate: " CERTIFICATE "\n"

#endif
