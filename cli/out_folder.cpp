// SPDX-License-Identifier: Apache-2.0
#include "cli/out_folder.h"

#include <raycontact/error.h>

#include <filesystem>
#include <fstream>

using raycontact::InputError;

void make_out_folder(const std::string& folder) {
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    if (error || !std::filesystem::is_directory(folder))
        throw InputError("--out " + folder + ": cannot be made a folder; name another");
    const auto probe = std::filesystem::path(folder) / "steps.csv";
    if (!std::ofstream(probe)) throw InputError(probe.string() + ": cannot be written; name another folder");
}

void write_out(const std::string& folder, const std::string& name, const std::string& text) {
    const auto file = std::filesystem::path(folder) / name;
    std::ofstream out(file, std::ios::binary | std::ios::trunc);
    out << text;
    if (!out.flush()) throw InputError(file.string() + ": cannot be written; is the disk full?");
}
