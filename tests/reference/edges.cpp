// SPDX-License-Identifier: Apache-2.0
#include "reference/edges.h"

#include "reference/graph.h"
#include "reference/ray.h"
#include "reference/side.h"
#include "reference/solid_edges.h"
#include "reference/vector.h"

#include <scenes/random.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <set>
#include <tuple>
#include <utility>

namespace raycontact::reference {

namespace {
constexpr std::uint32_t edge_start = 0xfffffffeu, edge_end = 0xffffffffu;

Vec3 shake(std::uint32_t vertex) {
    std::uint64_t state = vertex;
    const auto next = [&] { return static_cast<double>(scenes::splitmix64(state) >> 11) * 0x1p-52 - 1; };
    const double x = next();
    const double y = next();
    return {x, y, next()};
}

struct Crossing {
    std::uint32_t face = 0; ///< of the target
    double along = 0;       ///< 0 at the edge's first vertex, 1 at its second
    bool enters = false;
    Vec3 point;
    std::uint32_t node = 0; ///< of the graph of regions
};

struct End {
    std::uint32_t vertex = none;   ///< of the source; none: it is at a crossing
    std::uint32_t crossing = none; ///< of the edge, or edge_start, edge_end
    std::uint32_t face = none;     ///< that is crossed
    std::uint32_t node = 0;
    std::uint32_t point = 0; ///< of OneWay::points_
};

struct Piece {
    std::uint32_t edge = 0;
    End ends[2];
};

// One direction of the pair: the edges of a source against a target, in the target's frame, minus its centre.
class OneWay {
public:
    OneWay(const Solid& from, const Pose& from_pose, const Solid& to, const Pose& to_pose)
        : source(from), target(to), source_pose(from_pose), target_pose(to_pose), edges(edges_of(from)),
          small(std::min(from.diagonal, to.diagonal)), hair(1e-7 * small), to_target_(to), to_source_(from),
          contact(from.vertices.size()), nodes(from.vertices.size()) {
        shift_ = (source_pose.translation - target_pose.translation)
                 + (rotate(source_pose, source.centre) - rotate(target_pose, target.centre));
        for (std::uint32_t v = 0; v < source.vertices.size(); ++v)
            vertices.push_back(to_target(source.vertices[v] + hair * (0.01 * shake(v) - source.vertex_normals[v])));
        for (const CastRay& ray : cast_all(source, source_pose, target, target_pose))
            if (ray.contact) contact[ray.vertex] = ray;
    }

    Vec3 to_target(const Vec3& p) const { return rotate_back(target_pose, rotate(source_pose, p) + shift_); }
    Vec3 to_source(const Vec3& p) const { return rotate_back(source_pose, rotate(target_pose, p) - shift_); }
    Vec3 to_world(const Vec3& p) const { return target_pose.translation + rotate(target_pose, target.centre + p); }

    bool is_small(std::uint32_t face) const {
        double longest = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            const auto& t = source.triangles[face];
            longest = std::max(longest, length(source.vertices[t[(k + 1) % 3]] - source.vertices[t[k]]));
        }
        return longest <= 0.1 * small;
    }

    double edge_length(const Edge& edge) const { return length(source.vertices[edge.to] - source.vertices[edge.from]); }

