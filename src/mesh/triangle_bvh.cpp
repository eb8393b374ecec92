// SPDX-License-Identifier: Apache-2.0
#include "mesh/triangle_bvh.h"

#include "executor/divide.h"
#include "mesh/triangle_distance.h"

#include <algorithm>
#include <bit>
#include <utility>

namespace raycontact {

TriangleBvh::TriangleBvh(std::span<const Vec3> vertices, std::span<const Triangle> triangles,
                         std::span<const std::uint32_t> chosen, Executor& executor)
    : vertices_(vertices), triangles_(triangles), items_(chosen.size()), boxes_(std::bit_ceil(chosen.size()) + 1) {
    executor.run(static_cast<std::uint32_t>(chosen.size()), 4096, [&](std::uint32_t begin, std::uint32_t end) {
        for (std::uint32_t i = begin; i < end; ++i) {
            const auto [a, b, c] = triangles_[chosen[i]];
            const Vec3 &p = vertices_[a], &q = vertices_[b], &r = vertices_[c];
            items_[i] = {{least(least(p, q), r), most(most(p, q), r)}, p + q + r, chosen[i]};
        }
    });
    constexpr std::uint32_t large = 4096;
    const auto parts = divide(
        executor, whole(), [](const Part& part) { return part.size() > large; },
        [&](const Part& part) {
            split(part);
            return std::array{part.left(), part.right()};
        });
    for_each_part(executor, parts, [&](const Part& part) { build_below(part); });
}

/// Finds the part's box, and puts its items on their side of the middle.
void TriangleBvh::split(const Part& part) {
    Box& box = boxes_[part.node] = items_[part.first].box;
    for (std::uint32_t i = part.first + 1; i < part.last; ++i) box.add(items_[i].box);
    if (part.is_leaf()) return;
    const Vec3 size = box.high - box.low;
    double Vec3::*const along = size.x >= size.y && size.x >= size.z ? &Vec3::x
                                : size.y >= size.z                   ? &Vec3::y
                                                                     : &Vec3::z;
    const auto items = items_.begin();
    std::nth_element(items + part.first, items + part.middle(), items + part.last,
                     [along](const Item& p, const Item& q) {
                         return p.sum.*along != q.sum.*along ? p.sum.*along < q.sum.*along : p.triangle < q.triangle;
                     });
}

void TriangleBvh::build_below(const Part& part) {
    split(part);
    if (part.is_leaf()) return;
    build_below(part.left());
    build_below(part.right());
}

/// Pairs of parts that together cover all pairs of triangles whose boxes touch; about as many as wanted.
std::vector<TriangleBvh::Pair> TriangleBvh::pairs(std::size_t wanted) const {
    std::vector<Pair> open{{whole(), whole()}};
    for (bool opened = true; opened && open.size() < wanted;) {
        opened = false;
        std::vector<Pair> next;
        const auto keep = [&](const Pair& pair) {
            next.push_back(pair);
            return false;
        };
        for (const Pair& pair : open) {
            if (!box_of(pair[0]).touches(box_of(pair[1]))) continue;
            const bool may_open = !pair[0].is_leaf() && !pair[1].is_leaf();
            opened = opened || may_open;
            may_open ? any_half(pair, keep) : keep(pair);
        }
        open = std::move(next);
    }
    return open;
}

double TriangleBvh::nearest(const Part& part, const Vec3& point, double bound) const {
    for (std::uint32_t i = part.first; part.is_leaf() && i < part.last; ++i) {
        if (items_[i].box.squared_distance(point) >= bound) continue;
        const auto [a, b, c] = triangles_[items_[i].triangle];
        bound = std::min(bound, squared_distance(point, vertices_[a], vertices_[b], vertices_[c]));
    }
    if (part.is_leaf()) return bound;
    std::pair near{box_of(part.left()).squared_distance(point), part.left()};
    std::pair far{box_of(part.right()).squared_distance(point), part.right()};
    if (far.first < near.first) std::swap(near, far);
    for (const auto& [distance, half] : {near, far}) {
        if (distance < bound) bound = nearest(half, point, bound);
    }
    return bound;
}

bool TriangleBvh::meets(const Box& box, const Vec3& origin, const Vec3& direction) {
    double enter = 0, leave = 1e300;
    for (std::size_t k = 0; k < 3; ++k) {
        const double o = axis(origin, k), inverse = 1 / axis(direction, k);
        const double t1 = (axis(box.low, k) - o) * inverse, t2 = (axis(box.high, k) - o) * inverse;
        enter = std::max(enter, std::min(t1, t2));
        leave = std::min(leave, std::max(t1, t2));
    }
    // Wide enough for the rounding above; one box too many costs little.
    return enter <= leave + 1e-9 * std::fabs(leave);
}

} // namespace raycontact
