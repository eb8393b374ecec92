// SPDX-License-Identifier: Apache-2.0
#include "shape/shape_store.h"

#include "device/forwarding.h"

#include "scenes/models/model.h"
#include "shape/accelerators.h"
#include "shape/shape_data.h"

#include <cstring>
#include <gtest/gtest.h>
#include <new>
#include <stdexcept>

namespace raycontact {
namespace {

TEST(ShapeStore, SharesPacksAndFindsAgain) {
    const OpenDevice opened = open_device("cpu", 1);
    ShapeStore store(*opened.device);
    std::vector<std::shared_ptr<const Shape>> shapes;
    for (const std::uint32_t triangles : {80u, 902u, 300u})
        shapes.push_back(Shape::make(scenes::scene_model("gear", triangles).mesh));
    for (const auto& shape : shapes) store.add(shape);
    store.add(shapes[1]); // a second user
    EXPECT_EQ(store.arrays().headers.size(), 3u);
    EXPECT_FALSE(store.pack());

    store.remove(shapes[1].get());
    EXPECT_FALSE(store.pack()) << "one user is left";
    store.remove(shapes[1].get());
    EXPECT_TRUE(store.pack());
    EXPECT_EQ(store.arrays().headers.size(), 2u);

    std::vector<kernels::ShapeHeader> headers(2);
    store.arrays().headers.read(*opened.device, headers);
    for (const auto& shape : {shapes[0], shapes[2]}) {
        const kernels::ShapeHeader& header = headers[store.index_of(shape.get())];
        EXPECT_EQ(header.triangle_block_count, shape->data().triangle_blocks.size());
        EXPECT_EQ(header.triangle_blocks, host_place(shape->data().triangle_blocks)) << "not copied";
    }
}

// A device with memory of its own, which runs out after so many buffers.
class ScarceDevice : public ForwardingDevice {
public:
    ScarceDevice(std::unique_ptr<Device> real, int buffers) : ForwardingDevice(std::move(real)), left(buffers) {}
    const DeviceTraits& traits() const override { return traits_; }
    std::unique_ptr<Buffer> make_buffer(std::size_t bytes) override {
        if (left-- == 0) throw std::bad_alloc();
        return ForwardingDevice::make_buffer(bytes);
    }
    int left;

private:
    DeviceTraits traits_{.has_double = true, .shares_memory = false};
};

template <class T>
void expect_copied(std::span<const kernels::ulong> memory, kernels::ulong place, const std::vector<T>& values) {
    EXPECT_EQ(place % 8, 0u) << "a line of 64 bytes";
    ASSERT_LE(place * sizeof(kernels::ulong) + values.size() * sizeof(T), memory.size_bytes());
    EXPECT_EQ(std::memcmp(memory.data() + place, values.data(), values.size() * sizeof(T)), 0);
}

void expect_copies(const ShapeStore& store, Device& device, const std::vector<std::shared_ptr<const Shape>>& shapes) {
    std::vector<kernels::ulong> memory(store.arrays().memory.size());
    store.arrays().memory.read(device, memory);
    for (const auto& one : shapes) {
        const ShapeData& data = one->data();
        const kernels::ShapeHeader& header = store.headers()[store.index_of(one.get())];
        expect_copied(memory, header.nodes, data.nodes);
        expect_copied(memory, header.triangle_blocks, data.triangle_blocks);
        expect_copied(memory, header.faces, data.faces);
        expect_copied(memory, header.face_normals, data.face_normals);
        expect_copied(memory, header.vertex_blocks, data.vertex_blocks);
        expect_copied(memory, header.clusters, data.clusters);
        const Accelerators* more = accelerators_of(*one);
        expect_copied(memory, header.clearances, more != nullptr ? more->clearances : data.clearances);
        if (more != nullptr) expect_copied(memory, header.outside_cells, more->outside_cells);
    }
}

TEST(ShapeStore, CopiesToADeviceWithMemoryOfItsOwn) {
    OpenDevice opened = open_device("cpu", 1);
    ScarceDevice scarce(std::move(opened.device), 1);
    ShapeStore store(scarce);
    const auto shape = Shape::make(scenes::scene_model("gear", 902).mesh);
    const auto other = Shape::make(scenes::scene_model("sphere", 300).mesh);
    EXPECT_THROW(store.add(shape), std::bad_alloc);
    EXPECT_THROW(store.index_of(shape.get()), std::out_of_range) << "a shape that did not fit leaves nothing behind";

    scarce.left = 100;
    store.add(shape);
    store.add(other);
    shape->prepare();
    store.accelerate();
    expect_copies(store, scarce, {shape, other});
    store.remove(shape.get());
    EXPECT_TRUE(store.pack());
    expect_copies(store, scarce, {other});
    store.remove(other.get());
    EXPECT_TRUE(store.pack());
    EXPECT_EQ(store.arrays().headers.size(), 0u);
}

} // namespace
} // namespace raycontact
