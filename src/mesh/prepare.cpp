// SPDX-License-Identifier: Apache-2.0
#include <raycontact/error.h>
#include <raycontact/mesh.h>

#include "executor/float_environment.h"
#include "mesh/check.h"
#include "mesh/degenerate.h"
#include "mesh/holes.h"
#include "mesh/input_file.h"
#include "mesh/lowest_equal.h"
#include "mesh/nesting.h"
#include "mesh/predicates.h"
#include "mesh/stitch.h"
#include "mesh/surface.h"
#include "mesh/unite.h"
#include "number_text.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <string>
#include <utility>

namespace raycontact {
namespace {

/// The triangles of the file over file vertices, the lowest of each place.
PreparedMesh weld(const Mesh& mesh) {
    std::vector<Vec3> places(mesh.vertices);
    for (Vec3& p : places) p = p + Vec3{}; // turns -0 into 0
    const std::vector<std::uint32_t> lowest = lowest_equal(places);
    PreparedMesh prepared;
    prepared.name = mesh.name;
    prepared.report.repairs = mesh.repairs;
    for (const auto& [a, b, c] : mesh.triangles) prepared.triangles.push_back({lowest[a], lowest[b], lowest[c]});
    prepared.triangle_index.resize(mesh.triangles.size());
    std::iota(prepared.triangle_index.begin(), prepared.triangle_index.end(), 0u);
    return prepared;
}

/// Drops what drop_degenerate() finds, and reports how many.
void drop_triangles(PreparedMesh& prepared, std::span<const Vec3> vertices) {
    const Dropped dropped = drop_degenerate(prepared.triangles, vertices);
    std::size_t kept = 0;
    for (std::size_t i = 0; i < prepared.triangles.size(); ++i) {
        if (dropped.triangles[i]) continue;
        prepared.triangles[kept] = prepared.triangles[i];
        prepared.triangle_index[kept++] = prepared.triangle_index[i];
    }
    prepared.triangles.resize(kept);
    prepared.triangle_index.resize(kept);
    std::vector<std::string>& repairs = prepared.report.repairs;
    if (dropped.degenerate > 0) repairs.push_back("dropped " + counted(dropped.degenerate, "degenerate triangle"));
    if (dropped.duplicate > 0) repairs.push_back("dropped " + counted(dropped.duplicate, "duplicate triangle"));
    if (dropped.back_to_back > 0)
        repairs.push_back("dropped " + counted(dropped.back_to_back, "triangle") + " back to back with another");
    if (dropped.split > 0)
        repairs.push_back("split " + counted(dropped.split, "triangle") + " at a corner of another, in place of "
                          + counted(dropped.split, "degenerate triangle"));
}

/// Replaces the vertices of the triangles by the distinct ones in use. vertices: what the triangles' corners are;
/// index: their numbers in the file.
void number_vertices(std::span<const Vec3> vertices, std::span<const std::uint32_t> index, PreparedMesh& prepared) {
    std::vector<std::uint32_t> number(vertices.size(), 0), used;
    std::vector<Vec3> places;
    for (const Triangle& t : prepared.triangles) {
        for (const std::uint32_t v : t) number[v] = 1;
    }
    for (std::size_t v = 0; v < number.size(); ++v) {
        if (number[v] == 0) continue;
        number[v] = static_cast<std::uint32_t>(places.size());
        places.push_back(vertices[v]);
        used.push_back(index[v]);
    }
    for (Triangle& t : prepared.triangles) {
        for (std::uint32_t& v : t) v = number[v];
    }
    prepared.vertices = std::move(places);
    prepared.vertex_index = std::move(used);
}

/// Welded by exact position; with `repair` without the triangles that are of no use.
PreparedMesh welded(const Mesh& mesh, bool repair) {
    PreparedMesh prepared = weld(mesh);
    prepared.report.file_vertices = mesh.vertices.size();
    prepared.report.file_triangles = mesh.triangles.size();
    if (repair) drop_triangles(prepared, mesh.vertices);
    std::vector<std::uint32_t> index(mesh.vertices.size());
    std::iota(index.begin(), index.end(), 0u);
    number_vertices(mesh.vertices, index, prepared);
    return prepared;
}

/// Every edge is met as often one way as the other: closed, and wound alike everywhere.
bool is_balanced(std::span<const HalfEdge> edges) {
    bool balanced = true;
    for_each_edge(edges, [&](std::span<const HalfEdge> sides) { balanced = balanced && balance_of(sides) == 0; });
    return balanced;
}

/// A mesh on its way, with what is known of it. Each step names in the report what it did.
class Preparation {
public:
    Preparation(const Mesh& mesh, bool repair, std::uint32_t threads)
        : prepared_(welded(mesh, repair)), executor_(threads_for(prepared_.triangles.size(), threads)),
          edges_(sorted_half_edges(prepared_.triangles)) {}

