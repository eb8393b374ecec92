// SPDX-License-Identifier: Apache-2.0
#include <place_name.h>

#include <algorithm>

namespace raycontact::bullet {

namespace {

bool has_triangles(const Leaf& leaf) {
    return (leaf.kind == Kind::mesh || leaf.kind == Kind::field) && leaf.converted.shape != nullptr;
}

} // namespace

PlaceName name_of_triangle(const Leaf& leaf, int triangle) {
    if (!has_triangles(leaf)) return {};
    if (leaf.converted.names) return (*leaf.converted.names)[static_cast<std::size_t>(triangle)];
    return name_of_triangle(*leaf.shape, triangle);
}

PlaceName name_of_feature(const Leaf& leaf, const PointKey& key) {
    if (!has_triangles(leaf)) return {};
    if (key.feature == FeatureKind::edges) return name_of_triangle(leaf, key.vertex / 3);
    const Shape& shape = *leaf.converted.shape;
    const auto vertices = shape.vertex_index(); // ascending
    const auto at = std::lower_bound(vertices.begin(), vertices.end(), static_cast<std::uint32_t>(key.vertex));
    if (at == vertices.end() || *at != static_cast<std::uint32_t>(key.vertex)) return {};
    const std::uint32_t triangle =
        shape.vertex_triangles()[static_cast<std::size_t>(std::distance(vertices.begin(), at))];
    if (triangle == Shape::no_triangle) return {};
    return name_of_triangle(leaf, static_cast<int>(shape.triangle_index()[triangle]));
}

} // namespace raycontact::bullet
