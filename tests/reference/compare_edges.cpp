// SPDX-License-Identifier: Apache-2.0
#include "reference/compare_edges.h"

#include "reference/random.h"
#include "reference/text.h"
#include "reference/vector.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <set>
#include <tuple>

namespace raycontact::reference {

namespace {

using Key = std::tuple<FeatureKind, Side, std::uint32_t, std::uint32_t>; // what Contact::key() tells

Key key_of(const ReferenceContact& c) {
    return {c.kind, c.vertex_body, c.vertex, c.kind == FeatureKind::edges ? c.triangle : 0};
}

// One answer, of the library or of the reference, in common terms.
using Answers = std::map<Key, ReferenceContact>;

Answers answers(const std::vector<ReferenceContact>& contacts) {
    Answers list;
    for (const ReferenceContact& c : contacts) list[key_of(c)] = c;
    return list;
}

Answers answers(std::span<const Contact> contacts) {
    Answers list;
    for (const Contact& c : contacts) {
        if (c.feature.kind == FeatureKind::vertex) continue;
        ReferenceContact r;
        r.vertex_body = c.feature.source;
        r.kind = c.feature.kind;
        r.vertex = c.feature.source_index();
        r.triangle = c.feature.other_index();
        r.point = c.point();
        r.normal = {c.normal.x, c.normal.y, c.normal.z};
        r.depth = c.depth;
        r.ray_length = c.ray_length;
        r.weight = c.weight;
        list[key_of(r)] = r;
    }
    return list;
}

struct Difference {
    double normal, depth, point, weight;
    bool triangle;
    // `slack`: in steps of what double and float32 may differ by.
    bool none(double slack) const {
        return triangle && normal < 1e-5 * slack && depth < 1e-6 * slack && point < 1e-6 * slack && weight < 1e-6;
    }
};

Difference difference(const ReferenceContact& c, const ReferenceContact& d, double size) {
    return {length(c.normal - d.normal),
            std::max(std::fabs(c.depth - d.depth), std::fabs(c.ray_length - d.ray_length)) / size,
            length(c.point - d.point) / size, std::fabs(c.weight - d.weight) / c.weight, c.triangle == d.triangle};
}

bool alike(const Answers& x, const Answers& y, const Key& key, double size, double slack) {
    const auto i = x.find(key), j = y.find(key);
    if (i == x.end() || j == y.end()) return i == x.end() && j == y.end();
    return difference(i->second, j->second, size).none(slack);
}

std::string answer_of(const char* who, const Answers& list, const Key& key) {
    const auto at = list.find(key);
    if (at == list.end()) return text("\n  %s: none", who);
    const ReferenceContact& c = at->second;
    return text("\n  %s: triangle %u, depth %.9g, weight %.9g, normal %.6g %.6g %.6g, point %.9g %.9g %.9g", who,
                c.triangle, c.depth, c.weight, c.normal.x, c.normal.y, c.normal.z, c.point.x, c.point.y, c.point.z);
}

// By up to excuse_edges of the size: turned about its origin and moved.
Pose nudged(Pose pose, const Solid& solid, double by, double size, Random& random) {
    const Pose turn = small_rotation(random.direction(), by);
    const Vec3 centre = pose.translation + rotate(pose, solid.centre);
    Pose made;
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j) {
            double sum = 0;
            for (std::size_t k = 0; k < 3; ++k) sum += turn.rotation[3 * i + k] * pose.rotation[3 * k + j];
            made.rotation[3 * i + j] = sum;
        }
    made.translation = centre - rotate(made, solid.centre) + by * size * random.in_ball();
    return made;
}

// Vertices in contact, of which edges make much, are found in float32; near a tie they may be others, or meet other
// triangles. Direction `refined` names another triangle than the one that was met.
bool same_vertices(const std::vector<ReferenceContact>& expected, std::span<const Contact> found, Direction direction) {
    std::set<std::tuple<Side, std::uint32_t, std::uint32_t>> x, y;
    const auto met = [&](std::uint32_t triangle) { return direction == Direction::refined ? 0 : triangle; };
    for (const ReferenceContact& c : expected) x.emplace(c.vertex_body, c.vertex, met(c.triangle));
    for (const Contact& c : found)
        if (c.feature.kind == FeatureKind::vertex)
            y.emplace(c.feature.source, c.feature.source_index(), met(c.feature.other_index()));
    return x == y;
}

} // namespace

