// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <report/plot.h>
#include <scenes/run_log.h>

#include <string>
#include <vector>

namespace raycontact::report {

/// A figure of the table: what it is, its value, its unit, and what it means in a few words.
struct Row {
    std::string name, value, unit, meaning;
};

/// The same question put to someone else.
struct Comparison {
    std::string title;
    std::vector<Row> rows; ///< none: no comparison
    std::string note;      ///< what was compared, and what not
};

/// All that goes on the page; every text is made safe by make_page.
struct Page {
    std::string title;
    std::string summary;
    std::string view;        ///< a page of its own, shown in a frame; empty: none
    std::vector<Plot> plots; ///< over the same steps
    std::vector<Row> rows;
    std::string zeros; ///< what would be rows of zeros, in one sentence; empty: none
    Comparison comparison;
    std::string command; ///< that makes the same run again
    std::string footer;
};

/// One HTML document with everything inside: no link, no font, no script from elsewhere.
std::string make_page(const Page& page);

/// The words of the page: title, summary, table, command, footer, from the log and its summary_json. A summary that is
/// not JSON, or lacks a key, leaves that out; a key that is not known here is shown as it is.
void describe(const scenes::RunLog& log, Page& page);

} // namespace raycontact::report
