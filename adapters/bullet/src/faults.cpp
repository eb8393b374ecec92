// SPDX-License-Identifier: Apache-2.0
#include <faults.h>

#include <BulletCollision/BroadphaseCollision/btBroadphaseProxy.h>
#include <BulletCollision/CollisionDispatch/btCollisionObject.h>
#include <BulletCollision/CollisionShapes/btCollisionShape.h>

#include <algorithm>
#include <cstdio>

namespace raycontact::bullet {

namespace {

/// Bullet numbers proxies from 1; 0 is an object that is in no world.
int stay_of(const btCollisionObject& object) {
    const btBroadphaseProxy* proxy = object.getBroadphaseHandle();
    return proxy ? proxy->getUid() : 0;
}

std::string name_of(const btCollisionObject& object, int child) {
    const btCollisionShape& shape = *object.getCollisionShape();
    std::string text = "object with shape " + std::string(shape.getName());
    if (shape.isCompound()) text += ", child " + std::to_string(child);
    if (object.getUserIndex() >= 0) text += ", user index " + std::to_string(object.getUserIndex());
    return text;
}

} // namespace

void Faults::add(Fault fault) {
    if (known_.size() > most_known) known_.clear();
    Known& known = known_[fault.object];
    known.seen = now_;
    known.is_lost = false;
    // It was taken out of the world in between, or is another object where the old one lay.
    if (const int stay = stay_of(*fault.object); known.stay != stay) {
        known.texts.clear();
        known.stay = stay;
    }
    if (std::ranges::find(known.texts, fault.text) != known.texts.end()) return;
    known.texts.push_back(fault.text);
    waiting_.push_back(std::move(fault));
}

void Faults::set(const btCollisionObject& object, std::vector<Fault> faults) {
    const auto mended = [&](const std::string& text) {
        return std::ranges::find(faults, text, &Fault::text) == faults.end();
    };
    std::erase_if(waiting_, [&](const Fault& one) { return one.object == &object && mended(one.text); });
    if (const auto known = known_.find(&object); known != known_.end()) {
        std::erase_if(known->second.texts, mended);
        if (faults.empty()) known_.erase(known);
    }
    for (Fault& fault : faults) add(std::move(fault));
}

void Faults::set_lost(const btCollisionObject& object, Fault fault) {
    set(object, {std::move(fault)});
    known_[&object].is_lost = true;
}

void Faults::take_back(const btCollisionObject* object) {
    std::erase_if(waiting_, [&](const Fault& fault) {
        if (fault.object != object) return false;
        if (const auto known = known_.find(object); known != known_.end()) std::erase(known->second.texts, fault.text);
        return true;
    });
}

void Faults::tell() {
    while (!waiting_.empty()) { // the callback may ask for contacts, which tells, too
        const Fault fault = std::move(waiting_.front());
        waiting_.pop_front();
        const Callback callback = callback_; // it may put another in its place
        if (callback) callback(fault);
    }
}

Fault fault_of(const btCollisionObject& object, int child, const std::string& what) {
    return {&object, child, name_of(object, child) + ": " + what + "; it has no contacts until that is mended"};
}

Fault hint_of(const btCollisionObject& object, int child, const std::string& what) {
    return {&object, child, name_of(object, child) + ": " + what, false};
}

void print(const Fault& fault) {
    std::fprintf(stderr, "raycontact: %s\n", fault.text.c_str());
}

} // namespace raycontact::bullet
