// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/settings.h>
#include <raycontact/shape.h>

#include <CLI/CLI.hpp>

#include <string>
#include <string_view>

/// Adds --method --caster --direction, the thresholds, --devices and --threads to a subcommand; `settings` is filled
/// while the command line is read and must outlive it. A word or value that makes no sense by itself is bad usage:
/// InputError naming the option.
void add_common_options(CLI::App& command, raycontact::Settings& settings);
/// --speculative, which settings have already or not.
void add_speculative_option(CLI::App& command, raycontact::Settings& settings);

/// The same for values that make no sense together; for the command to call once all are known.
void check_common_options(const raycontact::Settings& settings);

/// Says on stderr that a mesh has edges so long that, with Features::vertices, they can cross another mesh unseen.
void warn_if_coarse(const raycontact::Shape& shape, const raycontact::Settings& settings);

/// What decides the contacts is the recording's unless the command line says otherwise; where they are found is ours.
/// Throws InputError when the two together make no sense.
raycontact::Settings recorded_unless_given(const CLI::App& command, const raycontact::Settings& given,
                                           const raycontact::Settings& recorded);
