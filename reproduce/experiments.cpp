// SPDX-License-Identifier: Apache-2.0
#include <reproduce/experiments.h>

namespace raycontact::reproduce {

std::vector<Experiment> all_experiments(const Workshop& shop) {
    std::vector<Experiment> all;
    const std::vector<std::string> scenes = scene_names();
    all.push_back(table1(shop));
    for (const std::string& scene : scenes) all.push_back(wrong_rays(shop, scene));
    all.push_back(lengths(shop));
    all.push_back(volumes(shop));
    for (const std::string& scene : scenes) all.push_back(times(shop, scene));
    all.push_back(table2(shop));
    for (const std::string& scene : scenes) all.push_back(two_devices(shop, scene));
    all.push_back(lga13(shop));
    return all;
}

} // namespace raycontact::reproduce