    // touching: a vertex of the pair is in contact.
    void cross_all(bool touching) {
        for (const Edge& edge : edges) {
            auto& list = crossings.emplace_back();
            if (!target.closed || !edge.sharp) continue;
            if (touching && is_small(edge.faces[0]) && (edge.faces[1] == none || is_small(edge.faces[1]))) continue;
            const Vec3 p = vertices[edge.from], q = vertices[edge.to];
            for (std::uint32_t f = 0; f < target.triangles.size(); ++f) {
                const auto& t = target.triangles[f];
                const Vec3 a = target.vertices[t[0]], b = target.vertices[t[1]], c = target.vertices[t[2]];
                const double above_p = dot(target.face_normals[f], p - a);
                const double above_q = dot(target.face_normals[f], q - a);
                if ((above_p > 0) == (above_q > 0)) continue;
                const Vec3 d = q - p;
                const double u = dot(d, cross(a - p, b - p));
                const double v = dot(d, cross(b - p, c - p));
                const double w = dot(d, cross(c - p, a - p));
                if (!(u >= 0 && v >= 0 && w >= 0) && !(u <= 0 && v <= 0 && w <= 0)) continue;
                Crossing crossing;
                crossing.face = f;
                crossing.along = above_p / (above_p - above_q);
                crossing.enters = above_p > 0;
                crossing.point = p + crossing.along * d;
                list.push_back(crossing);
            }
            std::sort(list.begin(), list.end(), [](const Crossing& x, const Crossing& y) { return x.along < y.along; });
        }
    }

    void add_nodes(Graph& graph) {
        for (auto& node : nodes) node = graph.add();
        for (auto& list : crossings)
            for (Crossing& c : list) c.node = graph.add();
    }

    void cut_pieces(bool with_concave) {
        vertex_points_.assign(source.vertices.size(), none);
        for (std::uint32_t e = 0; e < edges.size(); ++e) {
            if (!edges[e].sharp || (edges[e].concave && !with_concave)) continue;
            const auto& list = crossings[e];
            const auto n = static_cast<std::uint32_t>(list.size());
            if (n == 0) continue;
            if (!list[0].enters) add_piece(e, edge_start, 0);
            for (std::uint32_t i = 0; i < n; ++i) {
                if (!list[i].enters) continue;
                if (i + 1 == n)
                    add_piece(e, i, edge_end);
                else if (!list[i + 1].enters)
                    add_piece(e, i, i + 1);
            }
        }
    }

    void join_regions(Graph& graph) const {
        std::vector<bool> ends(source.vertices.size(), false);
        for (const Piece& piece : pieces) {
            graph.join(piece.ends[0].node, piece.ends[1].node);
            for (const End& end : piece.ends)
                if (end.vertex != none) ends[end.vertex] = true;
        }
        std::set<std::pair<std::uint32_t, std::uint32_t>> crossed; // or long ones in a flat face, which may be
        for (std::size_t e = 0; e < edges.size(); ++e)
            if (!crossings[e].empty() || (!edges[e].sharp && edge_length(edges[e]) > 0.1 * small))
                crossed.insert(std::minmax(edges[e].from, edges[e].to));
        for (const auto& [v, w] : source.edges) {
            if (crossed.contains(std::minmax(v, w))) continue;
            if (contact[v] && (contact[w] || ends[w])) graph.join(nodes[v], nodes[w]);
            if (contact[w] && ends[v]) graph.join(nodes[v], nodes[w]);
        }
    }

    std::vector<ReferenceContact> contacts_of(const std::vector<std::uint32_t>& region, VertexBody body,
                                              Direction direction) {
        gather_points(region);
        std::vector<std::optional<Choice>> choices;
        for (const Piece& piece : pieces) choices.push_back(choose(piece, region[piece.ends[0].node]));
        agree(choices, region);
        std::vector<ReferenceContact> contacts;
        std::set<std::uint32_t> spoken; // vertices
        for (std::size_t i = 0; i < pieces.size(); ++i) {
            const Piece& piece = pieces[i];
            const std::optional<Choice>& choice = choices[i];
            if (!choice) continue;
            if (const auto middle = deep_middle(piece, *choice)) {
                End end = piece.ends[0];
                end.point = middle->first;
                contacts.push_back(made(piece, end, choice->face, middle->second, body, direction));
                continue;
            }
            for (const int k : {0, 1}) {
                const End& end = piece.ends[k];
                const End& other = piece.ends[1 - k];
                if (end.vertex != none && contact[end.vertex]) continue;
                const double out = end_out(end, choice->face);
                if (out <= 0) continue;
                if (choice->deepest > 0 && out < choice->region / 2) continue;
                if (other.vertex != none && out < end_out(other, choice->face) / 2) continue;
                if (end.vertex != none && !spoken.insert(end.vertex).second) continue;
                contacts.push_back(made(piece, end, choice->face, out, body, direction));
            }
        }
        return contacts;
    }

