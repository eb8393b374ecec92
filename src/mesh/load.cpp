// SPDX-License-Identifier: Apache-2.0
#include <raycontact/mesh.h>

#include "mesh/check.h"
#include "mesh/input_file.h"

#include <raycontact/error.h>

#include <array>
#include <memory>
#include <string>
#include <string_view>

namespace raycontact {

namespace {

/// In the order of MeshFormat.
struct Format {
    std::string_view ending;
    Mesh (*read)(const InputFile&);
    std::vector<AssemblyPart> (*read_parts)(const InputFile&, std::vector<std::string>&) = nullptr;
};
constexpr std::array formats{Format{".obj", &read_obj, &read_obj_parts},
                             Format{".stl", &read_stl, &read_stl_parts},
                             Format{".ply", &read_ply},
                             Format{".off", &read_off},
                             Format{".gltf", &read_gltf, &read_gltf_parts},
                             Format{".glb", &read_gltf, &read_gltf_parts},
                             Format{".3mf", &read_3mf, &read_3mf_parts}};

constexpr const char* if_3mf([[maybe_unused]] const char* words) {
#ifdef RAYCONTACT_3MF
    return words;
#else
    return "";
#endif
}

const Format& format_of(const InputFile& file) {
    const std::string ending = lower_case(file.path.extension().string());
    for (const Format& format : formats)
        if (ending == format.ending) return format;
    if (ending == ".dae")
        file.fail("COLLADA (.dae) is not read; save it as .glb or .obj, or in Python, with trimesh and pycollada: "
                  "raycontact.Mesh(trimesh.load(file, force=\"mesh\"))");
    file.fail("unknown ending " + in_quotes(ending) + "; known are .obj .stl .ply .off .gltf .glb" + if_3mf(" .3mf"));
}

Mesh read_mesh(const Format& format, const InputFile& file, const std::string& name) {
    Mesh mesh = format.read(file);
    check_mesh(mesh, file.shown);
    mesh.name = printable(name);
    return mesh;
}

template <class Real>
Mesh mesh_of(std::span<const Real> coordinates, std::span<const std::uint32_t> corners, const std::string& given) {
    const std::string name = given.empty() ? "mesh" : printable(given);
    const auto check_threes = [&](std::size_t count, const char* what) {
        if (count % 3 == 0) return;
        throw InputError(name + ": " + std::to_string(count) + " " + what
                         + ", not a multiple of 3; give three of each");
    };
    check_threes(coordinates.size(), "coordinates");
    check_threes(corners.size(), "corners");
    Mesh mesh;
    mesh.name = printable(given);
    mesh.vertices.reserve(coordinates.size() / 3);
    mesh.triangles.reserve(corners.size() / 3);
    for (std::size_t i = 0; i < coordinates.size(); i += 3)
        mesh.vertices.push_back({double(coordinates[i]), double(coordinates[i + 1]), double(coordinates[i + 2])});
    for (std::size_t i = 0; i < corners.size(); i += 3)
        mesh.triangles.push_back({corners[i], corners[i + 1], corners[i + 2]});
    check_mesh(mesh, name);
    return mesh;
}

} // namespace

Mesh load_mesh(const std::filesystem::path& path) {
    const InputFile file = InputFile::read(path);
    return read_mesh(format_of(file), file, path.filename().string());
}

Mesh load_mesh(std::span<const std::byte> bytes, MeshFormat format, const std::string& name) {
    InputFile file{{}, name.empty() ? "mesh" : printable(name), {}};
    const auto index = static_cast<std::size_t>(format);
    if (index >= formats.size()) file.fail("unknown format; take one of MeshFormat");
    if (bytes.empty()) file.fail("is empty; give the bytes of a whole file");
    file.bytes.assign(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    return read_mesh(formats[index], file, name);
}

Mesh make_mesh(std::span<const double> coordinates, std::span<const std::uint32_t> corners, const std::string& name) {
    return mesh_of(coordinates, corners, name);
}

Mesh make_mesh(std::span<const float> coordinates, std::span<const std::uint32_t> corners, const std::string& name) {
    return mesh_of(coordinates, corners, name);
}

std::vector<AssemblyPart> load_assembly(const std::filesystem::path& path, std::vector<std::string>* left_out) {
    const InputFile file = InputFile::read(path);
    const Format& format = format_of(file);
    std::vector<AssemblyPart> parts;
    Mesh others; // what is said of what is no part
    if (format.read_parts != nullptr) {
        parts = format.read_parts(file, others.repairs);
    } else {
        auto mesh = std::make_shared<const Mesh>(read_mesh(format, file, path.filename().string()));
        others.repairs = mesh->repairs;
        parts.push_back({mesh->name, std::move(mesh), {}});
    }
    if (parts.empty()) check_mesh(others, file.shown);
    for (AssemblyPart& part : parts) {
        check_mesh(*part.mesh, file.shown + ": " + part.name);
        part.file = path.string();
    }
    if (left_out != nullptr) *left_out = std::move(others.repairs);
    return parts;
}

} // namespace raycontact
