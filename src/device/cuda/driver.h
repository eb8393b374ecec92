// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "device/device.h"

#include <string>
#include <string_view>

namespace raycontact::cuda {

// The driver's binary interface, as far as it is used. Handles are opaque; status 0 is success.
using Status = int;
using DeviceNumber = int;
using Address = unsigned long long; ///< of device memory
using ContextHandle = struct ContextObject*;
using StreamHandle = struct StreamObject*;
using EventHandle = struct EventObject*;
using ModuleHandle = struct ModuleObject*;
using FunctionHandle = struct FunctionObject*;

/// The functions of a driver, named as in NVIDIA's documentation.
struct Driver {
    Status (*cuInit)(unsigned flags) = nullptr;
    Status (*cuDriverGetVersion)(int* version) = nullptr; ///< 1000 * major + 10 * minor
    Status (*cuGetErrorName)(Status status, const char** text) = nullptr;
    Status (*cuGetErrorString)(Status status, const char** text) = nullptr;
    Status (*cuDeviceGetCount)(int* count) = nullptr;
    Status (*cuDeviceGet)(DeviceNumber* device, int index) = nullptr;
    Status (*cuDeviceGetName)(char* text, int size, DeviceNumber device) = nullptr;
    Status (*cuDeviceGetPCIBusId)(char* text, int size, DeviceNumber device) = nullptr;
    Status (*cuDeviceGetAttribute)(int* value, int attribute, DeviceNumber device) = nullptr;
    Status (*cuDeviceTotalMem)(std::size_t* bytes, DeviceNumber device) = nullptr;
    Status (*cuDevicePrimaryCtxRetain)(ContextHandle* context, DeviceNumber device) = nullptr;
    Status (*cuDevicePrimaryCtxRelease)(DeviceNumber device) = nullptr;
    Status (*cuCtxPushCurrent)(ContextHandle context) = nullptr;
    Status (*cuCtxPopCurrent)(ContextHandle* context) = nullptr;
    Status (*cuStreamCreate)(StreamHandle* stream, unsigned flags) = nullptr;
    Status (*cuStreamSynchronize)(StreamHandle stream) = nullptr;
    Status (*cuStreamDestroy)(StreamHandle stream) = nullptr;
    Status (*cuEventCreate)(EventHandle* event, unsigned flags) = nullptr;
    Status (*cuEventRecord)(EventHandle event, StreamHandle stream) = nullptr;
    Status (*cuEventSynchronize)(EventHandle event) = nullptr;
    Status (*cuEventElapsedTime)(float* milliseconds, EventHandle begin, EventHandle end) = nullptr;
    Status (*cuEventDestroy)(EventHandle event) = nullptr;
    Status (*cuModuleLoadDataEx)(ModuleHandle* module, const void* image, unsigned count, int* options,
                                 void** values) = nullptr;
    Status (*cuModuleGetFunction)(FunctionHandle* function, ModuleHandle module, const char* name) = nullptr;
    Status (*cuModuleUnload)(ModuleHandle module) = nullptr;
    Status (*cuFuncGetAttribute)(int* value, int attribute, FunctionHandle function) = nullptr;
    Status (*cuMemAlloc)(Address* memory, std::size_t bytes) = nullptr;
    Status (*cuMemFree)(Address memory) = nullptr;
    Status (*cuMemHostAlloc)(void** memory, std::size_t bytes, unsigned flags) = nullptr;
    Status (*cuMemFreeHost)(void* memory) = nullptr;
    Status (*cuMemcpyHtoDAsync)(Address to, const void* from, std::size_t bytes, StreamHandle stream) = nullptr;
    Status (*cuMemcpyDtoHAsync)(void* to, Address from, std::size_t bytes, StreamHandle stream) = nullptr;
    Status (*cuMemcpyDtoDAsync)(Address to, Address from, std::size_t bytes, StreamHandle stream) = nullptr;
    Status (*cuLaunchKernel)(FunctionHandle function, unsigned blocks_x, unsigned blocks_y, unsigned blocks_z,
                             unsigned threads_x, unsigned threads_y, unsigned threads_z, unsigned shared_bytes,
                             StreamHandle stream, void** arguments, void** extra) = nullptr;
};

/// The driver that is installed. Its library is loaded once and kept for the process.
struct Installed {
    Driver driver;
    std::string why_not; ///< empty: it is there
};
const Installed& installed();

/// Only where installed().why_not is empty.
inline const Driver& driver() {
    return installed().driver;
}

/// Throws DeviceError that names what failed, and how.
void check(Status status, std::string_view what);

} // namespace raycontact::cuda
