// SPDX-License-Identifier: Apache-2.0
#include "edges/regions.h"

namespace raycontact {

void Regions::join_keys() {
    std::sort(keys_.begin(), keys_.end());
    for (std::size_t i = 1; i < keys_.size(); ++i)
        if (keys_[i].first == keys_[i - 1].first) join(keys_[i].second, keys_[i - 1].second);
    keys_.clear();
}

} // namespace raycontact
