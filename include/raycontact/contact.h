// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/pose.h>
#include <raycontact/settings.h>

#include <array>
#include <cstdint>
#include <span>
#include <string>

namespace raycontact {

/// The body of the pair that the feature (here always a vertex) belongs to: the source of the ray.
enum class VertexBody : std::uint32_t { a = 0, b = 1 };

/// A vertex inside the other mesh: its ray met the closest face from inside (Hermann et al. 2008; Lehericey et al.
/// 2013, sections 2.1 and 3.2).
struct Contact {
    std::uint32_t body_a = 0; ///< its slot, slot_of(id); body_a < body_b
    std::uint32_t body_b = 0;
    VertexBody vertex_body = VertexBody::a;
    bool is_new = true;            ///< the last step had no contact with this key in this pair
    std::uint32_t vertex = 0;      ///< source vertex, index of its file
    std::uint32_t triangle = 0;    ///< triangle of the other body that was hit, index of its file
    Vec3 point;                    ///< the source vertex, world frame, metres
    std::array<float, 3> normal{}; ///< unit, world frame, from A to B
    float depth = 0;               ///< > 0, metres along the normal (section 3.2: r . n)
    float ray_length = 0;          ///< |r|, metres from the vertex to the hit
    /// Direction `weighted`: the vertex's share of its surface, m^2 (Shape::vertex_areas). Other directions: 1.
    float weight = 1;
};

/// A contact that the last step had and this step does not have. Read it before the next add(), which may give the slot
/// of a removed body to another body.
struct LostContact {
    std::uint32_t body_a = 0; ///< its slot; body_a < body_b
    std::uint32_t body_b = 0;
    VertexBody vertex_body = VertexBody::a;
    std::uint32_t vertex = 0; ///< source vertex, index of its file
};

/// Names the same physical contact from step to step, unique within its pair: source body ('a' or 'b'), feature type
/// (0 vertex), feature index, as 2 + 8 hex digits.
std::string contact_key(const Contact& contact);
std::string contact_key(const LostContact& contact);

/// XXH64 over every contact of every step in order; the same for every device, caster and thread count.
/// Layout per contact: step, body_a, body_b, vertex_body, vertex, triangle as little-endian uint32; normal, depth,
/// ray_length and, with direction `weighted` alone, weight as float32 bits; point as float64 bits.
class ContactHash {
public:
    /// direction: of the contacts that will be added.
    explicit ContactHash(Direction direction = Direction::reprojected);
    ~ContactHash();
    ContactHash(const ContactHash&) = delete;
    ContactHash& operator=(const ContactHash&) = delete;
    void add(std::uint32_t step, std::span<const Contact> contacts);
    std::string hex() const; ///< 16 hex digits of all that was added so far

private:
    void* state_;
    bool weighted_;
};

} // namespace raycontact
