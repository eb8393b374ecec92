// SPDX-License-Identifier: Apache-2.0
// Our own cutter, since mapbox/earcut is not in Debian. Ear clipping after Meisters 1975, with exact signs. Any
// triangles that face the way of a simple polygon and have its border together are a right cut: at each point the
// number of them that cover it is the polygon's winding number there. So the order in which ears are cut is free: small
// and round ones come first, which leaves few slivers and keeps each search near its ear.
#include "mesh/polygon.h"

#include "executor/float_environment.h"
#include "mesh/adjacency.h"
#include "mesh/check.h"
#include "mesh/predicates.h"
#include "mesh/vector.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <queue>

namespace raycontact {
namespace {

/// A polygon seen along an axis.
struct View {
    std::span<const Vec3> corners;
    std::size_t along = 2; ///< the axis
    int way = 0;           ///< 1 or -1 times a turn is positive where it is the polygon's; 0 without an area

    int turn(std::size_t a, std::size_t b, std::size_t c) const {
        return way * orient2d(corners[a], corners[b], corners[c], along);
    }
    double across(std::size_t i) const { return axis(corners[i], (along + 1) % 3); }
    double up(std::size_t i) const { return axis(corners[i], (along + 2) % 3); }
    bool same_place(std::size_t i, std::size_t k) const { return across(i) == across(k) && up(i) == up(k); }
};

/// Newell's normal, twice the area long, tells the axis.
View view_of(std::span<const Vec3> corners) {
    Vec3 normal;
    for (std::size_t i = 2; i < corners.size(); ++i)
        normal = normal + cross(corners[i - 1] - corners[0], corners[i] - corners[0]);
    View view{corners};
    for (const std::size_t k : {1u, 0u})
        if (std::fabs(axis(normal, k)) > std::fabs(axis(normal, view.along))) view.along = k;
    const double area = axis(normal, view.along);
    view.way = area > 0 ? 1 : area < 0 ? -1 : 0;
    return view;
}

bool fan_is_right(const View& view) {
    for (std::size_t i = 2; i < view.corners.size(); ++i)
        if (view.turn(0, i - 1, i) <= 0) return false;
    return true;
}

/// Corners of a polygon by place, in four cells for each: they lie along a line.
class Grid {
public:
    Grid(const View& view, const std::vector<std::size_t>& corners) : view_(&view) {
        if (corners.empty()) return;
        const auto [left, right] = std::ranges::minmax(corners, {}, [&](std::size_t i) { return view.across(i); });
        const auto [bottom, top] = std::ranges::minmax(corners, {}, [&](std::size_t i) { return view.up(i); });
        width_ = static_cast<std::size_t>(2 * std::sqrt(static_cast<double>(corners.size()))) + 1;
        across_ = Axis{view.across(left), view.across(right), width_};
        up_ = Axis{view.up(bottom), view.up(top), width_};
        first_.assign(width_ * width_ + 1, 0);
        for (const std::size_t i : corners) ++first_[cell_of(i) + 1];
        std::partial_sum(first_.begin(), first_.end(), first_.begin());
        order_.resize(corners.size());
        std::vector<std::size_t> next(first_);
        for (const std::size_t i : corners) order_[next[cell_of(i)]++] = i;
    }

    std::size_t size() const { return order_.size(); }

    /// Whether test(corner) holds for one in the cells of a box. Takes cells and corners off what may be looked at.
    template <class Test>
    bool any(double left, double right, double bottom, double top, std::size_t& work, Test&& test) const {
        const std::size_t last_column = across_.of(right), last_row = up_.of(top);
        for (std::size_t row = up_.of(bottom); row <= last_row; ++row) {
            for (std::size_t column = across_.of(left); column <= last_column; ++column) {
                const std::size_t cell = row * width_ + column;
                work -= std::min(work, 1 + first_[cell + 1] - first_[cell]);
                for (std::size_t at = first_[cell]; at < first_[cell + 1]; ++at)
                    if (test(order_[at])) return true;
            }
        }
        return false;
    }

private:
    struct Axis {
        double low = 0, high = 0;
        std::size_t cells = 1;
        std::size_t of(double x) const { // rises with x
            if (!(x > low)) return 0;
            if (x >= high) return cells - 1;
            return std::min(cells - 1, static_cast<std::size_t>((x - low) / (high - low) * static_cast<double>(cells)));
        }
    };
    std::size_t cell_of(std::size_t i) const { return up_.of(view_->up(i)) * width_ + across_.of(view_->across(i)); }

