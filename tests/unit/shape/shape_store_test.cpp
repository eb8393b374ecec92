// SPDX-License-Identifier: Apache-2.0
#include "shape/shape_store.h"

#include "device/forwarding.h"

#include "scenes/models/model.h"
#include "shape/shape_data.h"

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
    std::vector<kernels::TriangleBlock> blocks(store.arrays().triangle_blocks.size());
    store.arrays().triangle_blocks.read(*opened.device, blocks);
    for (const auto& shape : {shapes[0], shapes[2]}) {
        const kernels::ShapeHeader& header = headers[store.index_of(shape.get())];
        EXPECT_EQ(header.triangle_block_count, shape->data().triangle_blocks.size());
        EXPECT_EQ(blocks[header.triangle_block_first].triangle[0], shape->data().triangle_blocks[0].triangle[0]);
    }
}

// A device whose memory runs out after so many buffers.
class ScarceDevice : public ForwardingDevice {
public:
    ScarceDevice(std::unique_ptr<Device> real, int buffers) : ForwardingDevice(std::move(real)), left(buffers) {}
    std::unique_ptr<Buffer> make_buffer(std::size_t bytes) override {
        if (left-- == 0) throw std::bad_alloc();
        return ForwardingDevice::make_buffer(bytes);
    }
    int left;
};

TEST(ShapeStore, ShapeThatDidNotFitLeavesNothingBehind) {
    OpenDevice opened = open_device("cpu", 1);
    ScarceDevice scarce(std::move(opened.device), 3);
    ShapeStore store(scarce);
    const auto shape = Shape::make(scenes::scene_model("gear", 80).mesh);
    EXPECT_THROW(store.add(shape), std::bad_alloc);
    EXPECT_THROW(store.index_of(shape.get()), std::out_of_range);

    scarce.left = 100;
    store.add(shape);
    std::vector<kernels::ShapeHeader> headers(store.arrays().headers.size());
    store.arrays().headers.read(scarce, headers);
    const kernels::ShapeHeader& header = headers[store.index_of(shape.get())];
    EXPECT_EQ(header.edges.block_first + header.edges.block_count, store.arrays().vertex_blocks.size());
    EXPECT_EQ(header.node_first + shape->data().nodes.size(), store.arrays().nodes.size());
    store.remove(shape.get());
    EXPECT_TRUE(store.pack());
    EXPECT_EQ(store.arrays().headers.size(), 0u);
}

} // namespace
} // namespace raycontact
