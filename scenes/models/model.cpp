// SPDX-License-Identifier: Apache-2.0
#include <scenes/models/model.h>

#include <raycontact/error.h>
#include <scenes/models/bunny.h>
#include <scenes/models/procedural.h>

namespace raycontact::scenes {
namespace {

Model procedural(Mesh mesh, const char* what) {
    const std::string text = std::string("a procedural ") + what + " of " + std::to_string(mesh.vertices.size())
                             + " vertices and " + std::to_string(mesh.triangles.size()) + " triangles";
    return {std::move(mesh), text, false};
}

} // namespace

Model scene_model(std::string_view kind, std::uint32_t triangles) {
    if (kind == "hare") return procedural(hare(triangles), "hare");
    if (kind == "knot") return procedural(knot(triangles), "trefoil knot");
    if (kind == "gear") return procedural(gear(triangles), "gear");
    if (kind == "star") return procedural(star(triangles), "star of six arms");
    if (kind == "torus") return procedural(bumpy_torus(triangles), "bumpy torus");
    if (kind == "sphere") return procedural(bumpy_sphere(triangles), "bumpy sphere");
    if (kind != "bunny")
        throw InputError("model \"" + std::string(kind)
                         + "\" is not known; known are bunny, hare, knot, gear, torus, star, sphere");
    std::string why_not;
#ifdef RAYCONTACT_MESHOPTIMIZER
    if (triangles % 2 == 0 && triangles >= 60 && triangles <= 60'000)
        if (auto bunny = reduced_bunny(bunny_file(), triangles, why_not)) return std::move(*bunny);
    if (why_not.empty()) why_not = "a bunny has an even number of triangles from 60 to 60000";
#else
    why_not = "this program was built without meshoptimizer";
#endif
    // As lumpy as a bunny and without a hole: what comes closest to it in a pile.
    Model model = procedural(bumpy_sphere(triangles), "bumpy sphere");
    model.source += ", standing in for the Stanford bunny: " + why_not;
    model.stand_in = true;
    return model;
}

Mesh stood_up(Mesh mesh) {
    for (Vec3& v : mesh.vertices) v = {v.x, -v.z, v.y};
    return mesh;
}

} // namespace raycontact::scenes
