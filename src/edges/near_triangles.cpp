// SPDX-License-Identifier: Apache-2.0
#include "edges/near_triangles.h"

#include <array>
#include <cmath>

namespace raycontact {

namespace {

constexpr std::size_t lanes = 16;
static_assert(lanes == NODE_LANES && lanes == TRIANGLE_LANES);

// Lower x y z, upper x y z.
using Box6 = std::array<float, 6>;
struct Boxes {
    std::array<std::array<float, lanes>, 6> bounds;
};

std::uint32_t lanes_in(const float (*bounds)[lanes], const Box6& box) {
    std::array<std::uint32_t, lanes> in{};
    for (std::size_t k = 0; k < lanes; ++k)
        in[k] = static_cast<std::uint32_t>((bounds[0][k] <= box[3]) & (bounds[3][k] >= box[0])
                                           & (bounds[1][k] <= box[4]) & (bounds[4][k] >= box[1])
                                           & (bounds[2][k] <= box[5]) & (bounds[5][k] >= box[2]));
    std::uint32_t found = 0;
    for (std::size_t k = 0; k < lanes; ++k) found |= in[k] << k;
    return found;
}

/// Walks both trees at once. In float: `grow_` covers its rounding.
class Search {
public:
    Search(const SourceMesh& placed, double margin, std::vector<TrianglePair>& found)
        : first_(placed.source), second_(placed.target), found_(found) {
        for (std::size_t i = 0; i < 9; ++i) {
            rotation_[i] = static_cast<float>(placed.pose.rotation[i]);
            size_[i] = std::fabs(rotation_[i]);
        }
        const Vec3& t = placed.pose.translation;
        translation_ = {static_cast<float>(t.x), static_cast<float>(t.y), static_cast<float>(t.z)};
        grow_ = static_cast<float>(margin + 2 * placed.hair + 2e-6 * (first_.reach + second_.reach + length(t)));
    }

    void run() { both(0, 0); }

private:
    // The box of a child of the first body's tree, seen from the second, grown.
    Box6 box_of(const kernels::Node& node, std::size_t k) const {
        std::array<float, 3> middle{}, half{};
        for (std::size_t i = 0; i < 3; ++i) {
            middle[i] = 0.5f * (node.bounds[i][k] + node.bounds[3 + i][k]);
            half[i] = 0.5f * (node.bounds[3 + i][k] - node.bounds[i][k]);
        }
        Box6 box{};
        for (std::size_t i = 0; i < 3; ++i) {
            const float at = rotation_[3 * i] * middle[0] + rotation_[3 * i + 1] * middle[1]
                             + rotation_[3 * i + 2] * middle[2] + translation_[i];
            const float by = size_[3 * i] * half[0] + size_[3 * i + 1] * half[1] + size_[3 * i + 2] * half[2] + grow_;
            box[i] = at - by;
            box[3 + i] = at + by;
        }
        return box;
    }

    void both(std::uint32_t first, std::uint32_t second) {
        const kernels::Node &a = first_.nodes[first], &b = second_.nodes[second];
        for (std::size_t k = 0; k < lanes; ++k) {
            if (a.child[k] == NONE) continue;
            const Box6 box = box_of(a, k);
            for (std::uint32_t in = lanes_in(b.bounds, box); in != 0; in &= in - 1) {
                const std::uint32_t child = b.child[__builtin_ctz(in)];
                if (child != NONE) pair(a.child[k], box, child);
            }
        }
    }

    void pair(std::uint32_t first, const Box6& box, std::uint32_t second) {
        const bool first_leaf = (first & LEAF) != 0, second_leaf = (second & LEAF) != 0;
        if (first_leaf && second_leaf) {
            leaves(first & ~LEAF, second & ~LEAF);
        } else if (first_leaf) {
            const kernels::Node& b = second_.nodes[second];
            for (std::uint32_t in = lanes_in(b.bounds, box); in != 0; in &= in - 1) {
                const std::uint32_t child = b.child[__builtin_ctz(in)];
                if (child != NONE) pair(first, box, child);
            }
        } else if (second_leaf) {
            under_first(first, second & ~LEAF);
        } else {
            both(first, second);
        }
    }

