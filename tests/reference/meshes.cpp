// SPDX-License-Identifier: Apache-2.0
#include "reference/meshes.h"

#include "reference/vector.h"

#include <array>
#include <map>

namespace raycontact::reference {

namespace {

using Triangle = std::array<std::uint32_t, 3>;

// Quads with corners counter-clockwise, split along the first diagonal.
void add_quad(Mesh& mesh, std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    mesh.triangles.push_back({a, b, c});
    mesh.triangles.push_back({a, c, d});
}

// A closed polygon (counter-clockwise seen from +z) from z = 0 to z = height, with the triangles of its cap.
Mesh prism(const char* name, const std::vector<std::array<double, 2>>& outline, const std::vector<Triangle>& cap,
           double height) {
    Mesh mesh;
    mesh.name = name;
    const auto n = static_cast<std::uint32_t>(outline.size());
    for (const double z : {0.0, height})
        for (const auto& p : outline) mesh.vertices.push_back({p[0], p[1], z});
    for (const Triangle& t : cap) {
        mesh.triangles.push_back({t[0], t[2], t[1]});
        mesh.triangles.push_back({t[0] + n, t[1] + n, t[2] + n});
    }
    for (std::uint32_t i = 0; i < n; ++i) add_quad(mesh, i, (i + 1) % n, (i + 1) % n + n, i + n);
    return mesh;
}

// (n + 1)^2 vertices over [-1, 1]^2 at the height given, triangles facing up.
template <class Height>
Mesh height_field(const char* name, std::uint32_t n, Height height) {
    Mesh mesh;
    mesh.name = name;
    for (std::uint32_t j = 0; j <= n; ++j)
        for (std::uint32_t i = 0; i <= n; ++i) {
            const double x = 2.0 * i / n - 1;
            const double y = 2.0 * j / n - 1;
            mesh.vertices.push_back({x, y, height(x, y)});
        }
    for (std::uint32_t j = 0; j < n; ++j)
        for (std::uint32_t i = 0; i < n; ++i) {
            const std::uint32_t corner = j * (n + 1) + i;
            add_quad(mesh, corner, corner + 1, corner + n + 2, corner + n + 1);
        }
    return mesh;
}

} // namespace

Mesh box_mesh(const Vec3& h) {
    Mesh mesh = prism("box", {{-h.x, -h.y}, {h.x, -h.y}, {h.x, h.y}, {-h.x, h.y}}, {{0, 1, 2}, {0, 2, 3}}, 2 * h.z);
    return moved(std::move(mesh), {0, 0, -h.z});
}

Mesh grid_box_mesh(std::uint32_t n) {
    Mesh mesh;
    mesh.name = "grid box";
    std::map<std::array<std::uint32_t, 3>, std::uint32_t> index;
    const auto vertex = [&](const std::array<std::uint32_t, 3>& p) {
        const auto [found, fresh] = index.try_emplace(p, static_cast<std::uint32_t>(mesh.vertices.size()));
        if (fresh) mesh.vertices.push_back({1.0 * p[0] / n, 1.0 * p[1] / n, 1.0 * p[2] / n});
        return found->second;
    };
    for (std::size_t axis = 0; axis < 3; ++axis)
        for (const bool high : {false, true})
            for (std::uint32_t j = 0; j < n; ++j)
                for (std::uint32_t i = 0; i < n; ++i) {
                    const auto at = [&](std::uint32_t u, std::uint32_t v) {
                        std::array<std::uint32_t, 3> p{};
                        p[axis] = high ? n : 0;
                        p[(axis + 1) % 3] = u;
                        p[(axis + 2) % 3] = v;
                        return vertex(p);
                    };
                    // One after the other: the order of arguments is the compiler's, and new vertices count up.
                    const std::uint32_t a = at(i, j);
                    const std::uint32_t b = at(i + 1, j);
                    const std::uint32_t c = at(i + 1, j + 1);
                    const std::uint32_t d = at(i, j + 1);
                    if (high)
                        add_quad(mesh, a, b, c, d);
                    else
                        add_quad(mesh, a, d, c, b);
                }
    return mesh;
}

Mesh tetrahedron_mesh() {
    Mesh mesh;
    mesh.name = "tetrahedron";
    mesh.vertices = {{0, 0, 0}, {1, 0, 0.125}, {0.25, 1, 0}, {0.375, 0.25, 0.875}};
    mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
    return mesh;
}

Mesh cone_mesh() {
    Mesh mesh;
    mesh.name = "cone";
    mesh.vertices = {{0.5, 0.2, 0},   {0.2, 0.5, 0},  {-0.2, 0.5, 0}, {-0.5, 0.2, 0}, {-0.5, -0.2, 0},
                     {-0.2, -0.5, 0}, {0.2, -0.5, 0}, {0.5, -0.2, 0}, {0, 0, 1}};
    for (std::uint32_t i = 0; i < 8; ++i) mesh.triangles.push_back({i, (i + 1) % 8, 8});
    for (std::uint32_t i = 1; i < 7; ++i) mesh.triangles.push_back({0, i + 1, i});
    return mesh;
}

Mesh l_prism_mesh() {
    return prism("L prism", {{0, 0}, {1, 0}, {1, 0.5}, {0.5, 0.5}, {0.5, 1}, {0, 1}},
                 {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 5}}, 0.5);
}