    const View* view_;
    std::size_t width_ = 1;
    Axis across_, up_;
    std::vector<std::size_t> first_, order_; ///< of each cell; corners
};

class EarClipper {
public:
    explicit EarClipper(const View& view)
        : view_(view), left_(view.corners.size()), work_(4096 * left_), grid_(view, {}) {
        const std::size_t count = left_;
        for (std::size_t i = 0; i < count; ++i) corners_.push_back({(i + count - 1) % count, (i + 1) % count, 0, true});
        make_grid();
    }

    /// The triangles, or none where it ends nowhere.
    std::vector<Triangle> cut() {
        find_ears();
        while (left_ > 3) {
            if (work_ == 0 || (ears_.empty() && !find_ears() && !cut_flat())) return {};
            if (ears_.empty()) continue;
            const Ear ear = ears_.top();
            ears_.pop();
            if (corners_[ear.tip].left && corners_[ear.tip].changes == ear.changes) cut_off(ear.tip);
        }
        for (std::size_t tip = 0; left_ == 3; ++tip) {
            if (!corners_[tip].left) continue;
            if (turn_at(tip) < 0) return {};
            cut_off(tip);
        }
        return std::move(triangles_);
    }

private:
    struct Corner {
        std::size_t before, after;
        std::size_t changes; ///< of its neighbours
        bool left;           ///< not cut off yet
    };
    struct Ear {
        double shape; ///< height over the square of the longest side: small and round is better, a fan of a circle is
                      ///< worse
        std::size_t tip, changes;
        bool operator<(const Ear& other) const { return std::pair(shape, other.tip) < std::pair(other.shape, tip); }
    };

    int turn_at(std::size_t tip) const { return view_.turn(corners_[tip].before, tip, corners_[tip].after); }

    void cut_off(std::size_t tip) {
        const auto [before, after, changes, left] = corners_[tip];
        triangles_.push_back(
            {static_cast<std::uint32_t>(before), static_cast<std::uint32_t>(tip), static_cast<std::uint32_t>(after)});
        corners_[tip].left = false;
        corners_[before].after = after;
        corners_[after].before = before;
        --left_;
        if (2 * left_ < grid_.size()) make_grid();
        for (const std::size_t neighbour : {before, after}) {
            ++corners_[neighbour].changes;
            if (left_ > 3) add_ear(neighbour);
        }
    }

    /// Of the corners that are left.
    void make_grid() {
        std::vector<std::size_t> left;
        for (std::size_t i = 0; i < corners_.size(); ++i)
            if (corners_[i].left) left.push_back(i);
        grid_ = Grid(view_, left);
    }

    /// Whether the ear holds nothing but its own corners. Where a polygon touches itself, as at a bridge to a hole,
    /// corners at one place do not hide one another. One in the place of the tip or on a side is in the way if a side
    /// leads from it into the ear; from the places of the other two it would end in the ear or cross a side.
    bool is_free(std::size_t tip) {
        const std::array ear{corners_[tip].before, tip, corners_[tip].after};
        const auto [left, right] = std::minmax({view_.across(ear[0]), view_.across(ear[1]), view_.across(ear[2])});
        const auto [bottom, top] = std::minmax({view_.up(ear[0]), view_.up(ear[1]), view_.up(ear[2])});
        return !grid_.any(left, right, bottom, top, work_, [&](std::size_t i) {
            if (!corners_[i].left || view_.same_place(ear[0], i) || view_.same_place(ear[2], i)) return false;
            const int first = view_.turn(ear[0], ear[1], i), second = view_.turn(ear[1], ear[2], i);
            if (first < 0 || second < 0 || view_.turn(ear[2], ear[0], i) < 0) return false;
            const auto leads_in = [&](std::size_t to) {
                return (first > 0 || view_.turn(ear[0], ear[1], to) > 0)
                       && (second > 0 || view_.turn(ear[1], ear[2], to) > 0);
            };
            return (first > 0 && second > 0) || leads_in(corners_[i].before) || leads_in(corners_[i].after);
        });
    }

