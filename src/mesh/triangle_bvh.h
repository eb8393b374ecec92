// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mesh/adjacency.h"
#include "mesh/vector.h"

#include <cstdint>
#include <span>
#include <vector>

namespace raycontact {

/// A box hierarchy in double for the checks of a mesh (the rays of contacts have their own, in src/shape). Median
/// splits, so its depth is at most 32 and it depends on nothing but the triangles.
class TriangleBvh {
public:
    /// Over the given triangles only.
    TriangleBvh(std::span<const Vec3> vertices, std::span<const Triangle> triangles, std::vector<std::uint32_t> chosen);

    /// Calls test(i, k) once for each two triangles whose boxes touch, until it returns true; tells whether one did.
    template <class Test>
    bool any_pair(Test&& test) const {
        return !nodes_.empty() && any_pair_within(0, test);
    }

    /// Calls visit(i) for every triangle whose box the ray may meet. No component of the direction may be 0.
    template <class Visit>
    void along_ray(const Vec3& origin, const Vec3& direction, Visit&& visit) const {
        if (!nodes_.empty()) along_ray_below(0, origin, direction, visit);
    }

    /// Squared distance of a point from the nearest triangle, or `bound` where none is nearer than that.
    double nearest(const Vec3& point, double bound) const;

private:
    struct Box {
        Vec3 low, high;
    };
    struct Node {
        Box box;
        std::uint32_t first, last; ///< into order_
        std::uint32_t right;       ///< 0 for a leaf; the left child follows its parent
    };

    std::uint32_t build(std::uint32_t first, std::uint32_t last);
    Box box_of(std::uint32_t triangle) const;
    static bool touch(const Box& a, const Box& b) {
        return a.low.x <= b.high.x && b.low.x <= a.high.x && a.low.y <= b.high.y && b.low.y <= a.high.y
               && a.low.z <= b.high.z && b.low.z <= a.high.z;
    }
    static double squared_distance_of(const Box& box, const Vec3& point);
    static bool meets(const Box& box, const Vec3& origin, const Vec3& direction);

    template <class Test>
    bool any_pair_within(std::uint32_t n, Test& test) const {
        const Node& node = nodes_[n];
        if (node.right != 0) {
            return any_pair_within(n + 1, test) || any_pair_within(node.right, test)
                   || any_pair_between(n + 1, node.right, test);
        }
        for (std::uint32_t i = node.first; i < node.last; ++i) {
            for (std::uint32_t k = i + 1; k < node.last; ++k) {
                if (touch(boxes_[i], boxes_[k]) && test(order_[i], order_[k])) return true;
            }
        }
        return false;
    }

    template <class Test>
    bool any_pair_between(std::uint32_t a, std::uint32_t b, Test& test) const {
        const Node &left = nodes_[a], &right = nodes_[b];
        if (!touch(left.box, right.box)) return false;
        // The larger one is opened, so that boxes of like size meet.
        if (left.right != 0 && (right.right == 0 || left.last - left.first >= right.last - right.first)) {
            return any_pair_between(a + 1, b, test) || any_pair_between(left.right, b, test);
        }
        if (right.right != 0) return any_pair_between(a, b + 1, test) || any_pair_between(a, right.right, test);
        for (std::uint32_t i = left.first; i < left.last; ++i) {
            for (std::uint32_t k = right.first; k < right.last; ++k) {
                if (touch(boxes_[i], boxes_[k]) && test(order_[i], order_[k])) return true;
            }
        }
        return false;
    }

    template <class Visit>
    void along_ray_below(std::uint32_t n, const Vec3& origin, const Vec3& direction, Visit& visit) const {
        const Node& node = nodes_[n];
        if (!meets(node.box, origin, direction)) return;
        if (node.right == 0) {
            for (std::uint32_t i = node.first; i < node.last; ++i) visit(order_[i]);
            return;
        }
        along_ray_below(n + 1, origin, direction, visit);
        along_ray_below(node.right, origin, direction, visit);
    }

    std::span<const Vec3> vertices_;
    std::span<const Triangle> triangles_;
    std::vector<std::uint32_t> order_;
    std::vector<Box> boxes_; ///< of the triangles, in that order
    std::vector<Node> nodes_;
};

} // namespace raycontact
