// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/pose.h>
#include <raycontact/settings.h>

#include <array>
#include <cstdint>
#include <span>
#include <string>

namespace raycontact {

/// The body of the pair that the vertex belongs to: the source of the ray.
enum class VertexBody : std::uint8_t { a = 0, b = 1 };

/// What is in contact.
enum class Feature : std::uint8_t {
    vertex = 0, ///< a vertex inside the other mesh: its ray met the closest face from inside (Hermann et al. 2008)
    edges = 1,  ///< an edge of either body: they pass each other where the surfaces cross (docs/edges.md)
    inside = 2, ///< the whole body lies inside the other mesh; its deepest vertex stands for it
};

/// A vertex inside the other mesh (Hermann et al. 2008; Lehericey et al. 2013, sections 2.1 and 3.2), or two edges; or
/// what is about to touch.
struct Contact {
    std::uint32_t body_a = 0; ///< its slot, slot_of(id); body_a < body_b
    std::uint32_t body_b = 0;
    VertexBody vertex_body = VertexBody::a; ///< whose vertex it is; of edges a
    Feature feature = Feature::vertex;
    /// The last step had no contact with this key in this pair; or none that touched, and this one does.
    bool is_new = true;
    std::uint32_t vertex = 0; ///< of the source, index of its file; of edges: edge_a()
    std::uint32_t triangle =
        0;      ///< of the other body, that was hit (`refined`: the nearest); index of its file; of edges: edge_b()
    Vec3 point; ///< the source vertex, or a point of a's edge; world frame, metres
    std::array<float, 3> normal{}; ///< unit, world frame, from A to B
    /// Metres along the normal (section 3.2: r . n). <= 0: a speculative contact, minus the gap (docs/speculative.md).
    float depth = 0;
    float ray_length = 0; ///< |r|, metres from the point to the hit; of a speculative contact as long as the gap
    /// Direction `weighted`: the share of the source's surface, m^2 (Shape::vertex_areas; of edges, a sixth of the mean
    /// area of their triangles, of two at each edge). Other directions: 1.
    float weight = 1;

    /// Of Feature::edges: the edge of either body, 3 x its lowest triangle in the file + its first corner there.
    std::uint32_t edge_a() const { return vertex; }
    std::uint32_t edge_b() const { return triangle; }
    /// LostContact::other
    std::uint32_t other() const { return feature == Feature::edges ? triangle : 0; }
};

/// Whether nothing touches there yet (Settings::speculative).
inline bool is_speculative(const Contact& contact) {
    return !(contact.depth > 0);
}

/// The witness points, world frame, metres: the source's own point, and the point on the other body that lies `depth`
/// along the normal from it (with direction `reprojected` in the plane of the face that was hit). point_on_a -
/// point_on_b = depth x normal: A reaches that much too far.
Vec3 point_on_a(const Contact& contact);
Vec3 point_on_b(const Contact& contact);

/// A contact that touched in the last step and does not in this one. Read it before the next add(), which may give the
/// slot of a removed body to another body.
struct LostContact {
    std::uint32_t body_a = 0; ///< its slot; body_a < body_b
    std::uint32_t body_b = 0;
    VertexBody vertex_body = VertexBody::a;
    Feature feature = Feature::vertex;
    std::uint32_t vertex = 0; ///< as Contact::vertex
    std::uint32_t other = 0;  ///< of edges that of b, as Contact::triangle; of other features 0
};

/// Names the same physical contact from step to step, unique within its pair: source body ('a' or 'b'), feature type
/// (0 vertex, 1 edges, 2 inside), the vertex or the edge of a (8 hex digits) and, of edges, that of b (8 hex digits).
std::string contact_key(const Contact& contact);
std::string contact_key(const LostContact& contact);

/// XXH64 over every contact that touches, of every step in order; the same for every device, caster and thread count.
/// Layout per contact: step, body_a, body_b, vertex_body + 2 x feature, vertex, triangle as little-endian uint32;
/// normal, depth, ray_length and, with direction `weighted` alone, weight as float32 bits; point as float64 bits.
class ContactHash {
public:
    /// direction: of the contacts that will be added.
    /// speculative: speculative contacts count, too. Without them the hash does not depend on Settings::speculative.
    explicit ContactHash(Direction direction = Direction::reprojected, bool speculative = false);
    ~ContactHash();
    ContactHash(const ContactHash&) = delete;
    ContactHash& operator=(const ContactHash&) = delete;
    void add(std::uint32_t step, std::span<const Contact> contacts);
    std::string hex() const; ///< 16 hex digits of all that was added so far

private:
    void* state_;
    bool weighted_, speculative_;
};

} // namespace raycontact
