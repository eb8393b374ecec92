// SPDX-License-Identifier: Apache-2.0
#include <scenes/models/machined.h>

#include <raycontact/mass.h>
#include <scenes/models/trigonometry.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

namespace raycontact::scenes {

namespace {

using Loop = std::vector<std::uint32_t>;

struct Point {
    double x, y;
};

class Skin {
public:
    explicit Skin(const char* name) { mesh_.name = name; }

    std::uint32_t add(double x, double y, double z) {
        mesh_.vertices.push_back({x, y, z});
        return static_cast<std::uint32_t>(mesh_.vertices.size()) - 1;
    }
    Loop add_ring(double radius, double z, std::uint32_t around) {
        Loop ring;
        for (std::uint32_t i = 0; i < around; ++i) {
            const SineCosine at = sine_cosine(static_cast<double>(i) / around);
            ring.push_back(add(radius * at.cosine, radius * at.sine, z));
        }
        return ring;
    }
    void triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c) { mesh_.triangles.push_back({a, b, c}); }
    void quad(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
        triangle(a, b, c);
        triangle(a, c, d);
    }
    void join(const Loop& a, const Loop& b) {
        for (std::size_t i = 0; i < a.size(); ++i) {
            const std::size_t next = (i + 1) % a.size();
            quad(a[i], a[next], b[next], b[i]);
        }
    }
    void fan(std::uint32_t tip, const Loop& ring) {
        for (std::size_t i = 0; i < ring.size(); ++i) triangle(ring[i], ring[(i + 1) % ring.size()], tip);
    }
    /// All must be wound alike; turned outward here.
    Mesh mesh() {
        if (mass_of(mesh_.vertices, mesh_.triangles).volume < 0)
            for (auto& t : mesh_.triangles) std::swap(t[1], t[2]);
        return std::move(mesh_);
    }

private:
    Mesh mesh_;
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

double degrees(double angle) {
    return angle * std::numbers::pi / 180;
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

Mesh involute_gear(std::uint32_t teeth, double module, double width) {
    constexpr std::uint32_t flank = 6; // pieces
    constexpr double thinner = 0.98;   // a tooth than its half of the pitch
    const double pitch_radius = module * teeth / 2, base = pitch_radius * std::cos(degrees(20));
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

namespace {

constexpr double flat_at_root = 0.25, flat_at_crest = 0.125; // of a pitch
constexpr double flank = (1 - flat_at_root - flat_at_crest) / 2;

/// The thread's surface, of lines that climb: point k of column i lies at the turn i / around and the height of k and
/// that turn. After a turn each line goes on in the one that began a pitch higher. It lies between two level rings of
/// `end` radius at z = low and z = high.
void add_thread(Skin& skin, const Thread& thread, double play, bool starts_inside, double end, double low, double high,
                Loop& bottom, Loop& top) {
    const double depth = flank * thread.pitch / std::tan(degrees(30));
    const double outer = thread.outer + play, inner = outer - depth;
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

Mesh threaded_bolt(const Thread& thread) {
    Skin skin("bolt");
    const double depth = flank * thread.pitch / std::tan(degrees(30));
    Loop bottom, top;
    add_thread(skin, thread, 0, true, thread.outer - depth, 0, thread.length, bottom, top);
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
