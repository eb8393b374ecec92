// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "device/same_contacts.h"
#include "mesh/vector.h"
#include "pairs/directed_pairs.h"

#include "prepared_shape.h"
#include "reference/random.h"
#include "scenes/models/model.h"

#include <cstdint>
#include <vector>

namespace raycontact::device_test {

// Bodies that move a little in each step.
class MovingCrowd {
public:
    explicit MovingCrowd(std::uint32_t count, double radius) {
        for (const char* kind : {"torus", "knot", "gear"})
            shapes.push_back(prepared_shape(scenes::scene_model(kind, 200).mesh));
        for (std::uint32_t i = 0; i < count; ++i) {
            PlacedBody& body = bodies.emplace_back();
            body.shape = shapes[i % shapes.size()].get();
            body.shape_index = i % static_cast<std::uint32_t>(shapes.size());
            body.pose = random_.rotation();
            body.pose.translation = radius * random_.in_ball();
        }
        for (BodySlot a = 0; a < bodies.size(); ++a)
            for (BodySlot b = a + 1; b < bodies.size(); ++b) pairs.emplace_back(a, b);
        move();
    }

    void move() {
        for (PlacedBody& body : bodies) {
            body.pose.translation = body.pose.translation + 0.0005 * random_.in_ball();
            body.centred = centred_pose(*body.shape, body.pose);
        }
    }

    std::vector<std::shared_ptr<const Shape>> shapes;
    std::vector<PlacedBody> bodies;
    std::vector<SlotPair> pairs;

private:
    reference::Random random_{5};
};

} // namespace raycontact::device_test
