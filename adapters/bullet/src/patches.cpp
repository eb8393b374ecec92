// SPDX-License-Identifier: Apache-2.0
#include <patches.h>
#include <told.h>
#include <vectors.h>

#include <raycontact/manifold.h>

#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>
#include <BulletCollision/CollisionDispatch/btManifoldResult.h>

#include <algorithm>

namespace raycontact::bullet {

namespace {

// Bullet uses the low byte of m_contactPointFlags; ours travel with the point wherever Bullet copies it.
constexpr int flag_ours = 1 << 30;
constexpr int flag_vertex_on_1 = 1 << 29;
constexpr int feature_shift = 8, feature_mask = 3 << feature_shift;
constexpr int absent_shift = 20;
constexpr int absent_mask = most_keep_steps << absent_shift;

int absent_steps(const btManifoldPoint& p) {
    return (p.m_contactPointFlags & absent_mask) >> absent_shift;
}

/// Cosine from which on two normals at one place count as one.
constexpr btScalar like_normals = btScalar(0.9);
constexpr double one_place = 0.04; // of the usual reach

/// A point of the step before, moved along with its bodies.
struct Old {
    btManifoldPoint point;
    std::size_t patch;
    PointKey key;
    btVector3 on0, on1;
    btScalar distance;
    bool matched = false; ///< its contact is there again
};

struct Patch {
    btPersistentManifold* manifold = nullptr;
    std::vector<std::size_t> held; ///< old points without a contact
};

btVector3 middle(const btVector3& a, const btVector3& b) {
    return (a + b) * btScalar(0.5);
}

btManifoldPoint to_point(const Candidate& c, const btTransform& pose0, const btTransform& pose1,
                         const btCollisionObject* a, const btCollisionObject* b) {
    btManifoldPoint p(pose0.invXform(c.on0), pose1.invXform(c.on1), c.normal, c.distance);
    p.m_positionWorldOnA = c.on0;
    p.m_positionWorldOnB = c.on1;
    p.m_partId0 = c.key.child0;
    p.m_partId1 = c.key.child1;
    p.m_index0 = c.key.vertex_body == 0 ? c.key.vertex : c.triangle;
    p.m_index1 = c.key.vertex_body == 0 ? c.triangle : c.key.vertex;
    p.m_contactPointFlags =
        flag_ours | (c.key.vertex_body == 0 ? 0 : flag_vertex_on_1) | static_cast<int>(c.key.feature) << feature_shift;
    combine_materials(p, a, b);
    btPlaneSpace1(p.m_normalWorldOnB, p.m_lateralFrictionDir1, p.m_lateralFrictionDir2);
    return p;
}

/// Copies the solver's state of a point to its successor.
void inherit(btManifoldPoint& p, const btManifoldPoint& old) {
    p.m_appliedImpulse = old.m_appliedImpulse;
    p.m_prevRHS = old.m_prevRHS;
    p.m_appliedImpulseLateral1 = old.m_appliedImpulseLateral1;
    p.m_appliedImpulseLateral2 = old.m_appliedImpulseLateral2;
    p.m_lifeTime = old.m_lifeTime + 1;
}

int index_of(const btPersistentManifold& manifold, const PointKey& key) {
    for (int i = 0; i < manifold.getNumContacts(); ++i) {
        if (CollisionDispatcher::is_ours(manifold.getContactPoint(i))
            && CollisionDispatcher::key(manifold.getContactPoint(i)) == key)
            return i;
    }
    return -1;
}

void call_added(btManifoldPoint& point, const Candidate& candidate, const btCollisionObject* a,
                const btCollisionObject* b) {
    const btCollisionObjectWrapper wrap0(nullptr, a->getCollisionShape(), a, a->getWorldTransform(), -1, -1);
    const btCollisionObjectWrapper wrap1(nullptr, b->getCollisionShape(), b, b->getWorldTransform(), -1, -1);
    (*gContactAddedCallback)(point, &wrap0, candidate.name0.part, candidate.name0.index, &wrap1, candidate.name1.part,
                             candidate.name1.index);
}

bool of_edge(const PointKey& key) {
    return key.feature == FeatureKind::edges;
}

/// A point that was there in the step before under another key: where faces lie on each other, now a vertex speaks for
/// a corner and now an edge that ends there. The nearest of those not found again; null where none is near.
Old* predecessor_of(std::vector<Old>& old, const Candidate& c, const std::vector<Patch>& patches) {
    Old* found = nullptr;
    btScalar least = BT_LARGE_FLOAT;
    for (Old& o : old) {
        if (o.matched || (!of_edge(o.key) && !of_edge(c.key))) continue;
        const btScalar limit = patches[o.patch].manifold->getContactBreakingThreshold();
        const btScalar away = (middle(o.on0, o.on1) - middle(c.on0, c.on1)).length2();
        if (away > limit * limit || away >= least || o.point.m_normalWorldOnB.dot(c.normal) < like_normals) continue;
        least = away;
        found = &o;
    }
    return found;
}

} // namespace

void Patches::clear() {
    for (btPersistentManifold* m : manifolds_) dispatcher_.releaseManifold(m);
    manifolds_.clear();
}

void Patches::update(const std::vector<Candidate>& candidates, const btTransform& pose0, const btTransform& pose1,
                     const ManifoldSettings& settings, DispatcherStats& stats) {
    stats.contacts += candidates.size();
    if (candidates.empty() && manifolds_.empty()) return;

    // The old points, where they are now.
    std::vector<Patch> patches;
    std::vector<ManifoldPatch> groups; // of the same patches, the contacts of this step
    std::vector<Old> old;
    for (btPersistentManifold* m : manifolds_) {
        btVector3 normal(0, 0, 0), centre(0, 0, 0);
        const int count = m->getNumContacts();
        for (int i = 0; i < count; ++i) {
            const btManifoldPoint& p = m->getContactPoint(i);
            Old o{p, patches.size(), CollisionDispatcher::key(p), pose0(p.m_localPointA), pose1(p.m_localPointB), 0};
            o.distance = (o.on0 - o.on1).dot(p.m_normalWorldOnB);
            normal += p.m_normalWorldOnB;
            centre += middle(o.on0, o.on1);
            old.push_back(o);
        }
        if (count > 0) {
            normal.safeNormalize();
            centre /= btScalar(count);
        }
        patches.push_back({m, {}});
        groups.push_back({to_vec(normal), to_vec(centre), {}});
    }

    // Each contact joins the patch that its key was in, else the most suitable one, else it begins a new patch.
    std::vector<const Old*> before(candidates.size(), nullptr);
    for (std::size_t c = 0; c < candidates.size(); ++c) {
        for (Old& o : old) {
            if (o.matched || !(o.key == candidates[c].key)) continue;
            o.matched = true;
            before[c] = &o;
            break;
        }
    }
    for (std::size_t c = 0; c < candidates.size(); ++c) {
        if (before[c]) continue;
        if (Old* o = predecessor_of(old, candidates[c], patches)) {
            o->matched = true;
            before[c] = o;
        }
    }
    // Who asks for wider patches, as for one of a whole body, does not ask for fewer points in them.
    const double place =
        one_place * std::min(1.0, double(ManifoldSettings{}.patch_reach) / double(settings.patch_reach));
    std::vector<ManifoldPoint> points;
    points.reserve(candidates.size());
    for (std::size_t c = 0; c < candidates.size(); ++c) {
        const Candidate& contact = candidates[c];
        ManifoldPoint& point = points.emplace_back();
        point.position = to_vec(middle(contact.on0, contact.on1));
        point.normal = to_vec(contact.normal);
        point.depth = double(-contact.distance);
        point.reach = double(contact.reach);
        point.place = place * double(contact.reach);
        point.present = before[c] != nullptr;
        // A little more tolerance than for a newcomer, or points at the limit would change patches every step.
        if (before[c]
            && to_bullet(groups[before[c]->patch].normal).dot(contact.normal) >= settings.patch_cosine * btScalar(0.9))
            point.patch = static_cast<std::uint32_t>(before[c]->patch);
    }
    join_patches(points, double(settings.patch_cosine), groups);
    patches.resize(groups.size());
    for (std::size_t i = 0; i < old.size(); ++i) {
        const Old& o = old[i];
        if (o.matched || absent_steps(o.point) >= settings.keep_steps) continue;
        const btScalar limit = patches[o.patch].manifold->getContactBreakingThreshold();
        const btVector3 drift = o.on0 - o.on1 - o.distance * o.point.m_normalWorldOnB;
        if (o.distance <= limit && drift.length2() <= limit * limit) patches[o.patch].held.push_back(i);
    }

    manifolds_.clear();
    for (std::size_t g = 0; g < groups.size(); ++g) {
        Patch& patch = patches[g];
        const std::vector<std::uint32_t>& members = groups[g].points;
        std::vector<std::uint32_t> chosen = choose_points(points, members);
        std::ranges::sort(chosen);
        stats.reduced_away += members.size() - chosen.size();
        const std::size_t room = 4 - chosen.size();
        if (patch.held.size() > room) {
            std::stable_sort(patch.held.begin(), patch.held.end(),
                             [&](std::size_t a, std::size_t b) { return old[a].distance < old[b].distance; });
            patch.held.resize(room);
        }
        if (chosen.empty() && patch.held.empty()) {
            if (patch.manifold) dispatcher_.releaseManifold(patch.manifold);
            continue;
        }
        if (!patch.manifold) patch.manifold = dispatcher_.getNewManifold(object0_, object1_);
        btPersistentManifold& m = *patch.manifold;
        const bool was_empty = m.getNumContacts() == 0;

        std::vector<PointKey> wanted;
        wanted.reserve(chosen.size() + patch.held.size());
        for (const std::uint32_t c : chosen) wanted.push_back(candidates[c].key);
        for (const std::size_t i : patch.held) wanted.push_back(old[i].key);
        // Survivors are written first so that the manifold never runs empty in between: that would be an "ended" event.
        for (const std::uint32_t c : chosen) {
            const int at = index_of(m, candidates[c].key);
            if (at < 0) continue;
            btManifoldPoint p = to_point(candidates[c], pose0, pose1, object0_, object1_);
            inherit(p, m.getContactPoint(at));
            p.m_userPersistentData = m.getContactPoint(at).m_userPersistentData;
            m.getContactPoint(at) = p;
            ++stats.points_matched;
        }
        for (const std::size_t i : patch.held) {
            btManifoldPoint& p = m.getContactPoint(index_of(m, old[i].key));
            take_back(p, object0_, object1_);
            p.m_positionWorldOnA = old[i].on0;
            p.m_positionWorldOnB = old[i].on1;
            p.m_distance1 = old[i].distance;
            ++p.m_lifeTime;
            p.m_contactPointFlags += 1 << absent_shift;
            ++stats.points_held;
        }
        std::vector<std::size_t> arriving;
        for (const std::uint32_t c : chosen)
            if (index_of(m, candidates[c].key) < 0) arriving.push_back(c);
        const auto leave = [&](bool down_to_one) {
            for (int i = m.getNumContacts() - 1; i >= 0; --i) {
                if (down_to_one && m.getNumContacts() == 1) return;
                const PointKey k = CollisionDispatcher::key(m.getContactPoint(i));
                if (std::find(wanted.begin(), wanted.end(), k) == wanted.end()) m.removeContactPoint(i);
            }
        };
        leave(!arriving.empty());
        for (const std::size_t c : arriving) {
            btManifoldPoint p = to_point(candidates[c], pose0, pose1, object0_, object1_);
            if (before[c]) {
                inherit(p, before[c]->point);
                ++stats.points_matched;
            }
            if (m.getNumContacts() == 4) leave(false);
            m.addManifoldPoint(p, true);
        }
        leave(false);
        for (int i = 0; i < m.getNumContacts() && adds_are_told(*object0_, *object1_); ++i) {
            btManifoldPoint& point = m.getContactPoint(i);
            if (absent_steps(point) != 0) continue;
            const auto c = std::ranges::find(members, CollisionDispatcher::key(point),
                                             [&](std::uint32_t member) { return candidates[member].key; });
            if (c != members.end()) call_added(point, candidates[*c], object0_, object1_);
        }
        if (was_empty && gContactStartedCallback) gContactStartedCallback(patch.manifold);
        // Bullet calls it when it refreshes a manifold, in every step for every point, the last one first.
        for (int i = m.getNumContacts() - 1; gContactProcessedCallback && i >= 0; --i)
            gContactProcessedCallback(m.getContactPoint(i), const_cast<btCollisionObject*>(m.getBody0()),
                                      const_cast<btCollisionObject*>(m.getBody1()));
        stats.points += static_cast<std::uint64_t>(m.getNumContacts());
        ++stats.manifolds;
        manifolds_.push_back(patch.manifold);
    }
}

bool adds_are_told(const btCollisionObject& a, const btCollisionObject& b) {
    return gContactAddedCallback
           && ((a.getCollisionFlags() | b.getCollisionFlags()) & btCollisionObject::CF_CUSTOM_MATERIAL_CALLBACK) != 0;
}

PointKey CollisionDispatcher::key(const btManifoldPoint& p) {
    const bool on1 = (p.m_contactPointFlags & flag_vertex_on_1) != 0;
    const auto feature = static_cast<FeatureKind>((p.m_contactPointFlags & feature_mask) >> feature_shift);
    const int own = on1 ? p.m_index1 : p.m_index0, other = on1 ? p.m_index0 : p.m_index1;
    return {p.m_partId0, p.m_partId1, on1 ? 1 : 0, own, feature, names_both(feature) ? other : 0};
}

bool CollisionDispatcher::is_ours(const btManifoldPoint& p) {
    return (p.m_contactPointFlags & flag_ours) != 0;
}

} // namespace raycontact::bullet
