// SPDX-License-Identifier: Apache-2.0
#include "executor/divide.h"
#include "mesh/vector.h"
#include "shape/build.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

namespace raycontact {

namespace {

using kernels::uint;
constexpr std::size_t lanes = VERTEX_LANES;
constexpr float nan = std::numeric_limits<float>::quiet_NaN();

// A vertex or an edge, by its name in a block, and the place by which it is ordered.
struct Source {
    Point3f place;
    uint name;
    float hides = UNBOUNDED;
};
using Sources = std::span<Source>;

// What else a lane of a block holds (kernels::VertexBlock).
struct Lane {
    Point3f direction;
    float exit;
};

// Splits along the longest side at a multiple of the largest power of sixteen that fits, so that levels of the tree
// group neighbours. Returns how many come first. In place: a large mesh has few bytes to spare.
std::size_t split_by_place(Sources own) {
    Point3f low = own[0].place, high = low;
    for (const Source& source : own) {
        const Point3f& p = source.place;
        low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
        high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
    }
    float Point3f::*longest = &Point3f::x;
    for (float Point3f::*const side : {&Point3f::y, &Point3f::z})
        if (high.*side - low.*side > high.*longest - low.*longest) longest = side;
    std::size_t unit = lanes;
    while (unit * lanes < own.size()) unit *= lanes;
    const std::size_t units = (own.size() + unit - 1) / unit, left = unit * (units / 2);
    std::ranges::nth_element(own, own.begin() + static_cast<std::ptrdiff_t>(left), {},
                             [&](const Source& s) { return std::pair(s.place.*longest, s.name); });
    return left;
}

void order_below(Sources own) {
    if (own.size() <= lanes) {
        std::ranges::sort(own, {}, &Source::name);
        return;
    }
    const std::size_t left = split_by_place(own);
    order_below(own.first(left));
    order_below(own.subspan(left));
}

void order_by_place(Sources all, Executor& executor) {
    constexpr std::size_t large = 1 << 13;
    const auto parts = divide(
        executor, all, [](const Sources& part) { return part.size() > large; },
        [](const Sources& part) {
            const std::size_t left = split_by_place(part);
            return std::array{part.first(left), part.subspan(left)};
        });
    for_each_part(executor, parts, order_below);
}

// Where few edges are asked, those that hide much (near_edges.h), these lie in blocks of their own: those that count
// beside a contact, the same for pairs whose other body is four times smaller, and those with speculative contacts of
// their own. Parts of the shape's diagonal.
void order(Sources all, const ShapeData& shape, Executor& executor) {
    for (const double share : {0.01, 0.0025, 0.00025}) {
        const auto most = [](const Source& s) { return std::pair(-s.hides, s.name); };
        auto count = static_cast<std::size_t>(
            std::ranges::count_if(all, [&](const Source& s) { return double(s.hides) > share * shape.diagonal; }));
        count = std::min(all.size(), (count + lanes - 1) / lanes * lanes);
        std::ranges::nth_element(all, all.begin() + std::ptrdiff_t(count), {}, most);
        order_by_place(all.first(count), executor);
        all = all.subspan(count);
    }
    order_by_place(all, executor);
}

// Empty (NaN) until something is added.
struct Bounds {
    float low[3] = {nan, nan, nan}, high[3] = {nan, nan, nan}, hides = 0;
    void add(std::size_t k, float from, float to) { // fmin and fmax prefer a number to NaN
        low[k] = std::fmin(low[k], from);
        high[k] = std::fmax(high[k], to);
    }
};

Point3f rounded(const Vec3& v) {
    return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}

std::vector<Source> vertices_of(const ShapeData& shape) {
    std::vector<Source> sources;
    sources.reserve(shape.points.size());
    for (uint v = 0; v < shape.points.size(); ++v)
        if (shape.exit_distances[v] > 0) sources.push_back({shape.points[v], v});
    return sources;
}
Lane vertex_lane(const ShapeData& shape, uint vertex) {
    return {rounded(-1.0 * shape.vertex_normals[vertex]), std::min(shape.exit_distances[vertex], UNBOUNDED)};
}

std::array<Vec3, 2> ends_of(const ShapeData& shape, uint edge) {
    return {shape.corner(edge / 3, edge % 3), shape.corner(edge / 3, (edge + 1) % 3)};
}
// Each edge once, by its lowest triangle.
bool is_first(const ShapeData& shape, uint edge) {
    return shape.neighbours[edge / 3][edge % 3] >= edge / 3;
}
std::size_t edge_count(const ShapeData& shape) {
    std::size_t count = 0;
    for (uint edge = 0; edge < 3 * shape.mesh.triangles.size(); ++edge) count += is_first(shape, edge);
    return count;
}
std::vector<Source> edges_of(const ShapeData& shape) {
    std::vector<Source> sources;
    sources.reserve(edge_count(shape));
    for (uint edge = 0; edge < 3 * shape.mesh.triangles.size(); ++edge) {
        if (!is_first(shape, edge)) continue;
        const auto [from, to] = ends_of(shape, edge);
        sources.push_back({rounded(0.5 * (from + to)), edge, shape.hides[edge / 3][edge % 3]});
    }
    return sources;
}
Lane edge_lane(const ShapeData& shape, uint edge) {
    const auto [from, to] = ends_of(shape, edge);
    return {rounded(0.5 * (to - from)), shape.hides[edge / 3][edge % 3]};
}

std::size_t blocks_of(std::size_t sources) {
    return (sources + lanes - 1) / lanes;
}

// reach: how far a source reaches from its place, in lengths of its direction.
void build(ShapeData& shape, kernels::SourceTree& tree, Sources sources, Lane (*lane_of)(const ShapeData&, uint),
           float reach) {
    tree.block_first = static_cast<uint>(shape.vertex_blocks.size());
    std::vector<Bounds> below;
    below.reserve(blocks_of(sources.size()));
    for (std::size_t first = 0; first < sources.size(); first += lanes) {
        kernels::VertexBlock& block = shape.vertex_blocks.emplace_back();
        Bounds& bounds = below.emplace_back();
        for (std::size_t lane = 0; lane < lanes; ++lane) {
            const bool empty = first + lane >= sources.size();
            const Source own = empty ? Source{{nan, nan, nan}, NONE} : sources[first + lane];
            const Lane more = empty ? Lane{} : lane_of(shape, own.name);
            const float place[] = {own.place.x, own.place.y, own.place.z};
            const float direction[] = {more.direction.x, more.direction.y, more.direction.z};
            for (std::size_t k = 0; k < 3; ++k) {
                const float around = reach * std::fabs(direction[k]);
                block.position[k][lane] = place[k];
                block.direction[k][lane] = direction[k];
                bounds.add(k, place[k] - around, place[k] + around);
            }
            if (!empty) bounds.hides = std::max(bounds.hides, own.hides);
            block.exit[lane] = more.exit;
            block.vertex[lane] = own.name;
        }
    }
    tree.block_count = static_cast<uint>(below.size());

    // Proportional to the shape's size, so that rounding in the transform to a target's frame does not matter.
    const float slack = 1.0e-6f * static_cast<float>(shape.diagonal);
    // The top level may hold several blocks; the traversal takes them in turn.
    uint level = 0;
    do {
        tree.cluster_first[level] = static_cast<uint>(shape.clusters.size());
        std::vector<Bounds> here((below.size() + lanes - 1) / lanes);
        tree.cluster_count[level] = static_cast<uint>(here.size());
        below.resize(lanes * here.size());
        for (std::size_t i = 0; i < below.size(); ++i) {
            const std::size_t lane = i % lanes;
            if (lane == 0) shape.clusters.emplace_back();
            shape.clusters.back().hides[lane] = below[i].hides;
            here[i / lanes].hides = std::max(here[i / lanes].hides, below[i].hides);
            for (std::size_t k = 0; k < 3; ++k) {
                const float low = below[i].low[k], high = below[i].high[k], centre = 0.5f * low + 0.5f * high;
                shape.clusters.back().centre[k][lane] = centre;
                shape.clusters.back().half_size[k][lane] = std::max(high - centre, centre - low) + slack;
                here[i / lanes].add(k, low, high);
            }
        }
        below = std::move(here);
        ++level;
    } while (below.size() > 1 && level < CLUSTER_LEVELS);
    tree.cluster_levels = level;
}

// Puts them in the order of their names; false where these are not the names of all. names: room for each name.
bool put_in_order(std::vector<Source>& sources, std::span<const uint> order, std::size_t names) {
    if (order.size() != sources.size()) return false;
    std::vector<uint> place(names, NONE); // of each name, in `sources`
    for (uint i = 0; i < sources.size(); ++i) place[sources[i].name] = i;
    std::vector<Source> ordered;
    ordered.reserve(sources.size());
    for (const uint name : order) {
        if (name >= names || place[name] == NONE) return false;
        ordered.push_back(sources[place[name]]);
        place[name] = NONE;
    }
    sources = std::move(ordered);
    return true;
}

std::vector<uint> names_of(const ShapeData& shape, const kernels::SourceTree& tree) {
    std::vector<uint> names;
    names.reserve(lanes * tree.block_count);
    for (const auto& block : std::span(shape.vertex_blocks).subspan(tree.block_first, tree.block_count))
        std::ranges::copy_if(block.vertex, std::back_inserter(names), [](uint name) { return name != NONE; });
    return names;
}

// `arrange` puts the sources in their order, first the vertices, then the edges; false if it cannot.
template <class Arrange>
bool build_both(ShapeData& shape, Arrange&& arrange) {
    shape.vertex_blocks.reserve(blocks_of(shape.points.size()) + blocks_of(edge_count(shape)));
    const auto build_one = [&](kernels::SourceTree& tree, std::vector<Source> sources, auto lane_of, float reach) {
        if (!arrange(sources, reach > 0)) return false;
        build(shape, tree, sources, lane_of, reach);
        return true;
    };
    if (!build_one(shape.header.vertices, vertices_of(shape), vertex_lane, 0)
        || !build_one(shape.header.edges, edges_of(shape), edge_lane, 1))
        return false;
    shape.vertex_blocks.shrink_to_fit();
    shape.clusters.shrink_to_fit();
    return true;
}

} // namespace

void build_clusters(ShapeData& shape, Executor& executor) {
    build_both(shape, [&](std::vector<Source>& sources, bool) {
        order(sources, shape, executor);
        return true;
    });
}

SourceOrder source_order_of(const ShapeData& shape) {
    return {names_of(shape, shape.header.vertices), names_of(shape, shape.header.edges)};
}

bool restore_clusters(ShapeData& shape, const SourceOrder& known) {
    return build_both(shape, [&](std::vector<Source>& sources, bool of_edges) {
        return of_edges ? put_in_order(sources, known.edges, 3 * shape.mesh.triangles.size())
                        : put_in_order(sources, known.vertices, shape.points.size());
    });
}

} // namespace raycontact
