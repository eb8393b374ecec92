// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <output/out_folder.h>
#include <report/page.h>
#include <scenes/run_log.h>

#include <string>

namespace raycontact::report {

/// Claims what write_report will write, as far as its names are known.
void claim_report(output::OutFolder& folder);

/// Writes report.html, one file that needs no network and no other file. view: what view::make_view() made of the run;
/// empty: none. The caller keeps the file. The log has a step. Throws as OutFolder::write does.
void write_report(output::OutFolder& folder, const scenes::RunLog& log, const std::string& view = {},
                  const Comparison& comparison = {});

} // namespace raycontact::report
