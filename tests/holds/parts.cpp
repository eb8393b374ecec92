// SPDX-License-Identifier: Apache-2.0
#include <tests/holds/parts.h>

#include <scenes/models/skin.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace raycontact::scenes {

namespace {

struct Point {
    double x, y;
};

/// A body of revolution: radii and heights, from pole to pole or, without poles, closed.
Mesh turned(const char* name, const std::vector<Point>& profile, std::uint32_t around) {
    Skin skin(name);
    Loop before, first;
    std::uint32_t pole = 0;
    const bool has_poles = profile.front().x == 0;
    for (std::size_t k = 0; k < profile.size(); ++k) {
        if (profile[k].x == 0) {
            const std::uint32_t tip = skin.add(0, 0, profile[k].y);
            if (k == 0)
                pole = tip;
            else
                skin.fan(tip, before);
            continue;
        }
        Loop ring = skin.add_ring(profile[k].x, profile[k].y, around);
        if (k == 1 && has_poles) skin.fan(pole, {ring.rbegin(), ring.rend()});
        if (!before.empty()) skin.join(before, ring);
        if (first.empty()) first = ring;
        before = std::move(ring);
    }
    if (!has_poles) skin.join(before, first);
    return skin.mesh();
}

/// A polygon about the origin that can be seen whole from there, drawn out along z.
Mesh drawn_out(const char* name, const std::vector<Point>& polygon, double low, double high) {
    Skin skin(name);
    Loop below, above;
    for (const Point& p : polygon) below.push_back(skin.add(p.x, p.y, low));
    for (const Point& p : polygon) above.push_back(skin.add(p.x, p.y, high));
    skin.join(below, above);
    skin.fan(skin.add(0, 0, low), {below.rbegin(), below.rend()});
    skin.fan(skin.add(0, 0, high), above);
    return skin.mesh();
}

} // namespace

Vec3 centre(Mesh& mesh) {
    const Vec3 at = mass_of(mesh.vertices, mesh.triangles).centre;
    for (Vec3& v : mesh.vertices) v = {v.x - at.x, v.y - at.y, v.z - at.z};
    return at;
}

Mesh smooth_ring(double radius, double thick, std::uint32_t around, std::uint32_t across) {
    std::vector<Point> profile;
    for (std::uint32_t k = 0; k < across; ++k) {
        const SineCosine at = sine_cosine(static_cast<double>(k) / across);
        profile.push_back({radius + thick * at.cosine, thick * at.sine});
    }
    return turned("ring", profile, around);
}

Mesh smooth_ball(double radius, std::uint32_t around, std::uint32_t rings) {
    std::vector<Point> profile{{0, -radius}};
    for (std::uint32_t k = 1; k <= rings; ++k) {
        const SineCosine at = sine_cosine(0.5 * k / (rings + 1));
        profile.push_back({radius * at.sine, -radius * at.cosine});
    }
    profile.push_back({0, radius});
    return turned("ball", profile, around);
}

Mesh arch_stone(double inner, double outer, double depth, double from, double to) {
    Mesh mesh;
    mesh.name = "stone";
    for (const double y : {-depth / 2, depth / 2}) {
        for (const auto& [radius, turn] : {std::pair{inner, from}, {outer, from}, {outer, to}, {inner, to}}) {
            const SineCosine at = sine_cosine(turn);
            mesh.vertices.push_back({radius * at.cosine, y, radius * at.sine});
        }
    }
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}, {4, 6, 5}, {4, 7, 6}};
    for (std::uint32_t k = 0; k < 4; ++k) {
        const std::uint32_t next = (k + 1) % 4;
        mesh.triangles.push_back({next, k, 4 + k});
        mesh.triangles.push_back({next, 4 + k, 4 + next});
    }
    return mesh;
}

Mesh round_bowl(double inner, double outer, std::uint32_t around) {
    const std::uint32_t rings = around / 4;
    std::vector<Point> profile{{0, -outer}};
    for (std::uint32_t k = 1; k <= rings; ++k) {
        const SineCosine at = sine_cosine(0.25 * k / rings);
        profile.push_back({outer * at.sine, -outer * at.cosine});
    }
    for (std::uint32_t k = rings; k >= 1; --k) {
        const SineCosine at = sine_cosine(0.25 * k / rings);
        profile.push_back({inner * at.sine, -inner * at.cosine});
    }
    profile.push_back({0, -inner});
    return turned("bowl", profile, around);
}

