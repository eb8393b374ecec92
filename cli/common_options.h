// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/settings.h>

#include <CLI/CLI.hpp>

#include <string>
#include <string_view>

/// Adds --method --caster --direction --devices --threads to a subcommand; `settings` is filled while the command line
/// is read and must outlive it. A word that is not known is bad usage: InputError naming the option.
void add_common_options(CLI::App& command, raycontact::Settings& settings);

/// What `--devices` asks for, as Settings::device wants it. Throws InputError for a list that is malformed, names a
/// device twice or beside its own part, or needs more than this version has.
std::string device_from_list(std::string_view list);
