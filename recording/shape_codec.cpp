// SPDX-License-Identifier: Apache-2.0
#include <recording/shape_codec.h>

#include "mesh/check.h"

#include <raycontact/error.h>
#include <raycontact/primitives.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <stdexcept>
#include <utility>

namespace raycontact::recording {

namespace {

template <class T>
bool same_bits(std::span<const T> p, std::span<const T> q) {
    return p.size() == q.size() && (p.empty() || std::memcmp(p.data(), q.data(), p.size_bytes()) == 0);
}

bool same_bits(const Shape& p, const Shape& q) {
    return p.centre() == q.centre() && p.box_min() == q.box_min() && p.box_max() == q.box_max()
           && p.radius() == q.radius() && same_bits(p.vertices(), q.vertices())
           && same_bits(p.triangles(), q.triangles()) && same_bits(p.vertex_index(), q.vertex_index())
           && same_bits(p.triangle_index(), q.triangle_index()) && same_bits(p.vertex_normals(), q.vertex_normals())
           && same_bits(p.exit_distances(), q.exit_distances()) && same_bits(p.neighbours(), q.neighbours());
}

void put(Bytes& to, const Vec3& v) {
    recording::put(to, v.x);
    recording::put(to, v.y);
    recording::put(to, v.z);
}

Vec3 get_vector(ByteSource& from) {
    Vec3 v;
    v.x = from.get_double();
    v.y = from.get_double();
    v.z = from.get_double();
    if (!std::isfinite(v.x) || !std::isfinite(v.y) || !std::isfinite(v.z)) throw Damage("has a coordinate not finite");
    if (std::max({std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)}) > 1.001 * greatest_coordinate)
        throw Damage("has a coordinate too large");
    return v;
}

/// Of a round shape: radius and half length. A mesh takes more.
constexpr std::size_t measures_size = 2 * sizeof(double);

/// What is true or false of a mesh, a bit each. `checked` and `solid` are recorded as their opposites.
constexpr std::pair<bool MeshReport::*, std::uint32_t> flags[] = {{&MeshReport::closed, 1},
                                                                  {&MeshReport::manifold, 2},
                                                                  {&MeshReport::oriented, 4},
                                                                  {&MeshReport::self_intersecting, 8},
                                                                  {&MeshReport::outward, 16}};
constexpr std::uint32_t unchecked = 32, hollow = 64;

void put(Bytes& to, const MeshReport& r) {
    for (const std::uint64_t n : {r.vertices, r.triangles, r.file_vertices, r.file_triangles, r.components})
        recording::put(to, n);
    std::uint32_t bits = (r.checked ? 0 : unchecked) | (r.solid ? 0 : hollow);
    for (const auto& [flag, bit] : flags)
        if (r.*flag) bits |= bit;
    recording::put(to, bits);
    recording::put(to, r.volume);
    recording::put(to, r.area);
    put(to, r.box_min);
    put(to, r.box_max);
    recording::put(to, static_cast<std::uint32_t>(r.repairs.size()));
    for (const std::string& repair : r.repairs) recording::put(to, std::string_view(repair));
}

MeshReport get_report(ByteSource& from) {
    MeshReport r;
    for (std::uint64_t* n : {&r.vertices, &r.triangles, &r.file_vertices, &r.file_triangles, &r.components})
        *n = from.get<std::uint64_t>();
    const auto bits = from.get<std::uint32_t>();
    for (const auto& [flag, bit] : flags) r.*flag = bits & bit;
    r.checked = !(bits & unchecked);
    r.solid = r.closed && r.oriented && !(bits & hollow);
    r.volume = from.get_double();
    r.area = from.get_double();
    r.box_min = get_vector(from);
    r.box_max = get_vector(from);
    r.repairs.resize(from.get_count(4));
    for (std::string& repair : r.repairs) repair = from.get_text();
    return r;
}

/// What the report claims decides which vertices need no ray, so no claim is taken on trust. Topology must be as it
/// says. What rounding can change (remade_mesh) is believed only as far as the mesh bears it out.
void check_claims(PreparedMesh& mesh) {
    MeshReport& said = mesh.report;
    MeshReport found;
    try {
        found = measured_report(mesh);
    } catch (const InputError& error) {
        throw Damage(error.what());
    }
    if ((said.closed && !found.closed) || (said.manifold && !found.manifold) || (said.oriented && !found.oriented))
        throw Damage("is not as closed, manifold or oriented as its report says");
    if (said.checked) said.self_intersecting = said.self_intersecting || found.self_intersecting;
    said.outward = said.outward && found.outward;
    said.border_edges = found.border_edges; // not recorded, as `spanning`
    said.spanning = static_cast<std::uint64_t>(
        std::ranges::count_if(mesh.triangle_index, [&](std::uint32_t t) { return t >= said.file_triangles; }));
}

} // namespace

