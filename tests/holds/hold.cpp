// SPDX-License-Identifier: Apache-2.0
#include <tests/holds/hold.h>

#include <scenes/models/trigonometry.h>
#include <tests/holds/scenes.h>

#include <iterator>

namespace raycontact::scenes {

Pose turned_at(const Vec3& place, const Vec3& axis, double turns) {
    const SineCosine half = sine_cosine(turns / 2);
    return pose_from_quaternion(place, half.cosine, half.sine * axis.x, half.sine * axis.y, half.sine * axis.z);
}

std::vector<Hold> all_holds() {
    std::vector<Hold> all;
    for (auto group : {standing(), contraptions(), fits(), heaps()})
        all.insert(all.end(), std::make_move_iterator(group.begin()), std::make_move_iterator(group.end()));
    return all;
}

} // namespace raycontact::scenes
