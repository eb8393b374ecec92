// SPDX-License-Identifier: Apache-2.0
// Poses from a device's memory, contacts into it: of another context than the scene's, in the order of its queue.
#include "device/opencl/handle.h"
#include "scenes/models/model.h"
#include "tests/device/work.h"

#include <raycontact/error.h>
#include <raycontact/scene.h>

#include <array>
#include <cmath>
#include <cstring>
#include <gtest/gtest.h>
#include <string>

namespace raycontact {
namespace {

using namespace opencl;

// A program that uses OpenCL itself.
struct Caller {
    explicit Caller(std::uint32_t number) {
        cl_uint platforms = 0;
        check(clGetPlatformIDs(0, nullptr, &platforms), "clGetPlatformIDs");
        std::vector<cl_platform_id> all(platforms);
        check(clGetPlatformIDs(platforms, all.data(), nullptr), "clGetPlatformIDs");
        std::vector<cl_device_id> devices;
        for (const cl_platform_id platform : all) {
            cl_uint count = 0;
            if (clGetDeviceIDs(platform, CL_DEVICE_TYPE_ALL, 0, nullptr, &count) != CL_SUCCESS) continue;
            const std::size_t before = devices.size();
            devices.resize(before + count);
            check(clGetDeviceIDs(platform, CL_DEVICE_TYPE_ALL, count, devices.data() + before, nullptr), "devices");
        }
        const cl_device_id device = devices.at(number % devices.size());
        cl_int status = CL_SUCCESS;
        context.reset(clCreateContext(nullptr, 1, &device, nullptr, nullptr, &status));
        check(status, "clCreateContext");
        queue.reset(clCreateCommandQueue(context.get(), device, 0, &status));
        check(status, "clCreateCommandQueue");
    }
    Memory make(std::size_t bytes) const {
        cl_int status = CL_SUCCESS;
        Memory made(clCreateBuffer(context.get(), CL_MEM_READ_WRITE, bytes, nullptr, &status));
        check(status, "clCreateBuffer");
        return made;
    }
    UserMemory memory(const Memory& buffer, std::size_t bytes, std::size_t offset = 0) const {
        return UserMemory::opencl(queue.get(), buffer.get(), bytes, offset);
    }

