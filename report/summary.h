// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <report/page.h>
#include <scenes/run_log.h>

namespace raycontact::report {

/// The words of the page: title, summary, table, command, footer, from the log and its summary_json. A summary that is
/// not JSON, or lacks a key, leaves that out; a key that is not known here is shown as it is.
void describe(const scenes::RunLog& log, Page& page);

} // namespace raycontact::report
