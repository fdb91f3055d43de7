/* SPDX-License-Identifier: Apache-2.0 */
/* What the targets of the tool's readers share: a folder of their own, files
 * in it, a small scene, and what valid JSON is. */
#ifndef FUZZ_FILES_H
#define FUZZ_FILES_H

#include <stdbool.h>

#include "app/scene.h"
#include "fuzz/fuzz.h"

enum { FILES_PATH = 128 };

/* folder/name into path; the folder is made at the first call and is gone with
 * the program. It has the meshes ball.ply, wave_0.ply and wave_1.ply. */
const char *files_path(const char *name, char path[FILES_PATH]);
/* Writes the bytes there; aborts where the disk does not take them. */
void files_write(const char *name, const void *data, size_t size);
/* The file's bytes with a zero behind them, which the caller frees; NULL: there
 * is no such file. */
char *files_read(const char *name, size_t *size);

/* A scene of 4 × 4 and 3 × 4 particles above a plane, and its new world.
 * false: it is refused. scene_free and drape_destroy. */
bool files_scene(struct scene *scene, drape_world **world);

/* Whether the text is one JSON value by RFC 8259, in UTF-8. */
bool strict_json(const char *text, size_t size);

/* A sound checkpoint of that scene's run, of at most `most` bytes, in place of
 * the bytes there; its size, or `size` where there is no room. */
size_t checkpoint_begin(uint8_t *data, size_t size, size_t most);

/* The targets. */
fuzz_run fuzz_scene, fuzz_ply, fuzz_mesh, fuzz_frames, fuzz_checkpoint,
    fuzz_csv, fuzz_report, fuzz_look;
fuzz_mutate json_mutate, checkpoint_mutate;

#endif