    bool add_ear(std::size_t tip) {
        const int turn = turn_at(tip);
        const Vec3 &from = view_.corners[corners_[tip].before], &at = view_.corners[tip],
                   &to = view_.corners[corners_[tip].after];
        // One in the place of its neighbour, or that turns back on its own line, has no area and hides others.
        const bool back = turn == 0 && dot(from - at, to - at) >= 0;
        if (!back && (turn <= 0 || !is_free(tip))) return false;
        const double longest = std::max({dot(at - from, at - from), dot(to - at, to - at), dot(from - to, from - to)});
        constexpr double first = std::numeric_limits<double>::infinity();
        ears_.push({back ? first : length(cross(at - from, to - at)) / (longest * std::sqrt(longest)), tip,
                    corners_[tip].changes});
        return true;
    }

    bool find_ears() {
        bool any = false;
        for (std::size_t tip = 0; tip < corners_.size() && work_ > 0; ++tip)
            if (corners_[tip].left && add_ear(tip)) any = true;
        return any;
    }

    /// A corner on a straight line. Simple polygons have ears all the time and never come here.
    bool cut_flat() {
        work_ -= std::min(work_, corners_.size());
        for (std::size_t tip = 0; tip < corners_.size(); ++tip) {
            if (!corners_[tip].left || turn_at(tip) != 0) continue;
            cut_off(tip);
            return true;
        }
        return false;
    }

    const View& view_;
    std::size_t left_;
    std::size_t work_; ///< what may still be looked at: some thousand for each corner, so that no file takes for ever
    std::vector<Corner> corners_;
    Grid grid_; ///< those cut off go when they are the most
    std::priority_queue<Ear> ears_;
    std::vector<Triangle> triangles_;
};

/// Cuts the polygon whose fan starts at a triangle.
void cut(Mesh& mesh, std::size_t first, std::size_t count) {
    const FloatEnvironment environment; // the predicates need rounding to nearest
    std::vector<std::uint32_t> corners(mesh.triangles[first].begin(), mesh.triangles[first].end());
    for (std::size_t i = 3; i < count; ++i) corners.push_back(mesh.triangles[first + i - 2][2]);
    std::vector<Vec3> places;
    places.reserve(count);
    for (const std::uint32_t corner : corners) {
        const Vec3& place = mesh.vertices[corner];
        // Not for the predicates; prepare_mesh() refuses it.
        if (!(std::max({std::fabs(place.x), std::fabs(place.y), std::fabs(place.z)}) <= greatest_coordinate)) return;
        places.push_back(snapped(place));
    }
    const std::vector<Triangle> triangles = cut_polygon(places);
    for (std::size_t i = 0; i < triangles.size(); ++i)
        for (std::size_t k = 0; k < 3; ++k) mesh.triangles[first + i][k] = corners[triangles[i][k]];
}

bool are_vertices(std::span<const std::uint32_t> corners, const Mesh& mesh) {
    return std::ranges::all_of(corners, [&](std::uint32_t corner) { return corner < mesh.vertices.size(); });
}

} // namespace

std::vector<Triangle> cut_polygon(std::span<const Vec3> corners) {
    const View view = view_of(corners);
    if (view.way == 0) return {};
    if (!fan_is_right(view)) return EarClipper(view).cut();
    std::vector<Triangle> fan;
    for (std::uint32_t i = 2; i < corners.size(); ++i) fan.push_back({0, i - 1, i});
    return fan;
}

void PolygonCutter::append(Mesh& mesh, std::span<const std::uint32_t> corners) {
    const std::size_t first = mesh.triangles.size();
    for (std::size_t i = 2; i < corners.size(); ++i) mesh.triangles.push_back({corners[0], corners[i - 1], corners[i]});
    if (corners.size() == 3) return;
    if (are_vertices(corners, mesh))
        cut(mesh, first, corners.size());
    else
        waiting_.emplace_back(first, corners.size());
}

void PolygonCutter::finish(Mesh& mesh) const {
    for (const auto& [first, count] : waiting_) {
        const auto fan = std::span(mesh.triangles).subspan(first, count - 2);
        if (std::ranges::all_of(fan, [&](const Triangle& t) { return are_vertices(t, mesh); })) cut(mesh, first, count);
    }
}

} // namespace raycontact