    // A component of the source that lies in the target, where nothing crosses and no vertex is in contact.
    std::optional<ReferenceContact> inside(VertexBody body, Direction direction) const {
        if (!target.closed) return {};
        Graph graph;
        for (std::size_t v = 0; v < source.vertices.size(); ++v) graph.add();
        for (const auto& t : source.triangles) {
            graph.join(t[0], t[1]);
            graph.join(t[1], t[2]);
        }
        const auto component = graph.flood();
        std::map<std::uint32_t, bool> lies_in;
        double farthest = 0;
        std::optional<ReferenceContact> found;
        for (const auto& t : source.triangles)
            for (const std::uint32_t v : t) {
                const auto [at, fresh] = lies_in.try_emplace(component[v]);
                if (fresh) at->second = winding_number(target, vertices[v]) > 0.5;
                if (!at->second) continue;
                const auto [point, face] = nearest(vertices[v]);
                const double distance = length(point - vertices[v]);
                if (distance <= farthest) continue;
                farthest = distance;
                ReferenceContact c;
                c.vertex_body = body;
                c.feature = Feature::inside;
                c.vertex = source.vertex_index[v];
                c.triangle = target.triangle_index[face];
                c.point = to_world(vertices[v]);
                const Vec3 out = rotate(target_pose, unit(point - vertices[v]));
                c.normal = body == VertexBody::a ? -out : out;
                c.depth = c.ray_length = distance;
                if (direction == Direction::weighted) c.weight = source.vertex_areas[v];
                found = c;
            }
        return found;
    }

    bool in_contact() const {
        return std::any_of(contact.begin(), contact.end(), [](const auto& c) { return c.has_value(); });
    }
    bool crosses() const {
        return std::any_of(crossings.begin(), crossings.end(), [](const auto& list) { return !list.empty(); });
    }

    const Solid& source;
    const Solid& target;
    const Pose& source_pose;
    const Pose& target_pose;
    std::vector<Edge> edges;
    double small, hair;

private:
    struct Choice {
        std::uint32_t face = 0;
        double region = 0;  ///< R
        double deepest = 0; ///< V
    };

    void add_piece(std::uint32_t e, std::uint32_t from, std::uint32_t to) {
        const Edge& edge = edges[e];
        Piece piece;
        piece.edge = e;
        const std::uint32_t names[2] = {from, to};
        Vec3 at[2];
        for (const int k : {0, 1}) {
            End& end = piece.ends[k];
            end.crossing = names[k];
            if (names[k] == edge_start || names[k] == edge_end) {
                end.vertex = names[k] == edge_start ? edge.from : edge.to;
                end.node = nodes[end.vertex];
                at[k] = vertices[end.vertex];
            } else {
                const Crossing& crossing = crossings[e][names[k]];
                end.face = crossing.face;
                end.node = crossing.node;
                at[k] = crossing.point;
            }
        }
        const double whole = length(vertices[edge.to] - vertices[edge.from]);
        const double part = length(at[1] - at[0]);
        const double pull = std::min({1e-3 * small, 0.01 * whole, 0.25 * part});
        const Vec3 along = unit(at[1] - at[0]);
        for (const int k : {0, 1}) {
            End& end = piece.ends[k];
            if (end.vertex == none) {
                end.point = add_point(at[k] + (k == 0 ? pull : -pull) * along);
            } else {
                std::uint32_t& point = vertex_points_[end.vertex];
                if (point == none) point = add_point(at[k]);
                end.point = point;
            }
        }
        pieces.push_back(piece);
    }

