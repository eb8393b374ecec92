// SPDX-License-Identifier: Apache-2.0
#include <raycontact/shape.h>

#include "executor/float_environment.h"
#include "mesh/adjacency.h"
#include "mesh/check.h"
#include "mesh/measure.h"
#include "mesh/predicates.h"
#include "platform/system.h"
#include "shape/build.h"

#include <raycontact/error.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

namespace raycontact {

namespace {

constexpr double rounding = 1.1920929e-7;       // 2^-23
constexpr std::size_t many_triangles = 1 << 16; // a millisecond to give memory back is not noticed

// Rounds the vertices to float32, the double positions, too, so that steps see one geometry. Keeps what they were.
void round_vertices(ShapeData& shape) {
    shape.file_vertices = shape.mesh.vertices;
    shape.points.reserve(shape.mesh.vertices.size());
    Vec3 low{INFINITY, INFINITY, INFINITY}, high{-INFINITY, -INFINITY, -INFINITY};
    for (Vec3& v : shape.mesh.vertices) {
        const Vec3 offset = v - shape.centre;
        const Point3f p{static_cast<float>(offset.x), static_cast<float>(offset.y), static_cast<float>(offset.z)};
        shape.points.push_back(p);
        v = shape.centre + Vec3{p.x, p.y, p.z};
        shape.radius = std::max(shape.radius, length(v));
        shape.reach = std::max(shape.reach, length(Vec3{p.x, p.y, p.z}));
        low = least(low, {p.x, p.y, p.z});
        high = most(high, {p.x, p.y, p.z});
    }
    if (shape.file_vertices == shape.mesh.vertices) std::vector<Vec3>().swap(shape.file_vertices);
    shape.diagonal = length(high - low);
    shape.grain = shape.diagonal / std::sqrt(double(shape.mesh.triangles.size()));
    for (std::size_t k = 0; k < 3; ++k) {
        shape.header.low[k] = static_cast<float>(axis(low, k));
        shape.header.high[k] = static_cast<float>(axis(high, k));
    }
    shape.box_min = shape.centre + low;
    shape.box_max = shape.centre + high;
}

[[noreturn]] void refuse_saved() {
    throw InputError("Shape::load: the bytes are damaged: they are no shape; give what save() returned");
}

// Fills the tree, and the lanes of faces in it. Triangles without area are left out. saved: null of a new one.
void build_bvh(ShapeData& shape, std::span<const Vec3> normals, double grow, Executor& executor,
               const TreeOrder* saved) {
    std::vector<std::uint32_t> with_area;
    for (std::uint32_t i = 0; i < normals.size(); ++i)
        if (normals[i] != Vec3{}) with_area.push_back(i);
    TreePlan plan{shape.points, shape.mesh.triangles, with_area, grow, false, NODE_LEVELS};
    if (saved != nullptr) {
        if (!restore_tree(shape, plan, *saved, executor)) refuse_saved();
    } else if (!build_tree(shape, plan, executor)) {
        plan.balanced = true;
        if (!build_tree(shape, plan, executor))
            throw InputError("mesh '" + shape.mesh.name
                             + "': more than 16 million triangles; split it into several meshes");
    }
    for (std::size_t id = 0; id < shape.triangle_blocks.size(); ++id)
        for (std::size_t lane = 0; lane < TRIANGLE_LANES; ++lane)
            if (const std::uint32_t t = shape.triangle_blocks[id].triangle[lane]; t != NONE)
                shape.faces[t].triangle_lane = static_cast<std::uint32_t>(TRIANGLE_LANES * id + lane);
}

// Exact queries see the file's vertices: finds the triangles that rounding gave or took an area.
void find_slivers(ShapeData& shape, std::span<const Vec3> normals, double grow, Executor& executor) {
    std::vector<char> had_area(normals.size());
    executor.each(normals.size(), 1024, [&](std::uint32_t t) {
        std::array<Vec3, 3> corners;
        for (std::size_t k = 0; k < 3; ++k) corners[k] = snapped(shape.file_vertex(shape.mesh.triangles[t][k]));
        had_area[t] = !collinear(corners[0], corners[1], corners[2]);
    });
    std::vector<std::uint32_t> lost;
    for (std::uint32_t t = 0; t < normals.size(); ++t) {
        const bool has_area = normals[t] != Vec3{};
        if (has_area && !had_area[t]) shape.flat.push_back(t);
        if (!has_area && had_area[t]) lost.push_back(t);
    }
    if (lost.empty()) return;
    if (!build_tree(shape.slivers, {shape.points, shape.mesh.triangles, lost, grow, true, most_tree_levels}, executor))
        throw std::logic_error("a balanced tree is too deep");
}

} // namespace

Shape::Shape(std::unique_ptr<Data> data) : data_(std::move(data)) {
    data_->accelerators = std::make_shared<AcceleratorSlot>();
}
Shape::~Shape() = default;

std::shared_ptr<const Shape> Shape::make(const Mesh& mesh, std::uint32_t threads) {
    return make(prepare_mesh(mesh, {.threads = threads}), threads);
}

std::shared_ptr<const Shape> Shape::make(PreparedMesh mesh, std::uint32_t threads) {
    const FloatEnvironment environment;
    Executor executor(threads_for(mesh.triangles.size(), threads));
    return std::shared_ptr<const Shape>(new Shape(build_shape(std::move(mesh), executor)));
}

std::unique_ptr<ShapeData> build_shape(PreparedMesh mesh, Executor& executor, SlowParts* saved) {
    if (mesh.triangles.empty()) throw InputError("mesh '" + mesh.name + "': no triangles; nothing to collide");
    if (mesh.vertex_index.size() != mesh.vertices.size() || mesh.triangle_index.size() != mesh.triangles.size())
        throw InputError("mesh '" + mesh.name + "': its index maps do not fit; make it with prepare_mesh()");
    for (const auto& triangle : mesh.triangles)
        for (const std::uint32_t v : triangle)
            if (v >= mesh.vertices.size())
                throw InputError("mesh '" + mesh.name + "': vertex " + std::to_string(v) + " does not exist");
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
        if (!is_finite(mesh.vertices[v]))
            throw InputError("mesh '" + mesh.name + "': vertex " + std::to_string(v) + " is not finite");
    check_size(mesh.vertices, "mesh '" + mesh.name + "'");
    auto data = std::make_unique<ShapeData>();
    ShapeData& shape = *data;
    shape.mesh = std::move(mesh);
    shape.centre = box_of(shape.mesh.vertices).middle();
    round_vertices(shape);

    std::vector<Vec3> normals = face_normals(shape);
    if (std::all_of(normals.begin(), normals.end(), [](const Vec3& n) { return n == Vec3{}; }))
        throw InputError("mesh '" + shape.mesh.name + "': no triangle with an area; nothing to collide");
    shape.neighbours = triangle_neighbours(shape.mesh.triangles, shape.mesh.vertices);
    shape.faces.reserve(normals.size());
    shape.face_normals.reserve(normals.size());
    for (const auto& [a, b, c] : shape.neighbours) shape.faces.push_back({NONE, {a, b, c}});
    find_sharp_edges(shape, normals);
    find_components(shape);
    shape.vertex_normals = angle_weighted_normals(shape, normals, executor);
    find_perturbations(shape);
    shape.vertex_areas = measure_areas(shape);
    for (const Vec3& n : normals)
        shape.face_normals.push_back({static_cast<float>(n.x), static_cast<float>(n.y), static_cast<float>(n.z)});

    // Bounds of the float32 error in a ray test, with a margin: docs/internals/devices.md derives them. Rays into an
    // open mesh may start well outside its box.
    shape.header.closed = shape.mesh.report.solid ? 1 : 0;
    shape.header.outward = shape.header.closed != 0 && shape.mesh.report.outward ? 1 : 0;
    shape.header.tolerance = static_cast<float>(8 * rounding * shape.diagonal);
    const double grow = (shape.header.closed ? 32 : 256) * rounding * shape.diagonal;
    build_bvh(shape, normals, grow, executor, saved != nullptr ? &saved->tree : nullptr);
    find_slivers(shape, normals, grow, executor);
    shape.header.triangle_block_count = static_cast<kernels::uint>(shape.triangle_blocks.size());

    shape.exit_distances =
        saved != nullptr ? std::move(saved->exit_distances) : measure_exits(shape, normals, executor);
    if (shape.exit_distances.size() != shape.points.size()) refuse_saved();
    for (std::size_t v = 0; v < shape.points.size(); ++v) // where there is no normal, there is no ray
        if (shape.exit_distances[v] > 0 && shape.vertex_normals[v] == Vec3{}) refuse_saved();
    float longest_exit = 0, shortest_exit = UNBOUNDED;
    for (const float exit : shape.exit_distances) {
        if (exit > 0) shortest_exit = std::min(shortest_exit, exit);
        if (std::isfinite(exit))
            longest_exit = std::max(longest_exit, exit);
        else
            shape.rays_end = false;
    }
    shape.header.least_exit = shortest_exit;
    shape.header.ray_reach = longest_exit > 0 ? longest_exit : static_cast<float>(shape.diagonal);
    normals = {};
    const bool large = shape.mesh.triangles.size() > many_triangles;
    if (large) platform::trim_heap(); // what the tree took; here the most memory is in use
    if (saved == nullptr)
        build_clusters(shape, executor);
    else if (!restore_clusters(shape, saved->sources))
        refuse_saved();
    if (large) platform::trim_heap();
    set_box_clearance(shape.header);
    shape.set_places();
    return data;
}

void Shape::prepare(std::uint32_t threads) const {
    if (is_prepared()) return;
    Executor executor(threads_for(triangles().size(), threads));
    raycontact::prepare(*this, executor, {});
}
bool Shape::is_prepared() const noexcept {
    return accelerators_of(*this) != nullptr;
}

const std::string& Shape::name() const noexcept {
    return data_->mesh.name;
}
const MeshReport& Shape::report() const noexcept {
    return data_->mesh.report;
}
bool Shape::has_inside() const noexcept {
    return data_->header.closed != 0;
}
const Round* Shape::round() const noexcept {
    return data_->round ? &*data_->round : nullptr;
}
std::span<const Vec3> Shape::vertices() const noexcept {
    return data_->mesh.vertices;
}
std::span<const Vec3> Shape::file_vertices() const noexcept {
    return data_->file_vertices.empty() ? data_->mesh.vertices : data_->file_vertices;
}
std::span<const std::array<std::uint32_t, 3>> Shape::triangles() const noexcept {
    return data_->mesh.triangles;
}
std::span<const std::uint32_t> Shape::vertex_index() const noexcept {
    return data_->mesh.vertex_index;
}
std::span<const std::uint32_t> Shape::triangle_index() const noexcept {
    return data_->mesh.triangle_index;
}
Vec3 Shape::centre() const noexcept {
    return data_->centre;
}
Vec3 Shape::box_min() const noexcept {
    return data_->box_min;
}
Vec3 Shape::box_max() const noexcept {
    return data_->box_max;
}
double Shape::radius() const noexcept {
    return data_->radius;
}
double Shape::longest_edge() const noexcept {
    return data_->longest_edge;
}
std::span<const Vec3> Shape::vertex_normals() const noexcept {
    return data_->vertex_normals;
}
std::span<const float> Shape::vertex_areas() const noexcept {
    return data_->vertex_areas;
}
std::span<const float> Shape::exit_distances() const noexcept {
    return data_->exit_distances;
}
std::span<const std::array<std::uint32_t, 3>> Shape::neighbours() const noexcept {
    return data_->neighbours;
}
std::span<const std::uint32_t> Shape::vertex_triangles() const noexcept {
    return data_->vertex_triangle;
}

std::uint64_t Shape::memory_bytes() const {
    const auto bytes = [](const auto& list) { return list.capacity() * sizeof(list[0]); };
    const ShapeData& d = *data_;
    return sizeof d + bytes(d.mesh.vertices) + bytes(d.mesh.triangles) + bytes(d.mesh.vertex_index)
           + bytes(d.mesh.triangle_index) + bytes(d.points) + bytes(d.vertex_normals) + bytes(d.vertex_areas)
           + bytes(d.sharp_edges) + bytes(d.hides) + bytes(d.vertex_triangle) + bytes(d.perturbations)
           + bytes(d.component_vertices) + bytes(d.components) + bytes(d.exit_distances) + bytes(d.neighbours)
           + bytes(d.triangle_blocks) + bytes(d.file_vertices) + bytes(d.slivers.triangle_blocks)
           + bytes(d.slivers.nodes) + bytes(d.flat) + bytes(d.faces) + bytes(d.nodes) + bytes(d.vertex_blocks)
           + bytes(d.clusters) + bytes(d.face_normals)
           + (d.core ? sizeof d + bytes(d.core->nodes) + bytes(d.core->triangle_blocks) : 0)
           + (is_prepared() ? accelerators_of(*this)->bytes() : 0);
}

} // namespace raycontact
