/* SPDX-License-Identifier: Apache-2.0 */
/* Texts and numbers as JSON, whatever they hold. */
#ifndef APP_TEXT_H
#define APP_TEXT_H

#include <stdio.h>

/* The text as a JSON string with its quotes. Bytes that are not UTF-8, as a
 * file's name may have, become U+FFFD, one for each byte. */
void text_put(FILE *out, const char *text);

/* The number in the format, which is one for a double; null where it is not
 * finite, for which JSON has no word. */
void text_put_number(FILE *out, const char *format, double value);

#endif
