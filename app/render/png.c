/* SPDX-License-Identifier: Apache-2.0 */
/* Writes pictures as PNG. */
#include "app/base/app.h"
#include "app/base/file.h"
#include "app/render/picture.h"

#include <png.h>
#include <setjmp.h>

/* Writes the PNG; libpng reports a failed write by a longjmp to here. */
static bool encode(FILE *out, const uint8_t *rgb, int width, int height)
{
    png_structp png =
        png_create_write_struct(PNG_LIBPNG_VER_STRING, NULL, NULL, NULL);
    png_infop info = png ? png_create_info_struct(png) : NULL;
    if (!info || setjmp(png_jmpbuf(png))) {
        png_destroy_write_struct(&png, &info);
        return false;
    }
    png_init_io(png, out);
    png_set_IHDR(png, info, (png_uint_32)width, (png_uint_32)height, 8,
                 PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE,
                 PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    png_set_compression_level(png, 4);
    png_write_info(png, info);
    for (int k = 0; k < height; k++)
        png_write_row(png, rgb + (size_t)k * (size_t)width * 3);
    png_write_end(png, NULL);
    png_destroy_write_struct(&png, &info);
    return true;
}

bool picture_save(const char *directory, const char *name, const uint8_t *rgb,
                  int width, int height)
{
    struct file file;
    if (!file_open(&file, directory, name))
        return false;
    if (encode(file.stream, rgb, width, height))
        return file_close(&file);
    file_drop(&file);
    complain(APP_FAILED, "%s: cannot write the picture", file.path);
    return false;
}
