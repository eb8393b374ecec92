// SPDX-License-Identifier: Apache-2.0
// The kernels that every device runs, in the order of the pipeline; included after one dialect.h and types.h. No
// include guards: the CPU device compiles this text once per instruction set.
// clang-format off
#include "kernels/triangle.h"
#include "kernels/traverse.h"
#include "kernels/source_ray.h"
#include "kernels/ray_group.h"
#include "kernels/traverse_group.h"
#include "kernels/vertex_lanes.h"
#include "kernels/place_pairs.h"
#include "kernels/find_pairs.h"
#include "kernels/clearance.h"
#include "kernels/find_clusters.h"
#include "kernels/find_vertices.h"
#include "kernels/cast_rays.h"
#include "kernels/find_near.h"
#include "kernels/find_inside.h"
#include "kernels/follow.h"
#include "kernels/emit_contacts.h"
