// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/bullet/fault.h>

#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace raycontact::bullet {

/// The faults of objects: each is told once, as long as it lasts.
class Faults {
public:
    using Callback = std::function<void(const Fault&)>;

    void set_callback(Callback callback) { callback_ = std::move(callback); }
    /// Unless the last one of this child was the same, it waits for tell().
    void add(const btCollisionObject& object, int child, const std::string& what);
    /// The object has no fault any more.
    void forget(const btCollisionObject& object);
    /// Calls the callback, which may throw, for those that wait.
    void tell();
    /// The first of an object that has one; as if it had none from now on.
    Fault take(const btCollisionObject& object);

private:
    Callback callback_;
    std::map<std::pair<const btCollisionObject*, int>, Fault> known_; ///< never iterated but for one object
    std::vector<Fault> waiting_;
};

/// One line on stderr.
void print(const Fault& fault);

} // namespace raycontact::bullet