    /// Joins vertices of borders that differ in their last digits, and splits triangles at T-junctions.
    void close_borders(const Mesh& mesh) {
        std::vector<std::uint32_t> ends = border_vertices(edges_);
        if (ends.empty()) return;
        const double within = border_tolerance(prepared_.vertices);
        for (std::uint32_t& v : ends) v = prepared_.vertex_index[v];
        // A small part of a large whole may be no longer than the last digit.
        if (const auto joined = join_borders(mesh, ends, std::min(within, 1e-6 * diagonal()))) {
            prepared_ = welded(*joined, true);
            edges_ = sorted_half_edges(prepared_.triangles);
        }
        const Stitched stitched = stitch_borders(prepared_.triangles, prepared_.vertices, edges_, within, executor_);
        if (stitched.given_up) report("left T-junctions as they are: too many vertices lie on borders of others");
        if (stitched.at == 0) return;
        std::vector<std::uint32_t> index; // the pieces of a triangle have its own
        for (const std::uint32_t t : stitched.of) index.push_back(prepared_.triangle_index[t]);
        prepared_.triangles = stitched.triangles;
        prepared_.triangle_index = std::move(index);
        edges_ = sorted_half_edges(prepared_.triangles);
        std::string text = "split " + counted(stitched.split, "triangle") + " at " + counted(stitched.at, "T-junction");
        if (stitched.farthest > 0) text += ", up to " + text_of(stitched.farthest) + " m beside its edge";
        report(text);
    }

    /// When the vertices are all there.
    void measure(const std::string& name) {
        exact_ = snapped(prepared_.vertices);
        surface_.emplace(prepared_.triangles, exact_, executor_);
        if (surface_->is_empty()) throw InputError(name + ": no triangle has an area");
        check_size(prepared_.vertices, name);
        patches_ = find_patches(prepared_.triangles, edges_);
    }

    /// Makes the windings of each orientable patch agree with the majority.
    void agree_windings() {
        std::size_t turned = 0;
        for (std::size_t i = 0; i < prepared_.triangles.size(); ++i) {
            const Patch& patch = patches_.list[patches_.of[i]];
            const bool fewer_against = 2 * std::uint64_t{patch.turned} <= patch.size;
            if (!patch.orientable || (patches_.against[i] != 0) != fewer_against) continue;
            std::swap(prepared_.triangles[i][1], prepared_.triangles[i][2]);
            ++turned;
        }
        if (turned == 0) return;
        report("turned " + counted(turned, "triangle") + " to make windings agree");
        find_edges();
    }

    /// Turns closed patches as told.
    void turn_components(Nesting nesting) {
        const auto tree = [&]() -> const MeshTree& { return surface_->tree(); };
        const auto [contradicts, unknown] = patches_to_turn(prepared_, patches_, tree, nesting);
        for (std::size_t i = 0; i < prepared_.triangles.size(); ++i)
            if (contradicts[patches_.of[i]]) std::swap(prepared_.triangles[i][1], prepared_.triangles[i][2]);
        if (const auto turned = std::ranges::count(contradicts, 1); turned > 0) {
            report("turned " + counted(static_cast<std::size_t>(turned), "component") + " of "
                   + std::to_string(patches_.list.size())
                   + (nesting == Nesting::cavities ? " whose winding contradicts its nesting" : " that wound inward"));
            find_edges();
        }
        if (unknown > 0)
            report("left " + counted(unknown, "component")
                   + " as wound: too many lie in each other to tell which are cavities");
    }

