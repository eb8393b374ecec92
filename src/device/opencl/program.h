// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "device/host_kernels.h"
#include "device/opencl/handle.h"

#include <array>

namespace raycontact::opencl {

/// What is built, and how.
struct Source {
    std::string text, options;
    bool has_double = true; ///< the kernels that compute in double are there
};

/// The kernels, with the options that our bits need of this device.
Source exact_source(cl_device_id device);

/// The kernels of one device, built from their text by its driver, which keeps in its own cache what it has built.
class Program {
public:
    Program(cl_context context, cl_device_id device, const Source& source);

    /// Null for those that only run where memory is shared, or in double where the device has none.
    cl_kernel kernel(KernelId id) const { return kernels_[static_cast<std::size_t>(id)].get(); }
    static const char* name_of(KernelId id);
    /// One that is not of the pipeline.
    Kernel entry(const char* name) const;

private:
    BuiltProgram program_;
    std::array<Kernel, static_cast<std::size_t>(KernelId::count)> kernels_;
};

} // namespace raycontact::opencl
