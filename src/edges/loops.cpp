// SPDX-License-Identifier: Apache-2.0
#include "edges/loops.h"

#include <algorithm>

namespace raycontact {

namespace {

std::size_t hash_of(const Crossing& c) {
    std::uint64_t h = (std::uint64_t{c.edge} << 32 | c.face) ^ std::uint64_t{c.side} << 63;
    h *= 0x9e3779b97f4a7c15ull;
    return static_cast<std::size_t>(h ^ h >> 29);
}

} // namespace

void Loops::clear() {
    for (PlacedFace& face : faces_) face.face = NONE;
    normal_faces_ = {NONE, NONE};
    if (crossings_.empty()) return;
    crossings_.clear();
    loops_.clear();
    segments_.clear();
    std::fill(table_.begin(), table_.end(), NONE);
}

bool Loops::is_known(const Crossing& c) const {
    if (table_.empty()) return false;
    for (std::size_t i = hash_of(c);; ++i) {
        const std::uint32_t number = table_[i & (table_.size() - 1)];
        if (number == NONE) return false;
        if (crossings_[number].is_same(c)) return true;
    }
}

void Loops::remember(std::uint32_t number) {
    if (2 * crossings_.size() > table_.size()) {
        table_.assign(std::max<std::size_t>(64, 4 * table_.size()), NONE);
        for (std::uint32_t i = 0; i < number; ++i) remember(i);
    }
    std::size_t i = hash_of(crossings_[number]);
    while (table_[i & (table_.size() - 1)] != NONE) ++i;
    table_[i & (table_.size() - 1)] = number;
}

void Loops::follow(const PairMeshes& pair, const Crossing& seed) {
    if (is_known(seed)) return;
    const bool closed = walk(pair, seed, true);
    steps_[0].clear();
    if (!closed) walk(pair, seed, false);
    keep(seed, closed);
}

// A crossing lies between two pairs of triangles, one on either side of its edge. On the next pair it is followed by
// the other crossing of that pair. Returns whether that leads back to the seed.
bool Loops::walk(const PairMeshes& pair, const Crossing& seed, bool onward) {
    std::vector<Step>& steps = steps_[onward ? 1 : 0];
    steps.clear();
    Crossing at = seed;
    const EdgeFaces first = faces_of(pair.shape(at.side), at.edge);
    std::uint32_t next = onward ? first.own : first.across; // beyond the edge of `at`
    Crossing mark = seed; // of a fault in the mesh: the walk comes by here again (after Brent)
    std::size_t until = 1;
    while (next != NONE) {
        faces_[at.side].set(pair, at.side, next);
        faces_[1 - at.side].set(pair, 1 - at.side, at.face);
        Crossing other;
        if (!find_other(pair, faces_, at, other)) return false; // no manifold: the curve ends here
        for (std::size_t side = 0; side < 2; ++side) {
            if (normal_faces_[side] == faces_[side].face) continue;
            normal_faces_[side] = faces_[side].face;
            normals_[side] = pair.normal(side, faces_[side].face);
        }
        steps.push_back({other, {faces_[0].face, faces_[1].face}, normals_});
        if (other.is_same(seed)) return true;
        if (other.is_same(mark)) {
            steps.clear();
            return false;
        }
        if (steps.size() == until) {
            mark = other;
            until *= 2;
        }
        const std::uint32_t here = faces_[other.side].face;
        const EdgeFaces beyond = faces_of(pair.shape(other.side), other.edge);
        at = other;
        next = beyond.own == here ? beyond.across : beyond.own;
    }
    return false;
}

void Loops::keep(const Crossing& seed, bool closed) {
    Loop loop{
        static_cast<std::uint32_t>(crossings_.size()), 0, static_cast<std::uint32_t>(segments_.size()), 0, {}, false};
    const auto add = [this](const Crossing& c) {
        crossings_.push_back(c);
        remember(static_cast<std::uint32_t>(crossings_.size() - 1));
    };
    const auto join = [this](const Step& step, std::uint32_t from, std::uint32_t to) {
        segments_.push_back({from, to, step.faces, step.normals});
    };
    const auto &back = steps_[0], &onward = steps_[1];
    for (std::size_t i = back.size(); i-- > 0;) add(back[i].next);
    add(seed);
    for (std::size_t i = 0; i + (closed ? 1 : 0) < onward.size(); ++i) add(onward[i].next);
    loop.count = static_cast<std::uint32_t>(crossings_.size()) - loop.first;
    std::uint32_t at = loop.first;
    for (std::size_t i = back.size(); i-- > 0; ++at) join(back[i], at, at + 1);
    for (std::size_t i = 0; i < onward.size(); ++i, ++at)
        join(onward[i], at, closed && i + 1 == onward.size() ? loop.first : at + 1);
    loop.segment_count = static_cast<std::uint32_t>(segments_.size()) - loop.first_segment;
    measure(loop);
    loops_.push_back(loop);
}

// Which way the curve runs: along the cross product of the two outward normals. Single segments between nearly parallel
// faces may say otherwise, their sum does not.
void Loops::measure(Loop& loop) const {
    const Vec3 origin = crossings_[loop.first].point;
    double runs = 0;
    for (const LoopSegment& s : segments().subspan(loop.first_segment)) {
        const Vec3 u = crossings_[s.from].point - origin, v = crossings_[s.to].point - origin;
        loop.area = loop.area + 0.5 * cross(u, v);
        runs += dot(v - u, cross(s.normals[1], s.normals[0]));
    }
    loop.runs_back = runs < 0;
    if (loop.runs_back) loop.area = -1.0 * loop.area;
}

} // namespace raycontact