Mesh peg(double radius, double length, double bevel, std::uint32_t around) {
    return turned("peg", {{0, -length}, {radius - bevel, -length}, {radius, bevel - length}, {radius, 0}, {0, 0}},
                  around);
}

Mesh block_with_hole(double radius, double outer, double depth, double floor, std::uint32_t around) {
    const double corner = radius / sine_cosine(0.5 / around).cosine;
    return turned(
        "block", {{0, -depth - floor}, {outer, -depth - floor}, {outer, 0}, {corner, 0}, {corner, -depth}, {0, -depth}},
        around);
}

Mesh mug(double radius, double height, double wall) {
    constexpr std::uint32_t around = 32, rows = 12; // of cells outside
    constexpr std::uint32_t low = 2, high = 8;      // of the handle's ends, each two cells wide and high
    Skin skin("mug");
    std::vector<Loop> outside, inside;
    for (std::uint32_t k = 0; k <= rows; ++k) outside.push_back(skin.add_ring(radius, height * k / rows, around));
    for (std::uint32_t k = 0; k <= rows; ++k)
        inside.push_back(skin.add_ring(radius - wall, wall + (height - wall) * k / rows, around));
    const auto is_handle = [&](std::uint32_t row, std::uint32_t i) {
        return (i == 0 || i == around - 1) && (row == low || row == low + 1 || row == high || row == high + 1);
    };
    for (std::uint32_t k = 0; k < rows; ++k)
        for (std::uint32_t i = 0; i < around; ++i) {
            const std::uint32_t next = (i + 1) % around;
            if (!is_handle(k, i)) skin.quad(outside[k][i], outside[k][next], outside[k + 1][next], outside[k + 1][i]);
            skin.quad(inside[k][next], inside[k][i], inside[k + 1][i], inside[k + 1][next]);
        }
    skin.join(outside[rows], inside[rows]);
    skin.fan(skin.add(0, 0, 0), {outside[0].rbegin(), outside[0].rend()});
    skin.fan(skin.add(0, 0, wall), inside[0]);
    // The border of two by two cells, counter-clockwise as seen from outside.
    const auto border = [&](std::uint32_t row) {
        const std::uint32_t a = around - 1;
        return Loop{outside[row][a],     outside[row][0],     outside[row][1],     outside[row + 1][1],
                    outside[row + 2][1], outside[row + 2][0], outside[row + 2][a], outside[row + 1][a]};
    };
    // From the upper end in half an ellipse to the lower one. A ring's points keep their places about the way.
    constexpr std::uint32_t steps = 12;
    const double middle = height * (low + high + 2) / 2 / rows, reach = height * (high - low) / 2 / rows;
    const double thick = 1.0 * height / rows, out = 0.55 * height;
    Loop before = border(high);
    for (std::uint32_t s = 1; s < steps; ++s) {
        const SineCosine at = sine_cosine(0.25 - 0.5 * s / steps);
        const double x = radius + out * at.cosine, z = middle + reach * at.sine;
        // Across the way: outward in the plane of the handle, and y.
        const double along_x = out * at.sine, along_z = -reach * at.cosine;
        const double length = std::sqrt(along_x * along_x + along_z * along_z);
        const double up_x = -along_z / length, up_z = along_x / length;
        Loop ring;
        for (const auto& [y, up] : {std::pair{-1, -1}, {0, -1}, {1, -1}, {1, 0}, {1, 1}, {0, 1}, {-1, 1}, {-1, 0}}) {
            const double scale = (y != 0 && up != 0 ? 0.75 : 1) * 0.7 * thick;
            ring.push_back(skin.add(x + up_x * up * scale, y * scale, z + up_z * up * scale));
        }
        skin.join(before, ring);
        before = ring;
    }
    // The lower end is met from the other side: up and down change places.
    const Loop last = border(low);
    skin.join(before, {last[6], last[5], last[4], last[3], last[2], last[1], last[0], last[7]});
    return skin.mesh();
}

