// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/error.h>
#include <raycontact/export.h>

#include <string>
#include <utility>

class btCollisionObject;

namespace raycontact::bullet {

/// Why an object, or a child of its compound, takes no part in the contacts that RayContact finds, or only some.
struct Fault {
    const btCollisionObject* object = nullptr; ///< which one
    int child = 0;        ///< index of the leaf shape, depth first, when the object is a compound; else 0
    std::string text;     ///< names shape and reason, and says what to do, in one line
    bool left_out = true; ///< it takes no part; else it does, and the text says what is missing
};

/// CollisionDispatcher::add_body() throws it where a dispatch would leave the object out.
class RAYCONTACT_API ObjectError : public InputError {
public:
    /// Its text is the fault's.
    explicit ObjectError(Fault fault) : InputError(fault.text), fault_(std::move(fault)) {}
    /// What is wrong, and with which object.
    const Fault& fault() const noexcept { return fault_; }

private:
    Fault fault_;
};

} // namespace raycontact::bullet
