// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <reproduce/workshop.h>

#include <string>
#include <vector>

// One function for each experiment; `scene` is "avalanche" or "rain". The workshop must outlive what they return.
namespace raycontact::reproduce {

Experiment table1(const Workshop& shop);
Experiment wrong_rays(const Workshop& shop, const std::string& scene); ///< Figures 9 and 10, and the scene's size
Experiment lengths(const Workshop& shop);                              ///< section 5.2
Experiment volumes(const Workshop& shop);                              ///< section 5.2, beside the exact volume
Experiment times(const Workshop& shop, const std::string& scene);      ///< Figures 11 and 12, section 5.3
Experiment table2(const Workshop& shop);
Experiment two_devices(const Workshop& shop, const std::string& scene); ///< Figures 14 and 15
Experiment lga13(const Workshop& shop);                                 ///< LGA13 against its start, section 1

/// "avalanche" and "rain".
std::vector<std::string> scene_names();

} // namespace raycontact::reproduce
