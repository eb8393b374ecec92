// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "device/cuda/handle.h"

#include <array>
#include <functional>
#include <vector>

namespace raycontact::cuda {

/// Pinned host memory between the caller's memory and the device's: copies from and to it need not wait for each other,
/// and a device that fails never holds on to the caller's memory. The context is current in every call.
class Staging {
public:
    explicit Staging(std::shared_ptr<const Context> context);

    /// Has read its source when it returns. Waits only if the device has yet to copy all that lies here.
    void write(Address to, const void* from, std::size_t bytes);
    /// Waits once for all pieces together, unless they are more than fit here.
    void read(std::span<const Piece> pieces, const std::function<void()>& wait);
    /// Everything written was copied, since the stream was waited for.
    void all_copied();

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

    std::byte* place_up(std::size_t bytes);

    std::shared_ptr<const Context> context_;
    std::array<Part, 4> parts_;
    HostMemory up_, down_;
    std::size_t part_ = 0, filled_ = 0;
    std::vector<Started> started_; ///< of a read
};

} // namespace raycontact::cuda
