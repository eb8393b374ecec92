// SPDX-License-Identifier: Apache-2.0
#include <tests/stacks/solids.h>

#include <raycontact/mass.h>

namespace raycontact::scenes {

namespace {

using Triangles = std::vector<std::array<std::uint32_t, 3>>;

void add_quad(Triangles& triangles, std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    triangles.push_back({a, b, c});
    triangles.push_back({a, c, d});
}

// Counter-clockwise from above.
void add_ring(Mesh& mesh, double x, double y, double z) {
    for (const auto& [sx, sy] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}})
        mesh.vertices.push_back({sx * x / 2, sy * y / 2, z});
}

Mesh centred(Mesh mesh) {
    const Vec3 centre = mass_of(mesh.vertices, mesh.triangles).centre;
    for (Vec3& v : mesh.vertices) v = {v.x - centre.x, v.y - centre.y, v.z - centre.z};
    return mesh;
}

} // namespace

Mesh solid_wedge(const Vec3& size, bool upper) {
    Mesh mesh;
    mesh.name = "wedge";
    const double x = size.x / 2, y = size.y / 2, z = size.z / 2;
    for (const double side : {-y, y}) {
        mesh.vertices.push_back({-x, side, -z});
        if (upper) {
            mesh.vertices.push_back({x, side, z});
            mesh.vertices.push_back({-x, side, z});
        } else {
            mesh.vertices.push_back({x, side, -z});
            mesh.vertices.push_back({x, side, z});
        }
    }
    mesh.triangles = {{0, 1, 2}, {3, 5, 4}};
    for (std::uint32_t k = 0; k < 3; ++k) add_quad(mesh.triangles, (k + 1) % 3, k, 3 + k, 3 + (k + 1) % 3);
    return centred(std::move(mesh));
}

Mesh solid_tray(const Vec3& size, double thick) {
    Mesh mesh;
    mesh.name = "tray";
    add_ring(mesh, size.x, size.y, 0);
    add_ring(mesh, size.x, size.y, size.z);
    add_ring(mesh, size.x - 2 * thick, size.y - 2 * thick, size.z);
    add_ring(mesh, size.x - 2 * thick, size.y - 2 * thick, thick);
    add_quad(mesh.triangles, 0, 3, 2, 1);
    for (std::uint32_t ring = 0; ring < 12; ring += 4)
        for (std::uint32_t k = 0; k < 4; ++k) {
            const std::uint32_t next = (k + 1) % 4;
            add_quad(mesh.triangles, ring + k, ring + next, ring + 4 + next, ring + 4 + k);
        }
    add_quad(mesh.triangles, 12, 13, 14, 15);
    return centred(std::move(mesh));
}

} // namespace raycontact::scenes
