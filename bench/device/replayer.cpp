// SPDX-License-Identifier: Apache-2.0
#include "bench/device/replayer.h"

#include "executor/float_environment.h"

#include <scenes/peers/clock.h>

#include <utility>

namespace raycontact::bench {

namespace {

std::vector<OpenDevice> alone(OpenDevice opened) {
    std::vector<OpenDevice> list;
    list.push_back(std::move(opened));
    return list;
}

} // namespace

Replayer::Replayer(const Work& work, std::uint32_t copies, const Settings& settings, OpenDevice opened)
    : work_(work), copies_(copies), narrow_(settings, alone(std::move(opened))) {
    // What is measured is a scene that has run for some time.
    for (const auto& shape : work.shapes) shape->prepare(settings.execution.threads);
    bodies_.resize(copies * work.body_shape.size());
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
        const auto& shape = work.shapes[work.body_shape[i % work.body_shape.size()]];
        narrow_.parts().add_shape(shape);
        bodies_[i].shape = shape.get();
    }
    narrow_.parts().pack_shapes();
    for (PlacedBody& body : bodies_) body.shape_index = narrow_.parts().index_of(body.shape);
}

void Replayer::rest(const Settings& settings) {
    narrow_.set_settings(settings);
    step(0);
    narrow_.set_settings(settings); // forgets
}

void Replayer::step(std::size_t k) {
    const WorkStep& now = work_.steps[k];
    const auto count = static_cast<BodySlot>(now.poses.size());
    listed_.clear();
    for (std::uint32_t copy = 0; copy < copies_; ++copy)
        for (const auto& [a, b] : now.pairs) listed_.emplace_back(copy * count + a.slot, copy * count + b.slot);
    const FloatEnvironment environment;
    const double start = peers::now().wall;
    narrow_.parts().wake();
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
        bodies_[i].pose = now.poses[i % count];
        bodies_[i].centred = centred_pose(*bodies_[i].shape, bodies_[i].pose);
    }
    moved_.forget(); // every pose is set
    pairs_.set_all(narrow_.parts().executor(), listed_);
    narrow_.step(bodies_, moved_, pairs_, stats_);
    pairs_.step_done();
    step_us_ = peers::now().wall - start;
}

} // namespace raycontact::bench
