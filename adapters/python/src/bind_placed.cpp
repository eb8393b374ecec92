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
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

namespace raycontact::python {

namespace {

using Rows = std::pair<std::uint32_t, std::uint32_t>;

constexpr double infinite = std::numeric_limits<double>::infinity();

/// Shapes that have places: which of them meet, and which are nearest. Rows count from 0. Who else holds a list may ask
/// it at the same time, as long as nobody moves what is in it.
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
        for (std::vector<std::uint32_t>& order : orders_) order.clear();
        widest_ = none;
        return true;
    }
    Array poses() const { return matrices_of(poses_); }
    /// Distances of the last nearest().
    std::size_t asked() const { return asked_; }
    /// Pairs of rows of this list that are not asked, the lower one first.
    void set_allowed(std::vector<Rows> pairs) {
        std::ranges::sort(pairs);
        allowed_ = std::move(pairs);
    }

    /// Whether any two meet, or any of these and any of the others.
    bool any(PlacedList* others) {
        constexpr std::size_t alone = 64;
        const std::size_t axis = sort(others);
        std::vector<Near> near;
        for (std::size_t at = 0; at < places(others);) {
            {
                const WithoutGil without_gil;
                at = find_near(others, axis, at, 0, near, without_gil.flag());
                for (std::size_t i = 0; i < std::min(alone, near.size()); ++i)
                    if (!is_allowed(near[i].rows, others) && meet(near[i], others)) return true;
            }
            if (near.size() <= alone) continue;
            std::atomic<bool> found = false;
            for_each_item(near.size() - alone, 0, "pair", [&](std::size_t i) {
                const Near& pair = near[alone + i];
                if (!found && !is_allowed(pair.rows, others) && meet(pair, others)) found = true;
            });
            if (found) return true;
        }
        return false;
    }
    /// All pairs of rows that meet, in order.
    std::pair<Array, Array> all(PlacedList* others) {
        const std::size_t axis = sort(others);
        std::vector<Near> near;
        std::vector<Rows> met;
        for (std::size_t at = 0; at < places(others);) {
            {
                const WithoutGil without_gil;
                at = find_near(others, axis, at, 0, near, without_gil.flag());
                std::erase_if(near, [&](const Near& pair) { return is_allowed(pair.rows, others); });
            }
            std::vector<char> hit(near.size());
            for_each_item(near.size(), 0, "pair", [&](std::size_t i) { hit[i] = meet(near[i], others); });
            for (std::size_t i = 0; i < near.size(); ++i)
                if (hit[i]) met.push_back(near[i].rows);
        }
        std::ranges::sort(met);
        std::vector<std::int64_t> one, other;
        for (const auto& [i, k] : met) {
            one.push_back(i);
            other.push_back(k);
        }
        return {array_of(std::move(one), {met.size()}), array_of(std::move(other), {met.size()})};
    }
    /// The least distance of any two, or of any of these and any of the others but some, with their rows; infinite, and
    /// rows without meaning, where there is no pair.
    std::tuple<double, std::int64_t, std::int64_t> nearest(PlacedList* others, std::vector<std::uint32_t> but) {
        std::ranges::sort(but);
        const auto counts = [&](const Rows& rows) {
            return others == nullptr ? !is_allowed(rows, others) : !std::ranges::binary_search(but, rows.second);
        };
        const std::size_t axis = sort(others);
        asked_ = 0;
        Near best{infinite, {}};
        double reach = upper_bound_of(others, axis, counts);
        std::vector<Near> near;
        for (std::size_t at = 0; at < places(others) && best.distance > 0;) {
            {
                const WithoutGil without_gil;
                at = find_near(others, axis, at, reach, near, without_gil.flag());
                std::erase_if(near, [&](const Near& pair) { return !counts(pair.rows); });
                std::sort(near.begin(), near.end());
            }
            look(others, near, reach, best);
        }
        return {best.distance, best.rows.first, best.rows.second};
    }

private:
    struct Box {
        std::array<double, 3> low, high;
        double apart(const Box& other) const {
            double sum = 0;
            for (std::size_t k = 0; k < 3; ++k) {
                const double off = std::max({low[k] - other.high[k], other.low[k] - high[k], 0.0});
                sum += off * off;
            }
            return std::sqrt(sum);
        }
        /// What is in the two is no farther apart than this.
        double farthest(const Box& other) const {
            double sum = 0;
            for (std::size_t k = 0; k < 3; ++k) {
                const double off = std::max(high[k] - other.low[k], other.high[k] - low[k]);
                sum += off * off;
            }
            return std::sqrt(sum);
        }
    };
    /// Of two boxes, or of what is in them.
    struct Near {
        double distance;
        Rows rows;
        bool operator<(const Near& other) const {
            return std::tie(distance, rows) < std::tie(other.distance, other.rows);
        }
    };
    static constexpr std::size_t none = 3;

