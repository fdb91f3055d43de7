/* SPDX-License-Identifier: Apache-2.0 */
/* Included before everything that Frama-C reads, which knows no _Pragma. */
#define _Pragma(x)
