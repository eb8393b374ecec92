// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "executor/executor.h"
#include "mesh/adjacency.h"
#include "mesh/measure.h"

#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <span>
#include <utility>
#include <vector>

namespace raycontact {

/// A box hierarchy in double for the checks of a mesh (the rays of contacts have their own, in src/shape). Median
/// splits, so its depth is at most 32 and it depends on nothing but the triangles.
class TriangleBvh {
public:
    /// Over the given triangles only; at least one.
    TriangleBvh(std::span<const Vec3> vertices, std::span<const Triangle> triangles,
                std::span<const std::uint32_t> chosen, Executor& executor);

    /// Calls test(i, k), on several threads at once, for two triangles each whose boxes touch, until it returns true;
    /// returns whether it did.
    template <class Test>
    bool any_pair(Executor& executor, Test&& test) const {
        const std::vector<Pair> parts = pairs(executor.threads() > 1 ? 256 : 1);
        std::atomic<bool> found = false;
        executor.run(static_cast<std::uint32_t>(parts.size()), 1, [&](std::uint32_t begin, std::uint32_t end) {
            for (std::uint32_t i = begin; i < end && !found; ++i)
                if (any_pair_of(parts[i], test)) found = true;
        });
        return found;
    }

    /// Calls visit(i) for every triangle whose box the ray may meet. No component of the direction may be 0.
    template <class Visit>
    void along_ray(const Vec3& origin, const Vec3& direction, Visit&& visit) const {
        along_ray(whole(), origin, direction, visit);
    }

    /// Squared distance of a point from the nearest triangle, or `bound` if none is nearer than that.
    double nearest(const Vec3& point, double bound) const { return nearest(whole(), point, bound); }

    static constexpr std::uint32_t leaf_size = 4;

private:
    struct Item {
        Box box;
        Vec3 sum; ///< of the corners
        std::uint32_t triangle;
    };
    /// Some of the items, which are split at their middle, and the number of its box; the halves have twice that number
    /// and one more.
    struct Part {
        std::uint32_t node, first, last;
        std::uint32_t size() const { return last - first; }
        bool is_leaf() const { return size() <= leaf_size; }
        std::uint32_t middle() const { return first + size() / 2; }
        Part left() const { return {2 * node, first, middle()}; }
        Part right() const { return {2 * node + 1, middle(), last}; }
    };
    using Pair = std::array<Part, 2>;

    Part whole() const { return {1, 0, static_cast<std::uint32_t>(items_.size())}; }
    const Box& box_of(const Part& part) const { return boxes_[part.node]; }
    void split(const Part& part);
    void build_below(const Part& part);
    std::vector<Pair> pairs(std::size_t wanted) const;
    double nearest(const Part& part, const Vec3& point, double bound) const;
    static bool meets(const Box& box, const Vec3& origin, const Vec3& direction);

    template <class Visit>
    void along_ray(const Part& part, const Vec3& origin, const Vec3& direction, Visit& visit) const {
        if (!meets(box_of(part), origin, direction)) return;
        if (part.is_leaf()) {
            for (std::uint32_t i = part.first; i < part.last; ++i) visit(items_[i].triangle);
            return;
        }
        along_ray(part.left(), origin, direction, visit);
        along_ray(part.right(), origin, direction, visit);
    }

    /// Calls visit(pair) for the pairs that make up one, if it is not one of leaves, until that returns true. Opens the
    /// larger part, so that boxes of similar size are compared.
    template <class Visit>
    static bool any_half(const Pair& pair, Visit&& visit) {
        const auto& [a, b] = pair;
        if (a.node == b.node)
            return visit(Pair{a.left(), a.left()}) || visit(Pair{a.right(), a.right()})
                   || visit(Pair{a.left(), a.right()});
        if (!a.is_leaf() && (b.is_leaf() || a.size() >= b.size()))
            return visit(Pair{a.left(), b}) || visit(Pair{a.right(), b});
        return visit(Pair{a, b.left()}) || visit(Pair{a, b.right()});
    }

    /// Pairs of one triangle in either part.
    template <class Test>
    bool any_pair_of(const Pair& pair, Test& test) const {
        const auto& [a, b] = pair;
        if (!box_of(a).touches(box_of(b))) return false;
        if (!a.is_leaf() || !b.is_leaf())
            return any_half(pair, [&](const Pair& half) { return any_pair_of(half, test); });
        for (std::uint32_t i = a.first; i < a.last; ++i) {
            for (std::uint32_t k = a.node == b.node ? i + 1 : b.first; k < b.last; ++k) {
                if (items_[i].box.touches(items_[k].box) && test(items_[i].triangle, items_[k].triangle)) return true;
            }
        }
        return false;
    }

    std::span<const Vec3> vertices_;
    std::span<const Triangle> triangles_;
    std::vector<Item> items_;
    std::vector<Box> boxes_; ///< of parts, by their numbers
};

/// One that is made when it is first asked for: most meshes need none to be mended.
using LazyBvh = std::function<const TriangleBvh&()>;

} // namespace raycontact
