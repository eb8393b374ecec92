// SPDX-License-Identifier: Apache-2.0
#include "read_poses.h"

#include <raycontact/error.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstring>
#include <string>

namespace raycontact {

namespace {

std::size_t numbers_of(PoseForm form) {
    switch (form) {
    case PoseForm::matrix_4x4:
        return 16;
    case PoseForm::matrix_3x4:
        return 12;
    case PoseForm::position_wxyz:
    case PoseForm::position_xyzw:
        return 7;
    }
    throw InputError("pose form " + std::to_string(int(form)) + " is none");
}

Pose pose_of(const double* at, PoseForm form) {
    const Vec3 position{at[0], at[1], at[2]};
    if (form == PoseForm::position_wxyz) return pose_from_quaternion(position, at[3], at[4], at[5], at[6]);
    if (form == PoseForm::position_xyzw) return pose_from_quaternion(position, at[6], at[3], at[4], at[5]);
    if (form == PoseForm::matrix_4x4 && (at[12] != 0 || at[13] != 0 || at[14] != 0 || at[15] != 1))
        throw InputError("the last row is not 0 0 0 1; matrices are row-major, the translation in the last column");
    return {{at[0], at[1], at[2], at[4], at[5], at[6], at[8], at[9], at[10]}, {at[3], at[7], at[11]}};
}

template <class Number>
Pose pose_at(const std::byte* bytes, std::size_t i, PoseForm form) {
    const std::size_t count = numbers_of(form);
    std::array<Number, 16> numbers;
    std::memcpy(numbers.data(), bytes + i * count * sizeof(Number), count * sizeof(Number));
    std::array<double, 16> wide{};
    std::copy_n(numbers.begin(), count, wide.begin());
    return pose_of(wide.data(), form);
}

} // namespace

std::vector<Pose> read_poses(Executor& executor, const UserMemory& memory, std::size_t count, PoseForm form,
                             NumberType type) {
    const std::size_t size = numbers_of(form) * (type == NumberType::float32 ? sizeof(float) : sizeof(double));
    if (memory.bytes() < count * size)
        throw InputError("Scene::set_poses: " + std::to_string(memory.bytes()) + " bytes have no room for the "
                         + std::to_string(count) + " poses of " + std::to_string(size) + " bytes each");
    std::vector<std::byte> bytes(count * size);
    memory.read(bytes);
    const auto pose = [&](std::size_t i) {
        return type == NumberType::float32 ? pose_at<float>(bytes.data(), i, form)
                                           : pose_at<double>(bytes.data(), i, form);
    };
    std::vector<Pose> poses(count);
    std::atomic<bool> faulty = false;
    executor.each(count, 256, [&](std::uint32_t i) {
        try {
            poses[i] = pose(i);
        } catch (const InputError&) {
            faulty = true;
        }
    });
    for (std::size_t i = 0; faulty && i < count; ++i) {
        try {
            poses[i] = pose(i);
        } catch (const InputError& error) {
            throw InputError("Scene::set_poses, place " + std::to_string(i) + ": " + error.what());
        }
    }
    return poses;
}

} // namespace raycontact
