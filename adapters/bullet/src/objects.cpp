// SPDX-License-Identifier: Apache-2.0
#include <objects.h>

#include <raycontact/error.h>
#include <vectors.h>

#include <BulletDynamics/Dynamics/btRigidBody.h>
#include <LinearMath/btAabbUtil2.h>
#include <LinearMath/btTransformUtil.h>

#include <algorithm>
#include <utility>

namespace raycontact::bullet {

namespace {

bool unmoved(const btTransform& a, const btTransform& b) {
    bool all = alike(a.getOrigin(), b.getOrigin());
    for (int i = 0; i < 3; ++i) all = all && alike(a.getBasis()[i], b.getBasis()[i]);
    return all;
}

/// No point of the shape moves farther from one pose to the other. Nor does it if the scene lets the same motion go on.
btScalar longest_way(const Shape& shape, const btTransform& from, const btTransform& to) {
    btScalar turn = 0;
    for (int i = 0; i < 3; ++i) turn += (to.getBasis()[i] - from.getBasis()[i]).length2();
    return (to.getOrigin() - from.getOrigin()).length() + btSqrt(turn) * btScalar(shape.radius());
}

bool is_finite(const btTransform& t) {
    btScalar sum = 0; // of zeros, or of what is no number
    for (int i = 0; i < 3; ++i) sum += t.getBasis()[i].dot(btVector3(0, 0, 0)) + t.getOrigin()[i] * btScalar(0);
    return sum == 0;
}

bool is_finite(const btVector3& v) {
    return v.dot(btVector3(0, 0, 0)) == 0;
}

bool has_velocity(const btCollisionObject& object) {
    const btRigidBody* body = btRigidBody::upcast(&object);
    return body == nullptr || (is_finite(body->getLinearVelocity()) && is_finite(body->getAngularVelocity()));
}

/// Places an object as a whole. Returns why it cannot take part; empty: it can. A velocity comes first: the transform
/// is then its doing.
std::string place_whole(const btCollisionObject& object, const Stretch& kept, Placement& placement) {
    std::string fault_of_transform;
    try {
        placement = place(object.getWorldTransform(), kept);
    } catch (const InputError& error) {
        fault_of_transform = error.what();
    }
    const bool moves = has_velocity(object);
    if (moves && !fault_of_transform.empty()) return fault_of_transform;
    if (moves && is_finite(object.getInterpolationWorldTransform())) return {};
    return "its velocity is not finite, or beyond all bounds; set velocity and transform, and activate it, since "
           "Bullet disables such objects";
}

/// What a new stretch is compared with; that of a plane is not rounded.
const Stretch& kept_stretch(const Leaf& leaf) {
    return leaf.kind == Kind::plane ? no_stretch : leaf.stretch;
}

} // namespace

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

bool Objects::unchanged(const btCollisionObject& object, const Object& record) const {
    if (record.stale || record.version == 0) return false;
    std::size_t count = 0;
    bool same = true;
    each_leaf(*object.getCollisionShape(), btTransform::getIdentity(),
              [&](const btCollisionShape& shape, const btTransform& local) {
                  same = same && count < record.leaves.size();
                  if (!same) return;
                  const Leaf& leaf = record.leaves[count++];
                  same = leaf.shape == &shape && unmoved(leaf.local, local) && leaf.kind == kind_of(shape, convex_)
                         && (!in_scene(leaf.kind) || leaf.form == form_of(shape));
              });
    return same && count == record.leaves.size();
}

Object* Objects::find(const btCollisionObject& object) const {
    const auto i = records_.find(&object);
    return i == records_.end() ? nullptr : i->second.lock().get(); // one that is there is held elsewhere
}

const Stretch& Objects::kept_stretch_of(const btCollisionObject& object, std::size_t leaf,
                                        const btCollisionShape& shape) const {
    const Object* record = find(object);
    if (!record || leaf >= record->leaves.size()) return no_stretch;
    const Leaf& known = record->leaves[leaf];
    return known.shape == &shape ? kept_stretch(known) : no_stretch;
}

std::shared_ptr<Object> Objects::refresh(const btCollisionObject& object, std::uint64_t dispatch) {
    std::shared_ptr<Object> record = records_[&object].lock();
    if (!record) {
        record = {new Object, [this, key = &object](Object* gone) {
                      drop_bodies(*gone);
                      records_.erase(key);
                      faults_.take_back(key); // who waits longer may find it deleted
                      delete gone;
                  }};
        records_[&object] = record;
    }
    refresh(object, *record, dispatch);
    return record;
}

void Objects::refresh(const btCollisionObject& object, Object& record, std::uint64_t dispatch) {
    if (record.seen == dispatch && !record.leaves.empty() && !record.stale) return;
    if (!unchanged(object, record)) make_leaves(object, record);
    place_object(object, record);
    if (ahead_ > 0 && !record.misplaced()) expect(object, record, dispatch);
    record.seen = dispatch;
}

bool Objects::want_fields(Object& record) {
    bool any = false;
    for (Leaf& leaf : record.leaves) any = std::exchange(leaf.unmet, false) || any;
    if (any) record.seen = Object::never;
    return any;
}

void Objects::meet(Object& record, const btCollisionObject& other) const {
    const bool any = std::ranges::any_of(record.leaves, &Leaf::unmet);
    if (any && (kinds_in(*other.getCollisionShape(), convex_) & bit(Kind::mesh))) want_fields(record);
}

void Objects::place_object(const btCollisionObject& object, Object& record) {
    Placement whole;
    const bool alone = !object.getCollisionShape()->isCompound();
    record.fault = place_whole(object, alone ? kept_stretch(record.leaves.front()) : no_stretch, whole);
    record.pose = whole.pose;
    for (Leaf& leaf : record.leaves)
        if (leaf.kind != Kind::other && !record.misplaced()) place_leaf(object, record, leaf, whole);
    std::vector<Fault> faults = faults_of(object, record);
    auto& left_out = mended_.left_out;
    if (!faults.empty() && std::ranges::find(left_out, &object) == left_out.end()) left_out.push_back(&object);
    faults_.set(object, std::move(faults));
}

void Objects::report_lost(const btCollisionObject& object, std::uint64_t dispatch) {
    if (is_finite(object.getWorldTransform()) && is_finite(object.getInterpolationWorldTransform())
        && has_velocity(object))
        return;
    if (Object* record = find(object)) {
        refresh(object, *record, dispatch);
        return;
    }
    if (std::ranges::find(mended_.left_out, &object) != mended_.left_out.end()) return;
    Placement ignored;
    faults_.set_lost(object, fault_of(object, 0, place_whole(object, no_stretch, ignored)));
    mended_.left_out.push_back(&object);
}

std::vector<Fault> Objects::faults_of(const btCollisionObject& object, const Object& record) {
    std::vector<Fault> faults;
    if (record.misplaced()) faults.push_back(fault_of(object, 0, record.fault));
    for (const Leaf& leaf : record.leaves)
        if (leaf.left_out())
            faults.push_back(fault_of(object, static_cast<int>(&leaf - record.leaves.data()), leaf.fault));
    return faults;
}

void Objects::place_leaf(const btCollisionObject& object, Object& record, Leaf& leaf, const Placement& whole) {
    if (leaf.is_fixed != object.isStaticOrKinematicObject()) {
        leaf.is_fixed = !leaf.is_fixed;
        record.version = ++versions_; // others may find its contacts now
    }
    const bool was_left_out = leaf.left_out();
    const btTransform before = leaf.pose;
    bool unusable = false;
    try {
        const Placement placed = object.getCollisionShape()->isCompound()
                                     ? place(object.getWorldTransform() * leaf.local, kept_stretch(leaf))
                                     : whole;
        leaf.pose = leaf.next = placed.pose;
        if (placed.drifted) ++mended_.made_rigid;
        if (placed.stretch != no_stretch) ++mended_.scaled;
        const Stretch& stretch = stretch_of(leaf.kind, placed);
        if (stretch != leaf.stretch) {
            drop_body(leaf);
            leaf.stretch = stretch;
            leaf.unusable = false;
            if (leaf.kind != Kind::plane) record.version = ++versions_; // a plane has no mesh that would be another
        }
        if (leaf.unusable) return;
        if (!in_scene(leaf.kind) || leaf.unmet) {
            check_numbers(*leaf.shape); // read anew in every step
        } else if (!leaf.body.valid() && !leaf.flat) {
            unusable = true;
            leaf.converted = shapes_.get(*leaf.shape);
            leaf.flat = !leaf.converted.shape; // a convex shape without a mesh to stand for it, and so without a body
            if (!leaf.flat) leaf.converted = shapes_.stretched(leaf.converted, leaf.stretch);
        }
    } catch (const InputError& error) {
        leaf.fault = error.what();
        leaf.unusable = unusable;
        if (!was_left_out) record.version = ++versions_; // or its manifolds would stay
        return;
    }
    leaf.fault.clear();
    if (!in_scene(leaf.kind) || leaf.flat || leaf.unmet) return;
    leaf.way = 0;
    if (leaf.body.valid()) {
        scene_.set_pose(leaf.body, to_pose(leaf.pose));
        if (leaf.back.valid()) scene_.set_pose(leaf.back, to_pose(leaf.pose));
        leaf.way = longest_way(*leaf.converted.shape, before, leaf.pose);
    } else {
        leaf.body = scene_.add(leaf.converted.shape, to_pose(leaf.pose));
    }
    find_box(*leaf.converted.shape, leaf.pose, leaf.low, leaf.high);
}

// As Bullet will move it if nothing new is in its way. The scene itself goes on with the motion of what Bullet gives no
// velocity, and of one whose speed is beyond all bounds.
void Objects::expect(const btCollisionObject& object, Object& record, std::uint64_t dispatch) {
    const btRigidBody* body = btRigidBody::upcast(&object);
    if (body == nullptr) return;
    btTransform then;
    if (body->isKinematicObject()) { // one without mass is static, too
        const auto next = kinematics_.next_of(object);
        if (!next) return;
        then = *next;
    } else if (body->isStaticObject()) {
        return;
    } else {
        const btVector3 own = body->getLinearVelocity(),
                        gain = ahead_ * body->getInvMass() * body->getLinearFactor() * body->getTotalForce();
        if (record.expected != dispatch) { // a dispatch may ask twice
            // What held a body up in the last step holds it up in this one.
            record.is_held = record.expected != Object::never && record.expected + 1 == dispatch
                             && (own - record.unhindered).length2() > btScalar(0.25) * gain.length2();
            record.unhindered = own + gain;
            record.expected = dispatch;
        }
        btTransformUtil::integrateTransform(record.pose, record.is_held ? own : own + gain, body->getAngularVelocity(),
                                            ahead_, then);
    }
    for (Leaf& leaf : record.leaves) {
        if ((!leaf.body.valid() && leaf.kind != Kind::round && !leaf.unmet) || leaf.left_out()) continue;
        try {
            leaf.next = place(then * leaf.local).pose;
            if (!leaf.body.valid()) continue;
            scene_.set_next_pose(leaf.body, to_pose(leaf.next));
            if (leaf.back.valid()) scene_.set_next_pose(leaf.back, to_pose(leaf.next));
            leaf.way = longest_way(*leaf.converted.shape, leaf.pose, leaf.next);
        } catch (const InputError&) {
            return;
        }
    }
}

void Objects::make_leaves(const btCollisionObject& object, Object& record) {
    drop_bodies(record);
    each_leaf(*object.getCollisionShape(), btTransform::getIdentity(),
              [&](const btCollisionShape& shape, const btTransform& local) {
                  Leaf& leaf = record.leaves.emplace_back();
                  leaf.shape = &shape;
                  leaf.local = local;
                  leaf.kind = kind_of(shape, convex_);
                  if (in_scene(leaf.kind)) leaf.form = form_of(shape);
                  leaf.unmet = leaf.kind == Kind::field;
              });
    record.version = ++versions_;
    record.stale = false;
}

void Objects::drop_body(Leaf& leaf) {
    if (leaf.body.valid()) scene_.remove(leaf.body);
    if (leaf.back.valid()) scene_.remove(leaf.back);
    leaf.body = leaf.back = {};
    leaf.converted = leaf.reversed = {};
}

void Objects::add_back(Leaf& leaf) {
    if (leaf.back.valid()) return;
    leaf.reversed = shapes_.stretched(leaf.converted, no_stretch, true);
    leaf.back = scene_.add(leaf.reversed.shape, to_pose(leaf.pose));
    if (ahead_ > 0) scene_.set_next_pose(leaf.back, to_pose(leaf.next));
}

void Objects::drop_bodies(Object& record) {
    for (Leaf& leaf : record.leaves) drop_body(leaf);
    record.leaves.clear();
}

void Objects::refresh_pinned(std::uint64_t dispatch) {
    for (const auto& [object, record] : pinned_) refresh(*object, *record, dispatch);
}

void Objects::forget() {
    kinematics_.forget();
    mended_ = {};
    for (const auto& [object, record] : pinned_) {
        record->seen = Object::never;
        record->expected = Object::never;
    }
}

void Objects::pin(const btCollisionObject& object, std::shared_ptr<Object> record) {
    if (std::ranges::find(pinned_, &object, [](const auto& one) { return one.first; }) == pinned_.end())
        pinned_.emplace_back(&object, std::move(record));
}

void Objects::unpin(const btCollisionObject& object) {
    std::erase_if(pinned_, [&](const auto& one) { return one.first == &object; });
}

} // namespace raycontact::bullet
