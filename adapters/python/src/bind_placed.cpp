// SPDX-License-Identifier: Apache-2.0
#include "arrays.h"
#include "batch.h"
#include "bind.h"
#include "single.h"
#include "without_gil.h"

#include <raycontact/interruption.h>
#include <raycontact/query.h>

#include <nanobind/stl/pair.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

namespace raycontact::python {

namespace {

/// Shapes that have places: which of them meet. Rows count from 0.
class PlacedList {
public:
    PlacedList(std::vector<std::shared_ptr<Shape>> shapes, const Matrices& poses)
        : shapes_(std::move(shapes)), poses_(poses_of(poses)), boxes_(shapes_.size()) {
        for (std::size_t i = 0; i < shapes_.size(); ++i) boxes_[i] = box_of(*shapes_[i], poses_[i]);
    }
    /// False where the pose is no rigid float64 matrix.
    bool set_pose(std::size_t row, nb::handle given) {
        const auto pose = pose_of(given);
        if (!pose) return false;
        poses_.at(row) = *pose;
        boxes_[row] = box_of(*shapes_[row], *pose);
        return true;
    }
    /// Pairs of rows that are not asked, the lower one first; sorted.
    void set_allowed(std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs) {
        std::ranges::sort(pairs);
        allowed_ = std::move(pairs);
    }

    /// Whether any two meet, or any of these and any of the others.
    bool any(const PlacedList* others) const {
        constexpr std::size_t alone = 64, block = 1 << 14;
        std::vector<Rows> near;
        {
            const WithoutGil without_gil;
            near = near_pairs(others, without_gil.flag());
            for (std::size_t i = 0; i < std::min(alone, near.size()); ++i)
                if (meet(near[i], others)) return true;
        }
        std::atomic<bool> found = false;
        for (std::size_t begin = alone; begin < near.size() && !found; begin += block)
            for_each_item(std::min(block, near.size() - begin), 0, "pair", [&](std::size_t i) {
                if (!found && meet(near[begin + i], others)) found = true;
            });
        return found;
    }
    /// All pairs of rows that meet, in order.
    std::pair<Array, Array> all(const PlacedList* others) const {
        std::vector<Rows> near;
        {
            const WithoutGil without_gil;
            near = near_pairs(others, without_gil.flag());
            std::ranges::sort(near);
        }
        std::vector<char> hit(near.size());
        for_each_item(near.size(), 0, "pair", [&](std::size_t i) { hit[i] = meet(near[i], others); });
        std::vector<std::int64_t> one, other;
        for (std::size_t i = 0; i < near.size(); ++i) {
            if (!hit[i]) continue;
            one.push_back(near[i].first);
            other.push_back(near[i].second);
        }
        const std::size_t count = one.size();
        return {array_of(std::move(one), {count}), array_of(std::move(other), {count})};
    }

private:
    using Rows = std::pair<std::uint32_t, std::uint32_t>;
    struct Box {
        std::array<double, 3> low, high;
        bool touches(const Box& other) const {
            for (std::size_t k = 0; k < 3; ++k)
                if (low[k] > other.high[k] || other.low[k] > high[k]) return false;
            return true;
        }
    };

    /// Grown by what is rounded: whether bodies meet is decided exactly, by the last bit.
    static Box box_of(const Shape& shape, const Pose& pose) {
        const Vec3 low = shape.box_min(), high = shape.box_max(), &t = pose.translation;
        const std::array middle{(low.x + high.x) / 2, (low.y + high.y) / 2, (low.z + high.z) / 2},
            half{(high.x - low.x) / 2, (high.y - low.y) / 2, (high.z - low.z) / 2}, move{t.x, t.y, t.z};
        Box box{};
        for (std::size_t i = 0; i < 3; ++i) {
            double centre = move[i], size = 0, reach = std::fabs(move[i]);
            for (std::size_t k = 0; k < 3; ++k) {
                const double r = pose.rotation[3 * i + k];
                centre += r * middle[k];
                size += std::fabs(r) * half[k];
                reach += std::fabs(r) * (std::fabs(middle[k]) + half[k]);
            }
            size += 16 * std::numeric_limits<double>::epsilon() * reach;
            box.low[i] = centre - size;
            box.high[i] = centre + size;
        }
        return box;
    }

