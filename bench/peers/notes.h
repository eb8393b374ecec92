// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bench/peers/work.h>

#include <raycontact/scene.h>
#include <recording/replay.h>

#include <nlohmann/json_fwd.hpp>

#include <cstdint>
#include <span>
#include <string>

namespace raycontact::bench {

/// What a work was, for a person and for the files.
struct WorkNote {
    std::string name, source;
    std::uint32_t steps = 0;
    std::uint64_t pair_steps = 0;
    Pace pace;
};

/// Two lines for a person, above the work's own.
std::string heading(const WorkNote& work);
nlohmann::ordered_json works_json(std::span<const WorkNote> works);
/// What a method of ours did and got wrong.
void put_counts(nlohmann::ordered_json& object, const StepStats& sums, const recording::WrongRays& wrong);

} // namespace raycontact::bench
