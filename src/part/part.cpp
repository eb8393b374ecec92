// SPDX-License-Identifier: Apache-2.0
#include "part/part.h"

#include <utility>

namespace raycontact {

Part::Part(OpenDevice opened)
    : executor_(std::move(opened.executor)), device_(std::make_unique<CountingDevice>(std::move(opened.device))),
      shapes_(*device_) {}

void Part::forget() {
    standard_.clear();
    certified_.clear();
    coherent_.clear();
}

// `certified` needs memory that host and device share; on other devices it runs `standard`.
Part::Finds Part::finds(const Settings& settings) const {
    if (settings.method == Method::standard) return Finds::standard;
    if (settings.method != Method::certified) return Finds::coherent;
    return device_->traits().shares_memory ? Finds::certified : Finds::standard;
}

Update Part::update() const {
    return {*device_, *executor_, shapes_, bodies_, pairs_, motion_, *settings_};
}

void Part::begin(std::span<const PlacedBody> bodies, std::span<const SlotPair> pairs, const Settings& settings) {
    bodies_ = bodies;
    pairs_ = pairs;
    settings_ = &settings;
    const Update now = update();
    const Finds method = finds(settings);
    if (method != Finds::standard) motion_.update(*executor_, bodies);
    if (method == Finds::standard)
        standard_.begin(now, batch_);
    else if (method == Finds::certified)
        certified_.cast(now, batch_);
    else
        coherent_.cast(now, batch_);
    gather_.run(now, batch_);
}

std::span<const kernels::LocalContact> Part::end() {
    const Update now = update();
    const Finds method = finds(*settings_);
    for (;;) {
        const bool all_written = gather_.read(*device_, batch_);
        const bool all_cast = method != Finds::standard || standard_.had_room(*device_, batch_);
        if (all_written && all_cast) break;
        if (!all_cast) standard_.cast(now, batch_);
        gather_.run(now, batch_);
    }
    if (method == Finds::coherent) coherent_.keep(now);
    local_.set(gather_.contacts(), batch_.directed, pairs_.size());
    work_ = device_->take_work();
    work_.device = device_->info().id;
    work_.pairs = pairs_.size();
    return local_.contacts();
}

std::vector<std::byte> Part::take_out(std::span<const PlacedBody> bodies, std::span<const SlotPair> pairs) {
    if (settings_ == nullptr || finds(*settings_) != Finds::coherent) return {};
    return coherent_.take_out(*device_, shapes_, bodies, pairs);
}

void Part::put_in(std::span<const PlacedBody> bodies, std::span<const std::byte> bytes) {
    if (!bytes.empty()) coherent_.put_in(*device_, shapes_, bodies, bytes);
}

void Part::count(StepStats& stats) const {
    stats.pairs += pairs_.size();
    stats.side_tests += batch_.sums[RayBatch::contact_sum].sums[1];
    stats.rays_cast += batch_.sums[RayBatch::contact_sum].sums[2];
    switch (finds(*settings_)) {
    case Finds::standard:
        return StandardRays::count(batch_, pairs_.size(), stats);
    case Finds::certified:
        return certified_.count(batch_, stats);
    case Finds::coherent:
        return coherent_.count(stats);
    }
}

} // namespace raycontact
