// SPDX-License-Identifier: Apache-2.0
#include "exact/corners.h"

#include "exact/assemblies.h"
#include "exact/random_solids.h"
#include "reference/meshes.h"
#include "reference/vector.h"

#include "scenes/models/trigonometry.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace raycontact::exact {

using namespace reference;

namespace {

// How far the parts are in each other along x and y.
struct Overlap {
    double x, y;
    double way() const { return std::hypot(x, y); }
};

Overlap overlap_of(Random& random) {
    const auto one = [&] { return 1e-4 * std::pow(100, random.uniform()); };
    return {one(), one()};
}

struct Span {
    double low, high;
};

// Along the profile: b as long as a, shorter, longer, or beside its end.
Span span_beside(const Span& a, Random& random) {
    const double size = a.high - a.low, part = random.uniform(0.1, 0.4) * size;
    switch (random.below(5)) {
    case 0:
        return a;
    case 1:
        return {a.low + part, a.high - random.uniform(0.1, 0.4) * size};
    case 2:
        return {a.low - part, a.high + random.uniform(0.1, 0.4) * size};
    case 3:
        return {a.low + part, a.high + part};
    default:
        return {a.low, a.high - part};
    }
}

// A rectangle of which the corner at (x0, y0) may be cut.
Outline bar_outline(double x0, double y0, double width, double height, double cut) {
    Outline outline = rectangle(x0, y0, x0 + width, y0 + height);
    if (cut > 0) {
        outline[0] = {x0 + cut, y0};
        outline.push_back({x0, y0 + cut});
    }
    return outline;
}

double cut_of(Random& random) {
    return random.below(3) == 0 ? random.uniform(0.002, 0.02) : 0;
}

// The inner corner of an angle at the origin, filled or sharp.
Outline angle_outline(double width, double height, double thick, double fillet) {
    Outline outline = shifted(l_outline(width + thick, height + thick, thick), -thick, -thick);
    if (fillet > 0) {
        outline[3] = {fillet, 0};
        outline.insert(outline.begin() + 4, {0, fillet});
    }
    return outline;
}

// By up to 0.3 degrees about a point, for two of three pairs; the third lies as drawn.
void tilt(CornerPair& pair, const Vec3& about, Random& random) {
    if (random.below(3) == 0) return;
    const double angle = random.uniform(0, 0.3) * 0.0174533;
    pair.pose_b = small_rotation(random.direction(), angle);
    pair.pose_b.translation = about - rotate(pair.pose_b, about);
    double reach = 0;
    for (const Vec3& v : pair.b.vertices) reach = std::max(reach, length(v - about));
    pair.way += 2 * angle * reach;
}

CornerPair extruded_pair(const Outline& a, const Span& span_a, const Outline& b, const Span& span_b, double way,
                         Random& random) {
    CornerPair pair{
        extruded("a", a, {}, span_a.low, span_a.high), extruded("b", b, {}, span_b.low, span_b.high), {}, way};
    tilt(pair, {0, 0, 0.5 * (span_a.low + span_a.high)}, random);
    return pair;
}

CornerPair bar_in_angle(Random& random) {
    const Overlap in = overlap_of(random);
    const Outline angle =
        angle_outline(random.uniform(0.05, 0.6), random.uniform(0.05, 0.6), random.uniform(0.05, 0.3), 0);
    const Outline bar = bar_outline(-in.x, -in.y, random.uniform(0.05, 0.6), random.uniform(0.05, 0.6), cut_of(random));
    const Span span{0, random.uniform(0.2, 1)};
    return extruded_pair(angle, span, bar, span_beside(span, random), in.way(), random);
}

CornerPair angle_on_edge(Random& random) {
    const Overlap in = overlap_of(random);
    const Outline box = bar_outline(0, 0, random.uniform(0.2, 1), random.uniform(0.2, 1), cut_of(random));
    const Outline angle = shifted(
        angle_outline(random.uniform(0.05, 0.8), random.uniform(0.05, 0.8), random.uniform(0.05, 0.2), 0), in.x, in.y);
    const Span span{0, random.uniform(0.2, 1)};
    return extruded_pair(box, span, angle, span_beside(span, random), in.way(), random);
}

CornerPair angle_on_angle(Random& random) {
    const Overlap in = overlap_of(random);
    const double thick = random.uniform(0.05, 0.2);
    const Outline angle = angle_outline(random.uniform(0.3, 0.8), random.uniform(0.3, 0.8), thick, 0);
    const Outline other = shifted(angle_outline(random.uniform(0.3, 0.8), random.uniform(0.3, 0.8), thick, 0),
                                  thick - in.x, thick - in.y);
    const Span span{0, random.uniform(0.2, 1)};
    return extruded_pair(angle, span, other, span_beside(span, random), in.way(), random);
}

// Its inner lower left corner at the origin.
Outline channel_outline(double width, double height, double thick) {
    return shifted(u_outline(width + 2 * thick, height + thick, thick), -thick, -thick);
}

CornerPair bar_in_channel(Random& random) {
    const Overlap in = overlap_of(random);
    const double width = random.uniform(0.2, 0.8), height = random.uniform(0.1, 0.6);
    const Outline bar =
        bar_outline(-in.x, -in.y, random.uniform(0.3, 0.9) * width, random.uniform(0.05, 0.8), cut_of(random));
    const Span span{0, random.uniform(0.2, 1)};
    return extruded_pair(channel_outline(width, height, random.uniform(0.05, 0.2)), span, bar,
                         span_beside(span, random), in.way(), random);
}

// Too wide by `in` on either side, above the ground: each side has a way of its own.
CornerPair wide_bar_in_channel(Random& random) {
    const Overlap in = overlap_of(random);
    const double width = random.uniform(0.2, 0.8), height = random.uniform(0.3, 0.6);
    const Outline bar = rectangle(-in.x, 0.1, width + in.x, 0.1 + random.uniform(0.05, 0.5));
    const Span span{0, random.uniform(0.2, 1)};
    CornerPair pair{extruded("a", channel_outline(width, height, random.uniform(0.05, 0.2)), {}, span.low, span.high),
                    {},
                    {},
                    in.x};
    const Span other = span_beside(span, random);
    pair.b = extruded("b", bar, {}, other.low, other.high);
    return pair;
}

// A block with a T-slot from above, its neck and its wide part; and the key, smaller by `play` all round.
CornerPair key_in_slot(Random& random) {
    const double neck = random.uniform(0.1, 0.2), wide = neck + random.uniform(0.05, 0.2);
    const double under = random.uniform(0.1, 0.3), over = random.uniform(0.1, 0.3), wall = random.uniform(0.05, 0.2);
    const double play = 1e-3 * random.uniform(1, 5);
    const Outline block{{-wide - wall, -wall},
                        {wide + wall, -wall},
                        {wide + wall, under + over},
                        {neck, under + over},
                        {neck, under},
                        {wide, under},
                        {wide, 0},
                        {-wide, 0},
                        {-wide, under},
                        {-neck, under},
                        {-neck, under + over},
                        {-wide - wall, under + over}};
    const double n = neck - play, w = wide - play, u = under - play, top = under + over + random.uniform(-0.05, 0.1);
    const Outline key{{-w, play}, {w, play}, {w, u}, {n, u}, {n, top}, {-n, top}, {-n, u}, {-w, u}};
    const Overlap in = overlap_of(random);
    const double right = random.below(2) == 0 ? 1 : -1, up = random.below(2) == 0 ? 1 : -1;
    const bool only_x = random.below(4) == 0, only_y = !only_x && random.below(4) == 0;
    const double x = only_y ? 0 : in.x, y = only_x ? 0 : in.y;
    const Span span{0, random.uniform(0.2, 1)};
    return extruded_pair(block, span, shifted(key, only_y ? 0 : right * (play + x), only_x ? 0 : up * (play + y)),
                         span_beside(span, random), std::hypot(x, y), random);
}

CornerPair dovetail(Random& random) {
    const double narrow = random.uniform(0.1, 0.2), wide = narrow + random.uniform(0.03, 0.15);
    const double high = random.uniform(0.1, 0.3), wall = random.uniform(0.1, 0.2);
    const Outline block{
        {-wide - wall, -wall}, {wide + wall, -wall}, {wide + wall, high}, {narrow, high}, {wide, 0}, {-wide, 0},
        {-narrow, high},       {-wide - wall, high}};
    const double play = 1e-3 * random.uniform(1, 5), top = high + random.uniform(-0.02, 0.1);
    const double slope = (wide - narrow) / high;
    const auto half = [&](double y) { return wide - slope * y - play; };
    Outline tail{{-half(play), play}, {half(play), play}};
    if (top > high) {
        const Outline more{{half(high), high}, {half(high), top}, {-half(high), top}, {-half(high), high}};
        tail.insert(tail.end(), more.begin(), more.end());
    } else {
        const Outline more{{half(top), top}, {-half(top), top}};
        tail.insert(tail.end(), more.begin(), more.end());
    }
    const Overlap in = overlap_of(random);
    const double right = random.below(2) == 0 ? 1 : -1;
    const double x = random.below(3) == 0 ? 0 : play + in.x, y = random.below(2) == 0 ? play + in.y : 0;
    const Span span{0, random.uniform(0.2, 1)};
    return extruded_pair(block, span, shifted(tail, right * x, -y), span_beside(span, random), std::hypot(x, y),
                         random);
}

CornerPair saw_teeth(Random& random) {
    const std::uint32_t teeth = 1 + random.below(8);
    const double width = random.uniform(0.05, 0.2), high = random.uniform(0.03, 0.3), body = 0.3;
    Outline lower, upper;
    for (std::uint32_t k = 0; k <= 2 * teeth; ++k) upper.push_back({0.5 * width * k, k % 2 == 0 ? 0 : high});
    lower.assign(upper.rbegin(), upper.rend());
    lower.insert(lower.end(), {{0, -body}, {width * teeth, -body}});
    upper.insert(upper.end(), {{width * teeth, high + body}, {0, high + body}});
    const double down = overlap_of(random).x;
    const double aside = random.below(2) == 0 ? 0 : random.uniform(-1, 1) * down * 0.5 * width / high;
    const double along = random.below(3) == 0 ? width * random.below(teeth) : 0; // some teeth on
    const Span span{0, random.uniform(0.2, 1)};
    return extruded_pair(lower, span, shifted(upper, aside + along, -down), span_beside(span, random),
                         std::hypot(aside, down), random);
}

CornerPair cube_in_tray(Random& random) {
    const auto in = [&] { return overlap_of(random).x; };
    const Vec3 deep{in(), in(), in()},
        half{random.uniform(0.1, 0.7), random.uniform(0.1, 0.7), random.uniform(0.1, 0.9)};
    CornerPair pair{tray_mesh(), moved(box_mesh(half), Vec3{-0.8, -0.8, 0.2} + half - deep), {}, length(deep)};
    tilt(pair, {-0.8, -0.8, 0.2}, random);
    return pair;
}

// A cone from z = -height to its apex in the origin, and a shell over it that is `in` too low.
CornerPair cone_in_cap(Random& random) {
    const auto sides = 3 + random.below(20);
    const double radius = random.uniform(0.1, 0.5), height = random.uniform(0.1, 0.6),
                 thick = random.uniform(0.05, 0.2);
    const double part = random.uniform(0.3, 1.2);
    CornerPair pair{moved(cone_solid(sides, radius, height), {0, 0, -height}), {}, {}, overlap_of(random).x};
    Mesh cap;
    cap.name = "cap";
    for (const double out : {0.0, thick})
        for (const auto& [x, y] : regular(sides, part * radius + out)) cap.vertices.push_back({x, y, -part * height});
    cap.vertices.push_back({0, 0, 0});
    cap.vertices.push_back({0, 0, thick * (1 + height / radius)});
    for (std::uint32_t i = 0; i < sides; ++i) {
        const std::uint32_t j = (i + 1) % sides, in = 2 * sides, out = in + 1;
        cap.triangles.push_back({i, in, j});
        cap.triangles.push_back({sides + i, sides + j, out});
        cap.triangles.push_back({i, j, sides + j});
        cap.triangles.push_back({i, sides + j, sides + i});
    }
    pair.b = moved(cap, {0, 0, -pair.way});
    tilt(pair, {}, random);
    return pair;
}

CornerPair half_shell(Random& random) {
    const std::uint32_t half = 4 + random.below(20);
    const double radius = random.uniform(0.1, 0.4), thick = random.uniform(0.03, 0.2);
    const Outline rod = regular(2 * half, radius);
    Outline shell;
    for (std::uint32_t i = 0; i <= half; ++i)
        shell.push_back({(radius + thick) / radius * rod[i][0], (radius + thick) / radius * rod[i][1]});
    for (std::uint32_t i = 0; i <= half; ++i) shell.push_back(rod[half - i]);
    const double down = overlap_of(random).x;
    const Span span{0, random.uniform(0.2, 1)};
    return extruded_pair(rod, span, shifted(shell, 0, -down), span_beside(span, random), down, random);
}

CornerPair stairs(Random& random) {
    const std::uint32_t steps = 1 + random.below(6);
    std::vector<double> x{0}, y{0}; // where steps end; no two alike, so that no corners lie in a line
    for (std::uint32_t k = 0; k <= steps; ++k) {
        x.push_back(x.back() + random.uniform(0.1, 0.3));
        y.push_back(y.back() + random.uniform(0.1, 0.3));
    }
    Outline lower{{x[steps + 1], -0.3}, {x[steps + 1], y[steps]}};
    for (std::uint32_t k = steps; k > 0; --k) {
        lower.push_back({x[k], y[k]});
        lower.push_back({x[k], y[k - 1]});
    }
    lower.insert(lower.end(), {{0, 0}, {0, -0.3}});
    // A box on one of the steps, or the other half of the block.
    const Overlap in = overlap_of(random);
    Outline upper;
    if (random.below(2) == 0) {
        const std::uint32_t k = 1 + random.below(steps);
        upper = rectangle(x[k] - random.uniform(0.05, 0.5), y[k - 1], x[k], y[k - 1] + random.uniform(0.05, 0.5));
    } else {
        for (std::uint32_t k = 0; k <= steps; ++k) {
            upper.push_back({x[k], y[k]});
            upper.push_back({x[k + 1], y[k]});
        }
        upper.insert(upper.end(), {{x[steps + 1], y[steps] + 0.3}, {0, y[steps] + 0.3}});
    }
    const Span span{0, random.uniform(0.2, 1)};
    return extruded_pair(lower, span, shifted(upper, in.x, -in.y), span_beside(span, random), in.way(), random);
}

CornerPair combs(Random& random) {
    const std::uint32_t teeth = 2 + random.below(5);
    const double tooth = random.uniform(0.05, 0.1), play = 1e-3 * random.uniform(2, 6), high = random.uniform(0.1, 0.4);
    const double pitch = 2 * (tooth + play), body = 0.1;
    Outline lower{{0, -body}, {pitch * teeth, -body}};
    for (std::uint32_t k = teeth; k > 0; --k) {
        const double x = pitch * (k - 1);
        lower.push_back({x + pitch, 0});
        lower.push_back({x + tooth, 0});
        lower.push_back({x + tooth, high});
        lower.push_back({x, high});
    }
    Outline upper;
    upper.push_back({pitch * teeth + tooth, high + body});
    upper.push_back({tooth, high + body});
    for (std::uint32_t k = 0; k < teeth; ++k) {
        const double x = pitch * k + tooth + play;
        if (k == 0) {
            upper.back() = {x, high + body};
        } else {
            upper.push_back({x, high});
        }
        upper.push_back({x, 0});
        upper.push_back({x + tooth, 0});
        if (k + 1 < teeth)
            upper.push_back({x + tooth, high});
        else
            upper[0] = {x + tooth, high + body};
    }
    const Overlap in = overlap_of(random);
    const bool aside = random.below(3) != 0, down = !aside || random.below(2) == 0;
    const double x = aside ? (random.below(2) == 0 ? 1 : -1) * (play + in.x) : 0,
                 y = down ? in.y : -random.uniform(0.01, 0.05);
    const Span span{0, random.uniform(0.2, 1)};
    return extruded_pair(lower, span, shifted(upper, x, -y), span_beside(span, random),
                         std::hypot(aside ? in.x : 0, down ? in.y : 0), random);
}

// Two bars, each with a notch for the other.
CornerPair half_lap(Random& random) {
    const double high = random.uniform(0.1, 0.3), play = 1e-3 * random.uniform(1, 5);
    const double wide_a = random.uniform(0.1, 0.3), wide_b = random.uniform(0.1, 0.3),
                 cut = random.uniform(0.3, 0.7) * high;
    const double far = random.uniform(0.3, 0.8);
    const auto notched = [&](double half) {
        return Outline{{-far, 0},   {far, 0},     {far, high},   {half, high},
                       {half, cut}, {-half, cut}, {-half, high}, {-far, high}};
    };
    // Outlines in x and z, along y.
    CornerPair pair{extruded("a", notched(wide_b / 2 + play), {}, -wide_a / 2, wide_a / 2),
                    extruded("b", notched(wide_a / 2 + play), {}, -wide_b / 2, wide_b / 2),
                    {},
                    0};
    for (Vec3& v : pair.a.vertices) v = {v.x, -v.z, v.y};
    const double top = 2 * cut;
    for (Vec3& v : pair.b.vertices) v = {-v.z, -v.x, top - v.y};
    const Overlap in = overlap_of(random);
    const double third = overlap_of(random).x;
    const auto signs = [&] { return random.below(3) == 0 ? 0.0 : random.below(2) == 0 ? 1.0 : -1.0; };
    const double sx = signs(), sy = signs();
    const Vec3 deep{sx * in.x, sy * in.y, -third};
    pair.b = moved(pair.b, deep + Vec3{sx * play, sy * play, 0});
    pair.way = length(deep);
    tilt(pair, {0, 0, cut}, random);
    return pair;
}

// A block with a groove in the form of a V on the edge of a bar.
CornerPair notch_on_edge(Random& random) {
    const double wide = random.uniform(0.1, 0.3), deep = random.uniform(0.05, 0.3), wall = random.uniform(0.05, 0.2);
    const Outline block{
        {-wide - wall, 0},          {-wide, 0}, {0, deep}, {wide, 0}, {wide + wall, 0}, {wide + wall, deep + wall},
        {-wide - wall, deep + wall}};
    const double part = random.uniform(0.3, 1.5);
    const Outline edge{{0, deep},
                       {-part * wide, deep - part * deep},
                       {-part * wide, deep - part * deep - 0.3},
                       {part * wide, deep - part * deep - 0.3},
                       {part * wide, deep - part * deep}};
    const double up = overlap_of(random).x, aside = random.below(2) == 0 ? 0 : random.uniform(-0.5, 0.5) * up;
    const Span span{0, random.uniform(0.2, 1)};
    return extruded_pair(block, span, shifted(edge, aside, up), span_beside(span, random), std::hypot(up, aside),
                         random);
}

} // namespace

