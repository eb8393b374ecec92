// SPDX-License-Identifier: Apache-2.0
#include <tests/motion/scenes.h>

#include <iterator>

namespace raycontact::scenes {

std::vector<Hold> all_motions() {
    std::vector<Hold> all;
    for (auto group : {slides(), seams(), slopes(), rolls(), bounces()})
        all.insert(all.end(), std::make_move_iterator(group.begin()), std::make_move_iterator(group.end()));
    return all;
}

} // namespace raycontact::scenes