    std::uint32_t add_point(const Vec3& p) {
        points_.push_back(p);
        return static_cast<std::uint32_t>(points_.size() - 1);
    }

    // Of each region: its points, vertex contacts first, and the depth of the deepest vertex contact.
    void gather_points(const std::vector<std::uint32_t>& region) {
        for (std::uint32_t v = 0; v < source.vertices.size(); ++v) {
            if (!contact[v]) continue;
            std::uint32_t& point = vertex_points_[v];
            if (point == none) point = add_point(vertices[v]);
            region_points_[region[nodes[v]]].push_back(point);
            double& deepest = deepest_[region[nodes[v]]];
            deepest = std::max(deepest, contact[v]->depth);
        }
        for (const Piece& piece : pieces)
            for (const End& end : piece.ends)
                if (end.vertex == none || !contact[end.vertex]) region_points_[region[end.node]].push_back(end.point);
        for (auto& [name, list] : region_points_) {
            constexpr std::size_t most = 48;
            if (list.size() <= most) continue;
            std::vector<std::uint32_t> chosen;
            for (std::size_t i = 0; i < most; ++i) chosen.push_back(list[i * list.size() / most]);
            list = chosen;
        }
    }

    double way_out(std::uint32_t point, std::uint32_t face) {
        const auto [at, fresh] = ways_out_.try_emplace({point, face});
        if (!fresh) return at->second;
        const Vec3& p = points_[point];
        const Vec3& n = target.face_normals[face];
        const double below = dot(n, target.vertices[target.triangles[face][0]] - p);
        double out = below;
        if (below >= 0) {
            const Hit hit = to_target_.closest(p, n);
            if (hit.triangle != Hit::none && hit.from_inside) out = hit.distance;
        }
        return at->second = out;
    }

    double end_out(const End& end, std::uint32_t face) {
        if (end.face != face) return way_out(end.point, face);
        return dot(target.face_normals[face], target.vertices[target.triangles[face][0]] - points_[end.point]);
    }

    double piece_depth(const Piece& piece, std::uint32_t face) {
        return std::max(end_out(piece.ends[0], face), end_out(piece.ends[1], face));
    }

    double region_depth(std::uint32_t region, std::uint32_t face) {
        double depth = -std::numeric_limits<double>::infinity();
        for (const std::uint32_t point : region_points_[region]) depth = std::max(depth, way_out(point, face));
        return depth;
    }

    bool in_one_plane(std::uint32_t f, std::uint32_t g) const {
        const Vec3 &n = target.face_normals[f], &m = target.face_normals[g];
        const Vec3 &p = target.vertices[target.triangles[f][0]], &q = target.vertices[target.triangles[g][0]];
        return dot(n, m) > 1 - 1e-12 && std::fabs(dot(n, p) - dot(m, q)) < 1e-9 * target.diagonal;
    }

    std::vector<std::uint32_t> candidates_of(const Piece& piece) {
        std::vector<std::uint32_t> all;
        for (const End& end : piece.ends)
            if (end.face != none) all.push_back(end.face);
        const Edge& edge = edges[piece.edge];
        const Vec3 other = edge.faces[1] == none ? Vec3{} : source.face_normals[edge.faces[1]];
        const Vec3 inward = -unit(source.face_normals[edge.faces[0]] + other);
        const Vec3 down = rotate_back(target_pose, rotate(source_pose, inward));
        const Vec3& first = points_[piece.ends[0].point];
        const Vec3& last = points_[piece.ends[1].point];
        for (const Vec3& origin : {first, last, 0.5 * (first + last)}) {
            const Hit hit = to_target_.closest(origin, down);
            if (hit.triangle == Hit::none || !hit.from_inside) continue;
            const Vec3 beyond = to_source(origin) + hair * inward; // of the faces at the edge itself
            if (hit.distance > hair + to_source_.closest(beyond, inward).distance) continue;
            all.push_back(hit.triangle);
        }
        std::vector<std::uint32_t> list;
        for (const std::uint32_t face : all) {
            if (std::any_of(list.begin(), list.end(), [&](std::uint32_t f) { return in_one_plane(f, face); })) continue;
            list.push_back(face);
        }
        std::erase_if(list, [&](std::uint32_t face) { return piece_depth(piece, face) <= 0; });
        return list;
    }

