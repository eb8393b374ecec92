// SPDX-License-Identifier: Apache-2.0
#include <query.h>

#include <place_name.h>
#include <plane.h>
#include <raycontact/error.h>
#include <round.h>
#include <vectors.h>
#include <work.h>

#include <LinearMath/btAabbUtil2.h>

#include <array>
#include <functional>
#include <span>

namespace raycontact::bullet {

namespace {

void identify(btManifoldResult& result, bool first_is_a, const PlaceName& first, const PlaceName& second) {
    const PlaceName &a = first_is_a ? first : second, &b = first_is_a ? second : first;
    result.setShapeIdentifiersA(a.part, a.index);
    result.setShapeIdentifiersB(b.part, b.index);
}

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

} // namespace

btVector3 normal_of(const Contact& c) {
    return btVector3(c.normal.x, c.normal.y, c.normal.z);
}

std::vector<Queries::Placed> Queries::leaves_of(const btCollisionObjectWrapper& wrap) {
    std::vector<Placed> leaves;
    each_leaf(*wrap.getCollisionShape(), wrap.getWorldTransform(),
              [&](const btCollisionShape& shape, const btTransform& pose) {
                  Placed placed{{}, pose, static_cast<int>(leaves.size())};
                  placed.leaf.shape = &shape;
                  placed.leaf.kind = kind_of(shape);
                  placed.leaf.is_fixed = wrap.getCollisionObject()->isStaticOrKinematicObject();
                  const bool convex = placed.leaf.kind == Kind::convex || placed.leaf.kind == Kind::round;
                  if (convex && convex_ == ConvexShapes::bullet) placed.leaf.kind = Kind::other;
                  try {
                      if (placed.leaf.kind == Kind::round || placed.leaf.kind == Kind::plane) check_numbers(shape);
                      const Placement placement =
                          place(pose, objects_.kept_stretch_of(*wrap.getCollisionObject(), leaves.size(), shape));
                      placed.leaf.pose = placement.pose;
                      placed.leaf.stretch = stretch_of(placed.leaf.kind, placement);
                  } catch (const InputError& error) {
                      placed.leaf.fault = error.what();
                      faults_.add(fault_of(*wrap.getCollisionObject(), placed.index, placed.leaf.fault));
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
        aabb_once(*one.leaf.shape, one.pose, low, high);
        const btVector3 around(apart, apart, apart);
        for (Placed& two : leaves_b) {
            if (one.leaf.left_out() || two.leaf.left_out()) continue;
            btVector3 low_b, high_b;
            aabb_once(*two.leaf.shape, two.pose, low_b, high_b);
            if (!TestAabbAgainstAabb2(low - around, high + around, low_b, high_b)) continue;
            run_pair(one, two, a, b, info, result);
            result.setPersistentManifold(manifold); // Bullet's algorithms put in theirs, which is gone
        }
    }
    faults_.tell();
}

void Queries::convert(Placed& placed, const btCollisionObjectWrapper& whole) {
    Leaf& leaf = placed.leaf;
    if (!in_scene(leaf.kind) || leaf.converted.shape || leaf.left_out()) return;
    try {
        leaf.converted = shapes_.get_again(*leaf.shape);
        if (leaf.converted.shape) leaf.converted = shapes_.stretched(leaf.converted, leaf.stretch);
    } catch (const InputError& error) {
        leaf.fault = error.what();
        faults_.add(fault_of(*whole.getCollisionObject(), placed.index, leaf.fault));
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
    const bool convex = a.leaf.kind == Kind::convex || b.leaf.kind == Kind::convex;
    switch (work_for(a.leaf, b.leaf, convex_)) {
    case Work::plane:
        run_plane(a, b, result);
        break;
    case Work::round:
        run_round(a, b, result);
        break;
    case Work::batch:
        if (convex && result.m_closestPointDistanceThreshold > 0)
            run_bullet(a, b, whole_a, whole_b, info, result);
        else
            run_batch(a, b, result);
        break;
    case Work::bullet:
        run_bullet(a, b, whole_a, whole_b, info, result);
        break;
    case Work::nothing:
        break;
    }
}

void Queries::run_plane(const Placed& a, const Placed& b, btManifoldResult& result) {
    const bool a_is_mesh = b.leaf.kind == Kind::plane;
    const Placed& mesh = a_is_mesh ? a : b;
    const Placed& plane = a_is_mesh ? b : a;
    const HalfSpace space =
        half_space(static_cast<const btStaticPlaneShape&>(*plane.leaf.shape), plane.leaf.pose, plane.leaf.stretch);
    const btVector3& normal = space.normal;
    std::vector<PlaneContact> found;
    plane_contacts(mesh.leaf.converted, mesh.leaf.pose, space, 0, found);
    for (const PlaneContact& c : found) {
        const int vertex = static_cast<int>(mesh.leaf.converted.shape->vertex_index()[c.vertex]);
        identify(result, a_is_mesh, name_of_feature(mesh.leaf, {.vertex = vertex}), {});
        if (a_is_mesh)
            result.addContactPoint(normal, c.point + normal * c.depth, -c.depth);
        else
            result.addContactPoint(-normal, c.point, -c.depth);
    }
}

void Queries::run_round(const Placed& a, const Placed& b, btManifoldResult& result) {
    const bool a_is_mesh = a.leaf.kind == Kind::mesh;
    const Placed& mesh = a_is_mesh ? a : b;
    const Placed& ball = a_is_mesh ? b : a;
    std::vector<RoundContact> found;
    round_contacts(mesh.leaf.converted, mesh.leaf.pose, round_before(mesh.leaf, ball.leaf, convex_), ball.leaf.pose,
                   result.m_closestPointDistanceThreshold, found);
    for (const RoundContact& c : found) {
        const int triangle = static_cast<int>(mesh.leaf.converted.shape->triangle_index()[c.triangle]);
        identify(result, a_is_mesh, name_of_triangle(mesh.leaf, triangle), {});
        if (a_is_mesh)
            result.addContactPoint(-c.normal, c.point + c.normal * c.distance, c.distance);
        else
            result.addContactPoint(c.normal, c.point, c.distance);
    }
}

void Queries::run_batch(const Placed& a, const Placed& b, btManifoldResult& result) {
    // A callback may ask for other contacts, or throw: nothing of this pair is in the scene when it is called.
    std::vector<Contact> contacts;
    {
        const Guest guest_a(scene_, a.leaf.converted.shape, a.leaf.pose),
            guest_b(scene_, b.leaf.converted.shape, b.leaf.pose);
        const std::array pairs{Pair{guest_a.body, guest_b.body}};
        const std::span<const Contact> found = scene_.find_contacts(pairs);
        contacts.assign(found.begin(), found.end());
    }
    for (const Contact& c : contacts) {
        const auto source = static_cast<int>(c.feature.source_index());
        const std::uint32_t other = c.feature.other_index();
        const auto target = static_cast<int>(c.feature.kind == FeatureKind::edges ? other / 3 : other);
        const bool of_a = c.feature.source == Side::a;
        const Leaf &source_leaf = of_a ? a.leaf : b.leaf, &target_leaf = of_a ? b.leaf : a.leaf;
        identify(result, of_a, name_of_feature(source_leaf, {.vertex = source, .feature = c.feature.kind}),
                 name_of_triangle(target_leaf, target));
        result.addContactPoint(-normal_of(c), to_bullet(c.point_b), btScalar(-c.depth));
    }
}

void Queries::run_bullet(const Placed& a, const Placed& b, const btCollisionObjectWrapper& whole_a,
                         const btCollisionObjectWrapper& whole_b, const btDispatcherInfo& info,
                         btManifoldResult& result) {
    const btCollisionObjectWrapper wrap_a(&whole_a, a.leaf.shape, whole_a.getCollisionObject(), a.pose, -1, a.index);
    const btCollisionObjectWrapper wrap_b(&whole_b, b.leaf.shape, whole_b.getCollisionObject(), b.pose, -1, b.index);
    btCollisionAlgorithm* algorithm =
        dispatcher_.btCollisionDispatcher::findAlgorithm(&wrap_a, &wrap_b, nullptr, BT_CLOSEST_POINT_ALGORITHMS);
    const btCollisionObjectWrapper* const own_a = result.getBody0Wrap();
    const btCollisionObjectWrapper* const own_b = result.getBody1Wrap();
    struct AtTheEnd { // also if the user's callback throws
        std::function<void()> clean_up;
        ~AtTheEnd() { clean_up(); }
    };
    const AtTheEnd at_the_end{[&] {
        result.setBody0Wrap(own_a);
        result.setBody1Wrap(own_b);
        algorithm->~btCollisionAlgorithm();
        dispatcher_.freeCollisionAlgorithm(algorithm);
    }};
    result.setBody0Wrap(&wrap_a);
    result.setBody1Wrap(&wrap_b);
    result.setShapeIdentifiersA(-1, a.index);
    result.setShapeIdentifiersB(-1, b.index);
    algorithm->processCollision(&wrap_a, &wrap_b, info, &result);
}

} // namespace raycontact::bullet
