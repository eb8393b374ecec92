// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/step_details.h>

#include <cstdint>
#include <string>
#include <vector>

namespace raycontact {

/// What the last step did.
struct StepStats {
    std::uint64_t pairs = 0;         ///< unordered pairs in the narrow phase
    std::uint64_t contacts = 0;      ///< that touch
    std::uint64_t contacts_new = 0;  ///< of these, those that did not touch in the last step
    std::uint64_t contacts_lost = 0; ///< that touched in the last step, and do not in this one
    /// Beside them in Scene::contacts(): those that do not touch yet.
    std::uint64_t contacts_speculative = 0;
    /// Found, but left out by Settings::max_contacts_per_pair or max_contacts.
    std::uint64_t contacts_reduced = 0;
    double depth_max = 0;              ///< of all contacts, those left out as well, metres
    double broad_ms = 0;               ///< our broad phase; 0 when pairs were given
    double narrow_ms = 0;              ///< everything after the broad phase
    std::uint64_t pair_bytes = 0;      ///< memory kept for the open pairs
    std::uint64_t devices_lost = 0;    ///< that failed in this step; others cast their pairs in full
    std::vector<std::string> warnings; ///< in plain words, as of a device that failed; the contacts are complete
    StepDetails details;               ///< counts of work, for who measures
};

} // namespace raycontact
