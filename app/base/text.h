/* SPDX-License-Identifier: Apache-2.0 */
/* Writes arbitrary texts and numbers as valid JSON. */
#ifndef APP_BASE_TEXT_H
#define APP_BASE_TEXT_H

#include <stdio.h>

/* Writes the text as a JSON string with quotes. Bytes that are not UTF-8, which
 * a file's name may have, become U+FFFD, one for each byte. */
void text_put(FILE *out, const char *text);

/* Writes the number in a format for a double, or null if it is not finite, as
 * JSON has only finite numbers. */
void text_put_number(FILE *out, const char *format, double value);

#endif
