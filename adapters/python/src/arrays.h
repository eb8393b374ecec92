// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/body_id.h>
#include <raycontact/pose.h>
#include <raycontact/vector.h>

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

namespace raycontact::python {

namespace nb = nanobind;
using namespace nanobind::literals;

// What the Python half of the package hands over: contiguous, of these types, in memory of the host. It makes them of
// whatever users give and says what is wrong with that; a caller of this half gets nanobind's TypeError.
using Matrices = nb::ndarray<const double, nb::shape<-1, 4, 4>, nb::c_contig, nb::device::cpu>;
using Points = nb::ndarray<const double, nb::shape<-1, 3>, nb::c_contig, nb::device::cpu>;
using Corners = nb::ndarray<const std::uint32_t, nb::shape<-1, 3>, nb::c_contig, nb::device::cpu>;
using Ids = nb::ndarray<const std::int64_t, nb::shape<-1>, nb::c_contig, nb::device::cpu>;
using Pairs = nb::ndarray<const std::int64_t, nb::shape<-1, 2>, nb::c_contig, nb::device::cpu>;

/// A NumPy array of a type that is chosen at run time.
using Array = nb::ndarray<nb::numpy>;
using ReadOnlyArray = nb::ndarray<nb::numpy, nb::ro>;

/// The array owns the numbers.
template <typename Number>
Array array_of(std::vector<Number>&& numbers, std::initializer_list<std::size_t> shape) {
    auto own = std::make_unique<std::vector<Number>>(std::move(numbers));
    Number* data = own->data();
    const nb::capsule owner(own.release(),
                            [](void* given) noexcept { delete static_cast<std::vector<Number>*>(given); });
    return Array(data, shape.size(), shape.begin(), owner, nullptr, nb::dtype<Number>());
}

/// Shows memory of `owner` and keeps that alive.
template <typename Number>
ReadOnlyArray view_of(const Number* data, std::initializer_list<std::size_t> shape, nb::handle owner) {
    return ReadOnlyArray(data, shape.size(), shape.begin(), owner, nullptr, nb::dtype<Number>());
}

// An id as one number: the generation in the upper half. Ids of scenes that remove nothing count from 0.
inline std::int64_t number_of(BodyId id) {
    return static_cast<std::int64_t>(std::uint64_t{id.generation} << 32 | id.slot);
}
inline BodyId id_of(std::int64_t number) {
    const auto bits = static_cast<std::uint64_t>(number);
    return {static_cast<std::uint32_t>(bits), static_cast<std::uint32_t>(bits >> 32)};
}

/// Of a 4 x 4 matrix, row-major, whose last row was checked. The rotation is taken as it is.
Pose pose_at(const Matrices& matrices, std::size_t i);
std::vector<Pose> poses_of(const Matrices& matrices);
Array matrices_of(std::span<const Pose> poses);

std::vector<Vec3> points_of(const Points& points);

} // namespace raycontact::python