    static Box box_of(const Shape& shape, const Pose& pose) {
        const auto [low, high] = placed_box(shape, pose);
        return {{low.x, low.y, low.z}, {high.x, high.y, high.z}};
    }

    const PlacedList& or_own(const PlacedList* others) const { return others != nullptr ? *others : *this; }
    bool is_allowed(const Rows& rows, const PlacedList* others) const {
        return others == nullptr && !allowed_.empty() && std::ranges::binary_search(allowed_, rows);
    }
    bool meet(const Near& pair, const PlacedList* others) const {
        const auto& [i, k] = pair.rows;
        return intersects(*shapes_[i], poses_[i], *or_own(others).shapes_[k], or_own(others).poses_[k]);
    }

    /// Along which boxes are spread the most, measured in boxes: a sweep along it meets the fewest.
    std::size_t widest_axis() const {
        std::array<double, 3> spread{};
        for (std::size_t k = 0; k < 3; ++k) {
            double low = infinite, high = -infinite, size = 0;
            for (const Box& box : boxes_) {
                low = std::min(low, box.low[k]);
                high = std::max(high, box.high[k]);
                size += box.high[k] - box.low[k];
            }
            spread[k] = (high - low) / std::max(size, std::numeric_limits<double>::min());
        }
        return static_cast<std::size_t>(std::ranges::max_element(spread) - spread.begin());
    }
    double low_of(std::uint32_t row, std::size_t axis) const { return boxes_[row].low[axis]; }
    // What was sorted stays until somebody moves: others may look at it without the GIL.
    void sort_along(std::size_t axis) {
        std::vector<std::uint32_t>& order = orders_[axis];
        if (!order.empty()) return;
        order.resize(boxes_.size());
        std::iota(order.begin(), order.end(), 0u);
        std::ranges::sort(order, {}, [&](std::uint32_t i) { return std::pair(low_of(i, axis), i); });
    }
    /// Both lists along the axis that it returns: that of the longer one, which moves less.
    std::size_t sort(PlacedList* others) {
        PlacedList& longer = others != nullptr && others->boxes_.size() > boxes_.size() ? *others : *this;
        if (longer.widest_ == none) longer.widest_ = longer.widest_axis();
        const std::size_t axis = longer.widest_;
        sort_along(axis);
        if (others != nullptr) others->sort_along(axis);
        return axis;
    }

