// SPDX-License-Identifier: Apache-2.0
#include "arrays.h"
#include "bind.h"
#include "without_gil.h"

#include <raycontact/error.h>
#include <raycontact/primitives.h>
#include <raycontact/shape.h>

#include <nanobind/stl/optional.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace raycontact::python {

namespace {

Nesting nesting_from(std::string_view word) {
    if (word == "as_wound") return Nesting::as_wound;
    if (word == "cavities") return Nesting::cavities;
    if (word == "solids") return Nesting::solids;
    throw InputError("nesting \"" + std::string(word) + "\" is not known; give as_wound, cavities or solids");
}

Overlaps overlaps_from(std::string_view word) {
    if (word == "unite") return Overlaps::unite;
    if (word == "leave") return Overlaps::leave;
    throw InputError("overlaps \"" + std::string(word) + "\" is not known; give unite or leave");
}

Holes holes_from(std::string_view word) {
    if (word == "of_solids") return Holes::of_solids;
    if (word == "of_all") return Holes::of_all;
    if (word == "none") return Holes::none;
    throw InputError("holes \"" + std::string(word) + "\" is not known; give of_solids, of_all or none");
}

// Arrays show the shape's own memory and keep the shape alive.
template <typename Number, std::size_t Columns, auto Get>
ReadOnlyArray view(nb::handle_t<Shape> self) {
    const auto list = (nb::cast<const Shape&>(self).*Get)();
    const auto* data = reinterpret_cast<const Number*>(list.data());
    if constexpr (Columns == 1)
        return view_of(data, {list.size()}, self);
    else
        return view_of(data, {list.size(), Columns}, self);
}

nb::tuple three(const Vec3& v) {
    return nb::make_tuple(v.x, v.y, v.z);
}

nb::bytes save(const Shape& shape) {
    std::vector<std::byte> bytes;
    {
        const WithoutGil without_gil;
        bytes = shape.save();
    }
    return nb::bytes(reinterpret_cast<const char*>(bytes.data()), bytes.size());
}

std::shared_ptr<Shape> load(const nb::bytes& data) {
    const auto bytes = std::as_bytes(std::span(data.c_str(), data.size()));
    const WithoutGil without_gil;
    return std::const_pointer_cast<Shape>(Shape::load(bytes));
}

} // namespace

void bind_shape(nb::module_& m) {
    nb::class_<Shape>(m, "Shape")
        .def_prop_ro("name", &Shape::name)
        .def_prop_ro("report", &Shape::report, nb::rv_policy::reference_internal)
        .def_prop_ro("has_inside", &Shape::has_inside)
        .def(
            "prepare", [](const Shape& shape, std::uint32_t threads) { shape.prepare(threads); }, "threads"_a,
            nb::call_guard<WithoutGil>())
        .def_prop_ro("is_prepared", &Shape::is_prepared)
        .def("save", &save)
        .def_prop_ro("vertices", &view<double, 3, &Shape::file_vertices>, nb::rv_policy::automatic)
        .def_prop_ro("triangles", &view<std::uint32_t, 3, &Shape::triangles>, nb::rv_policy::automatic)
        .def_prop_ro("vertex_index", &view<std::uint32_t, 1, &Shape::vertex_index>, nb::rv_policy::automatic)
        .def_prop_ro("triangle_index", &view<std::uint32_t, 1, &Shape::triangle_index>, nb::rv_policy::automatic)
        .def_prop_ro("vertex_normals", &view<double, 3, &Shape::vertex_normals>, nb::rv_policy::automatic)
        .def_prop_ro("vertex_areas", &view<float, 1, &Shape::vertex_areas>, nb::rv_policy::automatic)
        .def_prop_ro("exit_distances", &view<float, 1, &Shape::exit_distances>, nb::rv_policy::automatic)
        .def_prop_ro("round",
                     [](const Shape& shape) -> std::optional<nb::tuple> {
                         const Round* round = shape.round();
                         if (round == nullptr) return std::nullopt;
                         return nb::make_tuple(three(round->from), three(round->to), round->radius);
                     })
        .def_prop_ro("radius", &Shape::radius)
        .def_prop_ro("longest_edge", &Shape::longest_edge)
        .def_prop_ro("memory_bytes", &Shape::memory_bytes)
        .def_prop_ro("mass", [](const Shape& shape) {
            // Of a mesh without an inside the sums mean nothing.
            const bool holds = shape.report().volume != 0;
            const Mass mass = shape.round() != nullptr ? mass_of(*shape.round())
                              : holds                  ? mass_of(shape.file_vertices(), shape.triangles())
                                                       : Mass{};
            return nb::make_tuple(mass.volume, three(mass.centre),
                                  array_of(std::vector<double>(mass.inertia.begin(), mass.inertia.end()), {3, 3}));
        });
    m.def(
        "make_shape",
        [](const Mesh& mesh, bool repair, const std::string& nesting, const std::string& holes,
           const std::string& overlaps, std::uint32_t threads) {
            const PrepareOptions options{.repair = repair ? Repair::allowed : Repair::as_is,
                                         .nesting = nesting_from(nesting),
                                         .holes = holes_from(holes),
                                         .overlaps = overlaps_from(overlaps),
                                         .threads = threads};
            const WithoutGil without_gil;
            return std::const_pointer_cast<Shape>(Shape::make(prepare_mesh(mesh, options), threads));
        },
        "mesh"_a, "repair"_a, "nesting"_a, "holes"_a, "overlaps"_a, "threads"_a);
    m.def(
        "make_ball", [](double radius) { return std::const_pointer_cast<Shape>(make_ball(radius)); }, "radius"_a);
    m.def(
        "make_capsule",
        [](double radius, double half_length) {
            return std::const_pointer_cast<Shape>(make_capsule(radius, half_length));
        },
        "radius"_a, "half_length"_a);
    m.def(
        "make_plane",
        [](double half_extent, double thickness) {
            return std::const_pointer_cast<Shape>(make_plane(half_extent, thickness));
        },
        "half_extent"_a, "thickness"_a);
    m.def("load_shape", &load, "data"_a);
}

} // namespace raycontact::python
