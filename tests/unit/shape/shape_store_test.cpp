// SPDX-License-Identifier: Apache-2.0
#include "shape/shape_store.h"

#include "scenes/models/model.h"
#include "shape/shape_data.h"

#include <gtest/gtest.h>

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

} // namespace
} // namespace raycontact
