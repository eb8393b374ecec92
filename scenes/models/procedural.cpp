// SPDX-License-Identifier: Apache-2.0
#include <scenes/models/procedural.h>

#include <raycontact/error.h>
#include <raycontact/mass.h>
#include <scenes/models/rings.h>
#include <scenes/models/trigonometry.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace raycontact::scenes {
namespace {

/// Half the triangles: the number of points all rings share.
std::uint32_t ring_points(const char* kind, std::uint32_t triangles, std::uint32_t least) {
    if (triangles % 2 != 0 || triangles < least || triangles > 2'000'000)
        throw InputError(std::string(kind) + ": " + std::to_string(triangles)
                         + " triangles asked for; the count must be even, from " + std::to_string(least)
                         + " to 2000000");
    return triangles / 2;
}

std::uint32_t nearest_count(double value) {
    return static_cast<std::uint32_t>(std::floor(value + 0.5));
}

// Its own division: the models' coordinates, and so recorded hashes, depend on each bit.
Vec3 normalized(const Vec3& v) {
    return v / length(v);
}

/// Joins the rings one after another, the last to the first.
void close_tube(Mesh& mesh, const std::vector<Ring>& rings) {
    for (std::size_t k = 0; k + 1 < rings.size(); ++k) stitch(mesh, rings[k], rings[k + 1]);
    stitch(mesh, rings.back(), rings.front(), nearest_start(mesh, rings.back(), rings.front()));
}

/// Distance from the middle of the bumpy sphere in a unit direction; a gyroid, so the bumps lie everywhere alike.
double bumpy_radius(const Vec3& d) {
    constexpr double bumps = 0.8; // turns of the wave per metre
    const SineCosine x = sine_cosine(bumps * d.x), y = sine_cosine(bumps * d.y), z = sine_cosine(bumps * d.z);
    return 1 + 0.27 * (x.sine * y.cosine + y.sine * z.cosine + z.sine * x.cosine);
}

/// Distance from the middle of the star in a unit direction: six rounded arms along the axes.
double star_radius(const Vec3& d) {
    const auto arm = [](double c) {
        const double square = c * c, fourth = square * square;
        return fourth * fourth * fourth;
    };
    return 0.36 + 0.64 * (arm(d.x) + arm(d.y) + arm(d.z));
}

/// Distance from the chest of the hare in a unit direction: lobes for all that sticks out.
double hare_radius(const Vec3& d) {
    struct Lobe {
        Vec3 along;
        double length;
        int sharpness; ///< its cosine is squared so often
    };
    static const std::array<Lobe, 12> lobes{{{normalized({-0.80, -0.45, 0}), 0.36, 2},
                                             {normalized({0, -1, 0}), 0.16, 2},
                                             {normalized({0.52, 0.75, 0}), 0.40, 3},
                                             {normalized({0.86, 0.50, 0}), 0.16, 5},
                                             {normalized({0.05, 0.96, 0.30}), 0.72, 6},
                                             {normalized({0.05, 0.96, -0.30}), 0.72, 6},
                                             {normalized({-0.96, -0.05, 0}), 0.16, 6},
                                             {normalized({0.62, -0.75, 0.20}), 0.22, 5},
                                             {normalized({0.62, -0.75, -0.20}), 0.22, 5},
                                             {normalized({0.05, -0.85, 0.45}), 0.22, 4},
                                             {normalized({0.05, -0.85, -0.45}), 0.22, 4},
                                             {normalized({0, 0, 1}), 0.02, 2}}};
    double radius = 0.36;
    for (const Lobe& lobe : lobes) {
        double part = (1 + d.x * lobe.along.x + d.y * lobe.along.y + d.z * lobe.along.z) / 2;
        for (int k = 0; k < lobe.sharpness; ++k) part *= part;
        radius += lobe.length * part;
    }
    return radius;
}

/// A sphere of rings, drawn out to the distance `radius_in` of each unit direction.
Mesh drawn_out_sphere(const char* kind, std::uint32_t triangles, std::uint32_t least,
                      double (*radius_in)(const Vec3& direction)) {
    const std::uint32_t points = ring_points(kind, triangles, least);
    Mesh mesh{std::string(kind) + "-" + std::to_string(triangles), {}, {}};
    // Triangles near equilateral: rings sqrt(3) / 2 of the points' spacing apart.
    const double rows = std::sqrt(points * 0.8660254037844386 * 0.7853981633974483);
    const std::uint32_t ring_count =
        std::clamp(nearest_count(rows) - std::min(nearest_count(rows), 1u), 1u, points / 4);
    std::vector<double> weights;
    for (std::uint32_t k = 0; k < ring_count; ++k)
        weights.push_back(sine_cosine(0.5 * (k + 1) / (ring_count + 1)).sine);
    const auto add = [&mesh, radius_in](const Vec3& direction) {
        const double radius = radius_in(direction);
        mesh.vertices.push_back({radius * direction.x, radius * direction.y, radius * direction.z});
    };
    const auto counts = share_out(points, weights, 3);
    std::vector<Ring> rings;
    add({0, 0, -1});
    for (std::uint32_t k = 0; k < ring_count; ++k) {
        const SineCosine latitude = sine_cosine(0.5 * (k + 1) / (ring_count + 1));
        Ring& ring = rings.emplace_back();
        ring.first = static_cast<std::uint32_t>(mesh.vertices.size());
        for (std::uint32_t i = 0; i < counts[k]; ++i) {
            ring.turn.push_back((i + 0.5 * (k % 2)) / counts[k]); // staggered rows
            const SineCosine longitude = sine_cosine(ring.turn.back());
            add(normalized({latitude.sine * longitude.cosine, latitude.sine * longitude.sine, -latitude.cosine}));
        }
    }
    const auto north = static_cast<std::uint32_t>(mesh.vertices.size());
    add({0, 0, 1});
    for (std::uint32_t i = 0; i < counts.front(); ++i)
        mesh.triangles.push_back({0, rings.front().first + (i + 1) % counts.front(), rings.front().first + i});
    for (std::uint32_t k = 0; k + 1 < ring_count; ++k) stitch(mesh, rings[k], rings[k + 1]);
    for (std::uint32_t i = 0; i < counts.back(); ++i)
        mesh.triangles.push_back({north, rings.back().first + i, rings.back().first + (i + 1) % counts.back()});
    normalise(mesh);
    return mesh;
}

} // namespace

