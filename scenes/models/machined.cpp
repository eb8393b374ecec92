// SPDX-License-Identifier: Apache-2.0
#include <scenes/models/machined.h>

#include <scenes/models/skin.h>

#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

namespace raycontact::scenes {

namespace {

constexpr double flat_at_root = 0.25, flat_at_crest = 0.125; // of a pitch
constexpr double flank = (1 - flat_at_root - flat_at_crest) / 2;

double depth_of(const Thread& thread) {
    return flank * thread.pitch / std::tan(30 * std::numbers::pi / 180);
}

/// The thread's surface, of lines that climb: point k of column i lies at the turn i / around and the height of k and
/// that turn. After a turn each line goes on in the one that began a pitch higher. It lies between two level rings of
/// `end` radius at z = low and z = high.
void add_thread(Skin& skin, const Thread& thread, double play, bool starts_inside, double end, double low, double high,
                Loop& bottom, Loop& top) {
    const double outer = thread.outer + play, inner = outer - depth_of(thread);
    // From the beginning of one flat to the beginning of the next one of its kind.
    struct Corner {
        double at, radius;
    };
    const std::vector<Corner> inside_first{{0, inner},
                                           {flat_at_root, inner},
                                           {flat_at_root + flank / 2, (inner + outer) / 2},
                                           {flat_at_root + flank, outer},
                                           {1 - flank, outer},
                                           {1 - flank / 2, (inner + outer) / 2}};
    std::vector<Corner> corners;
    // A nut begins where a bolt has its crest: the same lines, from another on.
    constexpr std::size_t first_outside = 3;
    for (std::size_t k = 0; k < inside_first.size(); ++k) {
        const std::size_t from = starts_inside ? 0 : first_outside, index = (from + k) % inside_first.size();
        const double at = inside_first[index].at + (from + k >= inside_first.size() ? 1 : 0);
        corners.push_back({at, inside_first[index].radius});
    }
    const std::uint32_t around = thread.around;
    const auto a_pitch = static_cast<std::uint32_t>(corners.size());
    // The lines keep off the rings. The last one climbs a pitch more.
    constexpr double off = 0.1;
    const auto first_pitch = static_cast<int>(std::ceil(low / thread.pitch + off - corners[0].at));
    const auto last_pitch = static_cast<int>(std::floor(high / thread.pitch - off - corners[0].at)) - 1;
    std::vector<Loop> columns(around + 1);
    const auto lines = static_cast<std::uint32_t>(last_pitch - first_pitch) * a_pitch + 1;
    for (std::uint32_t i = 0; i < around; ++i) {
        const double turn = static_cast<double>(i) / around;
        const SineCosine angle = sine_cosine(turn);
        // The first column has a pitch more: the last column's lines end there.
        const std::uint32_t count = lines + (i == 0 ? a_pitch : 0);
        for (std::uint32_t k = 0; k < count; ++k) {
            const Corner& corner = corners[k % a_pitch];
            const double z = thread.pitch * (first_pitch + k / a_pitch + corner.at + turn);
            columns[i].push_back(skin.add(corner.radius * angle.cosine, corner.radius * angle.sine, z));
        }
    }
    columns[around] = {columns[0].begin() + a_pitch, columns[0].end()};
    for (std::uint32_t i = 0; i < around; ++i)
        for (std::uint32_t k = 0; k + 1 < lines; ++k)
            skin.quad(columns[i][k], columns[i + 1][k], columns[i + 1][k + 1], columns[i][k + 1]);
    bottom = skin.add_ring(end, low, around);
    top = skin.add_ring(end, high, around);
    const std::uint32_t last = around - 1, end_line = lines - 1;
    for (std::uint32_t i = 0; i < last; ++i) {
        skin.quad(bottom[i], bottom[i + 1], columns[i + 1][0], columns[i][0]);
        const std::uint32_t k = i + 1;
        skin.quad(columns[k][end_line], columns[k + 1][end_line], top[(k + 1) % around], top[k]);
    }
    // Where a line has come round, it lies a pitch above its beginning. There the thread begins and ends with a wall:
    // the ridge's cut, between the second line and the last of a pitch.
    const std::uint32_t before = columns[last][0], after = columns[1][end_line];
    const std::uint32_t* s = columns[0].data();
    skin.quad(bottom[last], bottom[0], s[0], before);
    skin.triangle(before, s[0], s[1]);
    skin.triangle(before, s[1], s[6]);
    skin.quad(s[1], s[2], s[5], s[6]);
    skin.quad(s[2], s[3], s[4], s[5]);
    s += end_line;
    skin.triangle(after, s[1], s[0]);
    skin.triangle(after, s[6], s[1]);
    skin.quad(after, top[1], top[0], s[6]);
    skin.quad(s[6], s[5], s[2], s[1]);
    skin.quad(s[5], s[4], s[3], s[2]);
}

} // namespace

Mesh solid_box(const Vec3& size) {
    Skin skin("box");
    Loop below, above;
    for (const auto& [ring, z] : {std::pair{&below, -size.z / 2}, {&above, size.z / 2}})
        for (const auto& [x, y] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}) // counter-clockwise from above
            ring->push_back(skin.add(x * size.x / 2, y * size.y / 2, z));
    skin.quad(0, 3, 2, 1);
    skin.quad(4, 5, 6, 7);
    skin.join(below, above);
    return skin.mesh();
}

Mesh threaded_bolt(const Thread& thread) {
    Skin skin("bolt");
    Loop bottom, top;
    add_thread(skin, thread, 0, true, thread.outer - depth_of(thread), 0, thread.length, bottom, top);
    const double head = thread.across / 2, thick = 0.6 * thread.outer;
    const Loop under = skin.add_ring(head, 0, thread.around), below = skin.add_ring(head, -thick, thread.around);
    skin.join(under, bottom);
    skin.join(below, under);
    skin.fan(skin.add(0, 0, -thick), {below.rbegin(), below.rend()});
    skin.fan(skin.add(0, 0, thread.length), top);
    return skin.mesh();
}

Mesh threaded_nut(const Thread& thread) {
    Skin skin("nut");
    Loop bottom, top;
    add_thread(skin, thread, thread.play, false, thread.outer + thread.play, 0, thread.nut, bottom, top);
    const auto hexagon = [&](double z) {
        Loop ring;
        for (std::uint32_t i = 0; i < thread.around; ++i) {
            const double turn = static_cast<double>(i) / thread.around;
            const double sixth = turn * 6 - std::floor(turn * 6);
            const double radius = thread.across / 2 / sine_cosine((sixth - 0.5) / 6).cosine;
            const SineCosine at = sine_cosine(turn);
            ring.push_back(skin.add(radius * at.cosine, radius * at.sine, z));
        }
        return ring;
    };
    const Loop below = hexagon(0), above = hexagon(thread.nut);
    skin.join(below, bottom);
    skin.join(top, above);
    skin.join(above, below);
    return skin.mesh();
}

} // namespace raycontact::scenes
