/* SPDX-License-Identifier: Apache-2.0 */
/* The same as 1_hang.c in C++, to the last bit. The world is released by a
 * smart pointer, and errors are exceptions. Built with
 *     c++ -std=c++17 1_hang.cpp $(pkg-config --cflags --libs drape) -o 1_hang
 * or by the CMakeLists.txt beside it. */
#include <drape.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <exception>
#include <memory>
#include <stdexcept>
#include <vector>

static_assert(DRAPE_VERSION_MAJOR == 0 && DRAPE_VERSION_MINOR >= 1,
              "written for drape 0.1 and later");

namespace
{

constexpr int side = 41, steps = 60;

struct destroy {
    void operator()(drape_world *world) const { drape_destroy(world); }
};
using world_pointer = std::unique_ptr<drape_world, destroy>;

void check(int status)
{
    if (status != DRAPE_OK)
        throw std::runtime_error(drape_status_text(status));
}

/* A sheet of one metre, held by its first row. */
world_pointer make()
{
    std::vector<drape_pin> pins;
    for (int i = 0; i < side; i++)
        pins.push_back({i, 0, -1});
    drape_cloth cloth;
    drape_default_cloth(&cloth);
    cloth.m = cloth.n = side;
    cloth.v[1] = -1;
    cloth.v[2] = 0;
    cloth.pins = pins.data();
    cloth.n_pins = side;
    drape_def def;
    drape_default(&def);
    def.cloths = &cloth;
    def.n_cloths = 1;

    drape_world *world = nullptr;
    drape_error error;
    if (drape_create(&def, &world, &error) != DRAPE_OK)
        throw std::runtime_error(error.text);
    return world_pointer(world); /* drape_create has copied the definition */
}

int run()
{
    world_pointer world = make();
    int clean = 0;
    for (int k = 0; k < steps; k++) {
        drape_step_report report;
        check(drape_step(world.get(), &report));
        clean += report.outcome == 0;
    }
    std::vector<std::array<double, 3>> x(
        static_cast<std::size_t>(drape_vertices(world.get())));
    check(drape_read(world.get(), reinterpret_cast<double(*)[3]>(x.data()),
                     nullptr));
    double lowest = 0;
    for (const auto &at : x)
        lowest = std::min(lowest, at[1]);
    std::printf("%d of %d steps clean, longer by %.4f mm\n", clean, steps,
                1000 * (-lowest - 1));
    return clean == steps ? 0 : 1;
}

} // namespace

int main()
{
    try {
        return run();
    } catch (const std::exception &error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 1;
    }
}
