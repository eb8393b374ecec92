// SPDX-License-Identifier: Apache-2.0
#include "cli/nested_option.h"

#include <raycontact/error.h>

#include <array>
#include <string>
#include <utility>

namespace {

using raycontact::Nesting;

constexpr std::array words{std::pair{Nesting::as_wound, std::string_view("as-wound")},
                           std::pair{Nesting::cavities, std::string_view("cavities")},
                           std::pair{Nesting::solids, std::string_view("solids")}};

} // namespace

CLI::Option* add_nested_option(CLI::App& command, std::optional<Nesting>& nesting) {
    return command
        .add_option_function<std::string>(
            "--nested",
            [&nesting](const std::string& word) {
                for (const auto& [value, name] : words)
                    if (name == word) nesting = value;
                if (!nesting)
                    throw raycontact::InputError("--nested: '" + word
                                                 + "' is unknown; use one of: as-wound, cavities, solids");
            },
            "closed parts inside others: as-wound (as the file has them), cavities (each turned so that it is a cavity "
            "of the part around it, or a solid in a cavity) or solids (all wind outward); default: as-wound")
        ->type_name("WORD");
}

std::string_view word_of(Nesting nesting) {
    for (const auto& [value, name] : words)
        if (value == nesting) return name;
    return "?";
}
