// SPDX-License-Identifier: Apache-2.0
#include "read_poses.h"

#include <scenes/random.h>

#include <raycontact/error.h>

#include <array>
#include <cmath>
#include <cstring>
#include <gtest/gtest.h>
#include <string>

namespace raycontact {
namespace {

struct Quaternion {
    double w, x, y, z;
};

// The numbers of a pose in each form.
std::vector<double> numbers_of(const Quaternion& q, const Pose& pose, PoseForm form) {
    const auto& r = pose.rotation;
    const Vec3& t = pose.translation;
    switch (form) {
    case PoseForm::matrix_4x4:
        return {r[0], r[1], r[2], t.x, r[3], r[4], r[5], t.y, r[6], r[7], r[8], t.z, 0, 0, 0, 1};
    case PoseForm::matrix_3x4:
        return {r[0], r[1], r[2], t.x, r[3], r[4], r[5], t.y, r[6], r[7], r[8], t.z};
    case PoseForm::position_wxyz:
        return {t.x, t.y, t.z, q.w, q.x, q.y, q.z};
    case PoseForm::position_xyzw:
        return {t.x, t.y, t.z, q.x, q.y, q.z, q.w};
    }
    return {};
}

template <class Number>
std::vector<std::byte> bytes_of(const std::vector<double>& numbers) {
    std::vector<std::byte> bytes(numbers.size() * sizeof(Number));
    for (std::size_t i = 0; i < numbers.size(); ++i) {
        const auto number = static_cast<Number>(numbers[i]);
        std::memcpy(bytes.data() + i * sizeof number, &number, sizeof number);
    }
    return bytes;
}

constexpr PoseForm every_form[] = {PoseForm::matrix_4x4, PoseForm::matrix_3x4, PoseForm::position_wxyz,
                                   PoseForm::position_xyzw};

TEST(PoseForm, EachGivesThePoses) {
    scenes::Random random(1);
    Executor executor(2);
    constexpr std::size_t count = 600;
    for (const PoseForm form : every_form) {
        std::vector<double> numbers;
        std::vector<Pose> expected;
        for (std::size_t i = 0; i < count; ++i) {
            Quaternion q{random.symmetric(), random.symmetric(), random.symmetric(), 1.5 + random.symmetric()};
            const double length = std::sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
            q = {q.w / length, q.x / length, q.y / length, q.z / length};
            const Vec3 place{10 * random.symmetric(), random.symmetric(), 100 * random.symmetric()};
            expected.push_back(pose_from_quaternion(place, q.w, q.x, q.y, q.z));
            const auto own = numbers_of(q, expected.back(), form);
            numbers.insert(numbers.end(), own.begin(), own.end());
        }
        auto wide = bytes_of<double>(numbers), narrow = bytes_of<float>(numbers);
        for (const NumberType type : {NumberType::float64, NumberType::float32}) {
            auto& bytes = type == NumberType::float64 ? wide : narrow;
            const auto poses = read_poses(executor, UserMemory::host(bytes), count, form, type);
            ASSERT_EQ(poses.size(), count);
            const double most = type == NumberType::float64 ? 1e-14 : 1e-6;
            for (std::size_t i = 0; i < count; ++i) {
                for (std::size_t k = 0; k < 9; ++k) ASSERT_NEAR(poses[i].rotation[k], expected[i].rotation[k], most);
                ASSERT_NEAR(poses[i].translation.x, expected[i].translation.x, 10 * most);
                ASSERT_NEAR(poses[i].translation.z, expected[i].translation.z, 100 * most);
            }
        }
    }
}

std::string fault(std::vector<std::byte>& bytes, std::size_t count, PoseForm form) {
    Executor executor(2);
    try {
        read_poses(executor, UserMemory::host(bytes), count, form, NumberType::float32);
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

TEST(PoseForm, TheFirstFaultIsNamed) {
    std::vector<double> numbers;
    for (std::size_t i = 0; i < 1000; ++i) {
        const std::vector<double> one{1, 2, 3, i == 700 || i == 900 ? 0.0 : 1.0, 0, 0, 0};
        numbers.insert(numbers.end(), one.begin(), one.end());
    }
    auto bytes = bytes_of<float>(numbers);
    EXPECT_EQ(fault(bytes, 700, PoseForm::position_wxyz), "");
    EXPECT_EQ(fault(bytes, 1000, PoseForm::position_wxyz).find("Scene::set_poses, place 700: "), 0u);
    EXPECT_NE(fault(bytes, 1001, PoseForm::position_wxyz).find("28000 bytes have no room for the 1001 poses of 28"),
              std::string::npos);
}

} // namespace
} // namespace raycontact
