// SPDX-License-Identifier: Apache-2.0
// A constrained triangulation: points are put in one by one, then each segment that is no edge yet is made one by
// flipping the edges that cross it (Sloan 1993). All signs are exact.
#include "mesh/subdivision.h"

#include <algorithm>
#include <deque>
#include <limits>

namespace raycontact {

Subdivision::Subdivision(PointTable& points, const Triangle& corners, std::size_t& work)
    : table_(points), work_(work), corners_(corners), drop_(0), way_(0), points_(corners.begin(), corners.end()) {
    // The axis along which it looks largest.
    const Vec3 &a = table_[corners[0]].rough, &b = table_[corners[1]].rough, &c = table_[corners[2]].rough;
    const Vec3 normal = raycontact::cross(b - a, c - a);
    for (std::size_t k = 1; k < 3; ++k)
        if (std::fabs(axis(normal, k)) > std::fabs(axis(normal, drop_))) drop_ = k;
    for (std::size_t k = 0; k < 3 && way_ == 0; ++k) {
        const std::size_t drop = (drop_ + k) % 3;
        way_ = area_of(table_[corners[0]], table_[corners[1]], table_[corners[2]], drop).sign();
        if (way_ != 0) drop_ = drop;
    }
}

int Subdivision::turn(std::uint32_t p, std::uint32_t q, std::uint32_t r) const {
    if (p == q || q == r || r == p) return 0;
    if (const auto turn = rough_turn(table_[p], table_[q], table_[r], drop_)) return way_ * *turn;
    if (work_ == 0) return 0;
    constexpr std::size_t exactly = 500; // as many steps as that takes
    spend(exactly);
    return way_ * area_of(table_[p], table_[q], table_[r], drop_).sign();
}

void Subdivision::add(const Segment& segment) {
    points_.insert(points_.end(), {segment.first, segment.second});
    if (segment.first != segment.second) segments_.push_back(std::minmax(segment.first, segment.second));
}

// Of points on one line.
bool Subdivision::lies_between(std::uint32_t point, const Segment& ends) const {
    if (point == ends.first || point == ends.second) return false;
    for (const std::size_t k : {(drop_ + 1) % 3, (drop_ + 2) % 3}) {
        const int first = order(table_[ends.first], table_[point], k),
                  second = order(table_[point], table_[ends.second], k);
        if (first != 0 || second != 0) return first == second;
    }
    return false;
}

std::vector<std::uint32_t> Subdivision::on_edge(std::size_t k) const {
    const Segment edge{corners_[k], corners_[(k + 1) % 3]};
    std::vector<std::uint32_t> found;
    for (const std::uint32_t p : points_)
        if (turn(edge.first, edge.second, p) == 0 && lies_between(p, edge)) found.push_back(p);
    return found;
}

bool Subdivision::cross(const Segment& s, const Segment& t) const {
    return turn(s.first, s.second, t.first) * turn(s.first, s.second, t.second) < 0
           && turn(t.first, t.second, s.first) * turn(t.first, t.second, s.second) < 0;
}

void Subdivision::cross_segments() {
    std::ranges::sort(segments_);
    segments_.erase(std::unique(segments_.begin(), segments_.end()), segments_.end());
    for (std::size_t i = 0; i < segments_.size() && work_ > 0; ++i) {
        spend(i);
        for (std::size_t k = 0; k < i && work_ > 0; ++k) {
            const Segment &s = segments_[i], &t = segments_[k];
            if (!cross(s, t)) continue;
            const auto away = [&](std::uint32_t p) {
                return abs(area_of(table_[t.first], table_[t.second], table_[p], drop_));
            };
            points_.push_back(table_.add(between(table_[s.first], table_[s.second], away(s.first), away(s.second))));
        }
    }
}

void Subdivision::set(std::uint32_t piece, const Triangle& corners) {
    pieces_[piece] = corners;
    for (std::size_t k = 0; k < 3; ++k) edges_[{corners[k], corners[(k + 1) % 3]}] = piece;
}

void Subdivision::insert(std::uint32_t point) {
    spend(pieces_.size());
    for (std::uint32_t i = 0; i < pieces_.size(); ++i) {
        const auto [a, b, c] = pieces_[i];
        const std::array turns{turn(a, b, point), turn(b, c, point), turn(c, a, point)};
        if (std::ranges::any_of(turns, [](int t) { return t < 0; })) continue;
        const auto next = static_cast<std::uint32_t>(pieces_.size());
        const auto on = std::ranges::find(turns, 0);
        if (on == turns.end()) {
            pieces_.resize(next + 2);
            set(i, {a, b, point});
            set(next, {b, c, point});
            set(next + 1, {c, a, point});
            return;
        }
        const auto k = static_cast<std::size_t>(on - turns.begin());
        const Triangle whole = pieces_[i];
        const std::uint32_t u = whole[k], v = whole[(k + 1) % 3], w = whole[(k + 2) % 3];
        const auto across = edges_.find({v, u});
        pieces_.resize(next + 1);
        if (across != edges_.end()) {
            const std::uint32_t other = across->second;
            const Triangle& t = pieces_[other];
            const std::uint32_t x = *std::ranges::find_if(t, [&](std::uint32_t p) { return p != u && p != v; });
            edges_.erase(across);
            pieces_.resize(next + 2);
            set(other, {v, point, x});
            set(next + 1, {point, u, x});
        }
        edges_.erase({u, v});
        set(i, {u, point, w});
        set(next, {point, v, w});
        return;
    }
}

void Subdivision::recover(const Segment& segment) {
    const auto there = [&](std::uint32_t u, std::uint32_t v) { return edges_.contains({u, v}); };
    if (there(segment.first, segment.second) || there(segment.second, segment.first)) return;
    std::deque<Edge> crossing;
    for (const auto& [edge, piece] : edges_)
        if (edge.first < edge.second && there(edge.second, edge.first) && cross(segment, edge))
            crossing.push_back(edge);
    spend(edges_.size());
    while (!crossing.empty() && work_ > 0) {
        spend(1);
        const std::uint32_t u = crossing.front().first, v = crossing.front().second;
        crossing.pop_front();
        const std::uint32_t left = edges_.at({u, v}), right = edges_.at({v, u});
        const auto tip = [&](std::uint32_t piece) {
            return *std::ranges::find_if(pieces_[piece], [&](std::uint32_t p) { return p != u && p != v; });
        };
        const std::uint32_t c = tip(left), d = tip(right);
        if (!cross({c, d}, {u, v})) { // not convex
            crossing.emplace_back(u, v);
            continue;
        }
        edges_.erase({u, v});
        edges_.erase({v, u});
        set(left, {u, d, c});
        set(right, {d, v, c});
        if (cross(segment, {c, d})) crossing.push_back(std::minmax(c, d));
    }
}

std::vector<Triangle> Subdivision::cut() {
    std::ranges::sort(points_);
    points_.erase(std::unique(points_.begin(), points_.end()), points_.end());
    pieces_.assign(1, {});
    set(0, corners_);
    for (const std::uint32_t p : points_)
        if (std::ranges::count(corners_, p) == 0) insert(p);
    for (const Segment& segment : segments_) {
        if (work_ == 0) break;
        spend(points_.size());
        // From point to point along it.
        std::vector<std::uint32_t> along{segment.first, segment.second};
        for (const std::uint32_t p : points_)
            if (turn(segment.first, segment.second, p) == 0 && lies_between(p, segment)) along.push_back(p);
        const auto order_along = [&](std::uint32_t p, std::uint32_t q) {
            const int first = order(table_[p], table_[q], (drop_ + 1) % 3);
            return first != 0 ? first : order(table_[p], table_[q], (drop_ + 2) % 3);
        };
        std::ranges::sort(along, [&](std::uint32_t p, std::uint32_t q) { return order_along(p, q) < 0; });
        for (std::size_t i = 1; i < along.size(); ++i) recover({along[i - 1], along[i]});
    }
    for (Triangle& piece : pieces_) turn_as_whole(piece);
    return std::move(pieces_);
}

void Subdivision::turn_as_whole(Triangle& piece) const {
    const auto turned = [&](auto&& fits) {
        for (int turns = 0; turns < 3; ++turns, std::rotate(piece.begin(), piece.begin() + 1, piece.end()))
            for (std::size_t k = 0; k < 3; ++k)
                if (fits(k)) return true;
        return false;
    };
    if (turned([&](std::size_t k) { return piece[k] == corners_[k]; })) return;
    turned([&](std::size_t k) {
        const std::uint32_t from = corners_[k], to = corners_[(k + 1) % 3];
        return turn(from, to, piece[k]) == 0 && turn(from, to, piece[(k + 1) % 3]) == 0;
    });
}

} // namespace raycontact
