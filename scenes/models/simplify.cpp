// SPDX-License-Identifier: Apache-2.0
#include <scenes/models/simplify.h>

#include <meshoptimizer.h>

#include <algorithm>
#include <map>
#include <set>
#include <utility>

namespace raycontact::scenes {
namespace {

using Triangle = std::array<std::uint32_t, 3>;

/// Two triangles over the same three vertices enclose nothing: collapses leave such flaps behind.
void remove_flaps(std::vector<Triangle>& triangles) {
    std::map<Triangle, std::vector<std::size_t>> same;
    for (std::size_t t = 0; t < triangles.size(); ++t) {
        Triangle key = triangles[t];
        std::sort(key.begin(), key.end());
        same[key].push_back(t);
    }
    std::vector<bool> drop(triangles.size(), false);
    for (const auto& [key, members] : same)
        for (std::size_t k = 0; k + 1 < members.size(); k += 2) drop[members[k]] = drop[members[k + 1]] = true;
    std::size_t kept = 0;
    for (std::size_t t = 0; t < triangles.size(); ++t)
        if (!drop[t]) triangles[kept++] = triangles[t];
    triangles.resize(kept);
}

/// Splits the longest edge at its middle: two triangles more, the same surface.
void split_longest_edge(Mesh& mesh) {
    const auto squared_length = [&mesh](std::uint32_t a, std::uint32_t b) {
        const Vec3 &p = mesh.vertices[a], &q = mesh.vertices[b];
        return (p.x - q.x) * (p.x - q.x) + (p.y - q.y) * (p.y - q.y) + (p.z - q.z) * (p.z - q.z);
    };
    std::pair<std::uint32_t, std::uint32_t> longest{};
    double length = -1;
    for (const Triangle& t : mesh.triangles)
        for (std::size_t k = 0; k < 3; ++k)
            if (const double d = squared_length(t[k], t[(k + 1) % 3]); d > length) {
                length = d;
                longest = {t[k], t[(k + 1) % 3]};
            }
    const auto middle = static_cast<std::uint32_t>(mesh.vertices.size());
    const Vec3 p = mesh.vertices[longest.first], q = mesh.vertices[longest.second];
    mesh.vertices.push_back({(p.x + q.x) / 2, (p.y + q.y) / 2, (p.z + q.z) / 2});
    for (std::size_t t = 0, count = mesh.triangles.size(); t < count; ++t)
        for (std::size_t k = 0; k < 3; ++k) {
            const std::uint32_t a = mesh.triangles[t][k], b = mesh.triangles[t][(k + 1) % 3];
            if ((a != longest.first || b != longest.second) && (a != longest.second || b != longest.first)) continue;
            const std::uint32_t apex = mesh.triangles[t][(k + 2) % 3];
            mesh.triangles[t] = {a, middle, apex};
            mesh.triangles.push_back({middle, b, apex});
            break;
        }
}

/// Only the vertices in use, in their old order.
Mesh compact(const PreparedMesh& source, const std::vector<Triangle>& triangles) {
    std::set<std::uint32_t> used;
    for (const Triangle& t : triangles) used.insert(t.begin(), t.end());
    std::map<std::uint32_t, std::uint32_t> place;
    Mesh mesh{source.name, {}, triangles};
    for (const std::uint32_t v : used) {
        place[v] = static_cast<std::uint32_t>(mesh.vertices.size());
        mesh.vertices.push_back(source.vertices[v]);
    }
    for (Triangle& t : mesh.triangles)
        for (std::uint32_t& v : t) v = place[v];
    return mesh;
}

std::vector<Triangle> collapse(const PreparedMesh& mesh, std::uint32_t target) {
    std::vector<float> positions;
    std::vector<std::uint32_t> indices, result;
    for (const Vec3& v : mesh.vertices)
        positions.insert(positions.end(), {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)});
    for (const Triangle& t : mesh.triangles) indices.insert(indices.end(), t.begin(), t.end());
    result.resize(indices.size());
    constexpr float any_error = 1.0f; // relative to the extent: the count decides, not the error
    result.resize(meshopt_simplify(result.data(), indices.data(), indices.size(), positions.data(),
                                   mesh.vertices.size(), 3 * sizeof(float), std::size_t{target} * 3, any_error, 0,
                                   nullptr));
    std::vector<Triangle> triangles;
    for (std::size_t k = 0; k + 2 < result.size(); k += 3)
        triangles.push_back({result[k], result[k + 1], result[k + 2]});
    return triangles;
}

} // namespace

bool sound(const MeshReport& report) {
    return report.closed && report.manifold && report.oriented && report.outward && !report.self_intersecting
           && report.components == 1;
}

std::optional<Mesh> simplify_to(const PreparedMesh& mesh, std::uint32_t triangles) {
    if (triangles % 2 != 0 || triangles < 4 || triangles > mesh.triangles.size()) return std::nullopt;
    // At most a tenth of the triangles from splits; beyond that the mesh would not be the reduction it claims to be.
    // Forty tries: a reduction that keeps crossing itself mostly does so in one place, whatever the count.
    const std::uint32_t stride = std::max(2u, triangles / 400 / 2 * 2);
    for (std::uint32_t target = triangles; target >= 4 && target + triangles / 10 >= triangles; target -= stride) {
        std::vector<Triangle> reduced = collapse(mesh, target);
        remove_flaps(reduced);
        if (reduced.size() > triangles || reduced.size() % 2 != 0 || reduced.size() + triangles / 10 < triangles)
            continue;
        Mesh candidate = compact(mesh, reduced);
        // Cheap to tell before the splits, and a bad mesh stays bad through them.
        if (!sound(prepare_mesh(candidate, {.repair = Repair::as_is}).report)) continue;
        while (candidate.triangles.size() < triangles) split_longest_edge(candidate);
        if (candidate.triangles.size() == triangles && sound(prepare_mesh(candidate, {.repair = Repair::as_is}).report))
            return candidate;
    }
    return std::nullopt;
}

} // namespace raycontact::scenes
