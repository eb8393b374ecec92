// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bench/peers/contest.h>
#include <bench/peers/files.h>
#include <bench/peers/notes.h>

#include <span>
#include <string>

namespace raycontact::bench {

/// For a person.
std::string table(const Machine& machine, std::span<const WorkNote> works, std::span<const Result> results);
/// One object.
std::string json(const Machine& machine, std::span<const WorkNote> works, std::span<const Result> results);

/// peers, as write_both() does.
void write_results(output::OutFolder& folder, const Machine& machine, std::span<const WorkNote> works,
                   std::span<const Result> results);

} // namespace raycontact::bench
