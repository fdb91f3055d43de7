// SPDX-License-Identifier: Apache-2.0
// Counts each oracle's wrong answers over files of queries with known truth,
// and prints the tables of oracle/README.md.
#include "oracle/oracle.h"

#include <gmpxx.h>

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

namespace
{

struct Query {
    double x0[4][3], x1[4][3];
    bool truth;
};

struct Counts {
    long missed = 0, invented = 0, late = 0;

    void add(bool truth, bool hit)
    {
        missed += truth && !hit;
        invented += hit && !truth;
    }
};

[[noreturn]] void fail(const std::string &file, long line, const char *what)
{
    std::fprintf(stderr, "%s:%ld: %s\n", file.c_str(), line, what);
    std::exit(1);
}

// Eight rows a query: xn,xd,yn,yd,zn,zd,truth.
std::vector<Query> read(const std::string &file)
{
    std::ifstream in(file);
    std::vector<Query> queries;
    std::string row, cell[7];
    for (long line = 0; std::getline(in, row); line++) {
        std::istringstream cells(row);
        for (auto &c : cell)
            if (!std::getline(cells, c, ','))
                fail(file, line + 1, "seven columns are expected");
        if (line % 8 == 0)
            queries.push_back({});
        Query &q = queries.back();
        for (int k = 0; k < 3; k++) {
            mpq_class r(cell[2 * k] + "/" + cell[2 * k + 1]);
            r.canonicalize();
            double x = r.get_d();
            if (mpq_class(x) != r)
                fail(file, line + 1, "a number is not a binary64");
            (line % 8 < 4 ? q.x0 : q.x1)[line % 4][k] = x;
        }
        q.truth = cell[6][0] == '1';
    }
    if (queries.empty())
        fail(file, 1, "no query");
    return queries;
}

// Whether libccd reports that the hulls of the two swept primitives intersect,
// which they do for every pair that touches.
bool swept_hulls_meet(int method, int kind, const Query &q)
{
    double p[8][3];
    int n = kind == 0 ? 1 : 2;
    for (int k = 0; k < 8; k++)
        for (int c = 0; c < 3; c++) {
            int at = k < 2 * n ? k / 2 : n + (k - 2 * n) / 2;
            p[k][c] = (k % 2 ? q.x1 : q.x0)[at][c];
        }
    return orc_hull_ccd(method, 2 * n, p, 8 - 2 * n, p + 2 * n) != 0;
}

void print(const std::string &file)
{
    int kind = file.find("-ee") != std::string::npos;
    long truths = 0, differ = 0;
    Counts gmp, cgal, fcl[2], hull[2];
    const auto queries = read(file);
    for (const Query &q : queries) {
        uint32_t first, again;
        double t;
        truths += q.truth;
        gmp.add(q.truth, orc_ccd_gmp(kind, q.x0, q.x1, &first));
        cgal.add(q.truth, orc_ccd_cgal(kind, q.x0, q.x1, &again));
        differ += first != again;
        for (int k = 0; k < 2; k++) {
            bool hit = orc_ccd_fcl(kind, k, q.x0, q.x1, &t);
            fcl[k].add(q.truth, hit);
            fcl[k].late += hit && q.truth && t >= (first + 1.0) * 0x1p-30;
            hull[k].add(q.truth, swept_hulls_meet(k, kind, q));
        }
    }
    std::string name = file.substr(file.rfind('/') + 1);
    std::printf("| %s | %zu | %ld | %ld | %ld | %ld |", name.c_str(),
                queries.size(), truths, gmp.missed + gmp.invented,
                cgal.missed + cgal.invented, differ);
    for (const Counts &c : fcl)
        std::printf(" %ld / %ld / %ld |", c.missed, c.invented, c.late);
    std::printf(" %ld | %ld |\n", hull[0].missed, hull[1].missed);
    std::fflush(stdout);
}

} // namespace

int main(int argc, char **argv)
{
    std::puts("| file | queries | true | GMP wrong | CGAL wrong | toi differ "
              "| FCL Newton | FCL cubic | GJK | MPR |\n"
              "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |");
    for (int k = 1; k < argc; k++)
        print(argv[k]);
    return argc < 2;
}