    // The middle of a piece between two crossings, and its way out, if it stands for both.
    std::optional<std::pair<std::uint32_t, double>> deep_middle(const Piece& piece, const Choice& choice) {
        const auto& [first, last] = piece.ends;
        if (first.vertex != none || last.vertex != none) return {};
        const std::uint32_t middle = add_point(0.5 * (points_[first.point] + points_[last.point]));
        const double out = way_out(middle, choice.face);
        if (out <= 2 * std::max(end_out(first, choice.face), end_out(last, choice.face))) return {};
        if (out <= 0 || (choice.deepest > 0 && out < choice.region / 2)) return {};
        return std::pair(middle, out);
    }

    bool leaves_by_the_border(const Piece& piece) const {
        for (const int k : {0, 1}) {
            const End& end = piece.ends[k];
            if (end.vertex == none || !contact[end.vertex]) continue;
            const CastRay& ray = *contact[end.vertex];
            const Vec3& other = points_[piece.ends[1 - k].point];
            const Vec3 on_face = target.vertices[target.triangles[ray.triangle][0]];
            if (dot(target.face_normals[ray.triangle], on_face - other) < ray.depth / 2) return true;
        }
        return false;
    }

    std::optional<Choice> choose(const Piece& piece, std::uint32_t region) {
        if (leaves_by_the_border(piece)) return {};
        Choice choice;
        choice.deepest = deepest_.contains(region) ? deepest_.at(region) : 0;
        const auto candidates = candidates_of(piece);
        std::vector<double> of_piece, of_region;
        for (const std::uint32_t face : candidates) {
            of_piece.push_back(piece_depth(piece, face));
            of_region.push_back(std::max(of_piece.back(), region_depth(region, face)));
        }
        if (candidates.empty()) return {};
        if (*std::max_element(of_piece.begin(), of_piece.end()) < choice.deepest / 2) return {};
        const double least = *std::min_element(of_region.begin(), of_region.end());
        double least_piece = std::numeric_limits<double>::infinity();
        for (std::size_t i = 0; i < candidates.size(); ++i)
            if (of_region[i] < least + 3 * hair) least_piece = std::min(least_piece, of_piece[i]);
        bool chosen = false;
        for (std::size_t i = 0; i < candidates.size(); ++i) {
            if (of_region[i] >= least + 3 * hair || of_piece[i] >= least_piece + 3 * hair) continue;
            const Vec3 &n = target.face_normals[candidates[i]], &best = target.face_normals[choice.face];
            if (chosen && dot({0.31, 0.53, 0.79}, n) <= dot({0.31, 0.53, 0.79}, best)) continue;
            choice.face = candidates[i];
            choice.region = of_region[i];
            chosen = true;
        }
        return choice;
    }

