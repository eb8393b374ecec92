// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <candidate.h>
#include <objects.h>
#include <plane.h>

#include <optional>
#include <span>
#include <vector>

namespace raycontact::bullet {

/// What handles a pair of leaves; this does not depend on their positions.
enum class Work { batch, two_sided, plane, round, bullet, nothing };

/// Bullet has only its empty algorithm for two concave shapes.
bool unsupported(const btCollisionShape& a, const btCollisionShape& b);

/// Its longest way through; a plane has no end.
btScalar diagonal(const Leaf& leaf);

struct RoundPair;

/// Two leaves, and what of their contacts needs no batch, as candidates.
struct LeafPair {
    const Leaf &leaf0, &leaf1;
    int child0, child1; ///< their indices
    ConvexShapes convex;

    Work work() const;
    btScalar smaller_diagonal() const { return btMin(diagonal(leaf0), diagonal(leaf1)); }
    /// Metres: of their speculative contacts.
    btScalar margin(const Settings& settings) const;
    /// Of a mesh and something else, or of a height field and a ball or capsule.
    bool mesh_is_0() const {
        return leaf0.kind == Kind::mesh || (leaf0.kind == Kind::field && leaf1.kind != Kind::mesh);
    }
    const Leaf& mesh() const { return mesh_is_0() ? leaf0 : leaf1; }
    const Leaf& other() const { return mesh_is_0() ? leaf1 : leaf0; }
    /// Bullet's rule for convex shapes holds: each face of an open level stops them on both sides. What moves and is
    /// open lies on its vertices, whatever it is wound like.
    bool is_two_sided() const;

    /// Of a mesh and a plane.
    HalfSpace plane() const;
    /// Vertices of the mesh in a half space. near_by: also those nearer than this, and those that will be in it at the
    /// next dispatch, which are speculative. reach: of each candidate.
    void add_plane(const HalfSpace& space, std::optional<btScalar> near_by, btScalar reach,
                   std::vector<Candidate>& out) const;
    /// Of a mesh and a convex shape, in the mesh's frame.
    struct Passed {
        btVector3 low, high; ///< the box of the convex shape now and at the next dispatch, and `margin`
        std::vector<std::uint32_t> triangles; ///< of the mesh, in that box
    };
    Passed passed(btScalar margin) const;
    /// Where the surface ends inside the convex shape, or within `margin` of it, or will at the next dispatch: no ray
    /// tells the way out, since the surface has no direction there. reach: of each candidate.
    void add_borders(const Passed& passed, btScalar margin, btScalar reach, std::vector<Candidate>& out) const;

private:
    friend void add_rounds(std::span<const RoundPair> pairs, btScalar near_by, bool ahead);
    /// normal: unit, from the other leaf to the mesh. feature_of_mesh: the key names a feature of the mesh.
    Candidate candidate(bool feature_of_mesh, int feature, const btVector3& on_mesh, const btVector3& on_other,
                        const btVector3& normal, btScalar distance) const;
};

/// A ball or capsule with a mesh or height field; where its candidates go.
struct RoundPair {
    LeafPair pair;
    btScalar margin; ///< a step lower than this is no wall
    std::vector<Candidate>* out;
};
/// Of one ball or capsule with all that it may meet, since what ends where another goes on is no edge: where it is
/// nearer than near_by. ahead: also what it will touch, without what it will only pass.
void add_rounds(std::span<const RoundPair> pairs, btScalar near_by, bool ahead);

/// A contact of two meshes. swapped: its first body is the manifold's body 1.
Candidate candidate_of(const Contact& contact, int child0, int child1, bool swapped);

/// Gives a candidate what Bullet calls its places: of a mesh, sub-part and triangle, of a vertex or edge the lowest one
/// there; -1, -1 of other shapes.
void name_places(Candidate& candidate, const Leaf& leaf0, const Leaf& leaf1);

} // namespace raycontact::bullet
