// SPDX-License-Identifier: Apache-2.0
#include <border.h>
#include <vectors.h>

#include <raycontact/pose.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace raycontact::bullet {

namespace {

/// A face of the convex shape: outside of it n x > offset.
struct Face {
    Vec3 normal; ///< unit
    double offset;

    double height(const Vec3& x) const { return dot(normal, x) - offset; }
};

void faces_of(const Shape& convex, std::vector<Face>& faces) {
    faces.clear();
    const auto area = [&](std::uint32_t t) {
        const auto& [i, j, k] = convex.triangles()[t];
        const Vec3 a = convex.vertices()[i];
        return cross(convex.vertices()[j] - a, convex.vertices()[k] - a);
    };
    for (std::uint32_t t = 0; t < convex.triangles().size(); ++t) {
        const Vec3 own = area(t);
        if (!(length2(own) > 0)) continue;
        const Vec3 n = (1 / length(own)) * own;
        const auto is_known = [&](std::uint32_t other) { // by a triangle beside it
            return other < t && dot(area(other), n) > (1 - 1e-12) * length(area(other)) && length2(area(other)) > 0;
        };
        if (std::ranges::none_of(convex.neighbours()[t], is_known))
            faces.push_back({n, dot(n, convex.vertices()[convex.triangles()[t][0]])});
    }
}

/// As of other contacts (docs/internals/speculative.md).
constexpr double glancing = 0.25;
constexpr int halvings = 24;

/// Ends of an edge, in the frame of the convex shape.
using Ends = std::array<Vec3, 2>;

Vec3 point_at(const Ends& ends, double part) {
    return ends[0] + part * (ends[1] - ends[0]);
}

/// What of an edge is below all faces, or above by no more than the margin; parts of it.
std::optional<std::array<double, 2>> part_inside(const std::vector<Face>& faces, const Ends& ends, double margin) {
    double from = 0, to = 1;
    for (const Face& face : faces) {
        const double one = face.height(ends[0]) - margin, two = face.height(ends[1]) - margin;
        if (one > 0 && two > 0) return std::nullopt;
        if (one > 0) from = std::max(from, one / (one - two));
        if (two > 0) to = std::min(to, one / (one - two));
    }
    if (from > to) return std::nullopt;
    return std::array{from, to};
}

/// The shortest edge of its box, metres.
double size_across(const Leaf& leaf) {
    const Vec3 &low = leaf.converted.shape->box_min(), &high = leaf.converted.shape->box_max();
    return std::min({high.x - low.x, high.y - low.y, high.z - low.z});
}

} // namespace

void border_contacts(const Leaf& convex, const Leaf& mesh, std::span<const std::uint32_t> edges, double margin,
                     std::vector<BorderContact>& found) {
    static thread_local std::vector<Face> faces;
    found.clear();
    faces_of(*convex.converted.shape, faces);
    const Shape& shape = *mesh.converted.shape;
    const Pose in_world = to_pose(convex.pose), to_now = relative_pose(in_world, to_pose(mesh.pose)),
               to_next = relative_pose(to_pose(convex.next), to_pose(mesh.next));
    // It moves by no more than half of itself between two looks, up to 16 times its size.
    const double half = std::max(size_across(convex) / 2, 1e-9), way = double(convex.way + mesh.way);
    const int looks = static_cast<int>(std::clamp(std::ceil(way / half), 1.0, 32.0));
    for (const std::uint32_t number : edges) {
        const std::uint32_t t = number / 3, k = number % 3;
        const Vec3 &a = shape.vertices()[shape.triangles()[t][k]],
                   &b = shape.vertices()[shape.triangles()[t][(k + 1) % 3]];
        const Ends now{transform_point(to_now, a), transform_point(to_now, b)},
            next{transform_point(to_next, a), transform_point(to_next, b)};
        const auto at = [&](double when) {
            return Ends{now[0] + when * (next[0] - now[0]), now[1] + when * (next[1] - now[1])};
        };
        auto part = part_inside(faces, now, margin);
        Ends touches = now;
        const bool is_inside = part_inside(faces, now, 0).has_value();
        if (!is_inside) { // it may meet the shape on its way
            double from = 0, to = 0;
            for (int i = 1; i <= looks && to == 0; ++i) {
                const double when = double(i) / looks;
                (part_inside(faces, at(when), 0) ? to : from) = when;
            }
            for (int i = 0; i < halvings && to > 0; ++i) {
                const double when = (from + to) / 2;
                (part_inside(faces, at(when), 0) ? to : from) = when;
            }
            if (to > 0) {
                touches = at(to);
                part = part_inside(faces, touches, 0);
            }
        }
        if (!part) continue;
        const double middle = ((*part)[0] + (*part)[1]) / 2;
        const Vec3 there = point_at(touches, middle), then = point_at(next, middle);
        const Face* face = &*std::ranges::max_element(faces, {}, [&](const Face& f) { return f.height(there); });
        // A step lower than the margin is no wall: another face that the motion passes far less.
        double passed = -glancing * face->height(then);
        for (const Face& f : faces)
            if (f.height(there) >= -margin && -f.height(then) < passed) {
                passed = -f.height(then);
                face = &f;
            }
        const auto edge = static_cast<int>(3 * shape.triangle_index()[t] + k);
        for (const int end : {0, 1}) {
            const Vec3 x = point_at(now, (*part)[static_cast<std::size_t>(end)]);
            found.push_back({edge, end, to_bullet(transform_point(in_world, x)),
                             to_bullet(turned(in_world, face->normal)),
                             btScalar(is_inside ? face->height(x) : std::max(0.0, face->height(x)))});
        }
    }
}

} // namespace raycontact::bullet
