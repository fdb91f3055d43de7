/* SPDX-License-Identifier: Apache-2.0 */
/* One source, two precisions, one library: a file that is compiled for binary32
 * and for binary64 defines its external names with the suffix _32 or _64. The
 * build finds these names in the sources (ci/names.sh) and writes them as
 * macros into BUILD/names. */
#ifndef REF_NAMES_H
#define REF_NAMES_H

#ifndef REAL_BITS
#define REAL_BITS 32
#endif
#define REAL_PASTE_(name, bits) name##_##bits
#define REAL_PASTE(name, bits) REAL_PASTE_(name, bits)
#define REAL_NAME(name) REAL_PASTE(name, REAL_BITS)

#include "names/ref.h"

#endif