    // Step 5: a region that leaves by another face at once.
    void agree(std::vector<std::optional<Choice>>& choices, const std::vector<std::uint32_t>& region) {
        std::map<std::uint32_t, std::vector<std::size_t>> of_region; // pieces that give contacts
        for (std::size_t i = 0; i < pieces.size(); ++i)
            if (choices[i]) of_region[region[pieces[i].ends[0].node]].push_back(i);
        for (const auto& [name, list] : of_region) {
            double least = std::numeric_limits<double>::infinity(), most = 0;
            for (const std::size_t i : list) {
                least = std::min(least, choices[i]->region);
                most = std::max(most, choices[i]->region);
            }
            const auto first = std::find_if(list.begin(), list.end(),
                                            [&](std::size_t i) { return choices[i]->region < least + 3 * hair; });
            Choice other = *choices[*first];
            const CastRay* deepest = nullptr;
            for (std::uint32_t v = 0; v < source.vertices.size(); ++v)
                if (contact[v] && region[nodes[v]] == name && (!deepest || contact[v]->depth > deepest->depth))
                    deepest = &*contact[v];
            if (deepest && deepest->depth < most / 2) {
                const double depth = std::max(0.0, region_depth(name, deepest->triangle));
                if (depth < other.region - 3 * hair) {
                    other.region = depth;
                    other.face = deepest->triangle;
                }
            }
            for (const std::size_t i : list)
                if (other.region < choices[i]->region / 2 && piece_depth(pieces[i], other.face) > 0) choices[i] = other;
        }
    }

    ReferenceContact made(const Piece& piece, const End& end, std::uint32_t face, double out, VertexBody body,
                          Direction direction) const {
        const Edge& edge = edges[piece.edge];
        ReferenceContact c;
        c.vertex_body = body;
        c.feature = Feature::edges;
        c.crossing = end.crossing;
        c.vertex = edge.number;
        c.triangle = target.triangle_index[face];
        c.point = to_world(points_[end.point]);
        const Vec3 n = rotate(target_pose, target.face_normals[face]);
        c.normal = body == VertexBody::a ? -n : n;
        c.depth = c.ray_length = out;
        if (direction == Direction::weighted) {
            double area = 0;
            for (const std::uint32_t f : edge.faces) {
                if (f == none) continue;
                const auto& t = source.triangles[f];
                area += length(cross(source.vertices[t[1]] - source.vertices[t[0]],
                                     source.vertices[t[2]] - source.vertices[t[0]]))
                        / 2;
            }
            c.weight = area / 6;
        }
        return c;
    }

    std::pair<Vec3, std::uint32_t> nearest(const Vec3& p) const {
        double least = std::numeric_limits<double>::infinity();
        std::pair<Vec3, std::uint32_t> best;
        for (std::uint32_t f = 0; f < target.triangles.size(); ++f) {
            const auto& t = target.triangles[f];
            const Vec3 point =
                closest_on_triangle(p, target.vertices[t[0]], target.vertices[t[1]], target.vertices[t[2]]);
            if (dot(point - p, point - p) < least) {
                least = dot(point - p, point - p);
                best = {point, f};
            }
        }
        return best;
    }

