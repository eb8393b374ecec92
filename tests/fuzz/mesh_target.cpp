// SPDX-License-Identifier: Apache-2.0
// A mesh file in memory: read, checked and prepared as load_mesh and Shape::make do it. RAYCONTACT_FUZZ_READER is the
// reader, RAYCONTACT_FUZZ_FILE the file's name.
#include "fuzz/input.h"
#include "temporary_folder.h"
#include "tests/unit/mesh/formats.h"
#include "tests/unit/mesh/packages.h"
#include "tests/unit/mesh/solids.h"

#include "mesh/check.h"
#include "mesh/components.h"
#include "mesh/input_file.h"
#include "mesh/split.h"

#include <raycontact/mesh.h>
#include <raycontact/shape.h>

#include <string>
#include <string_view>
#include <vector>

using namespace raycontact;

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const TemporaryFolder folder;
    // A glTF file may name it.
    static const auto buffer = folder.write("m.bin", test::gltf_buffer(test::torus(6, 4, 1, 0.3)));
    fuzz::taken([&] {
        InputFile file{folder.path() / RAYCONTACT_FUZZ_FILE, RAYCONTACT_FUZZ_FILE,
                       std::string(reinterpret_cast<const char*>(data), size)};
        if (size == 0) return; // InputFile::read refuses it
        constexpr std::string_view name = RAYCONTACT_FUZZ_FILE;
        // Most changes to a package end at a checksum: what is none is the model in one.
        if constexpr (name.ends_with(".3mf"))
            if (!file.bytes.starts_with("PK")) file.bytes = test::zip_of(test::parts_3mf(file.bytes), false);
        const Mesh mesh = RAYCONTACT_FUZZ_READER(file);
        check_mesh(mesh, file.shown);
        if constexpr (!name.ends_with(".ply") && !name.ends_with(".off")) {
            constexpr auto read_parts = name.ends_with(".gltf")  ? &read_gltf_parts
                                        : name.ends_with(".3mf") ? &read_3mf_parts
                                        : name.ends_with(".obj") ? &read_obj_parts
                                                                 : &read_stl_parts;
            std::size_t triangles = 0;
            std::vector<std::string> left_out;
            for (const AssemblyPart& part : read_parts(file, left_out)) {
                check_mesh(*part.mesh, part.name);
                triangles += part.mesh->triangles.size();
            }
            if (triangles != mesh.triangles.size()) fuzz::fail("parts that are not the whole");
        }
        if (mesh.triangles.size() > 4000) return; // the fuzzer is to try many files, not large ones
        const PreparedMesh prepared = prepare_mesh(mesh);
        to_json(prepared.report);
        to_text(prepared.report);
        for (const auto& triangle : prepared.triangles)
            for (const std::uint32_t vertex : triangle)
                if (vertex >= prepared.vertices.size()) fuzz::fail("a vertex that is none");
        const auto components = find_components(mesh, 1);
        if (components)
            for (const std::uint32_t component : components->of)
                if (component >= components->count && component != in_none) fuzz::fail("a component that is none");
        if (prepared.triangles.size() <= 64) Shape::make(prepared);
    });
    return 0;
}