void compare_edges(const Solid& a, const Pose& pose_a, const Solid& b, const Pose& pose_b,
                   std::span<const Contact> contacts, EdgeComparison& sum, Direction direction) {
    ++sum.pairs;
    const auto of_edges = find_edges(a, pose_a, b, pose_b, direction);
    auto vertices = find_contacts(a, pose_a, b, pose_b);
    for (const ReferenceContact& c : of_edges)
        if (c.kind == FeatureKind::vertex) vertices.push_back(c);
    if (!same_vertices(vertices, contacts, direction)) {
        ++sum.pairs_excused;
        return;
    }
    const double size = std::max(a.diagonal, b.diagonal);
    const Answers expected = answers(of_edges);
    const Answers found = answers(contacts);
    sum.contacts += expected.size();
    std::vector<Key> different;
    for (const auto& [key, c] : expected) {
        const auto at = found.find(key);
        if (at == found.end() || !difference(c, at->second, size).none(1)) {
            different.push_back(key);
            continue;
        }
        const Difference d = difference(c, at->second, size);
        ++sum.agreed;
        sum.inside += c.kind == FeatureKind::inside;
        sum.worst_normal = std::max(sum.worst_normal, d.normal);
        sum.worst_depth = std::max(sum.worst_depth, d.depth);
        sum.worst_point = std::max(sum.worst_point, d.point);
    }
    for (const auto& [key, c] : found)
        if (!expected.contains(key)) different.push_back(key);
    if (different.empty()) return;
    std::vector<Answers> others;
    Random random(1);
    for (int i = 0; i < 12; ++i) {
        constexpr double steps[] = {excuse_edges / 25, excuse_edges / 5, excuse_edges};
        const Pose other = nudged(pose_b, b, steps[i % 3], size, random);
        others.push_back(answers(find_edges(a, pose_a, b, other, direction)));
    }
    for (const Key& key : different) {
        const bool excused = std::any_of(others.begin(), others.end(),
                                         [&](const Answers& other) { return alike(other, found, key, size, 20); });
        if (excused) {
            ++sum.excused;
            continue;
        }
        ++sum.wrong;
        if (sum.complaints.size() >= 5) continue;
        const auto [feature, body, vertex, other] = key;
        sum.complaints.push_back(
            (feature == FeatureKind::edges ? text("edges %u and %u of ", vertex, other)
                                           : text("inside, vertex %u of ", vertex))
            + (body == Side::a ? a.name + " (a) against " + b.name : b.name + " (b) against " + a.name)
            + answer_of("reference", expected, key) + answer_of("library", found, key) + "\n  pose a " + text(pose_a)
            + "\n  pose b " + text(pose_b));
    }
}

std::string EdgeComparison::summary() const {
    const auto number = [](std::uint64_t n) { return static_cast<unsigned long long>(n); };
    std::string s =
        text("%llu pairs, %llu of them excused; %llu contacts of edges: %llu agree (%llu of bodies inside; worst "
             "normal %.2g, "
             "depth %.2g, point %.2g), %llu excused (%.4f %%), %llu wrong",
             number(pairs), number(pairs_excused), number(contacts), number(agreed), number(inside), worst_normal,
             worst_depth, worst_point, number(excused),
             contacts ? 100.0 * static_cast<double>(excused) / static_cast<double>(contacts) : 0.0, number(wrong));
    for (const std::string& complaint : complaints) s += "\n" + complaint;
    return s;
}

} // namespace raycontact::reference
