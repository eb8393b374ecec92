// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bench/peers/files.h>
#include <bench/peers/growth.h>

#include <span>
#include <string>

namespace raycontact::bench {

/// For a person.
std::string table(const Machine& machine, std::span<const GrowthRow> rows);
/// One object.
std::string json(const Machine& machine, std::span<const GrowthRow> rows);
/// growth, as write_both() does.
void write_results(output::OutFolder& folder, const Machine& machine, std::span<const GrowthRow> rows);

} // namespace raycontact::bench
