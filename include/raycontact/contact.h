// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/body_id.h>
#include <raycontact/export.h>
#include <raycontact/settings.h>
#include <raycontact/vector.h>

#include <cstdint>
#include <limits>
#include <span>
#include <string>

namespace raycontact {

/// What is in contact.
enum class FeatureKind : std::uint8_t {
    vertex = 0, ///< a vertex inside the other mesh: its ray met the closest face from inside (Hermann et al. 2008)
    edges = 1,  ///< an edge of either body: they pass each other where the surfaces cross (docs/internals/edges.md)
    inside = 2, ///< the whole body lies inside the other mesh; its deepest vertex stands for it
    /// A vertex and a face that it is near or comes to, beside another contact of that vertex. Nothing touches there
    /// yet.
    vertex_face = 3,
    /// A face of either body, of direction `weighted`: what the bodies share between them (docs/internals/patches.md).
    faces = 4,
    /// A ball or capsule (primitives.h) and the other body, in closed form: where their distance is a local minimum.
    round = 5,
};

/// Whether a feature is named by what it is of either body, not of the source alone.
constexpr bool names_both(FeatureKind kind) noexcept {
    return kind == FeatureKind::edges || kind == FeatureKind::vertex_face || kind == FeatureKind::faces;
}

/// One body of a pair.
enum class Side : std::uint8_t { a = 0, b = 1 };

/// What touches: a feature of either body. Indices are those of the bodies' files.
struct ContactFeature {
    /// Of no feature, and of one that has no triangle.
    static constexpr std::uint32_t no_index = std::numeric_limits<std::uint32_t>::max();

    FeatureKind kind = FeatureKind::vertex; ///< what is in contact
    /// Whose vertex it is, where the ray begins; who is round; of edges, of faces and between round bodies a.
    Side source = Side::a;
    /// Of the source a vertex, of the other body the triangle that was hit (`refined`: the nearest); of edges an edge
    /// of either: 3 x its lowest triangle + its first corner there; of faces a triangle of either. Of a round source
    /// a number of the place on it that stays (docs/conventions.md, A contact); of the other body the triangle, or
    /// no_index if it is round, too.
    std::uint32_t index_a = 0;
    std::uint32_t index_b = 0; ///< likewise, of body b

    /// The index on the source.
    std::uint32_t source_index() const noexcept { return source == Side::a ? index_a : index_b; }
    /// The index on the other body.
    std::uint32_t other_index() const noexcept { return source == Side::a ? index_b : index_a; }
    /// Names the same physical contact from step to step, unique in its pair: it does not change when the ray meets
    /// another triangle. Contacts of a pair are sorted by it.
    std::uint64_t key() const noexcept {
        const std::uint64_t side = std::uint64_t(source), own = source_index();
        switch (kind) {
        case FeatureKind::vertex:
            return side << 62 | own;
        case FeatureKind::edges:
            return std::uint64_t{2} << 62 | std::uint64_t{index_a} << 31 | index_b;
        case FeatureKind::inside:
            return std::uint64_t{3} << 62 | side << 32 | own;
        case FeatureKind::faces: // a mesh has fewer than 2^30 of either
            return std::uint64_t{13} << 60 | std::uint64_t{index_a} << 30 | index_b;
        case FeatureKind::round:
            return std::uint64_t{25} << 59 | side << 58 | own;
        case FeatureKind::vertex_face:
            break;
        }
        return std::uint64_t{7} << 61 | side << 60 | own << 30 | other_index();
    }
    friend bool operator==(const ContactFeature&, const ContactFeature&) = default;
};

/// A vertex inside the other mesh (Hermann et al. 2008; Lehericey et al. 2013, sections 2.1 and 3.2), or two edges; or
/// what is about to touch.
struct Contact {
    BodyId body_a;          ///< has the lower slot
    BodyId body_b;          ///< has the higher slot
    ContactFeature feature; ///< what touches
    /// The last step had no contact with this key in this pair; or none that touched, and this one does.
    bool is_new = true;
    Vec3f normal; ///< unit, world frame, from a to b
    /// Metres along the normal (section 3.2: r . n). <= 0: a speculative contact, minus the gap
    /// (docs/internals/speculative.md).
    float depth = 0;
    float ray_length = 0; ///< |r|, metres from the point to the hit; of a speculative contact as long as the gap
    /// Direction `weighted`, m^2: of faces, the area across the normal that they share; of others, a share of the
    /// source's surface (Shape::vertex_areas; of edges, a sixth of the mean area of their triangles, of two at each
    /// edge); of a round body, the disc that the contact's plane cuts from it. Other directions: 1.
    float weight = 1;
    /// The witness points, world frame, metres: the source's vertex, a point of a's edge or of a round surface, or
    /// beside the middle of what faces share, and the other body's, which lies `depth` along the normal from it (with
    /// direction `reprojected` in the plane of the face that was hit). point_a - point_b = depth x normal: a reaches
    /// that much too far.
    Vec3 point_a;
    Vec3 point_b; ///< the witness point of body_b

    /// Names the same contact from step to step, unique in its pair.
    std::uint64_t key() const noexcept { return feature.key(); }
    /// The source's own point.
    const Vec3& point() const noexcept { return feature.source == Side::a ? point_a : point_b; }
    /// Nothing touches there yet (Settings::speculative).
    bool is_speculative() const noexcept { return !(depth > 0); }
};

/// A contact that touched in the last step and does not in this one. Its bodies may have been removed since.
struct LostContact {
    BodyId body_a;          ///< has the lower slot
    BodyId body_b;          ///< has the higher slot
    ContactFeature feature; ///< but for edges without the index on the other body: ContactFeature::no_index

    /// That of the contact that is gone.
    std::uint64_t key() const noexcept { return feature.key(); }
};

/// XXH64 over every contact that touches, of every step in order; the same for every device, caster and thread count.
/// Layout per contact: step, slots of a and b, source + 2 x kind, index on the source, index on the other body as
/// little-endian uint32; normal, depth, ray_length and, with direction `weighted` alone, weight as float32 bits; the
/// source's point as float64 bits.
class RAYCONTACT_API ContactHash {
public:
    /// direction: of the contacts that will be added.
    /// speculative: speculative contacts count, too. Without them the hash does not depend on Settings::speculative.
    explicit ContactHash(Direction direction = Direction::reprojected, bool speculative = false);
    ~ContactHash();
    ContactHash(const ContactHash&) = delete;
    ContactHash& operator=(const ContactHash&) = delete;
    /// The contacts of one step, in their order. Those that do not touch count only if `speculative` was given.
    void add(std::uint32_t step, std::span<const Contact> contacts);
    std::string hex() const; ///< 16 hex digits of all that was added so far

private:
    void* state_;
    bool weighted_, speculative_;
};

} // namespace raycontact
