/* SPDX-License-Identifier: Apache-2.0 */
/* drape, the command-line tool. It includes <drape.h> only, so it is also
 * the example of how to embed the library. */
#include "app/base/nearest.h"
#include "app/tool/options.h"

#include <drape.h>
#include <errno.h>
#include <signal.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

static int command_info(int argc, char **argv);
static int command_help(int argc, char **argv);

static const struct command {
    const char *name;
    int (*call)(int argc, char **argv);
    const char *summary, *usage;
} commands[] = {
    {"run", command_run, "simulate a scene and write its frames",
     "drape run SCENE.json|- [options]\n"
     "  --frames N            frames to make (default: the scene's)\n"
     "  --out DIR             where to write (default: the scene's name)\n"
     "  --backend ref|gpu     who computes (default: the scene's)\n"
     "  --precision 32|64     bits of a number in the state\n"
     "  --threads N           of the reference, 0: as many as cores (default)\n"
     "  --block N             threads of a block on the device, to 256\n"
     "  --every N             write every N-th frame only\n"
     "  --error E             m: choose integrator, dt and tolerance by trial\n"
     "  --checkpoint-every K  write DIR/checkpoint.drape every K frames\n"
     "  --resume FILE         go on from a checkpoint, bit for bit\n"
     "  --force               remove another run's files from DIR first\n"
     "  --trace               write DIR/trace.csv, a digest a stage\n"
     "  --contacts            write what touches in each frame, and impulses\n"
     "  --obj                 frames as OBJ too, with names and UVs\n"
     "  --no-obj              frames as PLY only, as without --obj\n"
     "  --allow-intersecting  accept a start state that intersects\n"
     "Ctrl-C finishes the step and leaves a checkpoint and the report.\n"},
    {"plan", command_plan, "print the stages of a scene, memory and time",
     "drape plan SCENE.json|- [--backend ref|gpu] [--precision 32|64]\n"
     "  [--allow-intersecting] [--speed speed.csv]\n"
     "Each stage, whether it is on, its memory, and why; and the time of a "
     "step\n"
     "on machines that were measured, or on those in what `make bench` "
     "wrote.\n"},
    {"audit", command_audit, "count intersecting triangle pairs, exactly",
     "drape audit MESH... | DIR [--obstacle MESH] [--list] [--frames] "
     "[--between]\n"
     "Meshes are tested against themselves and each other; those given by\n"
     "--obstacle not against themselves. DIR is what `run` wrote: every\n"
     "frame there is tested, and pairs that a seam joins are counted apart.\n"
     "--list prints the pairs. Exit status 1 on any.\n"
     "--frames: each MESH is a frame of one mesh, as any program made it;\n"
     "--between: what touches on the straight way to the next frame counts, "
     "too.\n"
     "These two, and files .npz, .usd and .abc with all their frames, need "
     "the\n"
     "Python package.\n"},
    {"render", command_render, "make pictures and a film of a run",
     "drape render DIR [options]\n"
     "  --frame N        this frame only (default: a film of all that are "
     "there)\n"
     "  --every K        every K-th of the frames there\n"
     "  --turn N         N pictures of one frame (default: the last), all "
     "around\n"
     "  --width W --height H   in pixels (default: 800 × 600)\n"
     "  --samples S      a pixel (default: 8)\n"
     "  --threads N      0: as many as cores (default)\n"
     "  --rate R         pictures a second of film (default: real time)\n"
     "  --no-film        pictures only\n"},
    {"ccd", command_ccd, "decide collision queries, exactly",
     "drape ccd --kind vf|ee FILE.csv|- | --frames A.ply B.ply\n"
     "Eight rows a query, xn,xd,yn,yd,zn,zd[,truth]: `v f0 f1 f2` or\n"
     "`a0 a1 b0 b1` at time 0, then at time 1. Prints `0` or `1 TOI`.\n"
     "--frames: a mesh at time 0 and 1. Prints all pairs that share no\n"
     "vertex and touch, `vf v f0 f1 f2` or `ee a0 a1 b0 b1`.\n"},
    {"convert", command_convert, "turn, size and level a mesh",
     "drape convert IN OUT [--up X,Y,Z] [--size S]\n"
     "Direction --up becomes +y, the largest dimension S, and the mesh\n"
     "stands on y = 0 in the middle of x and z. OUT ends in .ply, .obj,\n"
     ".stl, .glb, .dae or .fbx; - is PLY on standard output.\n"},
    {"pattern", command_pattern, "cut the panels of a sewing pattern",
     "drape pattern FILE.json [--cell H] [--out DIR]\n"
     "Reads a pattern in GarmentCode's JSON, lays its panels on grids of cells "
     "H m\n"
     "wide (default: 0.005), and prints how near cells and outlines are, and "
     "the\n"
     "lengths of seams. DIR gets tables, a picture, and the panels as PLY.\n"},
    {"sew", command_sew, "sew a garment and drape it on a body",
     "drape sew PATTERN.json [--body MESH] [options] | SCENE.json [options]\n"
     "          | MESH.obj [--unit M] [--body MESH] [options]\n"
     "  --body MESH      that wears it, in metres, y up\n"
     "  --motion SEQ     of the body, once it is worn: a point cache (.pc2), "
     "or\n"
     "                   numbered files, as walk_%04d.ply\n"
     "  --rate R         frames of SEQ a second (default: 60)\n"
     "  --apart H        m, room that parts of the body make where they press "
     "on\n"
     "                   each other (default: none)\n"
     "  --cell H         m, side of a cell (default: 0.005)\n"
     "  --fabric NAME    of `drape materials` (default: light cotton)\n"
     "  --attach LABEL[:soft|hard][:body|world][:SECONDS][,…] | none\n"
     "                   edges that are held once it is worn (default:\n"
     "                   lower_interface, where nothing is sewn to it)\n"
     "  --frames N       at most, until it is at rest (default: 600, or the\n"
     "                   scene's); then bodies move, if they do\n"
     "  --out DIR        where to write (default: the name)\n"
     "  --backend ref|gpu, --precision 32|64, --threads N, --block N\n"
     "  --every N        write every N-th frame only\n"
     "  --force          remove another run's files from DIR first\n"
     "  --trace          write DIR/trace.csv, a digest a stage\n"
     "  --obj            frames as OBJ too, with names and UVs\n"
     "  --no-motion      bodies stay where they are at time 0\n"
     "  --no-picture     no pictures of the end, front and back\n"
     "  --unit M         m, of MESH.obj's vertices: 0.001 for mm (default: 1)\n"
     "MESH.obj has UVs: its charts are panels, and DIR/mesh gets it anew a "
     "frame.\n"
     "A scene has its `garments`. Writes what `run` writes; sew.json, how its "
     "seams\nclosed; and sewn.json, a scene for `run` that begins as sewing "
     "ended.\n"
     "Exit status 1: a seam is open, or a step is not clean.\n"},
    {"untangle", command_untangle, "part a start that intersects",
     "drape untangle MESH... [--obstacle MESH] [options] | SCENE.json "
     "[options]\n"
     "Lists where meshes go through themselves and each other, in regions, "
     "and\n"
     "parts them; obstacles stay. DIR gets a mesh for each, untangle.json, "
     "pictures\nof where it was, and of a scene of garments start.json, which "
     "begins so.\n"
     "  --out DIR      where to write (default: untangled)\n"
     "  --rounds N     at most (default: 200); 0: lists only\n"
     "  --no-picture   no pictures\n"
     "Exit status 1: something still intersects.\n"},
    {"export", command_export, "write a run as USD, glTF, Alembic, film …",
     "drape export DIR --to FILE [--every K]\n"
     "FILE ends in .usdc, .usda, .usd, .glb, .abc, .npz, or for a film in "
     ".mp4\n"
     "or .gif, and gets the frames there, or every K-th of them. A name as\n"
     "frame_%04d.vtu is a file a frame, and ends in .ply, .obj, .off, .stl,\n"
     ".vtk or .vtu.\n"
     "It is part of the Python package.\n"},
    {"view", command_view, "show a run or a scene in a web browser",
     "drape view DIR|SCENE.json|MESH [--port N] [--host NAME] [--paused]\n"
     "Serves a page that shows the run, or the scene while it is computed and\n"
     "can be touched, or frames of meshes, as .npz, .usd, .ply.\n"
     "It is part of the Python package.\n"},
    {"sweep", command_sweep, "run many variants of a scene",
     "drape sweep SCENE.json --out DIR --set KEY=V,V... | --draw KEY=LO..HI\n"
     "  --set KEY=V,V...   each value of a key, as cloths.0.material.bend; of\n"
     "                     several keys all combinations\n"
     "  --draw KEY=LO..HI  at random between two numbers, --count N times,\n"
     "                     from --seed S\n"
     "  --frames N         frames to make (default: the scene's)\n"
     "  --every K          keep the positions of every K-th\n"
     "  --sew              sew the garments first, as drape sew does\n"
     "  --workers N        at a time (default: as many as processors)\n"
     "  --on local|ray|slurm  where; --option TEXT: of sbatch, once each\n"
     "Writes DIR/table.parquet and the arrays of each; what is there already "
     "is\nnot run again. It is part of the Python package.\n"},
    {"fetch-models", command_fetch_models,
     "fetch the statues of drape's own scenes",
     "drape fetch-models DIR [--from FROM]\n"
     "Fetches the public statues into DIR/models and collision queries with\n"
     "their truth into DIR/ccd, and prints their credits. What is there "
     "stays.\n"
     "DRAPE_DATA=DIR then names them to all commands. --from: a folder or an\n"
     "address that holds them, in place of the public ones. It needs curl,\n"
     "python3, and for the lion apt-get. Exit status 1: something is "
     "missing.\n"},
    {"materials", command_materials, "list the fabrics that scenes may name",
     "drape materials\n"
     "Each with its numbers, what it is, and where they are from.\n"},
    {"info", command_info, "print versions, precisions and backends",
     "drape info\n"},
    {"help", command_help, "print this, or the help of one command",
     "drape help [COMMAND]\n"},
};
enum { COMMANDS = sizeof commands / sizeof commands[0] };