Mesh hook(double length, double tip, double thick) {
    constexpr std::uint32_t around = 16, bends = 6;
    Skin skin("hook");
    Loop before;
    const double bend = 3 * thick; // radius
    const auto add = [&](double x, double z, double turn) {
        const SineCosine up = sine_cosine(turn); // of the way, from x towards z
        Loop ring;
        for (std::uint32_t i = 0; i < around; ++i) {
            const SineCosine at = sine_cosine(static_cast<double>(i) / around);
            const double side = thick * at.sine;
            ring.push_back(skin.add(x - side * up.sine, thick * at.cosine, z + side * up.cosine));
        }
        if (before.empty())
            skin.fan(skin.add(x, 0, z), {ring.rbegin(), ring.rend()});
        else
            skin.join(before, ring);
        before = ring;
    };
    constexpr std::uint32_t pieces = 8;
    for (std::uint32_t k = 0; k < pieces; ++k) add((length - bend) * k / pieces, 0, 0);
    for (std::uint32_t k = 0; k <= bends; ++k) {
        const SineCosine at = sine_cosine(0.25 * k / bends);
        add(length - bend + bend * at.sine, bend - bend * at.cosine, 0.25 * k / bends);
    }
    add(length, bend + tip, 0.25);
    skin.fan(skin.add(length, 0, bend + tip), before);
    return skin.mesh();
}

Mesh frustum(double below, double above, double height, std::uint32_t around) {
    const double half = height / 2;
    return turned("frustum", {{0, -half}, {below, -half}, {above, half}, {0, half}}, around);
}

Mesh axle_with_wheels(double radius, double flange_radius, double axle_radius, double flange, double inner,
                      double outer, std::uint32_t around) {
    std::vector<Point> profile{
        {0, -outer},           {radius, -outer}, {radius, -inner}, {flange_radius, -inner}, {flange_radius, -flange},
        {axle_radius, -flange}};
    for (std::size_t k = profile.size(); k-- > 0;) profile.push_back({profile[k].x, -profile[k].y});
    return turned("wheelset", profile, around);
}

Mesh step(double size_x, double size_y, double thick, double rise) {
    // From a point below the upper half all of it can be seen.
    const double half = size_x / 2, from_x = half / 4, from_z = -thick / 2;
    std::vector<Point> polygon{{-half, -thick}, {half, -thick}, {half, rise}, {0, rise}, {0, 0}, {-half, 0}};
    for (Point& p : polygon) p = {p.x - from_x, p.y - from_z};
    Mesh mesh = drawn_out("step", polygon, -size_y / 2, size_y / 2);
    for (Vec3& v : mesh.vertices) v = {v.x + from_x, -v.z, v.y + from_z};
    return mesh;
}

Mesh involute_gear(std::uint32_t teeth, double module, double width) {
    constexpr std::uint32_t flank = 6; // pieces
    constexpr double thinner = 0.98;   // a tooth than its half of the pitch
    const double pitch_radius = module * teeth / 2, base = pitch_radius * std::cos(20 * std::numbers::pi / 180);
    const double tip = pitch_radius + module, root = pitch_radius - 1.25 * module;
    const auto involute = [&](double radius) {
        const double angle = std::acos(base / radius);
        return std::tan(angle) - angle;
    };
    const double half = thinner * std::numbers::pi / (2 * teeth) + involute(pitch_radius);
    std::vector<Point> polygon;
    const auto add = [&](double radius, double angle) {
        polygon.push_back({radius * std::cos(angle), radius * std::sin(angle)});
    };
    const double first = std::max(base, root);
    for (std::uint32_t k = 0; k < teeth; ++k) {
        const double middle = 2 * std::numbers::pi * k / teeth;
        if (root < base) add(root, middle - half - 0.01);
        for (std::uint32_t i = 0; i <= flank; ++i) {
            const double radius = first + (tip - first) * i / flank;
            add(radius, middle - half + involute(radius));
        }
        for (std::uint32_t i = 0; i <= flank; ++i) {
            const double radius = tip - (tip - first) * i / flank;
            add(radius, middle + half - involute(radius));
        }
        if (root < base) add(root, middle + half + 0.01);
    }
    return drawn_out("gear", polygon, -width / 2, width / 2);
}

} // namespace raycontact::scenes
