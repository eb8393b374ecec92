// SPDX-License-Identifier: Apache-2.0
#include "cli/mesh.h"

#include <raycontact/mesh.h>

#include <iostream>
#include <memory>
#include <string>
#include <string_view>

namespace {

struct MeshOptions {
    std::string file;
    bool json = false;
    bool as_is = false;
};

void print_line(std::string_view text) {
    std::cout << text;
    if (!text.ends_with('\n')) std::cout << '\n';
}

} // namespace

void add_mesh(CLI::App& app) {
    CLI::App* command = app.add_subcommand("mesh", "Check a mesh file: OBJ, STL, PLY, OFF, glTF or GLB");
    auto options = std::make_shared<MeshOptions>();
    command->add_option("FILE", options->file, "the mesh file")->required();
    command->add_flag("--json", options->json, "print one JSON object on stdout");
    command->add_flag("--as-is", options->as_is, "report the mesh as the file gives it, repair nothing");
    command->callback([options] {
        using namespace raycontact;
        const PreparedMesh mesh =
            prepare_mesh(load_mesh(options->file), options->as_is ? Repair::as_is : Repair::allowed);
        print_line(options->json ? to_json(mesh.report) : to_text(mesh.report));
    });
}
