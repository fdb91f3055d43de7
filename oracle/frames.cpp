// SPDX-License-Identifier: Apache-2.0
// Audits the frames of a run by CGAL, with the output format of `drape audit`,
// so that ci/scenes.sh can compare the two. It reads frames by code of its own.
// usage: frames DIRECTORY [EVERY]
#include "oracle/oracle.h"

#include <cinttypes>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

namespace
{

// Vertices and triangles in flat arrays, as the oracle takes them.
struct Mesh {
    std::vector<double> x;
    std::vector<int32_t> tri, group;
};

[[noreturn]] void fail(const std::string &file, const char *what)
{
    std::fprintf(stderr, "%s: %s\n", file.c_str(), what);
    std::exit(2);
}

template <class T> T take(std::ifstream &in, const std::string &file)
{
    T value;
    if (!in.read(reinterpret_cast<char *>(&value), sizeof value))
        fail(file, "ends early");
    return value;
}

// The counts in a file's header, and whether coordinates are binary64.
struct Header {
    long vertices = -1, faces = -1;
    bool wide = false;
};

Header read_header(std::ifstream &in, const std::string &file)
{
    Header h;
    std::string line, word, kind;
    while (std::getline(in, line) && line != "end_header") {
        std::istringstream words(line);
        words >> word >> kind;
        if (word == "format" && kind != "binary_little_endian")
            fail(file, "is not what drape writes");
        if (word == "element")
            words >> (kind == "vertex" ? h.vertices : h.faces);
        h.wide |= word == "property" && kind == "double";
    }
    if (h.vertices < 0 || h.faces < 0)
        fail(file, "has no vertices or faces");
    return h;
}

// Adds a file's mesh as a group. Returns false if there is no such file.
bool append(Mesh &mesh, const std::string &file, int32_t group)
{
    std::ifstream in(file, std::ios::binary);
    if (!in)
        return false;
    Header h = read_header(in, file);
    auto first = (int32_t)(mesh.x.size() / 3);
    for (long k = 0; k < 3 * h.vertices; k++)
        mesh.x.push_back(h.wide ? take<double>(in, file)
                                : (double)take<float>(in, file));
    for (long k = 0; k < h.faces; k++) {
        if (take<uint8_t>(in, file) != 3)
            fail(file, "has a face that is no triangle");
        for (int c = 0; c < 3; c++) {
            auto v = take<int32_t>(in, file);
            if (v < 0 || v >= h.vertices)
                fail(file, "has a face beyond its vertices");
            mesh.tri.push_back(first + v);
        }
        mesh.group.push_back(group);
    }
    return true;
}

std::string path(const std::string &directory, const char *name, int frame)
{
    char text[64];
    std::snprintf(text, sizeof text, "/frames/%s_%04d.ply", name, frame);
    return directory + text;
}

// Returns the number of intersecting pairs of a frame, without pairs of two
// obstacles; -1: no such frame.
int64_t pairs_of(const std::string &directory, int frame)
{
    Mesh mesh;
    if (!append(mesh, path(directory, "cloth", frame), 1))
        return -1;
    if (!append(mesh, path(directory, "obstacles", frame), 0))
        append(mesh, directory + "/obstacles.ply", 0);
    int64_t degenerate, nt = (int64_t)mesh.group.size();
    return orc_self_pairs(
        (int64_t)mesh.x.size() / 3,
        reinterpret_cast<const double(*)[3]>(mesh.x.data()), nt,
        reinterpret_cast<const int32_t(*)[3]>(mesh.tri.data()),
        mesh.group.data(), 0, nullptr, &degenerate);
}

} // namespace

int main(int argc, char **argv)
{
    const int every = argc > 2 ? std::atoi(argv[2]) : 1;
    if (argc < 2 || argc > 3 || every < 1) {
        std::fputs("usage: frames DIRECTORY [EVERY]\n", stderr);
        return 2;
    }
    int64_t sum = 0, bad = 0, found;
    int frames = 0;
    for (; (found = pairs_of(argv[1], frames * every)) >= 0; frames++) {
        sum += found;
        bad += found > 0;
    }
    if (frames == 0)
        fail(argv[1], "no frames/cloth_0000.ply here");
    std::printf("%s: %d frames, %" PRId64 " of them with intersecting pairs, "
                "%" PRId64 " pairs\n",
                argv[1], frames, bad, sum);
    return sum != 0;
}
