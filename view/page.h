// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace raycontact::view {

/// The whole HTML document: the files of view/page with the data in their midst. json: of one object.
std::string make_page(std::string_view title, std::string_view json);

} // namespace raycontact::view
