/* SPDX-License-Identifier: Apache-2.0 */
/* Defaults of a definition, and its one complete check. */
#ifndef REF_DEFINE_H
#define REF_DEFINE_H

#include "spec/drape.h"

/* DRAPE_OK, or the status and one line of what is wrong and where. */
int define_check(const drape_def *def, drape_error *error);

#endif
