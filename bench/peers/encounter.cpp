// SPDX-License-Identifier: Apache-2.0
#include <bench/peers/encounter.h>

#include <utility>

namespace raycontact::bench {

Pose Encounter::pose(bool second, double distance, double sine, double cosine) const {
    const auto& spin = second ? spin_b : spin_a;
    const Quaternion q = times({cosine, sine * spin[0], sine * spin[1], sine * spin[2]}, second ? b : a);
    const double at = second ? distance : 0;
    const Vec3 where{home.x + at * way[0], home.y + at * way[1], home.z + at * way[2]};
    return pose_from_quaternion(where, q[0], q[1], q[2], q[3]);
}

std::vector<Encounter> encounters(std::uint32_t count) {
    constexpr double cell = 4;
    scenes::Random random(1);
    std::vector<Encounter> list(count);
    for (std::uint32_t i = 0; i < count; ++i) {
        Encounter& one = list[i];
        const std::uint32_t column = i % 4, row = i / 4 % 4, layer = i / 16;
        one.home = {cell * column, cell * row, cell * layer};
        one.way = random_direction(random);
        one.spin_a = random_direction(random);
        one.spin_b = random_direction(random);
        one.a = random_rotation(random);
        one.b = random_rotation(random);
    }
    return list;
}

Work encounter_work(std::string name, const std::shared_ptr<const Shape>& shape, std::string source,
                    std::uint32_t count) {
    Work work;
    work.name = std::move(name);
    work.source = std::move(source);
    work.shapes = {shape};
    work.body_shape.assign(std::size_t{2} * count, 0);
    return work;
}

std::vector<Pair> encounter_pairs(std::size_t count) {
    std::vector<Pair> pairs;
    for (std::uint32_t i = 0; i < count; ++i) pairs.emplace_back(BodyId{2 * i, 0}, BodyId{2 * i + 1, 0});
    return pairs;
}

} // namespace raycontact::bench
