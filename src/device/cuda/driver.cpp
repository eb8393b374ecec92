// SPDX-License-Identifier: Apache-2.0
#include "device/cuda/driver.h"

#include "platform/system.h"

namespace raycontact::cuda {

namespace {

constexpr const char* library_name = platform::on_windows ? "nvcuda.dll" : "libcuda.so.1";

} // namespace

Driver::Driver() : library(library_name) {
    if (!library) why_not = "no CUDA driver is installed here (" + std::string(library_name) + ")";
}

const Driver& driver() {
    static const Driver installed;
    return installed;
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
