// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mesh/degenerate.h"
#include "mesh/mesh_tree.h"

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace raycontact {

/// The triangles that a mesh is checked by: those with an area, in a tree that is made when it is first asked for.
class Surface {
public:
    Surface(std::span<const Triangle> triangles, std::span<const Vec3> exact, Executor& executor)
        : triangles_(triangles), exact_(exact), executor_(executor), with_area_(triangles_with_area(triangles, exact)) {
    }

    bool is_empty() const { return with_area_.empty(); }
    const MeshTree& tree() const { return tree_ ? *tree_ : tree_.emplace(exact_, triangles_, with_area_, executor_); }

private:
    std::span<const Triangle> triangles_;
    std::span<const Vec3> exact_;
    Executor& executor_;
    std::vector<std::uint32_t> with_area_;
    mutable std::optional<MeshTree> tree_;
};

} // namespace raycontact
