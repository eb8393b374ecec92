// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bench/peers/work.h>
#include <recording/replay.h>

#include <cstdint>
#include <span>
#include <vector>

namespace raycontact::bench {

/// What `standard` finds in every step of a work, every ray of the rule cast: right by definition. Contacts are kept by
/// name alone, since a work has up to a million.
class Reference {
public:
    explicit Reference(const Work& work, Features features = Features::vertices);

    /// Adds what one step of the work got wrong, and what it is a part of.
    void compare(std::size_t step, std::span<const Contact> found, recording::WrongRays& wrong);
    std::uint64_t rays(std::size_t step) const { return rays_[step]; }

private:
    struct Name {
        BodyId body_a, body_b;
        ContactFeature feature;
    };
    std::vector<std::vector<Name>> names_; ///< of each step
    std::vector<std::uint64_t> rays_;
    std::vector<Contact> contacts_; ///< of the step that is compared
};

} // namespace raycontact::bench
