// SPDX-License-Identifier: Apache-2.0
#include "device/cuda/driver.h"

#include "platform/library.h"
#include "platform/system.h"

namespace raycontact::cuda {

namespace {

Installed load() {
    Installed loaded;
    const std::string name = platform::on_windows ? "nvcuda.dll" : "libcuda.so.1";
    const platform::Library library(name);
    if (!library) {
        loaded.why_not = "no CUDA driver is installed here (" + name + ")";
        return loaded;
    }
    Driver& driver = loaded.driver;
    const auto find = [&](auto& function, const char* symbol) {
        library.find(symbol, function);
        if (!function)
            loaded.why_not =
                "the CUDA driver is too old: it has no " + std::string(symbol) + "; install one of CUDA 11";
    };
    // The suffix is part of the binary interface: without it, several of these are older functions.
    find(driver.cuInit, "cuInit");
    find(driver.cuDriverGetVersion, "cuDriverGetVersion");
    find(driver.cuGetErrorName, "cuGetErrorName");
    find(driver.cuGetErrorString, "cuGetErrorString");
    find(driver.cuDeviceGetCount, "cuDeviceGetCount");
    find(driver.cuDeviceGet, "cuDeviceGet");
    find(driver.cuDeviceGetName, "cuDeviceGetName");
    find(driver.cuDeviceGetPCIBusId, "cuDeviceGetPCIBusId");
    find(driver.cuDeviceGetAttribute, "cuDeviceGetAttribute");
    find(driver.cuDeviceTotalMem, "cuDeviceTotalMem_v2");
    find(driver.cuDevicePrimaryCtxRetain, "cuDevicePrimaryCtxRetain");
    find(driver.cuDevicePrimaryCtxRelease, "cuDevicePrimaryCtxRelease_v2");
    find(driver.cuCtxPushCurrent, "cuCtxPushCurrent_v2");
    find(driver.cuCtxPopCurrent, "cuCtxPopCurrent_v2");
    find(driver.cuStreamCreate, "cuStreamCreate");
    find(driver.cuStreamSynchronize, "cuStreamSynchronize");
    find(driver.cuStreamDestroy, "cuStreamDestroy_v2");
    find(driver.cuEventCreate, "cuEventCreate");
    find(driver.cuEventRecord, "cuEventRecord");
    find(driver.cuEventSynchronize, "cuEventSynchronize");
    find(driver.cuEventElapsedTime, "cuEventElapsedTime");
    find(driver.cuEventDestroy, "cuEventDestroy_v2");
    find(driver.cuModuleLoadDataEx, "cuModuleLoadDataEx");
    find(driver.cuModuleGetFunction, "cuModuleGetFunction");
    find(driver.cuModuleUnload, "cuModuleUnload");
    find(driver.cuFuncGetAttribute, "cuFuncGetAttribute");
    find(driver.cuMemAlloc, "cuMemAlloc_v2");
    find(driver.cuMemFree, "cuMemFree_v2");
    find(driver.cuMemHostAlloc, "cuMemHostAlloc");
    find(driver.cuMemFreeHost, "cuMemFreeHost");
    find(driver.cuMemcpyHtoDAsync, "cuMemcpyHtoDAsync_v2");
    find(driver.cuMemcpyDtoHAsync, "cuMemcpyDtoHAsync_v2");
    find(driver.cuMemcpyDtoDAsync, "cuMemcpyDtoDAsync_v2");
    find(driver.cuLaunchKernel, "cuLaunchKernel");
    return loaded;
}

} // namespace

const Installed& installed() {
    static const Installed loaded = load();
    return loaded;
}

void check(Status status, std::string_view what) {
    if (status == 0) return;
    const char *name = nullptr, *text = nullptr;
    driver().cuGetErrorName(status, &name);
    driver().cuGetErrorString(status, &text);
    throw DeviceError(std::string(what) + ": " + (name ? name : "CUDA status " + std::to_string(status))
                      + (text ? " (" + std::string(text) + ")" : ""));
}

} // namespace raycontact::cuda
