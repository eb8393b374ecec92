// SPDX-License-Identifier: Apache-2.0
#include "exact/random_solids.h"

#include "reference/meshes.h"
#include "reference/vector.h"

#include "scenes/models/procedural.h"
#include "scenes/models/trigonometry.h"

#include <cmath>

namespace raycontact::exact {

using namespace reference;

namespace {

// A prism over a polygon that is seen whole from its middle; with an extra vertex in each cap, so that it may be a
// star.
Mesh star_prism(const char* name, const std::vector<double>& radii, double half_height) {
    Mesh mesh;
    mesh.name = name;
    const auto n = static_cast<std::uint32_t>(radii.size());
    for (const double z : {-half_height, half_height})
        for (std::uint32_t i = 0; i < n; ++i) {
            const auto [sine, cosine] = scenes::sine_cosine(double(i) / n);
            mesh.vertices.push_back({radii[i] * cosine, radii[i] * sine, z});
        }
    mesh.vertices.push_back({0, 0, -half_height});
    mesh.vertices.push_back({0, 0, half_height});
    for (std::uint32_t i = 0; i < n; ++i) {
        const std::uint32_t j = (i + 1) % n;
        mesh.triangles.push_back({i, j, n + j});
        mesh.triangles.push_back({i, n + j, n + i});
        mesh.triangles.push_back({2 * n, j, i});
        mesh.triangles.push_back({2 * n + 1, n + i, n + j});
    }
    return mesh;
}

Mesh random_tetrahedron(Random& random) {
    for (;;) {
        Mesh mesh;
        mesh.name = "tetrahedron";
        for (int i = 0; i < 4; ++i) mesh.vertices.push_back(random.in_ball());
        const Vec3 a = mesh.vertices[0];
        const double volume =
            dot(cross(mesh.vertices[1] - a, mesh.vertices[2] - a), mesh.vertices[3] - a); // six times it
        if (std::fabs(volume) < 0.05) continue;
        if (volume < 0) std::swap(mesh.vertices[2], mesh.vertices[3]);
        mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
        return mesh;
    }
}

// A spike on every triangle: seen whole from the middle.
Mesh spiked(Mesh mesh, double reach) {
    mesh.name = "spiked " + mesh.name;
    std::vector<std::array<std::uint32_t, 3>> triangles;
    for (const auto& t : mesh.triangles) {
        const auto tip = static_cast<std::uint32_t>(mesh.vertices.size());
        mesh.vertices.push_back((reach / 3) * (mesh.vertices[t[0]] + mesh.vertices[t[1]] + mesh.vertices[t[2]]));
        for (std::size_t k = 0; k < 3; ++k) triangles.push_back({t[k], t[(k + 1) % 3], tip});
    }
    mesh.triangles = std::move(triangles);
    return mesh;
}

double between(Random& random, double low, double high) { // evenly by its logarithm
    return low * std::exp2(random.uniform() * std::log2(high / low));
}

Mesh stretched(Mesh mesh, Random& random, double least, double most) {
    const double size = between(random, least, most);
    const double x = random.uniform(0.4, 1);
    const double y = random.uniform(0.4, 1);
    const double z = random.uniform(0.4, 1);
    for (Vec3& v : mesh.vertices) v = {size * x * v.x, size * y * v.y, size * z * v.z};
    return mesh;
}

std::uint32_t even(Random& random, std::uint32_t least, std::uint32_t most) {
    return least + 2 * random.below((most - least) / 2 + 1);
}

Mesh named(Mesh mesh, const char* name) {
    mesh.name = name;
    return mesh;
}

Mesh unit_coarse(Random& random) {
    switch (random.below(18)) {
    case 0:
        return random_tetrahedron(random);
    case 1:
        return named(box_mesh({0.5, 0.5, 0.5}), "box");
    case 2:
        return named(box_mesh({0.6, 0.03, 0.1}), "bar");
    case 3:
        return named(box_mesh({0.1, 0.1, 1}), "bar");
    case 4:
        return named(box_mesh({0.8, 0.8, 0.03}), "plate");
    case 5: {
        const double height = random.uniform(0.05, 1);
        return prism_solid(3 + random.below(22), 0.6, height);
    }
    case 6: {
        const double height = random.uniform(0.3, 2), radius = random.uniform(0.2, 0.8);
        return cone_solid(3 + random.below(30), radius, height);
    }
    case 7: {
        std::vector<double> radii(2 * (3 + random.below(10)), 1);
        const double inner = random.uniform(0.3, 0.8);
        for (std::size_t i = 1; i < radii.size(); i += 2) radii[i] = inner;
        return star_prism("star", radii, random.uniform(0.05, 0.5));
    }
    case 8:
        return spiked(box_mesh({0.3, 0.3, 0.3}), random.uniform(1.5, 4));
    case 9: {
        const double length = random.uniform(1.2, 3);
        return spiked(bumpy_octahedron_mesh(1 + random.below(2)), length);
    }
    case 10:
        return named(scenes::gear(even(random, 48, 200)), "gear");
    case 11:
        return frame_mesh();
    case 12:
        return l_prism_mesh();
    case 13:
        return named(scenes::bumpy_torus(even(random, 18, 200)), "coarse torus");
    case 14:
        return bumpy_octahedron_mesh(1 + random.below(5));
    case 15:
        return named(box_mesh({1, 1e-3, 1e-3}), "needle");
    case 16:
        return named(box_mesh({1, 0.6, 1e-3}), "sheet");
    default:
        return named(scenes::bumpy_sphere(even(random, 8, 200)), "coarse sphere");
    }
}

Mesh unit_fine(Random& random) {
    switch (random.below(6)) {
    case 0:
        return named(scenes::bumpy_torus(even(random, 300, 1500)), "torus");
    case 1:
        return named(scenes::bumpy_sphere(even(random, 300, 1500)), "bumpy sphere");
    case 2:
        return named(scenes::knot(even(random, 400, 1500)), "knot");
    case 3:
        return named(scenes::gear(even(random, 300, 1500)), "fine gear");
    case 4:
        return named(scenes::star(even(random, 400, 1500)), "fine star");
    default:
        return bumpy_octahedron_mesh(7 + random.below(6));
    }
}

} // namespace

Mesh prism_solid(std::uint32_t corners, double radius, double half_height) {
    Mesh mesh;
    mesh.name = "prism";
    for (const double z : {-half_height, half_height})
        for (std::uint32_t i = 0; i < corners; ++i) {
            const auto [sine, cosine] = scenes::sine_cosine(double(i) / corners);
            mesh.vertices.push_back({radius * cosine, radius * sine, z});
        }
    for (std::uint32_t i = 0; i < corners; ++i) {
        const std::uint32_t j = (i + 1) % corners;
        mesh.triangles.push_back({i, j, corners + j});
        mesh.triangles.push_back({i, corners + j, corners + i});
        if (i == 0 || j == 0) continue;
        mesh.triangles.push_back({0, j, i});
        mesh.triangles.push_back({corners, corners + i, corners + j});
    }
    return mesh;
}

Mesh cone_solid(std::uint32_t corners, double radius, double height) {
    Mesh mesh;
    mesh.name = "cone";
    for (std::uint32_t i = 0; i < corners; ++i) {
        const auto [sine, cosine] = scenes::sine_cosine(double(i) / corners);
        mesh.vertices.push_back({radius * cosine, radius * sine, 0});
    }
    mesh.vertices.push_back({0, 0, height});
    for (std::uint32_t i = 0; i < corners; ++i) {
        const std::uint32_t j = (i + 1) % corners;
        mesh.triangles.push_back({i, j, corners});
        if (i != 0 && j != 0) mesh.triangles.push_back({0, j, i});
    }
    return mesh;
}

Mesh coarse_solid(Random& random) {
    Mesh mesh = unit_coarse(random);
    return stretched(std::move(mesh), random, 0.03, 1.5);
}

Mesh fine_solid(Random& random) {
    Mesh mesh = unit_fine(random);
    return stretched(std::move(mesh), random, 0.2, 2);
}

} // namespace raycontact::exact