    RayCaster to_target_, to_source_;
    Vec3 shift_;
    std::vector<Vec3> points_;                 ///< ends of pieces and vertex contacts
    std::vector<std::uint32_t> vertex_points_; ///< of each vertex in points_, or none
    std::map<std::uint32_t, std::vector<std::uint32_t>> region_points_;
    std::map<std::uint32_t, double> deepest_;
    std::map<std::pair<std::uint32_t, std::uint32_t>, double> ways_out_; ///< of points by faces

public:
    std::vector<Vec3> vertices;                   ///< of the source, moved by a hair
    std::vector<std::optional<CastRay>> contact;  ///< of each vertex of the source
    std::vector<std::uint32_t> nodes;             ///< of each vertex of the source
    std::vector<std::vector<Crossing>> crossings; ///< of each edge, along it
    std::vector<Piece> pieces;
};

// Names the flat face of each triangle.
std::vector<std::uint32_t> flat_faces(const OneWay& side) {
    Graph graph;
    for (std::size_t t = 0; t < side.source.triangles.size(); ++t) graph.add();
    for (const Edge& edge : side.edges)
        if (!edge.sharp) graph.join(edge.faces[0], edge.faces[1]);
    return graph.flood();
}

// A crossing on the line in which two flat faces meet.
struct OnLine {
    double at;
    std::uint32_t node;
    friend bool operator<(const OnLine& p, const OnLine& q) {
        return std::pair(p.at, p.node) < std::pair(q.at, q.node);
    }
};

// Crossings that share a flat face of each body: along their line the first and second, the third and fourth, ...
void join_curves(const OneWay& of_a, const OneWay& of_b, Graph& graph) {
    const std::vector<std::uint32_t> flat_a = flat_faces(of_a), flat_b = flat_faces(of_b);
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<OnLine>> lines; // by flat faces of a and of b
    const auto along = [&](std::uint32_t a, std::uint32_t b) {                    // frame of b
        return cross(rotate_back(of_a.target_pose, rotate(of_a.source_pose, of_a.source.face_normals[a])),
                     of_b.source.face_normals[b]);
    };
    const auto add = [&](std::uint32_t face_a, std::uint32_t face_b, const Vec3& point, std::uint32_t node) {
        const std::uint32_t a = flat_a[face_a], b = flat_b[face_b];
        lines[{a, b}].push_back({dot(point, along(a, b)), node});
    };
    for (std::size_t e = 0; e < of_a.edges.size(); ++e)
        for (const Crossing& c : of_a.crossings[e])
            for (const std::uint32_t face : of_a.edges[e].faces)
                if (face != none) add(face, c.face, c.point, c.node);
    for (std::size_t e = 0; e < of_b.edges.size(); ++e)
        for (const Crossing& c : of_b.crossings[e])
            for (const std::uint32_t face : of_b.edges[e].faces)
                if (face != none) add(c.face, face, of_b.to_source(c.point), c.node);
    for (auto& [faces, line] : lines) {
        const bool in_twos = line.size() % 2 == 0 && length(along(faces.first, faces.second)) > 1e-6;
        if (in_twos) std::sort(line.begin(), line.end());
        for (std::size_t i = 1; i < line.size(); i += in_twos ? 2 : 1) graph.join(line[i - 1].node, line[i].node);
    }
}

std::vector<ReferenceContact> find_with(const Solid& a, const Pose& pose_a, const Solid& b, const Pose& pose_b,
                                        Direction direction, bool with_concave) {
    OneWay of_a(a, pose_a, b, pose_b);
    OneWay of_b(b, pose_b, a, pose_a);
    Graph graph;
    const bool touching = of_a.in_contact() || of_b.in_contact();
    for (OneWay* side : {&of_a, &of_b}) {
        side->cross_all(touching);
        side->add_nodes(graph);
        side->cut_pieces(with_concave);
        side->join_regions(graph);
    }
    join_curves(of_a, of_b, graph);
    const auto region = graph.flood();
    std::vector<ReferenceContact> contacts = of_a.contacts_of(region, VertexBody::a, direction);
    const std::vector<ReferenceContact> others = of_b.contacts_of(region, VertexBody::b, direction);
    contacts.insert(contacts.end(), others.begin(), others.end());
    if (!with_concave && contacts.empty() && !touching && (of_a.crosses() || of_b.crosses()))
        return find_with(a, pose_a, b, pose_b, direction, true);
    if (!of_a.crosses() && !of_b.crosses() && !of_a.in_contact() && !of_b.in_contact()) {
        if (const auto c = of_a.inside(VertexBody::a, direction)) contacts.push_back(*c);
        if (const auto c = of_b.inside(VertexBody::b, direction)) contacts.push_back(*c);
    }
    std::stable_sort(contacts.begin(), contacts.end(), [](const auto& x, const auto& y) {
        return std::tuple(x.vertex_body, x.feature, x.vertex, x.crossing)
               < std::tuple(y.vertex_body, y.feature, y.vertex, y.crossing);
    });
    return contacts;
}

} // namespace

std::vector<ReferenceContact> find_edges(const Solid& a, const Pose& pose_a, const Solid& b, const Pose& pose_b,
                                         Direction direction) {
    return find_with(a, pose_a, b, pose_b, direction, false);
}

} // namespace raycontact::reference
