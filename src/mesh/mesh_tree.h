// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mesh/descent.h"

#include <atomic>
#include <functional>

namespace raycontact {

/// The tree that finds triangles for the checks of a mesh.
class MeshTree {
public:
    /// Over the given triangles only; at least one.
    MeshTree(std::span<const Vec3> vertices, std::span<const Triangle> triangles, std::span<const std::uint32_t> chosen,
             Executor& executor);

    /// Calls test(i, k), on several threads at once, for two triangles each whose boxes touch, until it returns true;
    /// returns whether it did.
    template <class Test>
    bool any_pair(Executor& executor, Test&& test) const {
        std::atomic<bool> found = false;
        executor.each(tree_.triangle_blocks.size(), 16, [&](std::uint32_t i) {
            if (!found && any_pair_of(tree_.triangle_blocks[i], test)) found = true;
        });
        return found;
    }

    /// Calls visit(i) for every triangle whose box the ray may meet. No component of the direction may be 0.
    template <class Visit>
    void along_ray(const Vec3& origin, const Vec3& direction, Visit&& visit) const {
        visit_blocks(
            tree_, [&](const Box& box) { return meets(box, origin - middle_, direction); },
            [&](const kernels::TriangleBlock& block) {
                for (const std::uint32_t t : block.triangle)
                    if (t != NONE && meets(boxes_[t], origin, direction)) visit(t);
                return true;
            });
    }

    /// Calls visit(i) for every triangle whose box comes within a distance of a segment, metres. Returns how many
    /// blocks it looked at.
    template <class Visit>
    std::size_t near_segment(const Vec3& from, const Vec3& to, double within, Visit&& visit) const {
        const Vec3 around{within, within, within}, way = without_zeros(to - from);
        const auto is_near = [&](const Box& box, const Vec3& origin) {
            return meets({box.low - around, box.high + around}, origin, way, 1);
        };
        std::size_t blocks = 0;
        visit_blocks(
            tree_, [&](const Box& box) { return is_near(box, from - middle_); },
            [&](const kernels::TriangleBlock& block) {
                ++blocks;
                for (const std::uint32_t t : block.triangle)
                    if (t != NONE && is_near(boxes_[t], from)) visit(t);
                return true;
            });
        return blocks;
    }

private:
    static Vec3 without_zeros(Vec3 direction);
    /// longest: how many times the direction goes.
    static bool meets(const Box& box, const Vec3& origin, const Vec3& direction, double longest = 1e300);
    Box box_of(const kernels::TriangleBlock& block) const;

    /// A triangle of the block, and one of it or of a later block.
    template <class Test>
    bool any_pair_of(const kernels::TriangleBlock& own, Test& test) const {
        const Box box = box_of(own), near{box.low - middle_, box.high - middle_};
        bool found = false;
        visit_blocks(
            tree_, [&](const Box& other) { return other.touches(near); },
            [&](const kernels::TriangleBlock& other) {
                if (&other < &own) return true;
                for (const std::uint32_t k : other.triangle) {
                    if (k == NONE || !boxes_[k].touches(box)) continue;
                    for (const std::uint32_t i : own.triangle) {
                        if (i == NONE || (&other == &own && i >= k) || !boxes_[i].touches(boxes_[k])) continue;
                        found = found || test(i, k);
                    }
                }
                return !found;
            });
        return found;
    }

    Vec3 middle_; ///< of the mesh; the tree lies about it, so that float32 is fine enough wherever the mesh is
    std::vector<Box> boxes_; ///< by triangle, exact
    TriangleTree tree_;
};

/// One that is made when it is first asked for: most meshes need none to be mended.
using LazyTree = std::function<const MeshTree&()>;

} // namespace raycontact
