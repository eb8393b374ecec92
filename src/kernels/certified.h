// SPDX-License-Identifier: Apache-2.0
// The kernels of the certified method (docs/certified.md), which only devices run that share the host's memory;
// included after kernels.h.
// clang-format off
#include "kernels/watch.h"
#include "kernels/tube.h"
#include "kernels/held_group.h"
#include "kernels/cap.h"
#include "kernels/hold.h"
