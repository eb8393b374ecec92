// SPDX-License-Identifier: Apache-2.0
#include <faults.h>

#include <BulletCollision/CollisionDispatch/btCollisionObject.h>
#include <BulletCollision/CollisionShapes/btCollisionShape.h>

#include <cstdio>
#include <limits>

namespace raycontact::bullet {

void Faults::add(const btCollisionObject& object, int child, const std::string& what) {
    const btCollisionShape& shape = *object.getCollisionShape();
    std::string text = "object with shape " + std::string(shape.getName());
    if (shape.isCompound()) text += ", child " + std::to_string(child);
    if (object.getUserIndex() >= 0) text += ", user index " + std::to_string(object.getUserIndex());
    text += ": " + what + "; it has no contacts until that is mended";
    Fault& known = known_[{&object, child}];
    if (known.text == text) return;
    known = {&object, child, std::move(text)};
    waiting_.push_back(known);
}

void Faults::forget(const btCollisionObject& object) {
    if (known_.empty()) return; // as good as always
    known_.erase(known_.lower_bound({&object, 0}), known_.upper_bound({&object, std::numeric_limits<int>::max()}));
}

void Faults::tell() {
    const std::vector<Fault> faults = std::exchange(waiting_, {});
    for (const Fault& fault : faults)
        if (callback_) callback_(fault);
}

Fault Faults::take(const btCollisionObject& object) {
    Fault fault = known_.lower_bound({&object, 0})->second;
    forget(object);
    std::erase_if(waiting_, [&](const Fault& one) { return one.object == &object; });
    return fault;
}

void print(const Fault& fault) {
    std::fprintf(stderr, "raycontact: %s\n", fault.text.c_str());
}

} // namespace raycontact::bullet
