// SPDX-License-Identifier: Apache-2.0
#include "property/ray_sources.h"

#include "reference/vector.h"

#include <algorithm>
#include <map>

namespace raycontact::reference {

namespace {

Vec3 on_grid(const Vec3& v, double step) {
    return {step * std::nearbyint(v.x / step), step * std::nearbyint(v.y / step), step * std::nearbyint(v.z / step)};
}

using Edge = std::array<std::uint32_t, 2>;

std::map<Edge, std::vector<std::uint32_t>> triangles_of_edges(const Solid& solid) {
    std::map<Edge, std::vector<std::uint32_t>> around;
    for (std::uint32_t t = 0; t < solid.triangles.size(); ++t)
        for (std::size_t k = 0; k < 3; ++k) {
            const auto [low, high] = std::minmax(solid.triangles[t][k], solid.triangles[t][(k + 1) % 3]);
            around[{low, high}].push_back(t);
        }
    return around;
}

Vec3 anywhere_in_box(const Solid& solid, Random& random) {
    const Vec3 size = solid.box_max - solid.box_min;
    return solid.box_min + Vec3{size.x * random.uniform(), size.y * random.uniform(), size.z * random.uniform()};
}

bool in_box(const Solid& solid, const Vec3& p) {
    return p.x >= solid.box_min.x && p.x <= solid.box_max.x && p.y >= solid.box_min.y && p.y <= solid.box_max.y
           && p.z >= solid.box_min.z && p.z <= solid.box_max.z;
}

} // namespace

Mesh ray_cloud(const Solid& target, Aim aim, std::uint32_t count, Random& random) {
    constexpr double corner_step = 0x1p-14; // of the corners about the first: the normal is then known in double
    constexpr double origin_step = 0x1p-22; // of the first corner: 24 bits up to 2 m from the cloud's middle
    constexpr double size = 0x1p-7;
    const auto around = triangles_of_edges(target);

    Mesh mesh;
    mesh.name = "ray cloud";
    const auto add = [&](const Vec3& origin, const Vec3& left, const Vec3& right) {
        const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
        mesh.vertices.insert(mesh.vertices.end(), {origin, origin + left, origin + right});
        mesh.triangles.push_back({first, first + 1, first + 2});
    };
    // Two far triangles hold the box, and with it the centre, where the grids are exact.
    add({-2, -2, -2}, {size, 0, 0}, {0, size, 0});
    add({2, 2, 2}, {-size, 0, 0}, {0, -size, 0});
    while (mesh.triangles.size() < count) {
        const Vec3 left = on_grid(size * random.direction(), corner_step);
        const Vec3 right = on_grid(size * unit(cross(random.direction(), left)), corner_step);
        const Vec3 direction = -unit(cross(left, right)); // of the rays
        if (direction == Vec3{}) continue;
        Vec3 origin = anywhere_in_box(target, random);
        if (aim != Aim::anywhere) {
            const Edge& edge = target.edges[random.below(static_cast<std::uint32_t>(target.edges.size()))];
            if (aim == Aim::silhouettes) {
                const auto& faces = around.at(edge);
                const double one = dot(direction, target.face_normals[faces.front()]);
                const double two = dot(direction, target.face_normals[faces.back()]);
                if (one * two >= 0) continue;
            }
            const double s = random.below(4) == 0 ? 0 : random.uniform();
            const Vec3 goal = (1 - s) * target.vertices[edge[0]] + s * target.vertices[edge[1]];
            origin = goal - random.uniform(0.01, 1) * target.diagonal * direction;
            if (!in_box(target, origin)) continue;
        }
        add(on_grid(origin, origin_step), left, right);
    }
    return mesh;
}

Mesh needle() {
    Mesh mesh;
    mesh.name = "needle";
    mesh.vertices = {{0, 0, 0}, {0x1p-9, 0, 0}, {0, 0x1p-9, 0}};
    mesh.triangles = {{0, 1, 2}};
    return mesh;
}

std::vector<Pose> axis_rotations() {
    std::vector<Pose> poses;
    const Vec3 axes[6] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
    for (const Vec3& x : axes)
        for (const Vec3& y : axes) {
            if (dot(x, y) != 0) continue;
            const Vec3 z = cross(x, y);
            Pose pose;
            pose.rotation = {x.x, y.x, z.x, x.y, y.y, z.y, x.z, y.z, z.z};
            poses.push_back(pose);
        }
    return poses;
}

} // namespace raycontact::reference