void normalise(Mesh& mesh) {
    Vec3 low = mesh.vertices.at(0), high = low;
    for (const Vec3& v : mesh.vertices) {
        low = {std::min(low.x, v.x), std::min(low.y, v.y), std::min(low.z, v.z)};
        high = {std::max(high.x, v.x), std::max(high.y, v.y), std::max(high.z, v.z)};
    }
    const double extent = std::max({high.x - low.x, high.y - low.y, high.z - low.z});
    const Vec3 centre = mass_of(mesh.vertices, mesh.triangles).centre;
    // Rounded to float32 so that a mesh written to any format and read again is the same mesh. Volatile because g++ 12
    // at -O2 vectorises the coordinates and drops the pair of conversions: the golden hashes tell.
    const auto place = [extent](double value, double middle) {
        const volatile float rounded = static_cast<float>((value - middle) / extent);
        return static_cast<double>(rounded);
    };
    for (Vec3& v : mesh.vertices) v = {place(v.x, centre.x), place(v.y, centre.y), place(v.z, centre.z)};
}

Mesh bumpy_sphere(std::uint32_t triangles) {
    return drawn_out_sphere("sphere", triangles, 8, bumpy_radius);
}

Mesh round_sphere(std::uint32_t triangles) {
    return drawn_out_sphere("round-sphere", triangles, 8, [](const Vec3&) { return 1.0; });
}

Mesh star(std::uint32_t triangles) {
    return drawn_out_sphere("star", triangles, 400, star_radius);
}

Mesh hare(std::uint32_t triangles) {
    return drawn_out_sphere("hare", triangles, 400, hare_radius);
}

Mesh bumpy_torus(std::uint32_t triangles) {
    const std::uint32_t points = ring_points("torus", triangles, 18);
    Mesh mesh{"torus-" + std::to_string(triangles), {}, {}};
    const std::uint32_t around = std::max(3u, nearest_count(std::sqrt(points * 0.42)));
    const std::uint32_t ring_count = std::max(3u, points / around);
    const auto counts = share_out(points, std::vector<double>(ring_count, 1.0), 3);
    std::vector<Ring> rings;
    for (std::uint32_t k = 0; k < ring_count; ++k) {
        const double station = static_cast<double>(k) / ring_count;
        const SineCosine major = sine_cosine(station), lobes = sine_cosine(5 * station);
        Ring& ring = rings.emplace_back();
        ring.first = static_cast<std::uint32_t>(mesh.vertices.size());
        for (std::uint32_t i = 0; i < counts[k]; ++i) {
            ring.turn.push_back(static_cast<double>(i) / counts[k]);
            const SineCosine minor = sine_cosine(ring.turn.back()), waves = sine_cosine(3 * ring.turn.back());
            // From the inside of the ring over its top: counter-clockwise about the way round.
            const double radius = 0.42 + 0.07 * lobes.sine + 0.05 * lobes.cosine * waves.cosine;
            const double out = 1 - radius * minor.cosine;
            mesh.vertices.push_back({out * major.cosine, out * major.sine, radius * minor.sine});
        }
    }
    close_tube(mesh, rings);
    normalise(mesh);
    return mesh;
}

