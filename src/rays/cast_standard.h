// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "rays/ray_queue.h"

#include <raycontact/settings.h>

namespace raycontact {

/// The standard method: every ray in full (paper section 2.1). hits[i] belongs to rays[i].
/// short_first: the rays are those that a grid left over, most of which end close by; a matter of time alone.
void cast_standard(Device& device, Caster caster, const ShapeStore::Arrays& shapes,
                   const Array<kernels::OrderedPair>& pairs, const Array<kernels::Ray>& rays, Array<kernels::Hit>& hits,
                   bool short_first = true);

} // namespace raycontact
