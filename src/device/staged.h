// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "device/array.h"

#include <vector>

namespace raycontact {

/// An array that the host fills, or reads, whole in each step: in place where the device's memory is the host's, else
/// through a copy of its own.
template <typename T>
class Staged {
public:
    /// To be filled with `size` elements, which hold anything; sent by send().
    std::span<T> fill(Device& device, std::size_t size) {
        array_.resize(device, size);
        if (T* const there = in_place(device)) return {there, size};
        copy_.resize(size);
        return copy_;
    }
    void send(Device& device) {
        if (array_.buffer() && array_.buffer()->host() == nullptr) array_.write(device, copy_);
    }

    /// To be written by a kernel, and read by read().
    void resize(Device& device, std::size_t size) { array_.resize(device, size); }
    /// Valid until the array is filled or resized again, or a kernel is told to write it.
    std::span<const T> read(Device& device) {
        if (const T* const there = in_place(device)) return {there, array_.size()};
        copy_.resize(array_.size());
        array_.read(device, copy_);
        return copy_;
    }

    Array<T>& array() { return array_; }
    const Array<T>& array() const { return array_; }
    std::size_t size() const { return array_.size(); }

private:
    // The host may touch it once the launches before are done.
    T* in_place(Device& device) {
        void* const there = array_.buffer() ? array_.buffer()->host() : nullptr;
        if (there != nullptr) device.queue().finish();
        return static_cast<T*>(there);
    }

    Array<T> array_;
    std::vector<T> copy_;
};

} // namespace raycontact
