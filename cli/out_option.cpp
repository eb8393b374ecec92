// SPDX-License-Identifier: Apache-2.0
#include "cli/out_option.h"

#include <raycontact/error.h>

#include <iostream>

CLI::Option* add_out(CLI::App& command, const std::string& option, std::string& name, const std::string& help) {
    return command.add_option_function<std::string>(
        option,
        [option, &name](const std::string& given) {
            if (given.empty()) throw raycontact::InputError(option + ": the name is empty; give one");
            name = given;
        },
        help);
}

void name_left_overs(const std::vector<std::filesystem::path>& files) {
    if (files.empty()) return;
    std::string list;
    for (const auto& file : files) list += (list.empty() ? "" : ", ") + file.string();
    std::cerr << "left by runs that were ended, use or remove: " << list << '\n';
}
