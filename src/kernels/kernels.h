// SPDX-License-Identifier: Apache-2.0
// Every kernel, in the order of the pipeline; included after one dialect.h and types.h. No include guards: the CPU
// device compiles this text once per instruction set.
#include "kernels/triangle.h"

#include "kernels/traverse.h"

#include "kernels/source_ray.h"

#include "kernels/ray_group.h"

#include "kernels/near_leaves.h"

#include "kernels/traverse_group.h"

#include "kernels/vertex_lanes.h"

#include "kernels/clearance.h"

#include "kernels/find_clusters.h"

#include "kernels/find_vertices.h"

#include "kernels/watch.h"

#include "kernels/look.h"

#include "kernels/cast_rays.h"

#include "kernels/tube.h"

#include "kernels/cap.h"

#include "kernels/held_group.h"

#include "kernels/cap_group.h"

#include "kernels/hold.h"

#include "kernels/follow.h"

#include "kernels/emit_contacts.h"

#include "kernels/scan.h"
