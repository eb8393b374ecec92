// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/mesh.h>

#include <CLI/CLI.hpp>

#include <optional>
#include <string_view>

/// Adds --nested; empty where it is not given. `nesting` is filled while the command line is read and must outlive it.
CLI::Option* add_nested_option(CLI::App& command, std::optional<raycontact::Nesting>& nesting);

/// The option's word.
std::string_view word_of(raycontact::Nesting nesting);
