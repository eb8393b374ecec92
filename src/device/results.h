// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "device/array.h"

#include <algorithm>
#include <span>
#include <vector>

namespace raycontact {

/// Results that a device writes, and how many the host reads of them before it knows their number.
template <class T>
class Results {
public:
    /// Before they are written.
    const Array<T>& room(Device& device) {
        constexpr std::size_t least = 1024;
        array_.grow(device, least);
        return array_;
    }
    /// To be read: as many as are likely, or `least`.
    Piece piece(std::size_t least = 0) {
        const std::size_t expected = std::min(std::max(expected_, least), array_.size());
        if (values_.size() < expected) values_.resize(expected);
        read_ = expected;
        return array_.piece(std::span(values_).first(expected));
    }
    /// After that was read, with their number: reads the rest. False if they had too little room: there is enough now,
    /// and they must be written again.
    bool take(Device& device, std::size_t count) {
        if (count > array_.size()) {
            array_.grow(device, count);
            return false;
        }
        const std::size_t known = std::min(count, read_);
        if (known < count) {
            if (values_.size() < count) values_.resize(count);
            const Piece rest = array_.piece(std::span(values_).first(count).subspan(known), known);
            device.queue().read({&rest, 1});
        }
        count_ = count;
        expected_ = count + count / 4;
        return true;
    }
    std::span<const T> values() const { return std::span(values_).first(count_); }
    /// There are none in this step, nor likely in the next.
    void rest() { count_ = expected_ = 0; }

private:
    Array<T> array_;
    std::vector<T> values_;
    std::size_t count_ = 0;    ///< of values_
    std::size_t read_ = 0;     ///< of this step
    std::size_t expected_ = 0; ///< in the next step, at most
};

} // namespace raycontact
