// SPDX-License-Identifier: Apache-2.0
#include "arrays.h"

namespace raycontact::python {

Pose pose_at(const Matrices& matrices, std::size_t i) {
    const double* m = matrices.data() + 16 * i;
    return {{m[0], m[1], m[2], m[4], m[5], m[6], m[8], m[9], m[10]}, {m[3], m[7], m[11]}};
}

std::vector<Pose> poses_of(const Matrices& matrices) {
    std::vector<Pose> poses;
    poses.reserve(matrices.shape(0));
    for (std::size_t i = 0; i < matrices.shape(0); ++i) poses.push_back(pose_at(matrices, i));
    return poses;
}

Array matrices_of(std::span<const Pose> poses) {
    std::vector<double> numbers;
    numbers.reserve(16 * poses.size());
    for (const auto& [r, t] : poses)
        numbers.insert(numbers.end(),
                       {r[0], r[1], r[2], t.x, r[3], r[4], r[5], t.y, r[6], r[7], r[8], t.z, 0.0, 0.0, 0.0, 1.0});
    return array_of(std::move(numbers), {poses.size(), 4, 4});
}

std::vector<Vec3> points_of(const Points& points) {
    std::vector<Vec3> list;
    list.reserve(points.shape(0));
    for (std::size_t i = 0; i < points.shape(0); ++i) {
        const double* p = points.data() + 3 * i;
        list.push_back({p[0], p[1], p[2]});
    }
    return list;
}

} // namespace raycontact::python
