// SPDX-License-Identifier: Apache-2.0
// Oracle of intersecting triangles by CGAL's exact predicates. oracle/README.md
#include "oracle/oracle.h"

// Turns off CGAL's internal checks, which take half of its time.
#define CGAL_NDEBUG

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/box_intersection_d.h>

#include <algorithm>
#include <utility>
#include <vector>

namespace
{

using K = CGAL::Exact_predicates_inexact_constructions_kernel;
using Pairs = std::vector<std::pair<int32_t, int32_t>>;

K::Point_3 point(const double p[3])
{
    return K::Point_3(p[0], p[1], p[2]);
}

int64_t give(Pairs &found, int64_t cap, int32_t (*pair)[2])
{
    for (auto &p : found)
        if (p.first > p.second)
            std::swap(p.first, p.second);
    std::sort(found.begin(), found.end());
    for (int64_t k = 0; k < cap && k < (int64_t)found.size(); k++) {
        pair[k][0] = found[k].first;
        pair[k][1] = found[k].second;
    }
    return (int64_t)found.size();
}

struct Soup {
    const double (*x)[3];
    const int32_t (*tri)[3];

    K::Point_3 at(int32_t t, int k) const { return point(x[tri[t][k % 3]]); }
    K::Triangle_3 triangle(int32_t t) const
    {
        return K::Triangle_3(at(t, 0), at(t, 1), at(t, 2));
    }
    K::Segment_3 opposite(int32_t t, int k) const
    {
        return K::Segment_3(at(t, k + 1), at(t, k + 2));
    }
    bool intersect(int32_t a, int32_t b) const;
};

// Tests two triangles by the number of vertices they share. None: the whole
// triangles; one: the edges opposite to the shared vertex; two: the third
// corners about the shared edge.
bool Soup::intersect(int32_t a, int32_t b) const
{
    int shared = 0, in_a = 0, in_b = 0, sum_a = 0, sum_b = 0;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            if (tri[a][i] == tri[b][j]) {
                shared++;
                in_a = i, in_b = j;
                sum_a += i, sum_b += j;
            }
    if (shared == 0)
        return CGAL::do_intersect(triangle(a), triangle(b));
    if (shared == 1)
        return CGAL::do_intersect(triangle(a), opposite(b, in_b)) ||
               CGAL::do_intersect(triangle(b), opposite(a, in_a));
    if (shared == 3)
        return true;
    int i = 3 - sum_a, j = 3 - sum_b; // the corners that are not shared
    return CGAL::coplanar(at(a, 0), at(a, 1), at(a, 2), at(b, j)) &&
           CGAL::coplanar_orientation(at(a, i + 1), at(a, i + 2), at(a, i),
                                      at(b, j)) == CGAL::POSITIVE;
}

} // namespace

int64_t orc_self_pairs(int64_t nv, const double (*x)[3], int64_t nt,
                       const int32_t (*tri)[3], const int32_t *group,
                       int64_t cap, int32_t (*pair)[2], int64_t *degenerate)
{
    using Policy = CGAL::Box_intersection_d::ID_EXPLICIT;
    using Box =
        CGAL::Box_intersection_d::Box_with_info_d<double, 3, int32_t, Policy>;
    (void)nv;
    Soup soup{x, tri};
    std::vector<Box> free, still; // of group 0
    CGAL::Bbox_3 all;
    *degenerate = 0;
    for (int32_t t = 0; t < nt; t++) {
        if (CGAL::collinear(soup.at(t, 0), soup.at(t, 1), soup.at(t, 2))) {
            ++*degenerate;
            continue;
        }
        bool moves = group == nullptr || group[t] != 0;
        CGAL::Bbox_3 box = soup.triangle(t).bbox();
        (moves ? free : still).push_back(Box(box, t));
        if (moves)
            all += box;
    }
    still.erase(std::remove_if(still.begin(), still.end(),
                               [&](const Box &b) {
                                   return !CGAL::do_overlap(b.bbox(), all);
                               }),
                still.end());
    Pairs found;
    auto test = [&](const Box &p, const Box &q) {
        if (soup.intersect(p.info(), q.info()))
            found.push_back({p.info(), q.info()});
    };
    // Below this number of boxes CGAL sweeps instead of splitting; its default
    // of 10 takes twice as long.
    const std::ptrdiff_t few = 1000;
    CGAL::box_self_intersection_d(free.begin(), free.end(), test, few);
    CGAL::box_intersection_d(free.begin(), free.end(), still.begin(),
                             still.end(), test, few);
    return give(found, cap, pair);
}

int64_t orc_self_pmp(int64_t nv, const double (*x)[3], int64_t nt,
                     const int32_t (*tri)[3], int64_t cap, int32_t (*pair)[2],
                     int64_t *degenerate)
{
    using Mesh = CGAL::Surface_mesh<K::Point_3>;
    Mesh mesh;
    for (int64_t k = 0; k < nv; k++)
        mesh.add_vertex(point(x[k]));
    for (int64_t t = 0; t < nt; t++) {
        auto v = [&](int k) { return Mesh::Vertex_index(tri[t][k]); };
        if (mesh.add_face(v(0), v(1), v(2)) == Mesh::null_face())
            return -1;
    }
    std::vector<std::pair<Mesh::Face_index, Mesh::Face_index>> faces;
    CGAL::Polygon_mesh_processing::self_intersections(
        mesh, std::back_inserter(faces));
    Pairs found;
    *degenerate = 0;
    for (auto &f : faces) {
        if (f.first == f.second)
            ++*degenerate;
        else
            found.push_back({(int32_t)f.first, (int32_t)f.second});
    }
    return give(found, cap, pair);
}

int orc_orient3(const double a[3], const double b[3], const double c[3],
                const double d[3])
{
    return CGAL::orientation(point(a), point(b), point(c), point(d));
}
