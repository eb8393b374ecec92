// SPDX-License-Identifier: Apache-2.0
#include <query.h>

#include <pair.h>
#include <raycontact/error.h>

#include <LinearMath/btAabbUtil2.h>

#include <array>
#include <optional>
#include <utility>

namespace raycontact::bullet {

namespace {

/// A body in the scene for as long as this lives.
struct Guest {
    Guest(Scene& s, const std::shared_ptr<const Shape>& shape, const btTransform& pose)
        : scene(s), body(s.add(shape, to_pose(pose))) {}
    ~Guest() { scene.remove(body); }
    Guest(const Guest&) = delete;
    Guest& operator=(const Guest&) = delete;
    Scene& scene;
    BodyId body;
};

/// Of points that were there before; beside the flags of patches.cpp.
constexpr int flag_stale = 1 << 17;

/// What Bullet's algorithm has put into a manifold of its own; nothing where a callback has taken it.
void copy_points(const btPersistentManifold& from, btPersistentManifold& to) {
    const bool turned = from.getBody0() != to.getBody0();
    for (int i = 0; i < from.getNumContacts(); ++i) {
        btManifoldPoint p = from.getContactPoint(i);
        if (turned) {
            std::swap(p.m_localPointA, p.m_localPointB);
            std::swap(p.m_positionWorldOnA, p.m_positionWorldOnB);
            std::swap(p.m_partId0, p.m_partId1);
            std::swap(p.m_index0, p.m_index1);
            p.m_normalWorldOnB = -p.m_normalWorldOnB;
        }
        to.addManifoldPoint(p);
    }
}

} // namespace

// One old point stays until the new ones are there: a manifold that runs empty in between would be told as one that
// ended.
void QueryAlgorithm::processCollision(const btCollisionObjectWrapper* a, const btCollisionObjectWrapper* b,
                                      const btDispatcherInfo& info, btManifoldResult* result) {
    const btCollisionObject &one = *a->getCollisionObject(), &two = *b->getCollisionObject();
    if (!manifold_)
        manifold_ = std::make_unique<btPersistentManifold>(
            &one, &two, 0,
            btMin(one.getCollisionShape()->getContactBreakingThreshold(gContactBreakingThreshold),
                  two.getCollisionShape()->getContactBreakingThreshold(gContactBreakingThreshold)),
            btMin(one.getContactProcessingThreshold(), two.getContactProcessingThreshold()));
    btPersistentManifold& m = *manifold_;
    while (m.getNumContacts() > 1) m.removeContactPoint(m.getNumContacts() - 1);
    if (m.getNumContacts() > 0) m.getContactPoint(0).m_contactPointFlags |= flag_stale;
    result->setPersistentManifold(&m);
    try {
        queries_.run(*a, *b, info, *result);
    } catch (...) { // Bullet's queries then forget the algorithm: its destructor is not called
        result->setPersistentManifold(nullptr);
        manifold_.reset();
        throw;
    }
    for (int i = m.getNumContacts() - 1; i >= 0; --i)
        if (m.getContactPoint(i).m_contactPointFlags & flag_stale) m.removeContactPoint(i);
}

std::vector<Queries::Placed> Queries::leaves_of(const btCollisionObjectWrapper& wrap) {
    std::vector<Placed> leaves;
    each_leaf(*wrap.getCollisionShape(), wrap.getWorldTransform(),
              [&](const btCollisionShape& shape, const btTransform& pose) {
                  Placed placed{{}, pose, static_cast<int>(leaves.size())};
                  placed.leaf.shape = &shape;
                  placed.leaf.kind = kind_of(shape, convex_);
                  placed.leaf.is_fixed = wrap.getCollisionObject()->isStaticOrKinematicObject();
                  try {
                      if (placed.leaf.kind == Kind::round || placed.leaf.kind == Kind::plane) check_numbers(shape);
                      const Placement placement =
                          place(pose, objects_.kept_stretch_of(*wrap.getCollisionObject(), leaves.size(), shape));
                      placed.leaf.pose = placement.pose;
                      placed.leaf.stretch = stretch_of(placed.leaf.kind, placement);
                  } catch (const InputError& error) {
                      placed.leaf.fault = error.what();
                      objects_.faults().add(fault_of(*wrap.getCollisionObject(), placed.index, placed.leaf.fault));
                  }
                  leaves.push_back(placed);
              });
    return leaves;
}

void Queries::run(const btCollisionObjectWrapper& a, const btCollisionObjectWrapper& b, const btDispatcherInfo& info,
                  btManifoldResult& result) {
    std::vector<Placed> leaves_a = leaves_of(a), leaves_b = leaves_of(b);
    btPersistentManifold* const manifold = result.getPersistentManifold();
    const btScalar apart = result.m_closestPointDistanceThreshold;
    for (Placed& one : leaves_a) {
        btVector3 low, high;
        one.leaf.shape->getAabb(one.pose, low, high);
        const btVector3 around(apart, apart, apart);
        for (Placed& two : leaves_b) {
            if (one.leaf.left_out() || two.leaf.left_out()) continue;
            btVector3 low_b, high_b;
            two.leaf.shape->getAabb(two.pose, low_b, high_b);
            if (!TestAabbAgainstAabb2(low - around, high + around, low_b, high_b)) continue;
            run_pair(one, two, a, b, info, result);
            result.setPersistentManifold(manifold); // Bullet's algorithms put in theirs, which is gone
        }
    }
    objects_.faults().tell();
}

void Queries::convert(Placed& placed, const btCollisionObjectWrapper& whole) {
    Leaf& leaf = placed.leaf;
    if (!in_scene(leaf.kind) || leaf.converted.shape || leaf.left_out()) return;
    try {
        leaf.converted = objects_.shapes().get_again(*leaf.shape);
        if (leaf.converted.shape) leaf.converted = objects_.shapes().stretched(leaf.converted, leaf.stretch);
    } catch (const InputError& error) {
        leaf.fault = error.what();
        objects_.faults().add(fault_of(*whole.getCollisionObject(), placed.index, leaf.fault));
    }
}

void Queries::run_pair(Placed& a, Placed& b, const btCollisionObjectWrapper& whole_a,
                       const btCollisionObjectWrapper& whole_b, const btDispatcherInfo& info,
                       btManifoldResult& result) {
    if (a.leaf.kind == Kind::mesh || b.leaf.kind == Kind::mesh) {
        convert(a, whole_a);
        convert(b, whole_b);
    }
    if (a.leaf.left_out() || b.leaf.left_out()) return;
    const LeafPair pair{a.leaf, b.leaf, a.index, b.index, convex_};
    const btScalar near_by = result.m_closestPointDistanceThreshold;
    std::vector<Candidate> found;
    switch (pair.work()) {
    case Work::plane:
        pair.add_plane(pair.plane(), std::nullopt, 0, found);
        break;
    case Work::round:
        add_rounds(std::array{RoundPair{pair, pair.margin(scene_.settings()), &found}}, near_by, false);
        break;
    case Work::batch:
        if (near_by > 0 && (a.leaf.kind == Kind::convex || b.leaf.kind == Kind::convex))
            return run_bullet(a, b, whole_a, whole_b, info, result);
        run_batch(a, b, found);
        break;
    case Work::two_sided:
    case Work::bullet:
        return run_bullet(a, b, whole_a, whole_b, info, result);
    case Work::nothing:
        break;
    }
    // A callback may ask for other contacts, or throw: nothing of this pair is in the scene when it is called.
    for (Candidate& c : found) {
        name_places(c, a.leaf, b.leaf);
        result.setShapeIdentifiersA(c.name0.part, c.name0.index);
        result.setShapeIdentifiersB(c.name1.part, c.name1.index);
        result.addContactPoint(c.normal, c.on1, c.distance);
    }
}

void Queries::run_batch(const Placed& a, const Placed& b, std::vector<Candidate>& found) {
    const Guest guest_a(scene_, a.leaf.converted.shape, a.leaf.pose),
        guest_b(scene_, b.leaf.converted.shape, b.leaf.pose);
    const std::array pairs{Pair{guest_a.body, guest_b.body}};
    for (const Contact& c : scene_.find_contacts(pairs)) found.push_back(candidate_of(c, a.index, b.index, false));
}

void Queries::run_bullet(const Placed& a, const Placed& b, const btCollisionObjectWrapper& whole_a,
                         const btCollisionObjectWrapper& whole_b, const btDispatcherInfo& info,
                         btManifoldResult& result) {
    const btCollisionObjectWrapper wrap_a(&whole_a, a.leaf.shape, whole_a.getCollisionObject(), a.pose, -1, a.index);
    const btCollisionObjectWrapper wrap_b(&whole_b, b.leaf.shape, whole_b.getCollisionObject(), b.pose, -1, b.index);
    const PooledAlgorithm algorithm = bullets_algorithm(dispatcher_, wrap_a, wrap_b, BT_CLOSEST_POINT_ALGORITHMS);
    struct Wraps { // as they were, also if the user's callback throws
        explicit Wraps(btManifoldResult& r) : result(r), a(r.getBody0Wrap()), b(r.getBody1Wrap()) {}
        ~Wraps() {
            result.setBody0Wrap(a);
            result.setBody1Wrap(b);
        }
        btManifoldResult& result;
        const btCollisionObjectWrapper *const a, *const b;
    } const as_they_were(result);
    result.setBody0Wrap(&wrap_a);
    result.setBody1Wrap(&wrap_b);
    result.setShapeIdentifiersA(-1, a.index);
    result.setShapeIdentifiersB(-1, b.index);
    btPersistentManifold* const own = result.getPersistentManifold();
    algorithm->processCollision(&wrap_a, &wrap_b, info, &result);
    btManifoldArray found;
    algorithm->getAllContactManifolds(found);
    for (int i = 0; i < found.size(); ++i) copy_points(*found[i], *own);
}

} // namespace raycontact::bullet
