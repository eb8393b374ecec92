// SPDX-License-Identifier: Apache-2.0
#include <pair.h>

#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>
#include <BulletCollision/CollisionDispatch/btManifoldResult.h>
#include <LinearMath/btAabbUtil2.h>

#include <algorithm>

namespace raycontact::bullet {

PairState::PairState(btCollisionDispatcher& dispatcher, Objects& objects, Touches& touches, const btCollisionObject* a,
                     const btCollisionObject* b)
    : object0(a), object1(b), record0(objects.acquire(*a)), record1(objects.acquire(*b)), patches(dispatcher, a, b),
      dispatcher_(dispatcher), objects_(objects), touches_(touches) {}

PairState::~PairState() {
    // The objects may be gone from the world, but Bullet cleans pairs before it forgets them.
    clear();
    objects_.release(object0);
    objects_.release(object1);
}

void PairState::clear() {
    for (const ChildPair& child : children_) drop_child(child);
    children_.clear();
    patches.clear();
    touches_.end(*this);
}

void PairState::drop_child(const ChildPair& child) {
    child.algorithm->~btCollisionAlgorithm();
    dispatcher_.freeCollisionAlgorithm(child.algorithm);
}

void PairState::check_versions(std::uint64_t version0, std::uint64_t version1) {
    if (version0 == version0_ && version1 == version1_) return;
    for (const ChildPair& child : children_) drop_child(child);
    children_.clear();
    if (version0_ != 0) patches.clear();
    version0_ = version0;
    version1_ = version1;
}

void PairState::run_child(int leaf0, int leaf1, const Leaf& a, const Leaf& b, const btDispatcherInfo& info) {
    const btTransform pose0 = object0->getWorldTransform() * a.local;
    const btTransform pose1 = object1->getWorldTransform() * b.local;
    const auto found = std::find_if(children_.begin(), children_.end(),
                                    [&](const ChildPair& c) { return c.leaf0 == leaf0 && c.leaf1 == leaf1; });
    btVector3 low0, high0, low1, high1;
    aabb_once(*a.shape, pose0, low0, high0);
    aabb_once(*b.shape, pose1, low1, high1);
    const btVector3 reach(gContactBreakingThreshold, gContactBreakingThreshold, gContactBreakingThreshold);
    if (!TestAabbAgainstAabb2(low0 - reach, high0 + reach, low1, high1)) {
        if (found != children_.end()) {
            drop_child(*found);
            children_.erase(found);
        }
        return;
    }
    const btCollisionObjectWrapper whole0(nullptr, object0->getCollisionShape(), object0, object0->getWorldTransform(),
                                          -1, -1);
    const btCollisionObjectWrapper whole1(nullptr, object1->getCollisionShape(), object1, object1->getWorldTransform(),
                                          -1, -1);
    const btCollisionObjectWrapper child0(&whole0, a.shape, object0, pose0, -1, leaf0);
    const btCollisionObjectWrapper child1(&whole1, b.shape, object1, pose1, -1, leaf1);
    const bool is_child0 = a.shape != object0->getCollisionShape(), is_child1 = b.shape != object1->getCollisionShape();
    const btCollisionObjectWrapper &wrap0 = is_child0 ? child0 : whole0, &wrap1 = is_child1 ? child1 : whole1;
    btCollisionAlgorithm* algorithm = nullptr;
    if (found != children_.end()) {
        algorithm = found->algorithm;
    } else {
        // Bullet's own: our findAlgorithm is for whole objects.
        algorithm =
            dispatcher_.btCollisionDispatcher::findAlgorithm(&wrap0, &wrap1, nullptr, BT_CONTACT_POINT_ALGORITHMS);
        children_.push_back({leaf0, leaf1, algorithm});
    }
    btManifoldResult result(&wrap0, &wrap1);
    result.setShapeIdentifiersA(-1, is_child0 ? leaf0 : -1);
    result.setShapeIdentifiersB(-1, is_child1 ? leaf1 : -1);
    algorithm->processCollision(&wrap0, &wrap1, info, &result);
}

void PairState::all_manifolds(btManifoldArray& out) const {
    for (btPersistentManifold* m : patches.manifolds()) out.push_back(m);
    for (const ChildPair& child : children_) child.algorithm->getAllContactManifolds(out);
}

} // namespace raycontact::bullet
