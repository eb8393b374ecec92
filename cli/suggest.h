// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>

#include <string>

/// What the program was given and does not know, in the order in which it was given, with the nearest name that it
/// knows, where one is near. After a parse that threw CLI::ExtrasError.
std::string what_was_not_expected(const CLI::App& app);