static const struct command *find(const char *name)
{
    for (int k = 0; k < COMMANDS; k++)
        if (strcmp(commands[k].name, name) == 0)
            return &commands[k];
    return NULL;
}

static int unknown(const char *name)
{
    struct nearest nearest = {.word = name};
    for (int k = 0; k < COMMANDS; k++)
        nearest_try(&nearest, commands[k].name);
    nearest_try(&nearest, "--version");
    nearest_try(&nearest, "--quiet");
    nearest_try(&nearest, "--help");
    int row = 0;
    const char *in, *other = hint_name(name, &row, &in);
    if (other && find(other))
        nearest.name = other;
    const char *what = *name == '-' ? "unknown option" : "no such command";
    if (nearest.name)
        return complain(APP_USAGE, "%s: %s; did you mean %s?", name, what,
                        nearest.name);
    return complain(APP_USAGE, "%s: %s (try: drape help)", name, what);
}

static int command_info(int argc, char **argv)
{
    int status = options_none("info", argc, argv);
    if (status == APP_OK)
        fputs(drape_info(), stdout);
    return status;
}

static void list_commands(FILE *out)
{
    fputs("usage: drape COMMAND [arguments]\n\n", out);
    for (int k = 0; k < COMMANDS; k++)
        fprintf(out, "  %-12s %s\n", commands[k].name, commands[k].summary);
    fputs("\n--quiet, before or after a command: no progress and no notes.\n"
          "--version: one line.\n"
          "`-` is standard input for a SCENE.json or a FILE.csv, and standard "
          "output\nfor the mesh that convert writes.\n",
          out);
    fputs("\nExit status: 0 done, 1 findings, 2 bad input, 3 failure, 130 "
          "interrupted.\n",
          out);
}

