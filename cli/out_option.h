// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>

#include <filesystem>
#include <string>
#include <vector>

/// An option that names a file or folder to write; an empty name is refused.
CLI::Option* add_out(CLI::App& command, const std::string& option, std::string& name, const std::string& help);

/// Says on standard error, if there are any, what runs that were ended left.
void name_left_overs(const std::vector<std::filesystem::path>& files);
