/* SPDX-License-Identifier: Apache-2.0 */
/* The backend of the reference; its `on` is a struct arena. */
#ifndef REF_WORLD_BACKEND_H
#define REF_WORLD_BACKEND_H

#include "ref/base/backend.h"

extern const struct backend backend_ref;

#endif
