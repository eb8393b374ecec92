// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "device/device.h"

#include <algorithm>
#include <span>

namespace raycontact {

/// A typed device buffer. It only grows, so that steps allocate nothing after warm-up.
template <typename T>
class Array {
public:
    std::size_t size() const { return size_; }
    std::size_t bytes() const { return buffer_ ? buffer_->bytes() : 0; }
    Buffer* buffer() const { return buffer_.get(); }

    /// Contents are lost when the array must grow.
    void resize(Device& device, std::size_t size) {
        if (size > capacity_) {
            const std::size_t capacity = std::max<std::size_t>(size + size / 2, 16);
            buffer_ = device.make_buffer(capacity * sizeof(T)); // may fail
            capacity_ = capacity;
        }
        size_ = size;
    }
    /// Makes room for at least `size` elements, and for half as many again if it must grow, since the next step may
    /// need a few more. size() is then the whole room.
    void grow(Device& device, std::size_t size) {
        if (size <= size_) return;
        resize(device, size);
        size_ = capacity_;
    }

    void write(Device& device, std::span<const T> values) {
        resize(device, values.size());
        if (!values.empty()) device.queue().write(*buffer_, 0, values.data(), values.size_bytes());
    }

    /// Keeps the elements; new ones are undefined.
    void extend(Device& device, std::size_t size) {
        if (size > capacity_) {
            Array grown;
            grown.resize(device, size);
            if (size_ > 0) device.queue().copy(*grown.buffer_, *buffer_, size_ * sizeof(T));
            *this = std::move(grown);
        }
        size_ = size;
    }

    /// Keeps the elements and adds `values`.
    void append(Device& device, std::span<const T> values) {
        const std::size_t old_size = size_;
        extend(device, old_size + values.size());
        if (!values.empty()) device.queue().write(*buffer_, old_size * sizeof(T), values.data(), values.size_bytes());
    }

    /// An argument of Queue::read() that copies the elements from `first` on to `values`.
    Piece piece(std::span<T> values, std::size_t first = 0) const {
        return {values.data(), buffer_.get(), first * sizeof(T), values.size_bytes()};
    }
    void read(Device& device, std::span<T> values) const {
        const Piece all = piece(values);
        device.queue().read({&all, 1});
    }

    /// The elements themselves, if the device shares memory with the host; only while no launch uses them.
    std::span<T> in_place() const { return {buffer_ ? static_cast<T*>(buffer_->host()) : nullptr, size_}; }

private:
    std::unique_ptr<Buffer> buffer_;
    std::size_t size_ = 0;
    std::size_t capacity_ = 0;
};

/// Of several arrays, as each one's.
template <typename... T>
void resize(Device& device, std::size_t size, Array<T>&... arrays) {
    (arrays.resize(device, size), ...);
}

} // namespace raycontact