CornerPair corner_pair(std::size_t family, Random& random) {
    constexpr CornerPair (*makers[])(Random&) = {
        bar_in_angle, angle_on_edge, angle_on_angle, bar_in_channel, wide_bar_in_channel,
        key_in_slot,  dovetail,      saw_teeth,      cube_in_tray,   cone_in_cap,
        half_shell,   stairs,        combs,          half_lap,       notch_on_edge};
    static_assert(std::size(makers) == std::size(corner_families));
    return makers[family](random);
}

CornerPair crossed_ridges(double half_angle, double turn, double overlap, Random& random) {
    const auto [sine, cosine] = scenes::sine_cosine(half_angle / 360);
    const double high = 0.5, half = high * sine / cosine;
    const auto wedge = [&](double along) {
        return Mesh{"wedge",
                    {{-half, -along, -high},
                     {half, -along, -high},
                     {0, -along, 0},
                     {-half, along, -high},
                     {half, along, -high},
                     {0, along, 0}},
                    {{0, 1, 2}, {3, 5, 4}, {0, 3, 4}, {0, 4, 1}, {1, 4, 5}, {1, 5, 2}, {2, 5, 3}, {2, 3, 0}}};
    };
    CornerPair pair{wedge(random.uniform(0.3, 0.7)), wedge(random.uniform(0.3, 0.7)), {}, overlap};
    for (Vec3& v : pair.b.vertices) v = {v.x, -v.y, -v.z};
    const auto [s, c] = scenes::sine_cosine(turn);
    pair.pose_b.rotation = {c, -s, 0, s, c, 0, 0, 0, 1};
    const double u = random.uniform(-0.1, 0.1), v = random.uniform(-0.1, 0.1); // where they cross, along either
    pair.pose_b.translation = {-s * v, u + c * v, -overlap};
    return pair;
}

} // namespace raycontact::exact
