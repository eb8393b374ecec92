// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <reproduce/workshop.h>

#include <string>

namespace raycontact::reproduce {

/// The 3D view of the scene that Figure 9 or 10 follows, with the contacts and predictions of `predictive`, for
/// PackedView::html.
Part view_part(const Workshop& shop, const std::string& scene);

} // namespace raycontact::reproduce
