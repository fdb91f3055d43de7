/* SPDX-License-Identifier: Apache-2.0 */
/* One source, two precisions, one library: every external function of ref/
 * takes the suffix of the build's precision. One that is missing here fails
 * to link, as it is then defined twice. Sorted. */
#ifndef REF_NAMES_H
#define REF_NAMES_H

#ifndef REAL_BITS
#define REAL_BITS 32
#endif
#define REAL_PASTE_(name, bits) name##_##bits
#define REAL_PASTE(name, bits) REAL_PASTE_(name, bits)
#define REAL_NAME(name) REAL_PASTE(name, REAL_BITS)

#define ref_bounds REAL_NAME(ref_bounds)

#endif
