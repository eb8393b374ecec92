// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "device/cuda/handle.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <functional>
#include <vector>

namespace raycontact::cuda {

/// Pinned host memory between the caller's memory and the device's: copies from and to it need not wait for each other,
/// and a device that fails never holds on to the caller's memory. The context is current in every call.
class Staging {
public:
    explicit Staging(std::shared_ptr<const Context> context)
        : context_(std::move(context)), up_(make_host_memory(context_, parts_.size() * part_bytes)),
          down_(make_host_memory(context_, down_bytes)) {
        for (Part& part : parts_) part.copied = make_event(context_, false);
    }

    /// Has read its source when it returns. Waits only if the device has yet to copy all that lies here.
    void write(Address to, const void* from, std::size_t bytes) {
        const auto* source = static_cast<const std::byte*>(from);
        while (bytes > 0) {
            const std::size_t some = std::min(bytes, part_bytes);
            const void* place = std::memcpy(place_up(some), source, some);
            check(driver().cuMemcpyHtoDAsync(to, place, some, context_->stream()), "cuMemcpyHtoDAsync");
            to += some;
            source += some;
            bytes -= some;
        }
    }

    /// Waits once for all pieces together, unless they are more than fit here.
    void read(std::span<const Piece> pieces, const std::function<void()>& wait) {
        std::size_t used = 0;
        started_.clear();
        const auto bring = [&] {
            wait();
            for (const Started& copy : started_) std::memcpy(copy.to, copy.from, copy.bytes);
            started_.clear();
            used = 0;
        };
        for (const Piece& piece : pieces)
            for (std::size_t at = 0; at < piece.bytes;) {
                if (used == down_bytes) bring();
                const std::size_t some = std::min(piece.bytes - at, down_bytes - used);
                std::byte* place = static_cast<std::byte*>(down_.get()) + used;
                check(driver().cuMemcpyDtoHAsync(place, address_of(piece.from) + piece.offset + at, some,
                                                 context_->stream()),
                      "cuMemcpyDtoHAsync");
                started_.push_back({static_cast<std::byte*>(piece.to) + at, place, some});
                used += some;
                at += some;
            }
        bring();
    }

    /// Everything written was copied, since the stream was waited for.
    void all_copied() {
        for (Part& part : parts_) part.in_use = false;
        filled_ = 0;
    }

private:
    /// A ring of parts: one is filled while the device copies from the others.
    struct Part {
        Event copied;
        bool in_use = false;
    };
    static constexpr std::size_t part_bytes = std::size_t{1} << 20, down_bytes = std::size_t{16} << 20;

    struct Started {
        void* to = nullptr;
        const std::byte* from = nullptr;
        std::size_t bytes = 0;
    };

    std::byte* place_up(std::size_t bytes) {
        if (bytes > part_bytes - filled_) {
            Part& full = parts_[part_];
            check(driver().cuEventRecord(full.copied.get(), context_->stream()), "cuEventRecord");
            full.in_use = true;
            part_ = (part_ + 1) % parts_.size();
            filled_ = 0;
            Part& next = parts_[part_];
            if (next.in_use) check(driver().cuEventSynchronize(next.copied.get()), "cuEventSynchronize");
            next.in_use = false;
        }
        std::byte* place = static_cast<std::byte*>(up_.get()) + part_ * part_bytes + filled_;
        filled_ += bytes;
        return place;
    }

    std::shared_ptr<const Context> context_;
    std::array<Part, 4> parts_;
    HostMemory up_, down_;
    std::size_t part_ = 0, filled_ = 0;
    std::vector<Started> started_; ///< of a read
};

} // namespace raycontact::cuda
