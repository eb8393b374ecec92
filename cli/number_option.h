// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/error.h>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <charconv>
#include <concepts>
#include <optional>
#include <string>

/// The number that the whole word is, in decimal whatever it begins with; nothing where it is none, or beyond what
/// fits.
template <class Number>
std::optional<Number> read_number(const std::string& word) {
    Number number{};
    const char* const last = word.data() + word.size();
    const auto [end, error] = std::from_chars(word.data(), last, number);
    if (error != std::errc{} || end != last) return std::nullopt;
    return number;
}

/// An option of one number; another word, and one out of range, are bad usage. `target`: a Number, or an optional of
/// one.
template <class Target, class Number>
CLI::Option* add_number(CLI::App& command, const std::string& option, Target& target, const std::string& help,
                        Number least, Number most) {
    CLI::Option* const added = command.add_option_function<std::string>(
        option,
        [=, &target](const std::string& word) {
            const std::optional<Number> number = read_number<Number>(word);
            if (!number || !(*number >= least && *number <= most))
                throw raycontact::InputError(fmt::format("{}: \"{}\" is not a {}number from {} to {}", option, word,
                                                         std::integral<Number> ? "whole " : "", least, most));
            target = *number;
        },
        help);
    if constexpr (std::same_as<Target, Number>) added->default_str(fmt::format("{}", target));
    return added->type_name(std::integral<Number> ? "N" : "METRES");
}