static int command_help(int argc, char **argv)
{
    static const struct option_row none[] = {{0}};
    int positional;
    int status = options_read(none, argc, argv, &positional);
    if (status != APP_OK)
        return status;
    if (positional > 1)
        return complain(APP_USAGE, "help: expected one COMMAND");
    if (positional == 0) {
        list_commands(stdout);
        return APP_OK;
    }
    const struct command *command = find(argv[0]);
    if (!command)
        return unknown(argv[0]);
    printf("%s\n\nusage: %s", command->summary, command->usage);
    return APP_OK;
}

/* Flushes standard output. If output was lost (a full disk, a closed pipe) the
 * whole call fails, unless it failed already. */
static int flush(int status)
{
    errno = 0;
    if (fflush(stdout) == 0 && !ferror(stdout))
        return status;
    return complain(APP_FAILED, "standard output: cannot write: %s",
                    errno ? strerror(errno) : "a part of it was lost");
}

/* Whether --help or -h is among the arguments of a command. */
static bool asks_help(int argc, char **argv)
{
    for (int k = 2; k < argc && strcmp(argv[k], "--") != 0; k++)
        if (strcmp(argv[k], "--help") == 0 || strcmp(argv[k], "-h") == 0)
            return true;
    return false;
}

int main(int argc, char **argv)
{
    /* a closed pipe or a file at its size limit then makes a write fail, which
     * is reported, instead of ending the process */
    signal(SIGPIPE, SIG_IGN);
    signal(SIGXFSZ, SIG_IGN);
    /* who ignores the end of children passes that on; then nobody could tell
     * how a reader of meshes or ffmpeg has ended */
    signal(SIGCHLD, SIG_DFL);
    for (; argc > 1 && strcmp(argv[1], "--quiet") == 0; argc--, argv++)
        app_quiet = true;
    if (argc < 2) {
        list_commands(stderr);
        return APP_USAGE;
    }
    const char *name = argv[1];
    if (strcmp(name, "--help") == 0 || strcmp(name, "-h") == 0)
        name = "help";
    if (strcmp(name, "--version") == 0) {
        puts("drape " DRAPE_VERSION);
        return flush(APP_OK);
    }
    const struct command *command = find(name);
    if (!command)
        return unknown(name);
    if (asks_help(argc, argv))
        return flush(command_help(1, argv + 1));
    return flush(command->call(argc - 2, argv + 2));
}
