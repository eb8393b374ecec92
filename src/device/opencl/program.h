// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "device/gpu/launches.h"
#include "device/opencl/handle.h"

#include <array>

namespace raycontact::opencl {

/// The text that is built, and its build options.
struct Source {
    std::string text, options;
    bool has_double = true;             ///< it contains the kernels that compute in double
    kernels::uint vertices_at_once = 1; ///< that an item handles in the kernels over vertices; VERTEX_LANES for a CPU
};

/// The kernels, with the build options that give our bits on this device.
Source exact_source(cl_device_id device);

/// The kernels of one device, built from their text by its driver, which caches what it has built.
class Program {
public:
    Program(cl_context context, cl_device_id device, const Source& source);

    /// Null for kernels that need shared memory, or double that the device lacks.
    cl_kernel kernel(KernelId id) const { return kernels_[static_cast<std::size_t>(id)].get(); }
    /// gpu::scan_kernels[i].
    cl_kernel scan_kernel(std::size_t i) const { return scan_kernels_[i].get(); }
    /// A kernel that is not part of the pipeline.
    Kernel entry(const char* name) const;

private:
    BuiltProgram program_;
    std::array<Kernel, static_cast<std::size_t>(KernelId::count)> kernels_;
    std::array<Kernel, gpu::scan_kernels.size()> scan_kernels_;
};

} // namespace raycontact::opencl
