// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <report/image.h>

#include <string>
#include <vector>

namespace raycontact::report {

/// An animated WebP that begins anew at its end; frames of one size. Throws std::runtime_error if libwebp fails.
std::string encode_webp(const std::vector<Image>& frames, int milliseconds_a_frame);

} // namespace raycontact::report
