// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <candidate.h>
#include <prefetch.h>

#include <vector>

namespace raycontact::bullet {

/// A point counts the steps since its contact was last there in eight bits: the most of ManifoldSettings::keep_steps.
constexpr int most_keep_steps = 255;

/// Whether gContactAddedCallback is called for points of these two.
bool adds_are_told(const btCollisionObject& a, const btCollisionObject& b);

/// The manifolds of one pair: one for each patch of contacts with like normals, so that a pair that touches in several
/// places is supported in all of them.
class Patches {
public:
    Patches(btCollisionDispatcher& dispatcher, const btCollisionObject* object0, const btCollisionObject* object1)
        : dispatcher_(dispatcher), object0_(object0), object1_(object1) {}
    ~Patches() { clear(); }
    Patches(const Patches&) = delete;
    Patches& operator=(const Patches&) = delete;

    /// This step's contacts, in the order of their keys. Points whose key is there again keep their impulses. The
    /// poses: of the two objects, rigid.
    void update(const std::vector<Candidate>& candidates, const btTransform& pose0, const btTransform& pose1,
                const ManifoldSettings& settings, DispatcherStats& stats);
    /// Prefetches what update() will read: the list of manifolds, then the manifolds.
    void fetch_list() const { prefetch(manifolds_.data()); }
    void fetch() const {
        for (const btPersistentManifold* m : manifolds_)
            for (std::size_t at = 0; at < sizeof(*m); at += 64) prefetch(reinterpret_cast<const char*>(m) + at);
    }
    void clear();
    const std::vector<btPersistentManifold*>& manifolds() const { return manifolds_; }

private:
    btCollisionDispatcher& dispatcher_;
    const btCollisionObject* object0_;
    const btCollisionObject* object1_;
    std::vector<btPersistentManifold*> manifolds_;
};

} // namespace raycontact::bullet
