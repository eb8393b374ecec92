// SPDX-License-Identifier: Apache-2.0
#include <objects.h>
#include <vectors.h>

#include <BulletDynamics/Dynamics/btRigidBody.h>
#include <LinearMath/btAabbUtil2.h>
#include <LinearMath/btTransformUtil.h>

namespace raycontact::bullet {

Pose to_pose(const btTransform& transform) {
    Pose pose;
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) pose.rotation[3 * i + j] = static_cast<double>(transform.getBasis()[i][j]);
    }
    const btVector3& t = transform.getOrigin();
    pose.translation = {static_cast<double>(t.x()), static_cast<double>(t.y()), static_cast<double>(t.z())};
    return pose;
}

void find_box(const Shape& shape, const btTransform& pose, btVector3& low, btVector3& high) {
    const btScalar coordinates = 2 * btScalar(shape.radius()) + pose.getOrigin().length();
    btTransformAabb(to_bullet(shape.box_min()), to_bullet(shape.box_max()), btScalar(1e-5) * coordinates, pose, low,
                    high);
}

Kind Objects::kind_for_us(const btCollisionShape& shape) const {
    const Kind kind = kind_of(shape);
    const bool left = convex_ == ConvexShapes::bullet && (kind == Kind::convex || kind == Kind::round);
    return left ? Kind::other : kind;
}

bool Objects::unchanged(const btCollisionObject& object, const Object& record) const {
    if (record.stale || record.version == 0) return false;
    std::size_t count = 0;
    bool same = true;
    each_leaf(*object.getCollisionShape(), btTransform::getIdentity(),
              [&](const btCollisionShape& shape, const btTransform& local) {
                  same = same && count < record.leaves.size();
                  if (!same) return;
                  const Leaf& leaf = record.leaves[count++];
                  same = leaf.shape == &shape && leaf.local == local && leaf.kind == kind_for_us(shape)
                         && (!in_scene(leaf.kind) || leaf.form == form_of(shape));
              });
    return same && count == record.leaves.size();
}

Object* Objects::find(const btCollisionObject& object) {
    const auto i = records_.find(&object);
    return i == records_.end() ? nullptr : &i->second;
}

Object& Objects::refresh(const btCollisionObject& object, std::uint64_t dispatch) {
    try {
        return refresh(object, records_[&object], dispatch);
    } catch (...) {
        drop_unused(&object);
        throw;
    }
}

Object& Objects::refresh(const btCollisionObject& object, Object& record, std::uint64_t dispatch) {
    if (record.seen == dispatch && !record.leaves.empty() && !record.stale) return record;
    if (!unchanged(object, record)) make_leaves(object, record);
    for (Leaf& leaf : record.leaves) {
        if (leaf.body == Leaf::no_body) continue;
        const btTransform pose = object.getWorldTransform() * leaf.local;
        scene_.set_pose(leaf.body, to_pose(pose));
        find_box(*leaf.converted.shape, pose, leaf.low, leaf.high);
    }
    if (ahead_ > 0) expect(object, record);
    record.seen = dispatch;
    return record;
}

// As Bullet will move it if nothing is in its way. The scene itself goes on with the motion of a kinematic object.
void Objects::expect(const btCollisionObject& object, const Object& record) {
    const btRigidBody* body = btRigidBody::upcast(&object);
    if (body == nullptr || body->isStaticOrKinematicObject()) return;
    const btVector3 velocity =
        body->getLinearVelocity() + ahead_ * body->getInvMass() * body->getLinearFactor() * body->getTotalForce();
    btTransform then;
    btTransformUtil::integrateTransform(object.getWorldTransform(), velocity, body->getAngularVelocity(), ahead_, then);
    for (const Leaf& leaf : record.leaves) {
        if (leaf.body != Leaf::no_body) scene_.set_next_pose(leaf.body, to_pose(then * leaf.local));
    }
}

void Objects::make_leaves(const btCollisionObject& object, Object& record) {
    drop_bodies(record);
    const auto make = [&](const btCollisionShape& shape, const btTransform& local) {
        Leaf leaf;
        leaf.shape = &shape;
        leaf.local = local;
        leaf.kind = kind_for_us(shape);
        if (in_scene(leaf.kind)) {
            leaf.form = form_of(shape);
            leaf.converted = shapes_.get(shape);
            if (leaf.converted.shape)
                leaf.body = scene_.add(leaf.converted.shape, to_pose(object.getWorldTransform() * leaf.local));
        }
        record.leaves.push_back(leaf);
    };
    try {
        each_leaf(*object.getCollisionShape(), btTransform::getIdentity(), make);
    } catch (...) { // of one child: those before it do not stay without it
        drop_bodies(record);
        record.version = 0;
        throw;
    }
    record.version = ++versions_;
    record.stale = false;
}

void Objects::drop_bodies(Object& record) {
    for (const Leaf& leaf : record.leaves) {
        if (leaf.body != Leaf::no_body) scene_.remove(leaf.body);
    }
    record.leaves.clear();
}

void Objects::release(const btCollisionObject* object) {
    const auto i = records_.find(object);
    if (i == records_.end()) return;
    if (i->second.uses > 0) --i->second.uses;
    drop_unused(object);
}

void Objects::drop_unused(const btCollisionObject* object) {
    const auto i = records_.find(object);
    if (i == records_.end() || i->second.uses > 0 || i->second.pinned) return;
    drop_bodies(i->second);
    records_.erase(i);
}

void Objects::refresh_pinned(std::uint64_t dispatch) {
    for (const auto& [object, record] : pinned_) refresh(*object, *record, dispatch);
}
void Objects::pin(const btCollisionObject& object, bool pinned) {
    const auto i = records_.find(&object);
    if (i == records_.end()) return;
    if (i->second.pinned != pinned) {
        if (pinned)
            pinned_.emplace_back(&object, &i->second);
        else
            std::erase_if(pinned_, [&](const auto& one) { return one.first == &object; });
    }
    i->second.pinned = pinned;
    drop_unused(&object);
}

} // namespace raycontact::bullet
