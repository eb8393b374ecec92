// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/error.h>
#include <raycontact/mesh.h>

#include <filesystem>
#include <string>

namespace raycontact::test {

/// What load_mesh() says of a file; "loaded" where it reads it.
inline std::string error_of(const std::filesystem::path& file) {
    try {
        load_mesh(file);
    } catch (const InputError& error) {
        return error.what();
    }
    return "loaded";
}

} // namespace raycontact::test
