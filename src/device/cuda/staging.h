// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "device/cuda/buffer.h"
#include "device/device.h"

#include <array>

namespace raycontact::cuda {

/// Pinned host memory between the caller's memory and the device's: copies from and to it need not wait for each other.
/// The context is current in every call.
class Staging {
public:
    explicit Staging(std::shared_ptr<const Context> context);

    /// Has read its source when it returns. Waits only if the device has yet to copy all that lies here, or for a large
    /// write, which goes up directly.
    void write(Address to, const void* from, std::size_t bytes);

    /// Starts the copies of a read. Pieces beyond the room here go to their places directly.
    void start(std::span<const Piece> pieces);
    /// Once the stream was waited for: brings what start() copied to its places.
    void bring(std::span<const Piece> pieces);
    /// Everything written was copied, since the stream was waited for.
    void all_copied();

private:
    /// A ring of parts: one is filled while the device copies from the others.
    struct Part {
        Event copied;
        bool in_use = false;
    };
    static constexpr std::size_t part_bytes = std::size_t{1} << 20, down_bytes = std::size_t{16} << 20;

    std::byte* place_up(std::size_t bytes);

    std::shared_ptr<const Context> context_;
    std::array<Part, 4> parts_;
    HostMemory up_, down_;
    std::size_t part_ = 0, filled_ = 0;
};

} // namespace raycontact::cuda
