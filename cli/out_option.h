// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <output/out_file.h>

#include <CLI/CLI.hpp>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

/// An option that names a file or folder to write; an empty name is refused.
CLI::Option* add_out(CLI::App& command, const std::string& option, std::string& name, const std::string& help);

/// What such an option names, before anything is read; nothing of an empty name. Throws InputError for another ending,
/// and for one of the files to read.
std::optional<raycontact::output::OutFile> claim(const std::vector<std::string>& read, const std::string& option,
                                                 const std::string& name, const std::string& ending);

/// Says on standard error, if there are any, what runs that were ended left.
void name_left_overs(const std::vector<std::filesystem::path>& files);
