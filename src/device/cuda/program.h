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
    Program(const std::shared_ptr<const Context>& context, const std::string& image) : module_(load(context, image)) {
        for (std::size_t i = 0; i < kernels_.size(); ++i)
            if (gpu::kernel_names[i]) kernels_[i] = entry(gpu::kernel_names[i]);
        for (std::size_t i = 0; i < scan_kernels_.size(); ++i) scan_kernels_[i] = entry(gpu::scan_kernels[i]);
        constexpr int most_threads_of_block = 0; // the text bounds them to SCAN_GROUP
        int threads = 0;
        check(driver().cuFuncGetAttribute(&threads, most_threads_of_block, scan_kernels_[0]), "cuFuncGetAttribute");
        scan_group_ = static_cast<std::size_t>(threads);
    }

    /// Null for kernels that need the host's memory.
    FunctionHandle kernel(KernelId id) const { return kernels_[static_cast<std::size_t>(id)]; }
    /// gpu::scan_kernels[i].
    FunctionHandle scan_kernel(std::size_t i) const { return scan_kernels_[i]; }
    /// SCAN_GROUP, as the kernels' text sets it.
    std::size_t scan_group() const { return scan_group_; }
    /// A kernel that is not part of the pipeline.
    FunctionHandle entry(const char* name) const {
        FunctionHandle function = nullptr;
        check(driver().cuModuleGetFunction(&function, module_.get(), name), name);
        return function;
    }

private:
    /// A PTX text is compiled here, by the driver; its log says why that failed.
    static Module load(const std::shared_ptr<const Context>& context, const std::string& image) {
        constexpr int error_log = 5, error_log_bytes = 6;
        std::array<char, 4096> log{};
        std::array options{error_log, error_log_bytes};
        std::array<void*, 2> values{log.data(), reinterpret_cast<void*>(std::uintptr_t{log.size() - 1})};
        ModuleHandle handle = nullptr;
        const Status status =
            driver().cuModuleLoadDataEx(&handle, image.c_str(), options.size(), options.data(), values.data());
        check(status, "cuModuleLoadDataEx" + (log[0] != '\0' ? ":\n" + std::string(log.data()) + "\n" : ""));
        return Module(handle, {context});
    }

    Module module_;
    std::array<FunctionHandle, static_cast<std::size_t>(KernelId::count)> kernels_{};
    std::array<FunctionHandle, gpu::scan_kernels.size()> scan_kernels_{};
    std::size_t scan_group_ = 0;
};

} // namespace raycontact::cuda
