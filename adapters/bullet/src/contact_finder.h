// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <leaf_pair.h>
#include <pair.h>

#include <cstdint>
#include <optional>
#include <unordered_map>
#include <utility>
#include <vector>

namespace raycontact::bullet {

/// Gives the pairs of a dispatch their candidates: those of meshes from one batch, the others at once.
class ContactFinder {
public:
    ContactFinder(Scene& scene, const ManifoldSettings& manifolds, ConvexShapes convex, Objects& objects,
                  DispatcherStats& stats)
        : scene_(scene), manifolds_(manifolds), convex_(convex), objects_(objects), stats_(stats) {}

    /// First in a dispatch.
    void begin() {
        batch_.clear();
        between_.clear();
        rounds_.clear();
        round_of_.clear();
    }
    /// What needs no other pair. The rest waits.
    void take(PairState& pair, const btDispatcherInfo& info);
    /// Balls and capsules, each with all that it may meet.
    void run_rounds();
    void run_batch();

private:
    enum class Sides { one, front, back }; ///< of an open mesh that stops a convex shape on both
    /// A pair as contacts name it.
    using Slots = std::pair<std::uint32_t, std::uint32_t>;
    /// Where the contacts of one pair in the batch belong.
    struct Entry {
        Pair pair;
        PairState* state;
        int child0, child1;
        bool swapped; ///< the scene's first body is the manifold's body 1
        btScalar reach;
        btScalar margin; ///< metres, of speculative contacts; without them larger than any way
        Sides sides;

        const Leaf& leaf0() const { return state->record0->leaves[static_cast<std::size_t>(child0)]; }
        const Leaf& leaf1() const { return state->record1->leaves[static_cast<std::size_t>(child1)]; }
    };
    /// What sinks by the slop and slides over a seam is not stopped by it.
    Contact with_least_change(const Contact& contact, const Entry& entry) const;
    /// Whether it belongs to the side where the convex shape is, and not to where the surface ends. Its key becomes
    /// that of the mesh's front.
    bool is_on_side(Candidate& candidate, const Entry& entry) const;
    static void join_sides(PairState& state);
    void add_to_batch(PairState& state, const LeafPair& pair, Sides sides);
    void add_two_sided(PairState& state, const LeafPair& pair);
    bool apart(const LeafPair& pair) const;
    std::optional<HalfSpace> face_between(const LeafPair& pair) const;
    void add_plane(PairState& state, const LeafPair& pair, const HalfSpace& space);
    void note_open(const PairState& state, const LeafPair& pair);
    void tell_one_sided(const btCollisionObject& object, int child, const Leaf& mesh);

    Scene& scene_;
    const ManifoldSettings& manifolds_;
    ConvexShapes convex_;
    Objects& objects_;
    DispatcherStats& stats_;
    std::vector<Entry> batch_;
    std::vector<PairState*> between_; ///< with a convex shape near fronts and backs of an open mesh; may be there twice
    std::vector<std::vector<RoundPair>> rounds_;            ///< of one ball or capsule each
    std::unordered_map<const Leaf*, std::size_t> round_of_; ///< no order of it shows
    std::vector<std::pair<Slots, std::uint32_t>> order_;    ///< of the batch: pairs ascending, with their places in it
    std::vector<Pair> pairs_;
    std::unordered_map<const Shape*, std::weak_ptr<const Shape>> told_one_sided_;
};

} // namespace raycontact::bullet
