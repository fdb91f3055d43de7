/* SPDX-License-Identifier: Apache-2.0 */
/* What the tool prints: see app/base/app.h. */
#include "app/base/app.h"

#include <stdarg.h>
#include <stdio.h>

bool app_quiet;

void say(const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    if (!app_quiet)
        vprintf(format, arguments);
    va_end(arguments);
}

int complain(int code, const char *format, ...)
{
    char line[2048];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(line, sizeof line, format, arguments);
    va_end(arguments);
    /* text from a file must not break the line or control the terminal */
    for (char *p = line; *p; p++)
        if ((unsigned char)*p < 32 || *p == 127)
            *p = '?';
    if (code || !app_quiet)
        fprintf(stderr, "drape: %s\n", line);
    return code;
}

int no_memory(void)
{
    return complain(APP_FAILED, "out of memory");
}
