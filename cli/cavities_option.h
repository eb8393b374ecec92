// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/mesh.h>

#include <CLI/CLI.hpp>

#include <optional>
#include <string_view>

/// Adds --cavities; empty where it is not given. `nesting` is filled while the command line is read and must outlive
/// it.
CLI::Option* add_cavities_option(CLI::App& command, std::optional<raycontact::Nesting>& nesting);

/// The option's word: "make" or "undo".
std::string_view cavities_word(raycontact::Nesting nesting);
