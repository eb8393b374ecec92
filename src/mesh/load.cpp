// SPDX-License-Identifier: Apache-2.0
#include <raycontact/mesh.h>

#include "mesh/check.h"
#include "mesh/input_file.h"

#include <array>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

namespace raycontact {

Mesh load_mesh(const std::filesystem::path& path) {
    const std::string ending = lower_case(path.extension().string());
    using Format = std::pair<std::string_view, Mesh (*)(const InputFile&)>;
    constexpr std::array formats{Format{".obj", &read_obj}, Format{".stl", &read_stl},   Format{".ply", &read_ply},
                                 Format{".off", &read_off}, Format{".gltf", &read_gltf}, Format{".glb", &read_gltf}};
    const InputFile file = InputFile::read(path);
    for (const auto& [known, read] : formats) {
        if (ending != known) continue;
        Mesh mesh = read(file);
        check_mesh(mesh, file.shown);
        mesh.name = printable(path.filename().string());
        return mesh;
    }
    file.fail("unknown ending " + in_quotes(ending) + "; known are .obj .stl .ply .off .gltf .glb");
}

std::vector<AssemblyPart> load_assembly(const std::filesystem::path& path) {
    const std::string ending = lower_case(path.extension().string());
    if (ending != ".gltf" && ending != ".glb") {
        auto mesh = std::make_shared<const Mesh>(load_mesh(path));
        std::string name = mesh->name;
        return {{std::move(name), std::move(mesh), {}}};
    }
    const InputFile file = InputFile::read(path);
    std::vector<AssemblyPart> parts = read_gltf_parts(file);
    if (parts.empty()) check_mesh({}, file.shown);
    for (const AssemblyPart& part : parts) check_mesh(*part.mesh, file.shown + ": " + part.name);
    return parts;
}

} // namespace raycontact
