// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/bullet/fault.h>

#include <cstdint>
#include <deque>
#include <functional>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

namespace raycontact::bullet {

/// The faults of objects: each is told once, as long as it lasts and the object stays in its world.
class Faults {
public:
    using Callback = std::function<void(const Fault&)>;

    void set_callback(Callback callback) { callback_ = std::move(callback); }
    /// Unless it is known, it waits for tell().
    void add(Fault fault);
    /// All that an object has now: what else it had is mended.
    void set(const btCollisionObject& object, std::vector<Fault> faults);
    /// The same for an object of which nobody says that it is mended: its fault is found anew in each dispatch until it
    /// is.
    void set_lost(const btCollisionObject& object, Fault fault);
    /// What of the object waits is as if it had not been found. It may be gone.
    void take_back(const btCollisionObject* object);
    /// Calls the callback for those that wait. Where it throws, the others go on waiting.
    void tell();
    /// Call it once a dispatch: forgets objects that were not in use for a while. They may be gone, and others lie at
    /// their addresses. in_use(address) must not look there.
    template <class InUse>
    void sweep(InUse&& in_use) {
        ++now_;
        std::erase_if(known_, [&](const auto& one) { return one.second.is_lost && one.second.seen + 1 < now_; });
        if (now_ % 64 != 0) return;
        for (auto& [object, known] : known_)
            if (in_use(object)) known.seen = now_;
        std::erase_if(known_, [&](const auto& one) { return one.second.seen + keep_dispatches < now_; });
    }

private:
    struct Known {
        std::vector<std::string> texts;
        std::uint64_t seen = 0;
        bool is_lost = false;
        int stay = 0; ///< the number of its broad-phase proxy, of which an object has another each time it is added
    };
    static constexpr std::uint64_t keep_dispatches = 600;
    static constexpr std::size_t most_known = 10'000; ///< where nothing is dispatched, only queried

    Callback callback_;
    std::unordered_map<const btCollisionObject*, Known> known_; ///< no order of it shows
    std::deque<Fault> waiting_;
    std::uint64_t now_ = 0;
};

/// child: of the leaves, depth first.
Fault fault_of(const btCollisionObject& object, int child, const std::string& what);
/// The same for one that takes part all the same.
Fault hint_of(const btCollisionObject& object, int child, const std::string& what);
/// One line on stderr.
void print(const Fault& fault);

} // namespace raycontact::bullet