    bool is_allowed(const Rows& rows) const { return std::ranges::binary_search(allowed_, rows); }
    bool meet(const Rows& rows, const PlacedList* others) const {
        const PlacedList& other = others != nullptr ? *others : *this;
        return intersects(*shapes_[rows.first], poses_[rows.first], *other.shapes_[rows.second],
                          other.poses_[rows.second]);
    }
    std::vector<std::uint32_t> by_begin(std::size_t axis) const {
        std::vector<std::uint32_t> order(boxes_.size());
        std::iota(order.begin(), order.end(), 0u);
        std::ranges::sort(order, {}, [&](std::uint32_t i) { return boxes_[i].low[axis]; });
        return order;
    }
    /// Along which they reach farthest.
    std::size_t longest_axis() const {
        std::array<double, 3> extent{};
        for (std::size_t k = 0; k < 3; ++k) {
            const auto [first, last] = std::ranges::minmax(boxes_, {}, [&](const Box& box) { return box.low[k]; });
            extent[k] = last.low[k] - first.low[k];
        }
        return static_cast<std::size_t>(std::ranges::max_element(extent) - extent.begin());
    }
    /// Whose boxes touch: sort and sweep. stopped: by Ctrl-C; null: never.
    std::vector<Rows> near_pairs(const PlacedList* others, const std::atomic<bool>* stopped) const {
        std::vector<Rows> found;
        if (boxes_.empty() || (others != nullptr && others->boxes_.empty())) return found;
        const auto check = [&] {
            if (stopped != nullptr && *stopped) throw Interrupted();
        };
        const std::size_t axis =
            others != nullptr && others->boxes_.size() > boxes_.size() ? others->longest_axis() : longest_axis();
        const std::vector<std::uint32_t> own = by_begin(axis);
        if (others == nullptr) {
            for (std::size_t i = 0; i < own.size(); ++i) {
                check();
                for (std::size_t k = i + 1; k < own.size() && boxes_[own[k]].low[axis] <= boxes_[own[i]].high[axis];
                     ++k) {
                    const Rows rows = std::minmax(own[i], own[k]);
                    if (boxes_[own[i]].touches(boxes_[own[k]]) && !is_allowed(rows)) found.push_back(rows);
                }
            }
            return found;
        }
        // Of two boxes that touch one begins in the other.
        const std::vector<std::uint32_t> theirs = others->by_begin(axis);
        const auto begin_of = [axis](const PlacedList& list) {
            return [&list, axis](std::uint32_t i) { return list.boxes_[i].low[axis]; };
        };
        for (const std::uint32_t i : own) {
            check();
            const Box& box = boxes_[i];
            for (auto at = std::ranges::lower_bound(theirs, box.low[axis], {}, begin_of(*others));
                 at != theirs.end() && others->boxes_[*at].low[axis] <= box.high[axis]; ++at)
                if (box.touches(others->boxes_[*at])) found.emplace_back(i, *at);
        }
        for (const std::uint32_t k : theirs) {
            check();
            const Box& box = others->boxes_[k];
            for (auto at = std::ranges::upper_bound(own, box.low[axis], {}, begin_of(*this));
                 at != own.end() && boxes_[*at].low[axis] <= box.high[axis]; ++at)
                if (box.touches(boxes_[*at])) found.emplace_back(*at, k);
        }
        return found;
    }

    std::vector<std::shared_ptr<Shape>> shapes_;
    std::vector<Pose> poses_;
    std::vector<Box> boxes_;
    std::vector<Rows> allowed_;
};

} // namespace

void bind_placed(nb::module_& m) {
    nb::class_<PlacedList>(m, "PlacedList")
        .def(nb::init<std::vector<std::shared_ptr<Shape>>, const Matrices&>(), "shapes"_a, "poses"_a)
        .def("set_pose", &PlacedList::set_pose, "row"_a, "pose"_a)
        .def("set_allowed", &PlacedList::set_allowed, "pairs"_a)
        .def("any", &PlacedList::any, nb::arg("others").none())
        .def("all", &PlacedList::all, nb::arg("others").none());
}

} // namespace raycontact::python
