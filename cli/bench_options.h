// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>

#include <iostream>
#include <string>
#include <type_traits>

#include <unistd.h>

// What the subcommands of `bench` share.

/// One line that says what is being done, on a terminal only.
inline void tell(const std::string& what) {
    if (isatty(STDERR_FILENO)) std::cerr << "\r\033[K" << what << std::flush;
}

template <class Number>
void add_number(CLI::App& command, const std::string& name, Number& value, const std::string& help, Number least,
                Number most) {
    command.add_option(name, value, help)
        ->type_name(std::is_integral_v<Number> ? "N" : "METRES")
        ->capture_default_str()
        ->check(CLI::Range(least, most));
}
