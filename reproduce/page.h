// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <reproduce/experiment.h>
#include <reproduce/plan.h>

#include <string>
#include <vector>

namespace raycontact::reproduce {

/// An experiment on the page.
struct Section {
    std::string name, title;
    Outcome outcome;
    std::vector<std::string> machines; ///< on which its parts were run
};

struct Page {
    Plan plan;
    std::vector<Section> sections;
    std::vector<std::string> not_run; ///< names of experiments
};

/// One HTML document with everything inside: no link to another host. Without scripts it lacks the 3D views alone.
std::string make_page(const Page& page);

} // namespace raycontact::reproduce
