// SPDX-License-Identifier: Apache-2.0
#include <recording/shape_codec.h>

#include "mesh/check.h"

#include <raycontact/error.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <stdexcept>

namespace raycontact::recording {

namespace {

double ulps_from(double x, int count) {
    for (; count > 0; --count) x = std::nextafter(x, INFINITY);
    for (; count < 0; ++count) x = std::nextafter(x, -INFINITY);
    return x;
}

/// Moves the outermost vertices on one axis by a few units in the last place, so that the middle of the box is `middle`
/// to the bit and every offset from it still rounds to the same float32.
void restore_middle(PreparedMesh& mesh, double Vec3::*axis, double middle) {
    const auto below = [&](const Vec3& p, const Vec3& q) { return p.*axis < q.*axis; };
    const auto [lowest, highest] = std::minmax_element(mesh.vertices.begin(), mesh.vertices.end(), below);
    const double low = (*lowest).*axis, high = (*highest).*axis;
    if (0.5 * (low + high) == middle) return;
    const auto same_offset = [&](double p, double q) {
        return static_cast<float>(p - middle) == static_cast<float>(q - middle);
    };
    // Both ends may have been halfway between two floats and gone different ways: then the true half width lies
    // between.
    const double halves[] = {high - middle, middle - low, 0.5 * ((high - middle) + (middle - low))};
    for (const double half : halves) {
        for (int i = -4; i <= 4; ++i) {
            for (int j = -4; j <= 4; ++j) {
                const double new_low = ulps_from(middle - half, i), new_high = ulps_from(middle + half, j);
                if (0.5 * (new_low + new_high) != middle || !same_offset(new_low, low) || !same_offset(new_high, high))
                    continue;
                for (Vec3& v : mesh.vertices) {
                    if (v.*axis == low)
                        v.*axis = new_low;
                    else if (v.*axis == high)
                        v.*axis = new_high;
                }
                return;
            }
        }
    }
}

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

enum Flag : std::uint32_t {
    closed = 1,
    manifold = 2,
    oriented = 4,
    self_intersecting = 8,
    outward = 16,
    unchecked = 32
};

void put(Bytes& to, const MeshReport& r) {
    for (const std::uint64_t n : {r.vertices, r.triangles, r.file_vertices, r.file_triangles, r.components})
        recording::put(to, n);
    recording::put(to, (r.closed ? closed : 0u) | (r.manifold ? manifold : 0u) | (r.oriented ? oriented : 0u)
                           | (r.self_intersecting ? self_intersecting : 0u) | (r.outward ? outward : 0u)
                           | (r.checked ? 0u : unchecked));
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
    const auto flags = from.get<std::uint32_t>();
    r.closed = flags & closed;
    r.manifold = flags & manifold;
    r.oriented = flags & oriented;
    r.self_intersecting = flags & self_intersecting;
    r.outward = flags & outward;
    r.checked = !(flags & unchecked);
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
    said.border_edges = found.border_edges; // not recorded
}

} // namespace

PreparedMesh remade_mesh(const Shape& shape) {
    PreparedMesh mesh;
    mesh.name = shape.name();
    mesh.vertices.assign(shape.vertices().begin(), shape.vertices().end());
    mesh.triangles.assign(shape.triangles().begin(), shape.triangles().end());
    mesh.vertex_index.assign(shape.vertex_index().begin(), shape.vertex_index().end());
    mesh.triangle_index.assign(shape.triangle_index().begin(), shape.triangle_index().end());
    mesh.report = shape.report();
    restore_middle(mesh, &Vec3::x, shape.centre().x);
    restore_middle(mesh, &Vec3::y, shape.centre().y);
    restore_middle(mesh, &Vec3::z, shape.centre().z);
    if (!same_bits(shape, *Shape::make(mesh)))
        throw std::runtime_error("recording: the mesh '" + shape.name() + "' cannot be recorded to the bit");
    return mesh;
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