    /// Spans the holes that `which` names.
    void span_holes(Holes which) {
        std::vector<Hole> holes = find_holes(prepared_.triangles, exact_, edges_);
        if (holes.empty()) return;
        MeshReport& found = prepared_.report;
        const std::size_t first = prepared_.triangles.size(), number = found.file_triangles;
        std::size_t spanning = 0;
        for (const Hole& hole : holes) spanning += hole.triangles.size();
        if (number + spanning > most_triangles) return; // no number is left for them
        const auto append = [&] {
            prepared_.triangles.resize(first);
            for (const Hole& hole : holes)
                prepared_.triangles.insert(prepared_.triangles.end(), hole.triangles.begin(), hole.triangles.end());
            surface_.emplace(prepared_.triangles, exact_, executor_);
        };
        append();
        if (!is_solid(prepared_, first, surface_->tree(), executor_)) {
            std::erase_if(holes, [&](const Hole& hole) {
                return which != Holes::of_all || !(hole.flat || size_of(hole, exact_) <= 0.1 * diagonal());
            });
            append();
        }
        if (holes.empty()) return;
        found.holes = holes.size();
        found.spanning = prepared_.triangles.size() - first;
        for (std::size_t i = 0; i < found.spanning; ++i)
            prepared_.triangle_index.push_back(static_cast<std::uint32_t>(number + i));
        find_edges();
        report("spanned " + counted(holes.size(), "hole") + " with " + counted(found.spanning, "triangle")
               + ", numbered from " + std::to_string(number) + " on");
        constexpr std::size_t most_named = 20;
        for (std::size_t i = 0; i < std::min(holes.size(), most_named); ++i)
            report("spanned a " + text_of(holes[i], exact_));
    }

    /// Makes one solid of parts that lie in each other. Whether the mesh is known to be one.
    bool unite_parts(const std::string& name) {
        if (!is_balanced(edges_)) return false;
        std::optional<PreparedMesh> given; // once there is a union
        if (const auto is_solid = unite_in_rounds(name, given)) return *is_solid;
        const PreparedMesh unrounded = given ? std::move(*given) : prepared_;
        prepared_ = unrounded;
        given.reset();
        const std::string step = text_of(round_vertices());
        renew();
        if (surface_->is_empty()) { // a needle
            prepared_ = unrounded;
            renew();
            report("left parts that cross as they are: too near for numbers that are rounded");
            return false;
        }
        report("rounded coordinates to multiples of " + step
               + " m: parts that cross were too near to each other's vertices and edges");
        if (const auto is_solid = unite_in_rounds(name, given)) return *is_solid;
        if (!given) {
            prepared_ = unrounded;
            renew();
        }
        report(given ? "left pieces of united parts that cross by a rounding"
                     : "left parts that cross as they are: too many, or too near");
        return false;
    }

    /// is_solid: it is known to be one. repaired: doubled triangles are gone.
    PreparedMesh finish(bool is_solid, bool repaired, Check check) {
        fill_report(prepared_, edges_);
        MeshReport& found = prepared_.report;
        // Walls back to back that hold nothing are closed, too; faces that coincide inside a solid say nothing.
        if (repaired && !is_solid && found.solid && std::fabs(found.volume) < 1e-9 * found.area * diagonal())
            found.solid = raycontact::is_solid(prepared_, prepared_.triangles.size(), surface_->tree(), executor_);
        if (!found.solid) found.volume = 0;
        prepared_.report.outward = is_solid;
        prepared_.report.checked = is_solid;
        if (!is_solid && check == Check::full) check_surface(prepared_, patches_, exact_, surface_->tree(), executor_);
        return std::move(prepared_);
    }

private:
    /// Nothing where some are left that cross. given: the mesh before the first union, if there was one.
    std::optional<bool> unite_in_rounds(const std::string& name, std::optional<PreparedMesh>& given) {
        const Box box = box_of(prepared_.vertices);
        const double near = std::max(1e-12 * diagonal(), 1e-15 * length(most(box.high, -1.0 * box.low)));
        constexpr int rounds = 5; // what is rounded may cross itself again
        for (int unions = 0; unions < rounds; ++unions) {
            const United united = unite(prepared_, patches_, exact_, surface_->tree(), near, unions > 0, executor_);
            if (united.done == United::Done::nothing) return true;
            if (united.done == United::Done::stays) return false;
            if (united.done == United::Done::given_up) return std::nullopt;
            if (!given) given = prepared_;
            take(united, unions == 0);
            renew();
            if (surface_->is_empty()) throw InputError(name + ": nothing is left of parts that lie in each other");
        }
        return std::nullopt;
    }