    /// Boxes that a sweep begins at: of two that are near one begins in the other.
    std::size_t places(const PlacedList* others) const {
        if (others == nullptr) return boxes_.size();
        return boxes_.empty() || others->boxes_.empty() ? 0 : boxes_.size() + others->boxes_.size();
    }
    /// Lists pairs whose boxes are at most `reach` apart, from that place of the sweep on until there are many; returns
    /// where to go on. stopped: by Ctrl-C; null: never.
    std::size_t find_near(const PlacedList* others, std::size_t axis, std::size_t at, double reach,
                          std::vector<Near>& found, const std::atomic<bool>* stopped) const {
        constexpr std::size_t many = 1 << 18;
        found.clear();
        const std::size_t count = boxes_.size();
        for (; at < places(others) && found.size() < many; ++at) {
            if (stopped != nullptr && *stopped) throw Interrupted();
            const bool from_own = at < count;
            const PlacedList& here = from_own ? *this : *others;
            const PlacedList& there = others != nullptr && !from_own ? *this : or_own(others);
            const std::vector<std::uint32_t>& order = there.orders_[axis];
            const std::uint32_t row = here.orders_[axis][from_own ? at : at - count];
            const Box& box = here.boxes_[row];
            const auto begin_of = [&](std::uint32_t i) { return there.low_of(i, axis); };
            // What begins where this one does comes up once.
            auto next = others == nullptr ? order.begin() + static_cast<std::ptrdiff_t>(at + 1)
                        : from_own        ? std::ranges::lower_bound(order, box.low[axis], {}, begin_of)
                                          : std::ranges::upper_bound(order, box.low[axis], {}, begin_of);
            for (; next != order.end() && begin_of(*next) <= box.high[axis] + reach; ++next) {
                const double apart = box.apart(there.boxes_[*next]);
                if (!(apart <= reach)) continue;
                const Rows rows = others == nullptr ? Rows(std::minmax(row, *next))
                                  : from_own        ? Rows(row, *next)
                                                    : Rows(*next, row);
                found.push_back({apart, rows});
            }
        }
        return at;
    }
    /// Of the least distance, by boxes that are next to each other. counts(rows): whether a pair is asked.
    template <class Counts>
    double upper_bound_of(const PlacedList* others, std::size_t axis, Counts&& counts) const {
        double least = infinite;
        const PlacedList& there = or_own(others);
        const std::vector<std::uint32_t>&own = orders_[axis], &order = there.orders_[axis];
        for (std::size_t at = 0; at < own.size(); ++at) {
            const std::uint32_t row = own[at];
            const auto begin_of = [&](std::uint32_t i) { return there.low_of(i, axis); };
            auto next = others == nullptr ? order.begin() + static_cast<std::ptrdiff_t>(at + 1)
                                          : std::ranges::lower_bound(order, low_of(row, axis), {}, begin_of);
            for (int tries = 0; tries < 2 && next != order.begin() && others != nullptr; ++tries) --next;
            for (int tries = 0; tries < 4 && next != order.end(); ++tries, ++next)
                if (counts(others != nullptr ? Rows(row, *next) : Rows(std::minmax(row, *next))))
                    least = std::min(least, boxes_[row].farthest(there.boxes_[*next]));
        }
        return least;
    }
    /// Nearest boxes first, a few at once: what is found spares most of the others. near: sorted.
    void look(const PlacedList* others, std::span<const Near> near, double& reach, Near& best) {
        constexpr std::size_t alone = 64;
        std::vector<double> found;
        for (std::size_t size = 4; !near.empty() && best.distance > 0; size = std::min<std::size_t>(2 * size, 1024)) {
            std::size_t count = 0;
            while (count < std::min(size, near.size()) && near[count].distance <= reach) ++count;
            if (count == 0) return;
            found.assign(count, infinite);
            asked_ += count;
            const auto ask = [&](std::size_t n) {
                const auto& [i, k] = near[n].rows;
                const auto least =
                    distance(*shapes_[i], poses_[i], *or_own(others).shapes_[k], or_own(others).poses_[k], reach);
                if (least) found[n] = least->distance;
            };
            if (size <= alone) {
                const WithoutGil without_gil;
                for (std::size_t n = 0; n < count; ++n) ask(n);
            } else {
                for_each_item(count, 0, "pair", ask);
            }
            const auto n = static_cast<std::size_t>(std::ranges::min_element(found) - found.begin());
            if (found[n] < best.distance) best = {found[n], near[n].rows};
            reach = std::min(reach, best.distance);
            near = near.subspan(count);
        }
    }

    std::vector<std::shared_ptr<Shape>> shapes_;
    std::vector<Pose> poses_;
    std::vector<Box> boxes_;
    std::vector<Rows> allowed_;
    std::array<std::vector<std::uint32_t>, 3> orders_; ///< rows by where their boxes begin, along each axis
    std::size_t widest_ = none, asked_ = 0;
};

} // namespace

void bind_placed(nb::module_& m) {
    nb::class_<PlacedList>(m, "PlacedList")
        .def(nb::init<std::vector<std::shared_ptr<Shape>>, const Matrices&>(), "shapes"_a, "poses"_a)
        .def("set_pose", &PlacedList::set_pose, "row"_a, "pose"_a)
        .def_prop_ro("poses", &PlacedList::poses, nb::rv_policy::automatic)
        .def_prop_ro("asked", &PlacedList::asked)
        .def("set_allowed", &PlacedList::set_allowed, "pairs"_a)
        .def("any", &PlacedList::any, nb::arg("others").none())
        .def("all", &PlacedList::all, nb::arg("others").none())
        .def("nearest", &PlacedList::nearest, nb::arg("others").none(), "but"_a);
}

} // namespace raycontact::python
