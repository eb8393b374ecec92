// SPDX-License-Identifier: Apache-2.0
#include <scenes/models/bunny.h>

#include <raycontact/error.h>
#include <scenes/models/cache.h>
#include <scenes/models/procedural.h>
#include <scenes/models/simplify.h>

#include <meshoptimizer.h>

#include <cstdio>

namespace raycontact::scenes {
namespace {

/// Raised whenever the way from the file to the mesh changes, so that no cache holds a mesh made the old way.
constexpr int recipe = 2;

std::filesystem::path cached_name(std::uint64_t content, std::uint32_t triangles) {
    char name[96];
    std::snprintf(name, sizeof name, "bunny-%u-%016llx-meshopt%d-r%d.mesh", triangles,
                  static_cast<unsigned long long>(content), MESHOPTIMIZER_VERSION, recipe);
    return name;
}

Model described(Mesh mesh) {
    const std::string text = "the Stanford bunny of Debian's package glmark2-data, reduced by meshoptimizer to "
                             + std::to_string(mesh.vertices.size()) + " vertices and "
                             + std::to_string(mesh.triangles.size())
                             + " triangles (a stand-in for the mesh of the paper, which is not available)";
    mesh.name = "bunny-" + std::to_string(mesh.triangles.size());
    return {std::move(mesh), text, false};
}

} // namespace

std::filesystem::path bunny_file() {
    return "/usr/share/glmark2/models/bunny.obj";
}

std::optional<Model> reduced_bunny(const std::filesystem::path& file, std::uint32_t triangles, std::string& why_not) {
    const auto content = hash_of_file(file);
    if (!content) {
        why_not = file.string() + " is not there (Debian package glmark2-data)";
        return std::nullopt;
    }
    const std::filesystem::path folder = cache_folder();
    const std::filesystem::path cached = folder.empty() ? folder : folder / cached_name(*content, triangles);
    if (!cached.empty())
        if (auto mesh = read_cached(cached); mesh && mesh->triangles.size() == triangles)
            return described(std::move(*mesh));
    try {
        auto mesh = simplify_to(prepare_mesh(load_mesh(file)), triangles);
        if (mesh) normalise(*mesh);
        if (!mesh || !sound(prepare_mesh(*mesh, {.repair = Repair::as_is}).report)) { // once more: normalise rounds
            why_not = "no reduction of " + file.string() + " to " + std::to_string(triangles)
                      + " triangles passed the checks";
            return std::nullopt;
        }
        if (!cached.empty()) write_cached(cached, *mesh);
        return described(std::move(*mesh));
    } catch (const InputError& error) {
        why_not = error.what();
        return std::nullopt;
    }
}

} // namespace raycontact::scenes
