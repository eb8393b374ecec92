// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "executor/executor.h"
#include "mesh/adjacency.h"
#include "mesh/measure.h"

#include <array>
#include <atomic>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace raycontact {

/// A box hierarchy in double for the checks of a mesh (the rays of contacts have their own, in src/shape). Median
/// splits, so its depth is at most 32 and it depends on nothing but the triangles.
class TriangleBvh {
public:
    /// Over the given triangles only; at least one.
    TriangleBvh(std::span<const Vec3> vertices, std::span<const Triangle> triangles, std::vector<std::uint32_t> chosen,
                Executor& executor);

    /// Calls test(i, k), on several threads at once, for two triangles each whose boxes touch, until it returns true;
    /// returns whether it did.
    template <class Test>
    bool any_pair(Executor& executor, Test&& test) const {
        const std::vector<NodePair> parts = node_pairs(executor.threads() > 1 ? 256 : 1);
        std::atomic<bool> found = false;
        executor.run(static_cast<std::uint32_t>(parts.size()), 1, [&](std::uint32_t begin, std::uint32_t end) {
            for (std::uint32_t i = begin; i < end && !found; ++i)
                if (any_pair_of(parts[i].a, parts[i].b, test)) found = true;
        });
        return found;
    }

    /// Calls visit(i) for every triangle whose box the ray may meet. No component of the direction may be 0.
    template <class Visit>
    void along_ray(const Vec3& origin, const Vec3& direction, Visit&& visit, std::uint32_t below = 0) const {
        const Node& node = nodes_[below];
        if (!meets(node.box, origin, direction)) return;
        if (node.right == 0) {
            for (std::uint32_t i = node.first; i < node.last; ++i) visit(order_[i]);
            return;
        }
        along_ray(origin, direction, visit, below + 1);
        along_ray(origin, direction, visit, node.right);
    }

    /// Squared distance of a point from the nearest triangle, or `bound` if none is nearer than that.
    double nearest(const Vec3& point, double bound, std::uint32_t below = 0) const;

    static constexpr std::uint32_t leaf_size = 4;

private:
    struct Node {
        Box box;
        std::uint32_t first, last; ///< into order_
        std::uint32_t right;       ///< 0 for a leaf; the left child follows its parent
        std::uint32_t size() const { return last - first; }
    };

    struct NodePair {
        std::uint32_t a, b;
    };
    /// Some of the order that a node covers.
    struct Part {
        std::uint32_t node, first, last;
    };
    struct Sorting;
    void build(Executor& executor);
    std::array<Part, 2> split(const Part& part, Sorting& sorting);
    void build_below(const Part& part, Sorting& sorting);
    std::vector<NodePair> node_pairs(std::size_t wanted) const;
    static double squared_distance_of(const Box& box, const Vec3& point);
    static bool meets(const Box& box, const Vec3& origin, const Vec3& direction);

    /// Pairs of one triangle below a and another below b.
    template <class Test>
    bool any_pair_of(std::uint32_t a, std::uint32_t b, Test& test) const {
        const Node &left = nodes_[a], &right = nodes_[b];
        if (!left.box.touches(right.box)) return false;
        if (a == b && left.right != 0) {
            return any_pair_of(a + 1, a + 1, test) || any_pair_of(left.right, left.right, test)
                   || any_pair_of(a + 1, left.right, test);
        }
        // Descends into the larger one, so that boxes of similar size are compared.
        if (left.right != 0 && (right.right == 0 || left.size() >= right.size()))
            return any_pair_of(a + 1, b, test) || any_pair_of(left.right, b, test);
        if (right.right != 0) return any_pair_of(a, b + 1, test) || any_pair_of(a, right.right, test);
        for (std::uint32_t i = left.first; i < left.last; ++i) {
            for (std::uint32_t k = a == b ? i + 1 : right.first; k < right.last; ++k) {
                if (boxes_[i].touches(boxes_[k]) && test(order_[i], order_[k])) return true;
            }
        }
        return false;
    }

    std::span<const Vec3> vertices_;
    std::span<const Triangle> triangles_;
    std::vector<std::uint32_t> order_;
    std::vector<Box> boxes_; ///< of the triangles, in that order
    std::vector<Node> nodes_;
};

/// Made when it is first asked for: most meshes need none to be mended.
class LazyBvh {
public:
    LazyBvh(std::span<const Vec3> vertices, std::span<const Triangle> triangles, std::vector<std::uint32_t> chosen,
            Executor& executor)
        : vertices_(vertices), triangles_(triangles), chosen_(std::move(chosen)), executor_(executor) {}

    const TriangleBvh& made() {
        if (!bvh_) bvh_.emplace(vertices_, triangles_, std::move(chosen_), executor_);
        return *bvh_;
    }

private:
    std::span<const Vec3> vertices_;
    std::span<const Triangle> triangles_;
    std::vector<std::uint32_t> chosen_;
    Executor& executor_;
    std::optional<TriangleBvh> bvh_;
};

} // namespace raycontact
