// SPDX-License-Identifier: Apache-2.0
#include "edges/loops.h"

#include <algorithm>

namespace raycontact {

namespace {

constexpr std::uint64_t no_faces = ~std::uint64_t{0};
// The vector area says which way unless the normals along the loop say otherwise by more than 60 degrees: of flush
// faces rounding decides where a loop runs, and they add nothing to the sum of normals.
constexpr double same_way = 0.5;

Vec3 unit(const Vec3& v) {
    const double size = length(v);
    return size > 0 ? (1 / size) * v : Vec3{};
}

} // namespace

void Loops::find(const PairMeshes& pair, std::span<const Crossing> crossings) {
    loops_.clear();
    order_.clear();
    segments_.clear();
    link(pair, crossings);
    seen_.assign(crossings.size(), false);
    for (std::uint32_t i = 0; i < crossings.size(); ++i) {
        if (seen_[i]) continue;
        walk(crossings, i);
        measure(pair, crossings, loops_.back());
    }
}

void Loops::link(const PairMeshes& pair, std::span<const Crossing> crossings) {
    links_.resize(crossings.size());
    by_faces_.clear();
    for (std::uint32_t i = 0; i < crossings.size(); ++i) {
        const Crossing& c = crossings[i];
        const auto [own, across] = faces_of(pair.shape(c.side), c.edge);
        std::size_t k = 0;
        for (const std::uint32_t face : {own, across}) {
            links_[i].next[k] = nowhere;
            links_[i].faces[k] = face == NONE  ? no_faces
                                 : c.side == 0 ? std::uint64_t{face} << 32 | c.face
                                               : std::uint64_t{c.face} << 32 | face;
            if (face != NONE) by_faces_.emplace_back(links_[i].faces[k], 2 * i + static_cast<std::uint32_t>(k));
            ++k;
        }
    }
    std::sort(by_faces_.begin(), by_faces_.end());
    for (std::size_t begin = 0, end = 0; begin < by_faces_.size(); begin = end) {
        while (end < by_faces_.size() && by_faces_[end].first == by_faces_[begin].first) ++end;
        if (end - begin != 2) continue; // no manifold, or a border: the curve ends here
        const std::uint32_t p = by_faces_[begin].second, q = by_faces_[begin + 1].second;
        links_[p / 2].next[p % 2] = q / 2;
        links_[q / 2].next[q % 2] = p / 2;
    }
}

void Loops::walk(std::span<const Crossing> crossings, std::uint32_t begin) {
    // The link by which the next crossing was reached is not the one by which the walk goes on.
    const auto leave = [this](std::uint32_t at, std::uint64_t by) { return links_[at].faces[0] == by ? 1u : 0u; };
    std::uint32_t at = begin;
    std::size_t by = 0;
    bool closed = false;
    // To an end, if there is one: the curve is listed from there.
    for (std::size_t steps = 0; steps <= crossings.size(); ++steps) {
        const std::uint32_t next = links_[at].next[by];
        if (next == nowhere) break;
        by = leave(next, links_[at].faces[by]);
        at = next;
        if (at == begin && by == 0) {
            closed = true;
            break;
        }
    }
    if (!closed) by = 1 - by;
    const std::uint32_t number = static_cast<std::uint32_t>(loops_.size());
    Loop loop{
        static_cast<std::uint32_t>(order_.size()), 0, static_cast<std::uint32_t>(segments_.size()), 0, closed, {}};
    for (;;) {
        seen_[at] = true;
        order_.push_back(at);
        ++loop.count;
        const std::uint32_t next = links_[at].next[by];
        if (next == nowhere) break;
        const std::uint64_t faces = links_[at].faces[by];
        segments_.push_back(
            {number, at, next, {static_cast<std::uint32_t>(faces >> 32), static_cast<std::uint32_t>(faces)}, {}});
        if (seen_[next]) break;
        by = leave(next, faces);
        at = next;
    }
    loop.segment_count = static_cast<std::uint32_t>(segments_.size()) - loop.first_segment;
    loops_.push_back(loop);
}

// Which way the curve runs: along the cross product of the two outward normals. Single segments between nearly parallel
// faces may say otherwise, their sum does not.
void Loops::measure(const PairMeshes& pair, std::span<const Crossing> crossings, Loop& loop) {
    const Vec3 origin = crossings[order_[loop.first]].point;
    Vec3 area{}, normals{};
    double runs = 0;
    for (std::size_t i = loop.first_segment; i < segments_.size(); ++i) {
        LoopSegment& s = segments_[i];
        s.normals = {pair.normal(0, s.faces[0]), pair.normal(1, s.faces[1])};
        const Vec3 u = crossings[s.from].point - origin, v = crossings[s.to].point - origin, along = v - u;
        area = area + 0.5 * cross(u, v);
        normals = normals + length(along) * (s.normals[1] - s.normals[0]);
        runs += dot(along, cross(s.normals[1], s.normals[0]));
    }
    if (runs < 0) area = -1.0 * area;
    loop.area = length(normals) > 0 && dot(unit(area), unit(normals)) < same_way ? length(area) * unit(normals) : area;
}

} // namespace raycontact