Mesh gear(std::uint32_t triangles) {
    const std::uint32_t points = ring_points("gear", triangles, 48);
    Mesh mesh{"gear-" + std::to_string(triangles), {}, {}};
    constexpr double bore = 0.3, root = 0.76, tip = 1.0, half_width = 0.2;
    const std::uint32_t around = std::max(4u, nearest_count(std::sqrt(points * 0.25)));
    const std::uint32_t ring_count = points / around;
    const std::uint32_t teeth = std::clamp(ring_count / 4, 1u, 18u);
    // A tooth: along the root, up a flank, along the tip, down the other flank, in shares of the pitch.
    constexpr double part_width[4] = {0.34, 0.14, 0.38, 0.14};
    constexpr double part_from[4] = {root, root, tip, tip}, part_to[4] = {root, tip, tip, root};
    std::vector<double> weights;
    for (std::uint32_t k = 0; k < 4 * teeth; ++k) weights.push_back(part_width[k % 4]);
    const auto stations = share_out(ring_count, weights, 1);
    const auto counts = share_out(points, std::vector<double>(ring_count, 1.0), 4);
    std::vector<Ring> rings;
    double begin = 0; // in pitches
    for (std::uint32_t part = 0; part < 4 * teeth; ++part) {
        for (std::uint32_t k = 0; k < stations[part]; ++k) {
            const double along = static_cast<double>(k) / stations[part];
            const SineCosine major = sine_cosine((begin + along * part_width[part % 4]) / teeth);
            const double outer = part_from[part % 4] + along * (part_to[part % 4] - part_from[part % 4]);
            Ring& ring = rings.emplace_back();
            ring.first = static_cast<std::uint32_t>(mesh.vertices.size());
            // A rectangle in the radial plane: bore, top face, teeth, bottom face; corners at whole quarters.
            const double corner_r[5] = {bore, bore, outer, outer, bore};
            const double corner_z[5] = {-half_width, half_width, half_width, -half_width, -half_width};
            const auto sides = share_out(counts[rings.size() - 1], {0.4, 0.6, 0.4, 0.6}, 1);
            for (std::size_t side = 0; side < 4; ++side)
                for (std::uint32_t i = 0; i < sides[side]; ++i) {
                    const double t = static_cast<double>(i) / sides[side];
                    const double r = corner_r[side] + t * (corner_r[side + 1] - corner_r[side]);
                    const double z = corner_z[side] + t * (corner_z[side + 1] - corner_z[side]);
                    ring.turn.push_back((static_cast<double>(side) + t) / 4);
                    mesh.vertices.push_back({r * major.cosine, r * major.sine, z});
                }
        }
        begin += part_width[part % 4];
    }
    close_tube(mesh, rings);
    normalise(mesh);
    return mesh;
}

Mesh knot(std::uint32_t triangles) {
    const std::uint32_t points = ring_points("knot", triangles, 60);
    Mesh mesh{"knot-" + std::to_string(triangles), {}, {}};
    constexpr double minor_radius = 0.45;
    const std::uint32_t around = std::max(3u, nearest_count(std::sqrt(points * 0.1)));
    const std::uint32_t ring_count = points / around;
    // With few rings the chords cut inward; a thinner tube then keeps the strands apart.
    const double tube = 0.24 * std::min(1.0, ring_count / 24.0);
    std::vector<Vec3> path;
    for (std::uint32_t k = 0; k < ring_count; ++k) {
        const double station = static_cast<double>(k) / ring_count;
        const SineCosine around_axis = sine_cosine(2 * station), around_tube = sine_cosine(3 * station);
        const double out = 1 + minor_radius * around_tube.cosine;
        path.push_back({out * around_axis.cosine, out * around_axis.sine, minor_radius * around_tube.sine});
    }
    const auto counts = share_out(points, std::vector<double>(ring_count, 1.0), 3);
    std::vector<Ring> rings;
    Vec3 up{1, 0, 0}; // carried along without twist, so that few-sided rings do not pinch; only the last band turns
    for (std::uint32_t k = 0; k < ring_count; ++k) {
        const Vec3 &before = path[(k + ring_count - 1) % ring_count], &after = path[(k + 1) % ring_count];
        const Vec3 tangent = normalized({after.x - before.x, after.y - before.y, after.z - before.z});
        const Vec3 side = normalized(cross(tangent, up));
        up = cross(side, tangent);
        Ring& ring = rings.emplace_back();
        ring.first = static_cast<std::uint32_t>(mesh.vertices.size());
        for (std::uint32_t i = 0; i < counts[k]; ++i) {
            ring.turn.push_back(static_cast<double>(i) / counts[k]);
            const SineCosine angle = sine_cosine(ring.turn.back());
            const double u = tube * angle.cosine, v = tube * angle.sine; // up, side, tangent: up x side = tangent
            mesh.vertices.push_back({path[k].x + u * up.x + v * side.x, path[k].y + u * up.y + v * side.y,
                                     path[k].z + u * up.z + v * side.z});
        }
    }
    close_tube(mesh, rings);
    normalise(mesh);
    return mesh;
}

} // namespace raycontact::scenes
