// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <report/image.h>

#include <string>

namespace raycontact::report {

/// PNG or JPEG, read by stb_image; fails the test when it cannot be.
Image decode(const std::string& bytes);

/// Standard deviation of the green channel, 0 for a blank picture.
double contrast(const Image& image);

} // namespace raycontact::report