    double diagonal() const {
        const Box box = box_of(prepared_.vertices);
        return length(box.high - box.low);
    }
    /// To multiples of a power of two, 2^-32 of the diagonal or a little more; returns it. Places that rounding alone
    /// keeps apart are then one, or as far apart as that.
    double round_vertices() {
        int exponent = 0;
        std::frexp(diagonal(), &exponent);
        const double step = std::ldexp(1.0, exponent - 32);
        const auto rounded = [&](double x) { return step * std::round(x / step); };
        for (Vec3& v : prepared_.vertices) v = {rounded(v.x), rounded(v.y), rounded(v.z)};
        return step;
    }
    void renew() {
        exact_ = snapped(prepared_.vertices);
        surface_.emplace(prepared_.triangles, exact_, executor_);
        find_edges();
    }
    void report(std::string text) { prepared_.report.repairs.push_back(std::move(text)); }

    void find_edges() {
        edges_ = sorted_half_edges(prepared_.triangles);
        patches_ = find_patches(prepared_.triangles, edges_);
    }

    /// The union instead of the mesh; what was rounded to one place is one vertex.
    void take(const United& united, bool tell) {
        const CutMesh& cut = united.cut;
        std::vector<Vec3> places(cut.vertices);
        for (Vec3& p : places) p = p + Vec3{}; // turns -0 into 0
        const std::vector<std::uint32_t> lowest = lowest_equal(places);
        std::vector<std::uint32_t> of, index(prepared_.vertex_index);
        const auto file_vertices = static_cast<std::uint32_t>(prepared_.report.file_vertices);
        const std::size_t given = index.size();
        index.resize(places.size());
        std::iota(index.begin() + static_cast<std::ptrdiff_t>(given), index.end(),
                  std::max(file_vertices, prepared_.vertex_index.back() + 1));
        prepared_.triangles.clear();
        for (std::size_t i = 0; i < cut.triangles.size(); ++i) {
            const auto [a, b, c] = cut.triangles[i];
            const Triangle t{lowest[a], lowest[b], lowest[c]};
            if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) continue; // rounded away
            prepared_.triangles.push_back(t);
            of.push_back(prepared_.triangle_index[cut.of[i]]);
        }
        prepared_.triangle_index = std::move(of);
        number_vertices(cut.vertices, index, prepared_);
        prepared_.report.spanning = static_cast<std::uint64_t>(
            prepared_.triangle_index.end()
            - std::ranges::lower_bound(prepared_.triangle_index, prepared_.report.file_triangles));
        if (!tell) return;
        std::string text = "united parts that lie in each other: split " + counted(united.split, "triangle")
                           + ", dropped " + counted(united.buried, "buried one");
        if (cut.vertices.size() > given)
            text += "; vertices from " + std::to_string(file_vertices) + " on are where they cross";
        report(text);
    }

    PreparedMesh prepared_;
    Executor executor_;
    std::vector<HalfEdge> edges_;
    std::vector<Vec3> exact_;        ///< vertices, snapped
    std::optional<Surface> surface_; ///< of the triangles as they are
    Patches patches_;
};

} // namespace

PreparedMesh prepare_mesh(const Mesh& mesh, const PrepareOptions& options) {
    const FloatEnvironment environment; // the predicates need rounding to nearest
    const std::string name = mesh.name.empty() ? "mesh" : printable(mesh.name);
    check_mesh(mesh, name);
    check_reach(mesh, name);
    const bool repair = options.repair == Repair::allowed;
    Preparation preparation(mesh, repair, options.threads);
    if (repair) preparation.close_borders(mesh);
    preparation.measure(name);
    if (repair) preparation.agree_windings();
    if (repair && options.holes != Holes::none) preparation.span_holes(options.holes);
    if (repair) preparation.turn_components(options.nesting); // holes closed: else a cavity would be outermost
    const bool is_solid = repair && options.overlaps == Overlaps::unite && preparation.unite_parts(name);
    return preparation.finish(is_solid, repair, options.check);
}

MeshReport measured_report(const PreparedMesh& mesh, Executor& executor) {
    const FloatEnvironment environment;
    PreparedMesh measured(mesh);
    const std::vector<HalfEdge> edges = sorted_half_edges(mesh.triangles);
    fill_report(measured, edges);
    const std::vector<Vec3> exact = snapped(mesh.vertices);
    const Surface surface(mesh.triangles, exact, executor);
    if (surface.is_empty()) throw InputError("no triangle has an area");
    check_surface(measured, find_patches(mesh.triangles, edges), exact, surface.tree(), executor);
    return measured.report;
}

MeshReport measured_report(const PreparedMesh& mesh) {
    Executor executor(0);
    return measured_report(mesh, executor);
}

} // namespace raycontact
