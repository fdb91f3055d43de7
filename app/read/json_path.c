/* SPDX-License-Identifier: Apache-2.0 */
/* The path within a JSON document, and errors that name it. */
#include "app/base/app.h"
#include "app/read/json.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

int json_refuse(const struct json *json, const char *format, ...)
{
    char text[512];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    return complain(APP_USAGE, "%s: %s: %s", json->file, json->where, text);
}

size_t json_enter(struct json *json, const char *format, ...)
{
    size_t length = strlen(json->where);
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(json->where + length, sizeof json->where - length, format,
              arguments);
    va_end(arguments);
    return length;
}

void json_leave(struct json *json, size_t length)
{
    json->where[length] = 0;
}
