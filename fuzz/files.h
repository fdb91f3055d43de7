/* SPDX-License-Identifier: Apache-2.0 */
/* Shared by the targets of the tool's readers: a temporary folder, files in it,
 * a small scene, and a strict JSON check. */
#ifndef FUZZ_FILES_H
#define FUZZ_FILES_H

#include <stdbool.h>

#include "app/scene/scene.h"
#include "fuzz/fuzz.h"

enum { FILES_PATH = 128 };

/* Writes folder/name to path. The folder is made at the first call and
 * removed when the program ends. It has the meshes ball.ply, wave_0.ply and
 * wave_1.ply. */
const char *files_path(const char *name, char path[FILES_PATH]);
/* Writes a file; aborts if the disk refuses. */
void files_write(const char *name, const void *data, size_t size);
/* Returns the file's bytes with a zero behind them, which the caller frees, or
 * NULL if there is no such file. */
char *files_read(const char *name, size_t *size);

/* Makes a scene of 4 × 4 and 3 × 4 particles above a plane, and a new world of
 * it. Returns false if it is refused. The caller uses scene_free and
 * drape_destroy. */
bool files_scene(struct scene *scene, drape_world **world);

/* Whether the text is one JSON value by RFC 8259, in UTF-8. */
bool strict_json(const char *text, size_t size);

/* Overwrites data by an undamaged checkpoint of that scene's run, of at most
 * `most` bytes. Returns its size, or `size` if it does not fit. */
size_t checkpoint_begin(uint8_t *data, size_t size, size_t most);

/* The targets. */
fuzz_run fuzz_scene, fuzz_ply, fuzz_mesh, fuzz_frames, fuzz_checkpoint,
    fuzz_csv, fuzz_report, fuzz_look, fuzz_pattern;
fuzz_mutate json_mutate, checkpoint_mutate;

#endif
