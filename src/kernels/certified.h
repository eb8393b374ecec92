// SPDX-License-Identifier: Apache-2.0
// The kernels of the certified method (docs/internals/certified.md). Only devices that share the host's memory run
// them. Included after kernels.h.
// clang-format off
#include "kernels/candidates.h"
#include "kernels/swept_clearance.h"
#include "kernels/held_group.h"
#include "kernels/normal_cone.h"
#include "kernels/hold.h"