PreparedMesh remade_mesh(const Shape& shape) {
    PreparedMesh mesh;
    mesh.name = shape.name();
    mesh.triangles.assign(shape.triangles().begin(), shape.triangles().end());
    mesh.vertex_index.assign(shape.vertex_index().begin(), shape.vertex_index().end());
    mesh.triangle_index.assign(shape.triangle_index().begin(), shape.triangle_index().end());
    mesh.report = shape.report();
    // Rounded vertices pack better, but the middle of their box may be another.
    for (const std::span<const Vec3> vertices : {shape.vertices(), shape.file_vertices()}) {
        mesh.vertices.assign(vertices.begin(), vertices.end());
        if (same_bits(shape, *Shape::make(mesh))) return mesh;
    }
    throw std::runtime_error("recording: the mesh '" + shape.name() + "' cannot be recorded to the bit");
}

Bytes encode_shape(const Shape& shape) {
    const Round* const round = shape.round();
    if (round == nullptr) return encode_mesh(remade_mesh(shape));
    Bytes to;
    put(to, round->radius);
    put(to, round->to.z);
    return to;
}

std::shared_ptr<const Shape> decode_shape(std::span<const unsigned char> bytes) {
    if (bytes.size() != measures_size) return Shape::make(decode_mesh(bytes));
    ByteSource from(bytes);
    const double radius = from.get_double(), half_length = from.get_double();
    try {
        return half_length == 0 ? make_ball(radius) : make_capsule(radius, half_length);
    } catch (const InputError& error) {
        throw Damage(error.what());
    }
}

Bytes encode_mesh(const PreparedMesh& mesh) {
    Bytes to;
    put(to, std::string_view(mesh.name));
    put(to, mesh.report);
    put(to, static_cast<std::uint32_t>(mesh.vertices.size()));
    for (const Vec3& v : mesh.vertices) put(to, v);
    for (const std::uint32_t index : mesh.vertex_index) put(to, index);
    put(to, static_cast<std::uint32_t>(mesh.triangles.size()));
    for (const auto& triangle : mesh.triangles)
        for (const std::uint32_t corner : triangle) put(to, corner);
    for (const std::uint32_t index : mesh.triangle_index) put(to, index);
    return to;
}

PreparedMesh decode_mesh(std::span<const unsigned char> bytes) {
    ByteSource from(bytes);
    PreparedMesh mesh;
    mesh.name = from.get_text();
    mesh.report = get_report(from);
    mesh.vertices.resize(from.get_count(28));
    mesh.vertex_index.resize(mesh.vertices.size());
    for (Vec3& v : mesh.vertices) v = get_vector(from);
    for (std::uint32_t& index : mesh.vertex_index) index = from.get<std::uint32_t>();
    mesh.triangles.resize(from.get_count(16));
    mesh.triangle_index.resize(mesh.triangles.size());
    for (auto& triangle : mesh.triangles) {
        for (std::uint32_t& corner : triangle) {
            corner = from.get<std::uint32_t>();
            if (corner >= mesh.vertices.size()) throw Damage("has a triangle with a vertex that does not exist");
        }
    }
    for (std::uint32_t& index : mesh.triangle_index) index = from.get<std::uint32_t>();
    if (from.left() != 0) throw Damage("holds more than a mesh");
    check_claims(mesh);
    return mesh;
}

} // namespace raycontact::recording
