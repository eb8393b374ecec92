// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <report/page.h>
#include <scenes/run_log.h>

/// Bullet's GImpact and ours on the poses of up to three frames of a run, by turns on one thread; takes some seconds.
/// No rows where no frame has a pair.
raycontact::report::Comparison compare_with_gimpact(const raycontact::scenes::RunLog& log);
