// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "arrays.h"

#include <raycontact/query.h>

#include <cstdint>
#include <initializer_list>
#include <limits>
#include <utility>
#include <vector>

namespace raycontact::python {

/// How many items lists of these sizes make: one of a thing counts for all items. Throws InputError where sizes differ.
std::size_t items_of(std::initializer_list<std::pair<const char*, std::size_t>> lists);

/// One for all items, or one for each.
template <typename List>
const auto& of_item(const List& list, std::size_t i) {
    return list[list.size() == 1 ? 0 : i];
}

/// Points or directions of each item, (n, 3); not numbers where there is none.
class VectorColumn {
public:
    explicit VectorColumn(std::size_t count) : numbers_(3 * count, std::numeric_limits<double>::quiet_NaN()) {}
    void set(std::size_t i, const Vec3& v) {
        numbers_[3 * i] = v.x;
        numbers_[3 * i + 1] = v.y;
        numbers_[3 * i + 2] = v.z;
    }
    Array take() {
        const std::size_t count = numbers_.size() / 3;
        return array_of(std::move(numbers_), {count, 3});
    }

private:
    std::vector<double> numbers_;
};

/// A number of each item, (n,).
template <typename Number>
class NumberColumn {
public:
    NumberColumn(std::size_t count, Number none) : numbers_(count, none) {}
    void set(std::size_t i, Number number) { numbers_[i] = number; }
    Array take() {
        const std::size_t count = numbers_.size();
        return array_of(std::move(numbers_), {count});
    }

private:
    std::vector<Number> numbers_;
};

/// Lengths; infinite where there is none.
struct LengthColumn : NumberColumn<double> {
    explicit LengthColumn(std::size_t count) : NumberColumn(count, any_distance) {}
};
/// Indices in the mesh, or ids; -1 where there is none.
struct IndexColumn : NumberColumn<std::int64_t> {
    explicit IndexColumn(std::size_t count) : NumberColumn(count, -1) {}
    void set_triangle(std::size_t i, std::uint32_t triangle) {
        set(i, triangle == Shape::no_triangle ? -1 : std::int64_t{triangle});
    }
};
/// Answers, as bytes that Python sees as bool.
struct AnswerColumn : NumberColumn<std::uint8_t> {
    explicit AnswerColumn(std::size_t count) : NumberColumn(count, 0) {}
};

/// What rays meet: distance, point, normal, triangle.
struct RayHitColumns {
    LengthColumn distance;
    VectorColumn point, normal;
    IndexColumn triangle;
    explicit RayHitColumns(std::size_t count) : distance(count), point(count), normal(count), triangle(count) {}
    void set(std::size_t i, const RayHit& hit);
    nb::tuple take();
};

/// What of two meshes is nearest: distance, both points, both triangles.
struct DistanceColumns {
    LengthColumn distance;
    VectorColumn point_a, point_b;
    IndexColumn triangle_a, triangle_b;
    explicit DistanceColumns(std::size_t count)
        : distance(count), point_a(count), point_b(count), triangle_a(count), triangle_b(count) {}
    void set(std::size_t i, const Distance& found);
    nb::tuple take();
};

/// When two meshes meet: time, distance, both points, normal, both triangles.
struct ImpactColumns {
    LengthColumn time, distance;
    VectorColumn point_a, point_b, normal;
    IndexColumn triangle_a, triangle_b;
    explicit ImpactColumns(std::size_t count)
        : time(count), distance(count), point_a(count), point_b(count), normal(count), triangle_a(count),
          triangle_b(count) {}
    void set(std::size_t i, const Impact& found);
    nb::tuple take();
};

/// What is nearest to points: distance, point, triangle.
struct ClosestPointColumns {
    LengthColumn distance;
    VectorColumn point;
    IndexColumn triangle;
    explicit ClosestPointColumns(std::size_t count) : distance(count), point(count), triangle(count) {}
    void set(std::size_t i, const ClosestPoint& found);
    nb::tuple take();
};

} // namespace raycontact::python
