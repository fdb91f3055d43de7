/* SPDX-License-Identifier: Apache-2.0 */
/* What cloth does against what physics says: `make validate`, and with --quick
 * a part of `make check`. spec/validation.md */
#include "validate/validate.h"

#include <stdlib.h>
#include <string.h>
#include <time.h>

static const struct part {
    const char *name;
    void (*run)(struct validate *v);
} parts[] = {{"cylinder", part_cylinder},
             {"plane", part_plane},
             {"tension", part_tension},
             {"measured", part_measured},
             {"cantilever", part_cantilever},
             {"motion", part_motion},
             {"cusick", part_cusick},
             {"fabrics", part_fabrics},
             {"hung", part_hung},
             {"contact", part_contact},
             {"ball", part_ball},
             {"statue", part_statue},
             {"meeting", part_meeting},
             {"layers", part_layers},
             {"grip", part_grip},
             {"impact", part_impact},
             {"belt", part_belt},
             {"converge", part_converge},
             {"buckling", part_buckling},
             {"bendtwist", part_bendtwist},
             {"stickslip", part_stickslip}};
enum { PARTS = sizeof parts / sizeof *parts };

/* argument: what was not understood. */
static int usage(const char *argument)
{
    fprintf(stderr, "validate: %s\n", argument);
    fputs(
        "usage: validate [--quick | --fine] [--backend ref|gpu]\n"
        "                [--precision 32|64] DIRECTORY [PART...]\n"
        "Writes values-PART.csv and properties-PART.csv; parts (default: all):",
        stderr);
    for (int k = 0; k < PARTS; k++)
        fprintf(stderr, " %s", parts[k].name);
    fputs("\nExit status 1: a promised property misses its bar.\n", stderr);
    return 2;
}

static FILE *csv(const char *directory, const char *name, const char *part,
                 const char *header)
{
    char path[4096];
    snprintf(path, sizeof path, "%s/%s-%s.csv", directory, name, part);
    FILE *out = fopen(path, "w");
    if (!out) {
        fprintf(stderr, "validate: %s: cannot be written\n", path);
        exit(2);
    }
    fprintf(out, "%s\n", header);
    return out;
}

static void run_part(struct validate *v, const char *directory,
                     const struct part *part, const int *bits)
{
    clock_t start = clock();
    v->values = csv(directory, "values", part->name,
                    "part,property,backend,bits,size,value,theory,unit");
    v->properties =
        csv(directory, "properties", part->name,
            "part,property,backend,bits,unit,theory,size 1,size 2,size 3,"
            "size 4,value 1,value 2,value 3,value 4,error,order,bar,promised,"
            "result");
    for (int k = 0; k < 2; k++) {
        v->bits = bits[k];
        if (v->bits)
            part->run(v);
    }
    fclose(v->values);
    fclose(v->properties);
    fprintf(stderr, "%s: %.1f s\n", part->name,
            (double)(clock() - start) / CLOCKS_PER_SEC);
}

/* Whether argument *k is this option with one of its two values: then which,
 * and *k is moved to the value. */
static bool choice(int argc, char **argv, int *k, const char *option,
                   const char *const value[2], int *chosen)
{
    if (strcmp(argv[*k], option) != 0 || *k + 1 >= argc)
        return false;
    for (*chosen = 0; *chosen < 2; ++*chosen)
        if (!strcmp(argv[*k + 1], value[*chosen])) {
            ++*k;
            return true;
        }
    return false;
}

int main(int argc, char **argv)
{
    static const char *const backends[] = {"ref", "gpu"};
    static const char *const precisions[] = {"32", "64"};
    int chosen = 0;
    struct validate v = {0};
    const char *directory = NULL;
    int bits[2] = {64, 32};
    bool wanted[PARTS] = {0}, some = false;
    for (int k = 1; k < argc; k++) {
        int part = 0;
        while (part < PARTS && strcmp(argv[k], parts[part].name) != 0)
            part++;
        if (!strcmp(argv[k], "--quick"))
            v.quick = true;
        else if (!strcmp(argv[k], "--fine"))
            v.fine = true;
        else if (choice(argc, argv, &k, "--backend", backends, &chosen))
            v.backend = chosen ? DRAPE_GPU : DRAPE_REF;
        else if (choice(argc, argv, &k, "--precision", precisions, &chosen))
            bits[chosen] = 0; /* the other one is left out */
        else if (!directory && argv[k][0] != '-')
            directory = argv[k];
        else if (part < PARTS)
            some = wanted[part] = true;
        else
            return usage(argv[k]);
    }
    if (!directory)
        return usage("no directory");
    for (int k = 0; k < PARTS; k++)
        if (wanted[k] || !some)
            run_part(&v, directory, &parts[k], bits);
    if (v.known)
        printf("known: %d properties that are not promised miss their bars\n",
               v.known);
    printf("%d passed, %d failed\n", v.passed, v.failed);
    return v.failed || !v.passed;
}
