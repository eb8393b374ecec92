// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "device/cuda/handle.h"
#include "device/gpu/launches.h"

#include <array>

namespace raycontact::cuda {

/// The kernels of one device.
class Program {
public:
    /// image: of image_for(). The context is current.
    Program(const std::shared_ptr<const Context>& context, const std::string& image);

    /// Null for kernels that need the host's memory.
    FunctionHandle kernel(KernelId id) const { return kernels_[static_cast<std::size_t>(id)]; }
    /// gpu::scan_kernels[i].
    FunctionHandle scan_kernel(std::size_t i) const { return scan_kernels_[i]; }
    /// SCAN_GROUP, as the kernels' text sets it.
    std::size_t scan_group() const { return scan_group_; }
    /// A kernel that is not part of the pipeline.
    FunctionHandle entry(const char* name) const;

private:
    Module module_;
    std::array<FunctionHandle, static_cast<std::size_t>(KernelId::count)> kernels_{};
    std::array<FunctionHandle, gpu::scan_kernels.size()> scan_kernels_{};
    std::size_t scan_group_ = 0;
};

} // namespace raycontact::cuda
