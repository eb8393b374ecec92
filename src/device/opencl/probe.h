// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "device/opencl/launcher.h"
#include "device/opencl/program.h"

namespace raycontact::opencl {

/// What a device was found to compute.
struct Probed {
    std::string differs;       ///< the first float operation whose bits are not the host's; empty: it is exact
    bool exact_double = false; ///< it can place pairs
};

/// Lets the device compute 65 536 of each operation that decides a contact, and compares them with the host's, bit for
/// bit. A driver's own claims are not enough: some contract or flush whatever the text and the options demand.
Probed probe(Launcher& launcher, const Program& program, const Source& source, cl_context context);

} // namespace raycontact::opencl