    // A node of the first body against a block of the second.
    void under_first(std::uint32_t first, std::uint32_t block) {
        const Box6 all = whole(boxes_of_second(block));
        const kernels::Node& a = first_.nodes[first];
        for (std::size_t k = 0; k < lanes; ++k) {
            if (a.child[k] == NONE) continue;
            const Box6 box = box_of(a, k);
            bool apart = false;
            for (std::size_t i = 0; i < 3; ++i) apart |= box[i] > all[3 + i] || box[3 + i] < all[i];
            if (apart) continue;
            if ((a.child[k] & LEAF) != 0)
                leaves(a.child[k] & ~LEAF, block);
            else
                under_first(a.child[k], block);
        }
    }

    static Box6 whole(const Boxes& boxes) {
        Box6 all{3e38f, 3e38f, 3e38f, -3e38f, -3e38f, -3e38f};
        for (std::size_t i = 0; i < 3; ++i)
            for (std::size_t k = 0; k < lanes; ++k) { // comparisons with the NaN of empty lanes are false
                if (boxes.bounds[i][k] < all[i]) all[i] = boxes.bounds[i][k];
                if (boxes.bounds[3 + i][k] > all[3 + i]) all[3 + i] = boxes.bounds[3 + i][k];
            }
        return all;
    }

    const Boxes& boxes_of_second(std::uint32_t block) {
        if (second_block_ == block) return second_boxes_;
        second_block_ = block;
        const kernels::TriangleBlock& from = second_.triangle_blocks[block];
        for (std::size_t i = 0; i < 3; ++i)
            for (std::size_t k = 0; k < lanes; ++k) {
                const float p = from.corner[i][k], q = from.corner[3 + i][k], r = from.corner[6 + i][k];
                const float low = p < q ? p : q, high = p < q ? q : p;
                second_boxes_.bounds[i][k] = low < r ? low : r;
                second_boxes_.bounds[3 + i][k] = high > r ? high : r;
            }
        return second_boxes_;
    }

    const Boxes& boxes_of_first(std::uint32_t block) {
        if (first_block_ == block) return first_boxes_;
        first_block_ = block;
        const kernels::TriangleBlock& from = first_.triangle_blocks[block];
        for (std::size_t i = 0; i < 3; ++i) {
            const float rx = rotation_[3 * i], ry = rotation_[3 * i + 1], rz = rotation_[3 * i + 2];
            for (std::size_t k = 0; k < lanes; ++k) {
                const float p = rx * from.corner[0][k] + ry * from.corner[1][k] + rz * from.corner[2][k];
                const float q = rx * from.corner[3][k] + ry * from.corner[4][k] + rz * from.corner[5][k];
                const float r = rx * from.corner[6][k] + ry * from.corner[7][k] + rz * from.corner[8][k];
                const float low = p < q ? p : q, high = p < q ? q : p;
                first_boxes_.bounds[i][k] = (low < r ? low : r) + (translation_[i] - grow_);
                first_boxes_.bounds[3 + i][k] = (high > r ? high : r) + (translation_[i] + grow_);
            }
        }
        return first_boxes_;
    }

    void leaves(std::uint32_t first, std::uint32_t second) {
        const Boxes &a = boxes_of_first(first), &b = boxes_of_second(second);
        float bounds[6][lanes];
        for (std::size_t i = 0; i < 6; ++i)
            for (std::size_t k = 0; k < lanes; ++k) bounds[i][k] = b.bounds[i][k];
        for (std::size_t k = 0; k < lanes; ++k) {
            const std::uint32_t own = first_.triangle_blocks[first].triangle[k];
            if (own == NONE) continue;
            const Box6 box{a.bounds[0][k], a.bounds[1][k], a.bounds[2][k],
                           a.bounds[3][k], a.bounds[4][k], a.bounds[5][k]};
            for (std::uint32_t in = lanes_in(bounds, box); in != 0; in &= in - 1)
                found_.push_back({own, second_.triangle_blocks[second].triangle[__builtin_ctz(in)]});
        }
    }

    const ShapeData &first_, &second_;
    std::vector<TrianglePair>& found_;
    std::array<float, 9> rotation_{}, size_{};
    std::array<float, 3> translation_{};
    float grow_ = 0;
    std::uint32_t first_block_ = NONE, second_block_ = NONE; ///< whose boxes are at hand
    Boxes first_boxes_{}, second_boxes_{};
};

} // namespace

void find_near_triangles(const SourceMesh& first_to_second, double margin, std::vector<TrianglePair>& found) {
    Search(first_to_second, margin, found).run();
}

} // namespace raycontact
