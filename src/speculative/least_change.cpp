// SPDX-License-Identifier: Apache-2.0
#include <raycontact/least_change.h>

#include "contacts/write_contact.h"
#include "speculative/approach.h"
#include "speculative/edge_search.h"

#include <algorithm>
#include <array>
#include <limits>

namespace raycontact {

namespace {

PlacedBody placed(const MovingShape& body) {
    return {&body.shape, 0, 0, body.now, centred_pose(body.shape, body.now), centred_pose(body.shape, body.next)};
}

// The first that the file counts so; NONE if there is none.
std::uint32_t number_of(std::span<const std::uint32_t> file_index, std::uint32_t index) {
    const auto at = std::ranges::lower_bound(file_index, index); // they rise
    return at == file_index.end() || *at != index ? NONE : static_cast<std::uint32_t>(at - file_index.begin());
}

void of_vertex(Contact& contact, const SpeculativePair& pair) {
    const bool from_a = contact.feature.source == Side::a;
    const OneWay& body = pair.bodies[from_a ? 0 : 1];
    const PlacedBody& target = from_a ? pair.b : pair.a;
    const std::uint32_t vertex = number_of(body.source.mesh.vertex_index, contact.feature.source_index()),
                        triangle = number_of(body.target.mesh.triangle_index, contact.feature.other_index());
    if (!body.moves || vertex == NONE || triangle == NONE) return;
    const Vec3 out = rotated_back(target.centred.rotation, (from_a ? -1.0 : 1.0) * Vec3(contact.normal));
    const Approaches approaches(pair, contact.feature.source, vertex, {});
    const double depth = double(contact.depth);
    const Approach best = approaches.least_change({triangle, out, -depth}, approaches.point() + depth * out);
    if (best.face == triangle || !(best.gap < 0)) return;
    (from_a ? contact.feature.index_b : contact.feature.index_a) = body.target.mesh.triangle_index[best.face];
    write_direction(contact, rotated(target.centred.rotation, best.normal), static_cast<float>(-best.gap));
}

void of_edges(Contact& contact, const SpeculativePair& pair) {
    // Of a triangle that was split at T-junctions the piece whose edge is nearest: all have its number.
    const auto edge = [&](const PlacedBody& body, std::uint32_t index) {
        const ShapeData& shape = body.shape->data();
        const std::span<const std::uint32_t> numbers = shape.mesh.triangle_index;
        const Vec3 at = rotated_back(body.centred.rotation, contact.point_a - body.centred.translation);
        std::uint32_t nearest = NONE;
        double least = std::numeric_limits<double>::infinity();
        const auto [begin, end] = std::equal_range(numbers.begin(), numbers.end(), index / 3);
        for (auto piece = begin; piece != end; ++piece) {
            const auto t = static_cast<std::uint32_t>(piece - numbers.begin());
            const Vec3 from = shape.corner(t, index % 3), to = shape.corner(t, (index + 1) % 3);
            const double away = length(at - nearest_of(at, from, to, to).point);
            if (away < least) nearest = 3 * t + index % 3;
            least = std::min(least, away);
        }
        return nearest;
    };
    const Pose& frame = pair.b.centred;
    FeatureContact found{Side::a,
                         FeatureKind::edges,
                         edge(pair.a, contact.feature.index_a),
                         edge(pair.b, contact.feature.index_b),
                         rotated_back(frame.rotation, contact.point_a - frame.translation),
                         -1.0 * rotated_back(frame.rotation, Vec3(contact.normal)),
                         double(contact.depth)};
    if (found.index == NONE || found.other == NONE) return;
    const Vec3 before = found.normal;
    change_least(pair, found);
    if (found.normal == before) return;
    contact.point_a = transform_point(frame, found.point);
    write_direction(contact, rotated(frame.rotation, found.normal), static_cast<float>(found.depth));
}

} // namespace

Contact least_change(const Contact& contact, const MovingShape& a, const MovingShape& b, double margin) {
    Contact changed = contact;
    if (contact.is_speculative() || double(contact.depth) > margin) return changed;
    const PlacedBody first = placed(a), second = placed(b);
    const SpeculativePair pair(first, second, margin);
    if (contact.feature.kind == FeatureKind::vertex) of_vertex(changed, pair);
    if (contact.feature.kind == FeatureKind::edges) of_edges(changed, pair);
    return changed;
}

} // namespace raycontact
