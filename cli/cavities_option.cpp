// SPDX-License-Identifier: Apache-2.0
#include "cli/cavities_option.h"

#include <raycontact/error.h>

#include <string>

using raycontact::Nesting;

CLI::Option* add_cavities_option(CLI::App& command, std::optional<Nesting>& nesting) {
    return command
        .add_option_function<std::string>(
            "--cavities",
            [&nesting](const std::string& word) {
                if (word != "make" && word != "undo")
                    throw raycontact::InputError("--cavities: '" + word + "' is unknown; use one of: make, undo");
                nesting = word == "make" ? Nesting::cavities : Nesting::solids;
            },
            "closed parts inside others: make (each becomes a cavity of the part around it, or a solid in a cavity) or "
            "undo (all are solids); without it they stay as the file winds them")
        ->type_name("make|undo");
}

std::string_view cavities_word(Nesting nesting) {
    return nesting == Nesting::cavities ? "make" : "undo";
}