Mesh frame_mesh() {
    Mesh mesh;
    mesh.name = "frame";
    for (const double z : {0.0, 0.25})
        for (const double h : {0.75, 0.375}) // outer square, then the hole
            for (const auto& p : std::array<std::array<double, 2>, 4>{{{-h, -h}, {h, -h}, {h, h}, {-h, h}}})
                mesh.vertices.push_back({p[0], p[1], z});
    for (std::uint32_t i = 0; i < 4; ++i) {
        const std::uint32_t j = (i + 1) % 4;
        add_quad(mesh, i, j, 8 + j, 8 + i);           // outer wall
        add_quad(mesh, 4 + j, 4 + i, 12 + i, 12 + j); // wall of the hole
        add_quad(mesh, 8 + i, 8 + j, 12 + j, 12 + i); // top
        add_quad(mesh, j, i, 4 + i, 4 + j);           // bottom
    }
    return mesh;
}

Mesh bumpy_octahedron_mesh(std::uint32_t n) {
    Mesh mesh;
    mesh.name = "bumpy octahedron";
    std::map<std::array<int, 3>, std::uint32_t> index;
    const int m = static_cast<int>(n);
    const auto vertex = [&](int x, int y, int z) {
        const auto [found, fresh] = index.try_emplace({x, y, z}, static_cast<std::uint32_t>(mesh.vertices.size()));
        if (fresh) {
            const Vec3 d = unit({1.0 * x, 1.0 * y, 1.0 * z});
            // Dents along the axes and in every other octant; a radius > 0 keeps it star-shaped, so without crossings.
            const double quartic = d.x * d.x * d.x * d.x + d.y * d.y * d.y * d.y + d.z * d.z * d.z * d.z;
            const double radius = 1.05 - 0.55 * quartic + 1.1 * d.x * d.y * d.z;
            mesh.vertices.push_back(radius * d);
        }
        return found->second;
    };
    for (const int sx : {1, -1})
        for (const int sy : {1, -1})
            for (const int sz : {1, -1})
                for (int i = 0; i < m; ++i)
                    for (int j = 0; i + j < m; ++j) {
                        const auto at = [&](int u, int v) { return vertex(sx * (m - u - v), sy * u, sz * v); };
                        const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
                            if (sx * sy * sz > 0)
                                mesh.triangles.push_back({a, b, c});
                            else
                                mesh.triangles.push_back({a, c, b});
                        };
                        const std::uint32_t corner = at(i, j);
                        const std::uint32_t right = at(i + 1, j);
                        const std::uint32_t up = at(i, j + 1);
                        add(corner, right, up);
                        if (i + j + 1 < m) add(right, at(i + 1, j + 1), up);
                    }
    return mesh;
}

Mesh bowl_mesh(std::uint32_t n) {
    Mesh mesh = height_field("bowl", n, [](double x, double y) { return 0.625 * (x * x + y * y); });
    for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
    return mesh;
}

Mesh sheet_mesh(std::uint32_t n) {
    return height_field("sheet", n, [](double x, double y) { return 0.5 * x * y * (1 - x * x) + 0.25 * y * y * y; });
}

Mesh open_box_mesh(std::uint32_t n) {
    Mesh mesh = grid_box_mesh(n);
    mesh.name = "open box";
    const auto on_lid = [&](std::uint32_t v) { return mesh.vertices[v].z == 1; };
    std::erase_if(mesh.triangles, [&](const Triangle& t) { return on_lid(t[0]) && on_lid(t[1]) && on_lid(t[2]); });
    return mesh; // the vertices inside the lid stay, in use by no triangle
}

Mesh crooked_pyramid_mesh(Random& random) {
    Mesh mesh;
    mesh.name = "crooked pyramid";
    mesh.vertices.push_back({0, 0, 0});
    for (int i = 0; i < 6; ++i) {
        constexpr double x[6] = {1, 0.5, -0.5, -1, -0.5, 0.5};
        constexpr double y[6] = {0, 0.75, 0.75, 0, -0.75, -0.75};
        const double r = random.uniform(0.1, 1);
        mesh.vertices.push_back({r * x[i], r * y[i], random.uniform(-2, 2)});
    }
    mesh.vertices.push_back({0, 0, -10});
    for (std::uint32_t i = 1; i <= 6; ++i) {
        mesh.triangles.push_back({0, i, i % 6 + 1});
        mesh.triangles.push_back({7, i % 6 + 1, i});
    }
    return mesh;
}

Mesh moved(Mesh mesh, const Vec3& by) {
    for (Vec3& v : mesh.vertices) v = v + by;
    return mesh;
}

} // namespace raycontact::reference
