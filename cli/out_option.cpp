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

std::optional<raycontact::output::OutFile> claim(const std::vector<std::string>& read, const std::string& option,
                                                 const std::string& name, const std::string& ending) {
    if (name.empty()) return std::nullopt;
    const std::string what = option + " " + name;
    if (!name.ends_with(ending)) throw raycontact::InputError(what + ": give a name that ends in " + ending);
    std::error_code none;
    for (const std::string& file : read)
        if (std::filesystem::equivalent(file, name, none))
            throw raycontact::InputError(what + ": is one of the files to read; give another name");
    return raycontact::output::OutFile(name);
}

void name_left_overs(const std::vector<std::filesystem::path>& files) {
    if (files.empty()) return;
    std::string list;
    for (const auto& file : files) list += (list.empty() ? "" : ", ") + file.string();
    std::cerr << "left by runs that were ended, use or remove: " << list << '\n';
}