    Context context;
    CommandQueue queue;
};

constexpr std::uint32_t side = 4, count = side * side * side;

std::vector<Pose> poses_of(int step) {
    std::vector<Pose> poses;
    for (std::uint32_t i = 0; i < count; ++i) {
        const double turn = 0.3 * i + 0.05 * step;
        poses.push_back(
            pose_from_quaternion({0.8 * (i % side), 0.8 * (i / side % side), 0.8 * (i / side / side) - 0.01 * step},
                                 std::cos(turn), 0.6 * std::sin(turn), 0, 0.8 * std::sin(turn)));
    }
    return poses;
}

std::vector<double> matrices_of(std::span<const Pose> poses) {
    std::vector<double> numbers;
    for (const Pose& pose : poses) {
        const auto& r = pose.rotation;
        const Vec3& t = pose.translation;
        for (const double number : {r[0], r[1], r[2], t.x, r[3], r[4], r[5], t.y, r[6], r[7], r[8], t.z})
            numbers.push_back(number);
    }
    return numbers;
}

void step_through_memory(const std::string& device) {
    Settings settings;
    settings.execution.devices = device;
    Scene scene(settings), expected;
    const auto shape = Shape::make(scenes::scene_model("gear", 300).mesh);
    std::vector<BodyId> ids;
    for (std::uint32_t i = 0; i < count; ++i) {
        ids.push_back(scene.add(shape));
        expected.add(shape);
    }
    const Caller caller(0);
    constexpr std::size_t room = 20000, before = 64; // contacts; bytes before the poses
    const std::size_t pose_bytes = count * 12 * sizeof(double);
    const Memory poses = caller.make(before + pose_bytes), keys = caller.make(room * sizeof(std::uint64_t)),
                 points = caller.make(room * 3 * sizeof(double)), slots = caller.make(room * 2 * sizeof(std::uint32_t));
    for (int step = 0; step < 5; ++step) {
        const std::vector<Pose> now = poses_of(step);
        // Not waited for: the queue's order is enough.
        const std::vector<double> numbers = matrices_of(now);
        check(clEnqueueWriteBuffer(caller.queue.get(), poses.get(), CL_FALSE, before, pose_bytes, numbers.data(), 0,
                                   nullptr, nullptr),
              "clEnqueueWriteBuffer");
        scene.set_poses(ids, caller.memory(poses, pose_bytes, before), PoseForm::matrix_3x4, NumberType::float64);
        expected.set_poses(ids, now);
        scene.find_contacts();
        const auto found = expected.find_contacts();
        ASSERT_GT(found.size(), 100u);
        ASSERT_LT(found.size(), room);
        const std::array outputs{
            ContactOutput{ContactColumn::key, caller.memory(keys, room * sizeof(std::uint64_t))},
            ContactOutput{ContactColumn::point_a, caller.memory(points, room * 3 * sizeof(double))},
            ContactOutput{ContactColumn::slots, caller.memory(slots, room * 2 * sizeof(std::uint32_t))}};
        ASSERT_EQ(scene.write_contacts(outputs), found.size());
        std::vector<std::uint64_t> read_keys(found.size());
        std::vector<double> read_points(3 * found.size());
        std::vector<std::uint32_t> read_slots(2 * found.size());
        outputs[0].memory.read(std::as_writable_bytes(std::span(read_keys)));
        outputs[1].memory.read(std::as_writable_bytes(std::span(read_points)));
        outputs[2].memory.read(std::as_writable_bytes(std::span(read_slots)));
        for (std::size_t i = 0; i < found.size(); ++i) {
            ASSERT_EQ(read_keys[i], found[i].key());
            ASSERT_EQ((Vec3{read_points[3 * i], read_points[3 * i + 1], read_points[3 * i + 2]}), found[i].point_a);
            ASSERT_EQ((SlotPair{read_slots[2 * i], read_slots[2 * i + 1]}), pair_of(found[i]));
        }
    }
}

TEST(user_memory, a_scene_on_the_cpu_steps_through_it) {
    step_through_memory("cpu");
}
TEST(user_memory, a_scene_on_a_device_steps_through_it) {
    step_through_memory(device_test::tested_device());
}

std::string refusal(void* queue, void* buffer, std::size_t bytes, std::size_t offset) {
    try {
        UserMemory::opencl(queue, buffer, bytes, offset);
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

TEST(user_memory, what_is_wrong_with_a_buffer_is_said) {
    const Caller one(0), other(0);
    const Memory buffer = one.make(64);
    EXPECT_EQ(refusal(one.queue.get(), buffer.get(), 48, 16), "");
    EXPECT_NE(refusal(one.queue.get(), buffer.get(), 48, 17).find("it has 64 bytes, not 48 from byte 17"),
              std::string::npos);
    EXPECT_NE(refusal(one.queue.get(), buffer.get(), 1, 65).find("it has 64 bytes"), std::string::npos);
    EXPECT_NE(refusal(other.queue.get(), buffer.get(), 8, 0).find("another context"), std::string::npos);
    EXPECT_NE(refusal(one.queue.get(), nullptr, 8, 0).find("the buffer is none"), std::string::npos);
    EXPECT_NE(refusal(nullptr, buffer.get(), 8, 0).find("the queue is none"), std::string::npos);
    std::vector<std::byte> more(65);
    EXPECT_THROW(one.memory(buffer, 64).read(more), InputError);
    EXPECT_THROW(one.memory(buffer, 64).write(more), InputError);
}

} // namespace
} // namespace raycontact
