// SPDX-License-Identifier: Apache-2.0
#include "arrays.h"
#include "bind.h"
#include "without_gil.h"

#include <raycontact/assembly.h>
#include <raycontact/error.h>
#include <raycontact/mesh.h>

#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <cstddef>
#include <span>
#include <string_view>
#include <type_traits>
#include <utility>

namespace raycontact::python {

namespace {

MeshFormat format_from(std::string_view word) {
    using enum MeshFormat;
    for (const auto& [name, format] : {std::pair<std::string_view, MeshFormat>{"obj", obj},
                                       {"stl", stl},
                                       {"ply", ply},
                                       {"off", off},
                                       {"gltf", gltf},
                                       {"glb", glb},
                                       {"3mf", threemf}})
        if (word == name) return format;
    throw InputError("format \"" + std::string(word) + "\" is not known; give obj, stl, ply, off, gltf, glb or 3mf");
}

/// Each of a report, in order. One that is added does not compile before it is named here.
template <typename Report, typename Visit>
void for_each_field(Report& report, const Visit& visit) {
    auto& [vertices, triangles, file_vertices, file_triangles, closed, solid, border_edges, holes, spanning, manifold,
           oriented, checked, self_intersecting, outward, components, volume, area, box_min, box_max, repairs] = report;
    visit(vertices), visit(triangles), visit(file_vertices), visit(file_triangles), visit(closed), visit(solid);
    visit(border_edges), visit(holes), visit(spanning), visit(manifold), visit(oriented), visit(checked);
    visit(self_intersecting), visit(outward), visit(components), visit(volume), visit(area);
    for (auto* corner : {&box_min, &box_max}) visit(corner->x), visit(corner->y), visit(corner->z);
    visit(repairs);
}

nb::tuple state_of(const MeshReport& report) {
    nb::list state;
    for_each_field(report, [&](const auto& field) { state.append(nb::cast(field)); });
    return nb::tuple(state);
}

void set_state(MeshReport& made, const nb::tuple& state) {
    MeshReport report;
    std::size_t count = 0, at = 0;
    for_each_field(report, [&](auto&) { ++count; });
    if (state.size() != count) throw InputError("MeshReport: the pickle is of another version; make the shape anew");
    for_each_field(report,
                   [&](auto& field) { field = nb::cast<std::remove_reference_t<decltype(field)>>(state[at++]); });
    new (&made) MeshReport(std::move(report));
}

void bind_report(nb::module_& m) {
    nb::class_<MeshReport>(m, "MeshReport", "What a mesh is, after the repairs it names.")
        .def_ro("vertices", &MeshReport::vertices, "distinct positions in use by a triangle")
        .def_ro("triangles", &MeshReport::triangles, "kept")
        .def_ro("file_vertices", &MeshReport::file_vertices, "as given")
        .def_ro("file_triangles", &MeshReport::file_triangles, "as given, polygons split")
        .def_ro("closed", &MeshReport::closed, "every edge has a triangle on both sides")
        .def_ro("solid", &MeshReport::solid, "has an inside: closed, oriented, and it holds something")
        .def_ro("border_edges", &MeshReport::border_edges, "edges met an odd number of times; 0: closed")
        .def_ro("holes", &MeshReport::holes, "spanned ones")
        .def_prop_ro("kind", &kind_of, "'solid', 'solid with holes' or 'sheet'")
        .def_ro("spanning", &MeshReport::spanning, "triangles that span them: not in the file, numbered after its own")
        .def_ro("manifold", &MeshReport::manifold, "no edge has more than two triangles, no vertex more than one fan")
        .def_ro("oriented", &MeshReport::oriented, "across every shared edge the two triangles wind the same way")
        .def_ro("self_intersecting", &MeshReport::self_intersecting,
                "two triangles meet elsewhere than in their shared vertices or edge")
        .def_ro("outward", &MeshReport::outward, "closed and oriented, its normals pointing out everywhere")
        .def_ro("components", &MeshReport::components, "connected over shared vertices")
        .def_ro("volume", &MeshReport::volume, "m^3, signed; 0 unless solid")
        .def_ro("area", &MeshReport::area, "m^2")
        .def_ro("repairs", &MeshReport::repairs, "in words with counts; empty when nothing was changed")
        .def_prop_ro(
            "good", [](const MeshReport& report) { return verdict_of(report).good; },
            "contacts with the mesh are what the rule of contact says")
        .def_prop_ro(
            "verdict", [](const MeshReport& report) { return verdict_of(report).text; },
            "one line: \"good for contacts\", or what is wrong and what to do")
        .def(
            "to_json", [](const MeshReport& report) { return to_json(report); },
            "The JSON of `raycontact mesh --json`.")
        .def("__getstate__", &state_of)
        .def("__setstate__", &set_state)
        .def("__repr__",
             [](const MeshReport& report) {
                 return "<MeshReport: " + std::to_string(report.triangles) + " triangles, " + verdict_of(report).text
                        + ">";
             })
        .def("__str__", [](const MeshReport& report) { return to_text(report); });
}

} // namespace

void bind_mesh(nb::module_& m) {
    bind_report(m);
    nb::class_<Mesh>(m, "Mesh")
        .def_ro("name", &Mesh::name)
        .def_ro("repairs", &Mesh::repairs)
        .def_prop_ro(
            "vertices",
            [](nb::handle_t<Mesh> self) {
                const auto& list = nb::cast<const Mesh&>(self).vertices;
                return view_of(reinterpret_cast<const double*>(list.data()), {list.size(), 3}, self);
            },
            nb::rv_policy::automatic)
        .def_prop_ro(
            "triangles",
            [](nb::handle_t<Mesh> self) {
                const auto& list = nb::cast<const Mesh&>(self).triangles;
                return view_of(reinterpret_cast<const std::uint32_t*>(list.data()), {list.size(), 3}, self);
            },
            nb::rv_policy::automatic);
    m.def(
        "load_mesh", [](const std::filesystem::path& file) { return load_mesh(file); }, "file"_a,
        nb::call_guard<WithoutGil>());
    m.def(
        "parse_mesh",
        [](const nb::bytes& bytes, const std::string& format, const std::string& name) {
            const std::span all(static_cast<const std::byte*>(bytes.data()), bytes.size());
            const MeshFormat read_as = format_from(format);
            const WithoutGil without_gil;
            return load_mesh(all, read_as, name);
        },
        "data"_a, "format"_a, "name"_a);
    m.def(
        "make_mesh",
        [](const Points& vertices, const Corners& triangles, const std::string& name,
           const std::vector<std::string>& repairs) {
            const WithoutGil without_gil;
            Mesh mesh = make_mesh(std::span(vertices.data(), vertices.size()),
                                  std::span(triangles.data(), triangles.size()), name);
            mesh.repairs = repairs;
            return mesh;
        },
        "vertices"_a, "triangles"_a, "name"_a, "repairs"_a);
    m.def(
        "weld_mesh", [](const Mesh& mesh, double length) { return weld_mesh(mesh, length); }, "mesh"_a, "length"_a,
        nb::call_guard<WithoutGil>());
    m.def(
        "load_assembly",
        [](const std::filesystem::path& file) {
            std::vector<AssemblyPart> parts;
            std::vector<std::string> left_out;
            {
                const WithoutGil without_gil;
                parts = load_assembly(file, &left_out);
            }
            nb::list list;
            for (const AssemblyPart& part : parts)
                list.append(
                    nb::make_tuple(part.name, std::const_pointer_cast<Mesh>(part.mesh), matrices_of({&part.pose, 1})));
            return nb::make_tuple(list, left_out);
        },
        "file"_a);
}

} // namespace raycontact::python
