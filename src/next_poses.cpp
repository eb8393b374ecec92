// SPDX-License-Identifier: Apache-2.0
#include "next_poses.h"

#include "mesh/vector.h"
#include "shape/shape_data.h"
#include "state_bytes.h"

namespace raycontact {

namespace {

// The motion from `last` to `now`, once more: the turn about the body's own origin.
Pose go_on(const Pose& last, const Pose& now) {
    const auto &p = last.rotation, &q = now.rotation;
    Pose next;
    std::array<double, 9> turn{};
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j)
            turn[3 * i + j] = (q[3 * i] * p[3 * j] + q[3 * i + 1] * p[3 * j + 1]) + q[3 * i + 2] * p[3 * j + 2];
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j)
            next.rotation[3 * i + j] = (turn[3 * i] * q[j] + turn[3 * i + 1] * q[3 + j]) + turn[3 * i + 2] * q[6 + j];
    next.translation = now.translation + (now.translation - last.translation);
    return next;
}

} // namespace

bool NextPoses::goes_on(const Known& last, const PlacedBody& body) {
    return last.is_of(body) && length(body.pose.translation - last.pose.translation) <= body.shape->data().diagonal;
}

void NextPoses::set(BodySlot body, std::uint32_t generation, const Pose& pose) {
    if (given_.size() <= body) given_.resize(body + std::size_t{1});
    given_[body] = {pose, generation, true};
}

std::span<const Pose> NextPoses::update(Executor& executor, std::span<const PlacedBody> bodies, SlotChanges& moved) {
    given_.resize(bodies.size());
    last_.resize(bodies.size());
    next_.resize(bodies.size());
    changed_.resize(bodies.size());
    executor.each(bodies.size(), 512, [&](BodySlot i) {
        const PlacedBody& body = bodies[i];
        changed_[i] = 0;
        if (body.shape == nullptr) return;
        Pose next = body.pose;
        if (given_[i].is_of(body))
            next = given_[i].pose;
        else if (goes_on(last_[i], body))
            next = go_on(last_[i].pose, body.pose);
        changed_[i] = !same_bits(next, next_[i]);
        next_[i] = next;
    });
    for (BodySlot i = 0; i < bodies.size(); ++i)
        if (changed_[i] != 0) moved.mark(i);
    return next_;
}

void NextPoses::step_done(Executor& executor, std::span<const PlacedBody> bodies) {
    executor.each(bodies.size(), 1024, [&](BodySlot i) {
        given_[i].there = false;
        last_[i] = {bodies[i].pose, bodies[i].generation, bodies[i].shape != nullptr};
    });
}

void NextPoses::forget() {
    given_.clear();
    last_.clear();
    next_.clear();
}

void NextPoses::save(std::vector<std::byte>& bytes) const {
    put_list<Known>(bytes, given_);
    put_list<Known>(bytes, last_);
}

void NextPoses::load(std::span<const std::byte>& bytes) {
    given_ = take_list<Known>(bytes);
    last_ = take_list<Known>(bytes);
    next_.clear();
}

} // namespace raycontact
