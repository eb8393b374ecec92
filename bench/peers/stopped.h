// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace raycontact::bench {

/// What a progress callback throws to end a benchmark early: what was measured in whole until then still counts.
struct Stopped {};

} // namespace raycontact::bench
