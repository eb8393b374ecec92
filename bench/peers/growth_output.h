// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bench/peers/growth.h>
#include <bench/peers/machine.h>

#include <filesystem>
#include <span>
#include <string>

namespace raycontact::bench {

/// For a person.
std::string table(const Machine& machine, std::span<const GrowthRow> rows);
/// One object.
std::string json(const Machine& machine, std::span<const GrowthRow> rows);
/// growth, as write_both() does.
std::filesystem::path write_results(const std::filesystem::path& folder, const Machine& machine,
                                    std::span<const GrowthRow> rows);

} // namespace raycontact::bench
