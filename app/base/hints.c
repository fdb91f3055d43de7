/* SPDX-License-Identifier: Apache-2.0 */
/* Words of other programs, and what they are called here. */
#include "app/base/nearest.h"

#include <stdbool.h>
#include <stddef.h>
#include <strings.h>

/* A word, the name that it goes by here, and the key whose object has this
 * name, where that is another object. A name is suggested only where the table
 * that is read has this name or this key. */
static const struct {
    const char *word, *name, *in;
} names[] = {
    {"file", "mesh", NULL},
    {"filename", "mesh", NULL},
    {"path", "mesh", NULL},
    {"model", "mesh", NULL},
    {"obj", "mesh", NULL},
    {"stl", "mesh", NULL},
    {"filepath", "mesh", NULL},
    {"mesh_file", "mesh", NULL},
    {"mesh_path", "mesh", NULL},
    {"uri", "mesh", NULL},
    {"vertices", "mesh", NULL},
    {"triangles", "mesh", NULL},
    {"faces", "mesh", NULL},
    {"mesh", "mesh", "obstacles"},
    {"file", "mesh", "obstacles"},
    {"type", "shape", NULL},
    {"kind", "shape", NULL},
    {"primitive", "shape", NULL},
    {"mass", "density", "material"},
    {"weight", "density", "material"},
    {"density", "density", "material"},
    {"stiffness", "stretch", "material"},
    {"stretch", "stretch", "material"},
    {"youngs_modulus", "stretch", NULL},
    {"youngs_modulus", "stretch", "material"},
    {"shear", "shear", "material"},
    {"bend", "bend", "material"},
    {"thickness", "thickness", "material"},
    {"friction", "friction", "material"},
    {"mu", "friction", NULL},
    {"mu", "friction", "material"},
    {"damping", "damping", "material"},
    {"fabric", "material", NULL},
    {"resolution", "particles", NULL},
    {"grid", "particles", NULL},
    {"segments", "particles", NULL},
    {"width", "size", NULL},
    {"height", "size", NULL},
    {"dimensions", "size", NULL},
    {"at", "at", "start"},
    {"position", "at", "start"},
    {"location", "at", "start"},
    {"translation", "at", "start"},
    {"translate", "at", NULL},
    {"translate", "at", "start"},
    {"offset", "at", NULL},
    {"center", "at", NULL},
    {"center", "at", "start"},
    {"centre", "at", NULL},
    {"origin", "at", NULL},
    {"shape", "shape", "start"},
    {"rotation", "angle", NULL},
    {"rotate", "angle", NULL},
    {"velocity", "motion", NULL},
    {"color", "colour", NULL},
    {"color", "colour", "look"},
    {"colour", "colour", "look"},
    {"fixed", "pins", NULL},
    {"pinned", "pins", NULL},
    {"attach", "pins", NULL},
    {"constraints", "pins", NULL},
    {"colliders", "obstacles", NULL},
    {"bodies", "obstacles", NULL},
    {"objects", "obstacles", NULL},
    {"sheets", "cloths", NULL},
    {"seams", "garments", NULL},
    {"seam", "garments", NULL},
    {"sewing", "garments", NULL},
    {"sew", "garments", NULL},
    {"stitch", "garments", NULL},
    {"stitches", "garments", NULL},
    {"garment", "garments", NULL},
    {"panels", "garments", NULL},
    {"pattern", "pattern", "garments"},
    {"timestep", "dt", NULL},
    {"time_step", "dt", NULL},
    {"substeps", "steps_per_frame", NULL},
    {"steps", "frames", NULL},
    {"duration", "frames", NULL},
    {"num_frames", "frames", NULL},
    {"speed", "velocity", NULL},
    {"gpu", "backend", NULL},
    {"cpu", "ref", NULL},
    {"host", "ref", NULL},
    {"cuda", "gpu", NULL},
    {"simulate", "run", NULL},
    {"sim", "run", NULL},
    {"bake", "run", NULL},
    {"show", "view", NULL},
    {"play", "view", NULL},
    {"fabrics", "materials", NULL},
    {"-o", "--out", NULL},
    {"--output", "--out", NULL},
    {"-n", "--frames", NULL},
    {"-f", "--frames", NULL},
    {"--steps", "--frames", NULL},
    {"-j", "--threads", NULL},
    {"-t", "--threads", NULL},
    {"-b", "--backend", NULL},
    {"--num-threads", "--threads", NULL},
    {"--fps", "--rate", NULL},
    {"--gpu", "--backend", NULL},
    {"--cuda", "--backend", NULL},
    {"-q", "--quiet", NULL},
};

/* A word, and the end of the sentence: drape cannot … yet. */
static const struct {
    const char *word, *what;
} missing[] = {
    {"mesh", "simulate a mesh of triangles as cloth"},
    {"file", "simulate a mesh of triangles as cloth"},
    {"obj", "simulate a mesh of triangles as cloth"},
    {"model", "simulate a mesh of triangles as cloth"},
    {"triangles", "simulate a mesh of triangles as cloth"},
    {"faces", "simulate a mesh of triangles as cloth"},
    {"vertices", "simulate a mesh of triangles as cloth"},
    {"tear", "tear cloth"},
    {"tearing", "tear cloth"},
    {"tear_threshold", "tear cloth"},
    {"fracture", "tear cloth"},
    {"pressure", "inflate cloth"},
    {"inflate", "inflate cloth"},
    {"balloon", "inflate cloth"},
    {"volume", "inflate cloth"},
    {"plasticity", "leave cloth stretched or creased"},
    {"creases", "leave cloth stretched or creased"},
    {"mass", "let cloth push bodies"},
    {"dynamic", "let cloth push bodies"},
    {"rods", "simulate rods"},
    {"device", "choose a device by its number"},
    {"device_id", "choose a device by its number"},
    {"--device", "choose a device by its number"},
    {"--device-id", "choose a device by its number"},
    {"--gpu-id", "choose a device by its number"},
    {"--gpus", "choose a device by its number"},
};

const char *hint_name(const char *word, int *k, const char **in)
{
    for (; *k < (int)(sizeof names / sizeof *names); ++*k)
        if (strcasecmp(names[*k].word, word) == 0) {
            *in = names[*k].in;
            return names[(*k)++].name;
        }
    return NULL;
}

const char *hint_missing(const char *word)
{
    for (size_t k = 0; k < sizeof missing / sizeof *missing; k++)
        if (strcasecmp(missing[k].word, word) == 0)
            return missing[k].what;
    return NULL;
}
