// SPDX-License-Identifier: Apache-2.0
#include "part/parts.h"

#include "interruption.h"

#include <algorithm>

namespace raycontact {

Parts::Parts(std::vector<OpenDevice> opened) {
    for (OpenDevice& device : opened) add(std::move(device));
    if (parts_.size() > 1) threads_ = std::make_unique<SideBySide>(parts_.size());
}

void Parts::add(OpenDevice opened) {
    std::string id = opened.device->info().id;
    auto part = std::make_unique<Part>(std::move(opened));
    if (left() > 0) part->shapes().add_all_of(parts_[first()]->shapes());
    devices_.push_back(std::move(id));
    faults_.emplace_back();
    errors_.emplace_back();
    parts_.push_back(std::move(part));
}

std::size_t Parts::left() const {
    return parts_.size() - static_cast<std::size_t>(std::count(parts_.begin(), parts_.end(), nullptr));
}

std::size_t Parts::first() const {
    const auto any = std::ranges::find_if(parts_, [](const auto& part) { return part != nullptr; });
    return static_cast<std::size_t>(any - parts_.begin());
}

void Parts::attempt(std::size_t number, const Function& work) {
    if (!has(number)) return;
    // What a GPU was given is not left halfway.
    const Interruptible interruptible(devices_[number].starts_with("cpu") ? interruption_flag : nullptr);
    try {
        work(number);
    } catch (const DeviceError& error) {
        faults_[number] = error.what();
    } catch (...) {
        errors_[number] = std::current_exception();
    }
}

std::vector<std::size_t> Parts::drop_failed() {
    std::vector<std::size_t> failed;
    std::exception_ptr other;
    std::string all;
    for (std::size_t i = 0; i < size(); ++i) {
        if (const std::exception_ptr error = std::exchange(errors_[i], nullptr); error && !other) other = error;
        const std::string fault = std::exchange(faults_[i], {});
        if (fault.empty()) continue;
        failed.push_back(i);
        all += (all.empty() ? "device " : "; device ") + devices_[i] + " failed: " + fault;
    }
    if (other) std::rethrow_exception(other);
    if (failed.empty()) return failed;
    if (failed.size() == left()) throw DeviceError(all + "; no other device is left to go on");
    for (const std::size_t i : failed) parts_[i].reset();
    warnings_.push_back(all + "; it is not used any more, its pairs are cast again by the others");
    return failed;
}

std::vector<std::size_t> Parts::run_all(const Function& work) {
    if (left() < 2 || !threads_) return each(work);
    threads_->run([&](std::size_t i) { attempt(i, work); });
    return drop_failed();
}

std::vector<std::size_t> Parts::each(const Function& work) {
    for (std::size_t i = 0; i < size(); ++i) attempt(i, work);
    return drop_failed();
}

void Parts::between_steps(const Function& work) {
    const auto failed = each(work);
    lost_.insert(lost_.end(), failed.begin(), failed.end());
}

void Parts::add_shape(const std::shared_ptr<const Shape>& shape) {
    between_steps([&](std::size_t i) { parts_[i]->shapes().add(shape); });
}

void Parts::remove_shape(const Shape* shape) {
    for (const auto& part : parts_)
        if (part) part->shapes().remove(shape);
}

// All stores have had the same calls, so a shape has the same index in each.
kernels::uint Parts::index_of(const Shape* shape) const {
    return parts_[first()]->shapes().index_of(shape);
}

bool Parts::pack_shapes() {
    bool packed = false;
    between_steps([&](std::size_t i) { packed = parts_[i]->shapes().pack() || packed; });
    return packed;
}

void Parts::accelerate_shapes() {
    if (plain_shapes() > 0) between_steps([&](std::size_t i) { parts_[i]->shapes().accelerate(); });
}

std::size_t Parts::plain_shapes() const {
    std::size_t most = 0;
    for (const auto& part : parts_)
        if (part) most = std::max(most, part->shapes().plain());
    return most;
}

void Parts::wake() {
    if (left() > 1 && threads_) threads_->wake();
    for (const auto& part : parts_)
        if (part) part->executor().wake();
}

void Parts::forget() {
    for (const auto& part : parts_)
        if (part) part->forget();
}

} // namespace raycontact
