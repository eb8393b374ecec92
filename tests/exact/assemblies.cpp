// SPDX-License-Identifier: Apache-2.0
#include "exact/assemblies.h"

#include "reference/meshes.h"
#include "reference/vector.h"

#include "scenes/models/trigonometry.h"

#include <cstdio>
#include <cstdlib>
#include <stdexcept>

namespace raycontact::exact {

using namespace reference;

namespace {

using Corner = std::array<double, 2>;

double turn_of(const Corner& a, const Corner& b, const Corner& c) { // > 0: to the left
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

bool cross_each_other(const Corner& a, const Corner& b, const Corner& c, const Corner& d) {
    return (turn_of(a, b, c) > 0) != (turn_of(a, b, d) > 0) && (turn_of(c, d, a) > 0) != (turn_of(c, d, b) > 0);
}

// The outline with its holes as one loop of corner numbers: each hole is entered and left over its shortest bridge.
std::vector<std::uint32_t> one_loop(const std::vector<Corner>& corners, const std::vector<std::uint32_t>& sizes) {
    std::vector<std::uint32_t> loop;
    for (std::uint32_t i = 0; i < sizes[0]; ++i) loop.push_back(i);
    std::uint32_t first = sizes[0];
    for (std::size_t hole = 1; hole < sizes.size(); ++hole) {
        const std::uint32_t size = sizes[hole];
        double least = -1;
        std::size_t at = 0;
        std::uint32_t to = 0;
        for (std::size_t i = 0; i < loop.size(); ++i)
            for (std::uint32_t j = 0; j < size; ++j) {
                const Corner &p = corners[loop[i]], &q = corners[first + j];
                const double square = (p[0] - q[0]) * (p[0] - q[0]) + (p[1] - q[1]) * (p[1] - q[1]);
                if (least >= 0 && square >= least) continue;
                bool free = true;
                const auto meets = [&](std::uint32_t a, std::uint32_t b) {
                    const bool shares = corners[a] == p || corners[b] == p || corners[a] == q || corners[b] == q;
                    return !shares && cross_each_other(p, q, corners[a], corners[b]);
                };
                for (std::size_t k = 0; k < loop.size(); ++k) free &= !meets(loop[k], loop[(k + 1) % loop.size()]);
                std::uint32_t begin = sizes[0];
                for (std::size_t h = 1; h < sizes.size(); begin += sizes[h++])
                    for (std::uint32_t k = 0; k < sizes[h]; ++k) free &= !meets(begin + k, begin + (k + 1) % sizes[h]);
                if (free) least = square, at = i, to = j;
            }
        std::vector<std::uint32_t> around; // the other way round, for it bounds from inside
        for (std::uint32_t k = 0; k <= size; ++k) around.push_back(first + (to + size - k % size) % size);
        around.push_back(loop[at]);
        loop.insert(loop.begin() + static_cast<std::ptrdiff_t>(at) + 1, around.begin(), around.end());
        first += size;
    }
    return loop;
}

std::vector<std::array<std::uint32_t, 3>> cut_into_ears(const std::vector<Corner>& corners,
                                                        std::vector<std::uint32_t> loop) {
    std::vector<std::array<std::uint32_t, 3>> triangles;
    std::size_t at = 0, tries = 0;
    while (loop.size() > 3) {
        const std::size_t n = loop.size();
        at %= n;
        const std::uint32_t i = loop[at], j = loop[(at + 1) % n], k = loop[(at + 2) % n];
        const Corner &a = corners[i], &b = corners[j], &c = corners[k];
        bool ear = turn_of(a, b, c) > 0;
        for (const std::uint32_t other : loop) {
            const Corner& p = corners[other];
            if (!ear) break;
            if (p == a || p == b || p == c) continue;
            ear = !(turn_of(a, b, p) >= 0 && turn_of(b, c, p) >= 0 && turn_of(c, a, p) >= 0);
        }
        if (!ear) {
            ++at;
            if (++tries > 2 * n) throw std::logic_error("no ear is left");
            continue;
        }
        triangles.push_back({i, j, k});
        loop.erase(loop.begin() + static_cast<std::ptrdiff_t>((at + 1) % n));
        ++at;
        tries = 0;
    }
    triangles.push_back({loop[0], loop[1], loop[2]});
    return triangles;
}

// x, y, z to y, z, x: what was extruded along z lies along x.
Mesh along_x(Mesh mesh) {
    for (Vec3& v : mesh.vertices) v = {v.z, v.x, v.y};
    return mesh;
}

Mesh block(double x0, double y0, double z0, double x1, double y1, double z1) {
    return extruded("block", rectangle(x0, y0, x1, y1), {}, z0, z1);
}

Outline mirrored(const Outline& outline, double about) { // at x = about
    Outline result(outline.rbegin(), outline.rend());
    for (Corner& c : result) c[0] = 2 * about - c[0];
    return result;
}

// Open to the right: arms from the back at -length to x = 0.
Outline clamp_outline(double length, double width, double thick) {
    return {{-length, 0},       {0, 0},     {0, thick},      {-length + thick, thick}, {-length + thick, width - thick},
            {0, width - thick}, {0, width}, {-length, width}};
}

// Rows that rise by a pitch a turn, knots of the profile up the flank; after a turn a row is the one above, so vertices
// are numbered along one spiral for each knot. Outward; open at both ends.
struct Thread {
    static constexpr std::uint32_t knots = 4, sides = thread_sides;
    std::vector<Vec3> vertices;
    std::vector<std::array<std::uint32_t, 3>> triangles;
    std::uint32_t rows;
    std::uint32_t at(std::uint32_t side, std::uint32_t row) const { // side may be `sides`
        return side == sides ? at(0, row + knots) : row * sides + side;
    }
    Thread(std::uint32_t pitches, double wider) : rows(pitches * knots + 1) {
        // Root, flank, crest, flank, of M20: root P/4 wide, crest P/8, 5/8 H deep.
        constexpr double up[knots] = {0, 0.25, 0.5625, 0.6875};
        const double depth = 0.54127 * thread_pitch;
        for (std::uint32_t row = 0; row < rows + knots; ++row)
            for (std::uint32_t side = 0; side < sides; ++side) {
                if (row >= rows && side > 0) continue; // the seam above the last turn
                const double radius = thread_radius + wider - (row % knots < 2 ? depth : 0);
                const double turn = double(side) / sides;
                const auto [sine, cosine] = scenes::sine_cosine(turn);
                const std::uint32_t turns = row / knots;
                const double height = turns + up[row % knots] + turn;
                vertices.resize(std::max<std::size_t>(vertices.size(), row * sides + side + 1));
                vertices[row * sides + side] = {radius * cosine, radius * sine, height * thread_pitch};
            }
        for (std::uint32_t row = 0; row + 1 < rows; ++row)
            for (std::uint32_t side = 0; side < sides; ++side) {
                const std::uint32_t a = at(side, row), b = at(side + 1, row);
                const std::uint32_t c = at(side + 1, row + 1), d = at(side, row + 1);
                triangles.push_back({a, b, c});
                triangles.push_back({a, c, d});
            }
    }
    // The border at the bottom (above: at the top), once around counter-clockwise: the last row, then down the seam.
    std::vector<std::uint32_t> border(bool above) const {
        const std::uint32_t row = above ? rows - 1 : 0;
        std::vector<std::uint32_t> loop;
        for (std::uint32_t side = 0; side < sides; ++side) loop.push_back(at(side, row));
        for (std::uint32_t k = knots; k > 0; --k) loop.push_back(at(0, row + k));
        return loop;
    }
    double height() const {
        const std::uint32_t turns = (rows - 1) / knots;
        return turns * thread_pitch;
    }
};

void drop_unused(Mesh& mesh) {
    std::vector<std::uint32_t> now(mesh.vertices.size(), 0);
    for (const auto& t : mesh.triangles)
        for (const std::uint32_t v : t) now[v] = 1;
    std::uint32_t count = 0;
    for (std::size_t i = 0; i < now.size(); ++i)
        if (now[i] != 0) mesh.vertices[count] = mesh.vertices[i], now[i] = count++;
    mesh.vertices.resize(count);
    for (auto& t : mesh.triangles)
        for (std::uint32_t& v : t) v = now[v];
}

} // namespace

Mesh extruded(std::string name, const Outline& outline, const std::vector<Outline>& holes, double bottom, double top) {
    std::vector<Corner> corners = outline;
    std::vector<std::uint32_t> sizes{static_cast<std::uint32_t>(outline.size())};
    for (const Outline& hole : holes) {
        corners.insert(corners.end(), hole.begin(), hole.end());
        sizes.push_back(static_cast<std::uint32_t>(hole.size()));
    }
    Mesh mesh;
    mesh.name = std::move(name);
    const auto n = static_cast<std::uint32_t>(corners.size());
    for (const double z : {bottom, top})
        for (const Corner& c : corners) mesh.vertices.push_back({c[0], c[1], z});
    for (const auto& t : cut_into_ears(corners, one_loop(corners, sizes))) {
        mesh.triangles.push_back({t[2], t[1], t[0]});
        mesh.triangles.push_back({n + t[0], n + t[1], n + t[2]});
    }
    std::uint32_t first = 0;
    for (std::size_t loop = 0; loop < sizes.size(); first += sizes[loop++])
        for (std::uint32_t k = 0; k < sizes[loop]; ++k) {
            std::uint32_t i = first + k, j = first + (k + 1) % sizes[loop];
            if (loop > 0) std::swap(i, j);
            mesh.triangles.push_back({i, j, n + j});
            mesh.triangles.push_back({i, n + j, n + i});
        }
    return mesh;
}

Outline rectangle(double x0, double y0, double x1, double y1) {
    return {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}};
}

Outline regular(std::uint32_t corners, double radius, double turn) {
    Outline outline;
    for (std::uint32_t i = 0; i < corners; ++i) {
        const auto [sine, cosine] = scenes::sine_cosine(turn + double(i) / corners);
        outline.push_back({radius * cosine, radius * sine});
    }
    return outline;
}

Outline star_outline(std::uint32_t points, double outer, double inner) {
    Outline outline = regular(2 * points, outer);
    for (std::size_t i = 1; i < outline.size(); i += 2)
        outline[i] = {outline[i][0] * inner / outer, outline[i][1] * inner / outer};
    return outline;
}

Outline gear_outline(std::uint32_t teeth, double outer, double inner) {
    Outline outline = regular(4 * teeth, outer);
    for (std::size_t i = 0; i < outline.size(); ++i)
        if (i % 4 >= 2) outline[i] = {outline[i][0] * inner / outer, outline[i][1] * inner / outer};
    return outline;
}

Outline l_outline(double width, double height, double thick) {
    return {{0, 0}, {width, 0}, {width, thick}, {thick, thick}, {thick, height}, {0, height}};
}

Outline u_outline(double width, double height, double thick) {
    return {{0, 0},         {width, 0},      {width, height}, {width - thick, height}, {width - thick, thick},
            {thick, thick}, {thick, height}, {0, height}};
}

Outline t_outline(double width, double height, double thick) {
    const double x = width / 2, s = thick / 2;
    return {{-s, 0},     {s, 0},       {s, height - thick},  {x, height - thick},
            {x, height}, {-x, height}, {-x, height - thick}, {-s, height - thick}};
}

Outline e_outline(double width, double height, double thick) {
    const double low = (height - thick) / 2, high = (height + thick) / 2;
    return {{0, 0},          {width, 0},    {width, thick}, {thick, thick},          {thick, low},
            {width, low},    {width, high}, {thick, high},  {thick, height - thick}, {width, height - thick},
            {width, height}, {0, height}};
}

Outline shifted(Outline outline, double x, double y) {
    for (auto& c : outline) c[0] += x, c[1] += y;
    return outline;
}

FlushPair fitted_pair(std::uint32_t kind, double overlap, Random& random) {
    const double d = overlap;
    const double width = random.uniform(0.5, 2), height = random.uniform(0.5, 2);
    const double right = random.uniform(0.8, 3), thick = random.uniform(0.3, 0.6);
    FlushPair pair;
    pair.overlap = d;
    pair.b = block(-d, 0, 0, right, width, height);
    if (kind % fitted_kinds == 0) { // a block in the corner of an L, flush with its ends
        pair.a = extruded("L", shifted(l_outline(thick + right, thick + width, thick), -thick, -thick), {}, 0, height);
    } else { // a plug in the hole of a frame, off its middle
        const double play = random.uniform(0.3, 0.6);
        pair.a = extruded("frame", rectangle(-thick, -thick, right + play + thick, width + thick),
                          {rectangle(0, 0, right + play, width)}, 0, height);
    }
    return pair;
}

FlushPair flush_pair(std::uint32_t kind, double overlap, Random& random) {
    const double d = overlap;
    const double width = random.uniform(0.5, 2), height = random.uniform(0.5, 2);
    const double left = random.uniform(0.8, 3), right = random.uniform(0.8, 3); // how far the parts reach
    const double thick = random.uniform(0.3, 0.6);
    const auto wall = [&](const Outline& outline) { return extruded("profile", outline, {}, 0, height); };
    FlushPair pair;
    pair.overlap = d;
    switch (kind % flush_kinds) {
    case 0: // beams end to end
        pair.a = block(-left, 0, 0, 0, width, height);
        pair.b = block(-d, 0, 0, right, width, height);
        break;
    case 1: // a narrow beam at a wide one, flush on two sides
        pair.a = block(-left, 0, 0, 0, width, height);
        {
            const double h = random.uniform(0.6, 0.9) * height, w = random.uniform(0.6, 0.9) * width;
            pair.b = block(-d, 0, 0, right, w, h);
            break;
        }
    case 2: // the leg of an L goes on as a beam
        pair.a = wall(shifted(l_outline(left, width + thick, thick), -left, 0));
        pair.b = block(-d, 0, 0, right, thick, height);
        break;
    case 3: // a beam across the arms of a U
        pair.a = wall(clamp_outline(left, 3 * thick + width, thick));
        pair.b = block(-d, 0, 0, right, 3 * thick + width, height);
        break;
    case 4: { // the stem of a T goes on as a beam
        Outline t = t_outline(3 * thick + width, left, thick);
        for (auto& c : t) c = {-c[1], c[0]};
        pair.a = wall(t);
        pair.b = block(-d, -thick / 2, 0, right, thick / 2, height);
        break;
    }
    case 5: { // plates with holes side by side
        const double top = random.uniform(0.25, 0.5), y = width + 1;
        const Outline hole = shifted(regular(4 + random.below(9), 0.2), -left / 2, y / 2);
        pair.a = extruded("plate", rectangle(-left, 0, 0, y), {hole}, 0, top);
        const double x = right / 2;
        pair.b =
            extruded("plate", rectangle(-d, 0, right, y),
                     {rectangle(x - 0.1, 0.3, x + 0.1, 0.6), rectangle(x - 0.1, y - 0.7, x + 0.1, y - 0.4)}, 0, top);
        break;
    }
    case 6: // a U on a U, tips on tips
        pair.a = wall(clamp_outline(left, 3 * thick + width, thick));
        pair.b = wall(mirrored(clamp_outline(right, 3 * thick + width, thick), -d / 2));
        break;
    default: { // I beams end to end
        const double w = width, h = height + 2 * thick, web = thick / 2;
        const Outline section{{-w, 0}, {w, 0},  {w, thick},      {web, thick},      {web, h - thick}, {w, h - thick},
                              {w, h},  {-w, h}, {-w, h - thick}, {-web, h - thick}, {-web, thick},    {-w, thick}};
        pair.a = along_x(extruded("beam", section, {}, -left, 0));
        pair.b = along_x(extruded("beam", section, {}, -d, right));
        break;
    }
    }
    return pair;
}

Mesh placed(Mesh mesh, const Pose& pose) {
    for (Vec3& v : mesh.vertices) v = transform_point(pose, v);
    return mesh;
}

Mesh with_six_digits(Mesh mesh) {
    const auto rounded = [](double x) {
        char text[40];
        std::snprintf(text, sizeof text, "%.6g", x);
        return std::strtod(text, nullptr);
    };
    for (Vec3& v : mesh.vertices) v = {rounded(v.x), rounded(v.y), rounded(v.z)};
    return mesh;
}

Mesh in_float32(Mesh mesh) {
    for (Vec3& v : mesh.vertices) v = {double(float(v.x)), double(float(v.y)), double(float(v.z))};
    return mesh;
}

Mesh bolt_mesh(std::uint32_t pitches) {
    const Thread thread(pitches, 0);
    Mesh mesh;
    mesh.name = "bolt";
    mesh.vertices = thread.vertices;
    mesh.triangles = thread.triangles;
    for (const bool above : {false, true}) {
        // From one point each end is seen whole, its step, too.
        const auto tip = static_cast<std::uint32_t>(mesh.vertices.size());
        mesh.vertices.push_back({0, 0, above ? thread.height() + 2 * thread_pitch : -thread_pitch});
        const auto loop = thread.border(above);
        for (std::size_t i = 0; i < loop.size(); ++i) {
            const std::uint32_t p = loop[i], q = loop[(i + 1) % loop.size()];
            mesh.triangles.push_back(above ? std::array{tip, p, q} : std::array{tip, q, p});
        }
    }
    drop_unused(mesh);
    return mesh;
}

Mesh nut_mesh(std::uint32_t pitches, double clearance) {
    const Thread thread(pitches, clearance);
    Mesh mesh;
    mesh.name = "nut";
    mesh.vertices = thread.vertices;
    for (const auto& t : thread.triangles) mesh.triangles.push_back({t[0], t[2], t[1]}); // seen from the axis
    constexpr std::uint32_t sides = Thread::sides;
    const auto outer = static_cast<std::uint32_t>(mesh.vertices.size());
    const Outline hexagon = regular(6, 1.8 * thread_radius);
    for (const double z : {-0.5 * thread_pitch, thread.height() + 1.5 * thread_pitch})
        for (std::uint32_t side = 0; side < sides; ++side) {
            const Corner &p = hexagon[side * 6 / sides], &q = hexagon[(side * 6 / sides + 1) % 6];
            const std::uint32_t sixth = sides / 6, along = side % sixth;
            const double part = double(along) / sixth;
            mesh.vertices.push_back({p[0] + part * (q[0] - p[0]), p[1] + part * (q[1] - p[1]), z});
        }
    for (std::uint32_t side = 0; side < sides; ++side) {
        const std::uint32_t a = outer + side, b = outer + (side + 1) % sides;
        mesh.triangles.push_back({a, b, b + sides});
        mesh.triangles.push_back({a, b + sides, a + sides});
    }
    for (const bool above : {false, true}) {
        const auto loop = thread.border(above);
        const std::uint32_t ring = outer + (above ? sides : 0);
        const auto add = [&](std::uint32_t p, std::uint32_t q, std::uint32_t r) { // below: p, q, r seen from below
            mesh.triangles.push_back(above ? std::array{p, r, q} : std::array{p, q, r});
        };
        for (std::uint32_t i = 0; i < loop.size(); ++i) {
            const std::uint32_t p = loop[i], q = loop[(i + 1) % loop.size()];
            const std::uint32_t out = ring + (i < sides ? i : 0);
            if (i < sides) add(out, q, ring + (i + 1) % sides);
            add(out, p, q);
        }
    }
    drop_unused(mesh);
    return mesh;
}

Mesh tray_mesh() {
    Mesh tray;
    tray.name = "tray";
    const auto square = [&](double half, double z) {
        for (const double x : {-half, half})
            for (const double y : {-half, half}) tray.vertices.push_back({x, y, z});
    };
    square(1, 0);
    square(1, 1);
    square(0.8, 1);
    square(0.8, 0.2);
    const auto quad = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
        tray.triangles.push_back({a, b, c});
        tray.triangles.push_back({a, c, d});
    };
    quad(0, 1, 3, 2);     // below
    quad(12, 14, 15, 13); // the floor
    constexpr std::uint32_t around[] = {0, 2, 3, 1};
    for (std::size_t i = 0; i < 4; ++i) {
        const std::uint32_t p = around[i], q = around[(i + 1) % 4];
        quad(p, q, q + 4, p + 4);           // a side
        quad(p + 4, q + 4, q + 8, p + 8);   // the rim
        quad(p + 8, q + 8, q + 12, p + 12); // a wall
    }
    return tray;
}

Mesh pipe_mesh(std::uint32_t sides, double outer, double inner, double length) {
    return extruded("pipe", regular(sides, outer), {regular(sides, inner)}, -length / 2, length / 2);
}

} // namespace raycontact::exact
