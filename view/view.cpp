// SPDX-License-Identifier: Apache-2.0
#include <view/view.h>

#include <view/layers.h>
#include <view/levels.h>
#include <view/motion.h>

#include <raycontact/error.h>
#include <recording/replay.h>
#include <report/svg.h>

#include "page_text.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <iterator>
#include <map>
#include <span>
#include <stdexcept>

namespace raycontact::view {

namespace {

using Json = nlohmann::ordered_json;

// Names come from files: what is no UTF-8 is replaced.
std::string dump(const Json& json) {
    return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

struct DrawnMesh {
    std::string name;
    std::span<const Vec3> vertices;
    std::span<const std::array<std::uint32_t, 3>> triangles;
};

Json shape_json(const DrawnMesh& mesh, std::uint32_t most, std::uint64_t& bytes) {
    const Levels levels = make_levels(mesh.vertices, mesh.triangles, most);
    std::vector<std::uint16_t> vertices;
    for (std::size_t axis = 0; axis < 3; ++axis)
        for (const auto& vertex : levels.vertices) vertices.push_back(vertex[axis]);
    Bytes triangles;
    Json counts = Json::array();
    for (const auto& level : levels.triangles) {
        counts.push_back(level.size());
        for (const std::uint32_t v : level) recording::put(triangles, v);
    }
    Json json{{"name", mesh.name},
              {"triangles", mesh.triangles.size()},
              {"low", levels.low},
              {"high", levels.high},
              {"vertexCount", levels.vertices.size()},
              {"levels", counts},
              {"vertices", blob(split_bytes(vertices))},
              {"indices", blob(triangles)}};
    bytes += dump(json).size();
    return json;
}

Json shapes_json(const std::vector<DrawnMesh>& meshes, std::uint32_t triangles, std::uint64_t& bytes) {
    std::uint64_t all = 0;
    for (const DrawnMesh& mesh : meshes) all += mesh.triangles.size();
    Json json = Json::array();
    for (const DrawnMesh& mesh : meshes) {
        const std::uint64_t own = mesh.triangles.size();
        const std::uint64_t share = all > triangles ? std::max<std::uint64_t>(own * triangles / all, coarsest) : own;
        json.push_back(shape_json(mesh, static_cast<std::uint32_t>(share), bytes));
    }
    return json;
}

/// 0xrrggbb, from the body's index alone: the same body has the same colour in every page.
std::uint32_t colour_of(std::size_t body, bool moves) {
    if (!moves) return 0xd3d3d3;
    constexpr std::uint32_t palette[] = {0xe48252, 0xe7c543, 0xe8dd7d, 0xafce83, 0x3dbdb2, 0x79d0da,
                                         0x3f98cd, 0x6e74b9, 0xc187ce, 0xe391b8, 0xe8e5df, 0xd9643d};
    // A multiplicative hash: neighbours in a grid get unlike colours, and a little lighter or darker.
    const std::uint32_t mixed = (static_cast<std::uint32_t>(body) + 1) * 2654435769u;
    const std::uint32_t base = palette[(mixed >> 16) % std::size(palette)], light = 237 + (mixed >> 8 & 31u); // of 256
    std::uint32_t colour = 0;
    for (const int bits : {16, 8, 0}) colour |= std::min((base >> bits & 255u) * light / 256, 255u) << bits;
    return colour;
}

/// Where nothing moves at all, nothing is told from the ground.
Json bodies_json(const std::vector<recording::Body>& bodies, std::uint32_t steps, const std::vector<bool>& moves) {
    const bool still = std::find(moves.begin(), moves.end(), true) == moves.end();
    Json json = Json::array();
    for (std::size_t b = 0; b < moves.size(); ++b)
        json.push_back({bodies[b].shape, bodies[b].first_step, std::min(bodies[b].end_step, steps),
                        colour_of(b, still || moves[b])});
    return json;
}

Found find_contacts(recording::Reader& reader, const ViewOptions& options) {
    recording::Follower follower(reader, options.settings);
    Found found;
    std::vector<Pose> poses;
    std::vector<Pair> pairs;
    for (std::uint32_t i = 0; i < reader.steps(); ++i) {
        reader.read_step(i, poses, pairs);
        follower.place(i, poses);
        Scene& scene = follower.scene();
        scene.find_contacts(pairs);
        found.add(scene, i % options.layer_every == 0);
        if (options.progress) options.progress(reader.steps() + i + 1);
    }
    return found;
}

Json layers_json(const Found& found, View& view) {
    const LayerScale scale = scale_of(found.layers);
    Json steps = Json::array();
    for (const LayerStep& layer : found.layers) {
        steps.push_back({{"step", layer.step},
                         {"contacts", layer.contacts.size()},
                         {"predictions", layer.predictions.size()},
                         {"contactData", blob(columns(layer.contacts, scale, true))},
                         {"predictionData", blob(columns(layer.predictions, scale, false))}});
        view.contacts += layer.contacts.size();
        view.predictions += layer.predictions.size();
    }
    Json json{
        {"low", scale.low},      {"high", scale.high},       {"length", scale.length}, {"depth", scale.depth},
        {"steps", steps},        {"devices", found.devices}, {"pairs", found.pairs},   {"contacts", found.contacts},
        {"depths", found.depths}};
    view.layer_bytes = dump(json).size();
    return json;
}

Json motion_json(const Motion& motion, View& view) {
    Json json{{"low", motion.low},
              {"high", motion.high},
              {"kept", motion.kept},
              {"stride", motion.stride},
              {"numbers", blob(split_bytes(differences(motion)))}};
    view.motion_bytes = dump(json).size();
    return json;
}

std::string_view file(std::string_view name) {
    for (const PageFile& page_file : page_files)
        if (page_file.name == name) return page_file.text;
    throw std::logic_error("view/page has no file " + std::string(name));
}

// Within a script element no "<" may stand: "<!--" and "</script" would change how the rest is read.
std::string for_script(std::string_view json) {
    std::string safe;
    for (const char c : json) {
        if (c == '<')
            safe += "\\u003c";
        else
            safe += c;
    }
    return safe;
}

/// The whole HTML document: the files of view/page with the data in their midst. json: of one object.
std::string make_page(const std::string& title, std::string_view json) {
    std::string page = "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
                       "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>"
                       + report::escape_html(title) + "</title>\n<style>\n";
    page += file("view.css");
    page += "</style>\n</head>\n<body>\n";
    page += file("view.html");
    page += "<script type=\"application/json\" id=\"recording\">" + for_script(json) + "</script>\n<script>\n";
    page += "'use strict';\n";
    page += file("problem.js");
    page += "(async()=>{\n";
    for (const char* part :
         {"decode.js", "camera.js", "shaders.js", "bodies.js", "layers.js", "clashes.js", "controls.js", "main.js"})
        page += file(part);
    page += "})().catch(fail);\n</script>\n</body>\n</html>\n";
    return page;
}

/// What a page of bodies that move says of them.
struct Shown {
    std::string scene, mesh_source;
    std::uint64_t seed = 0;
    double dt = 0;
    std::uint32_t steps = 0;
    Settings settings;
    std::vector<recording::Body> bodies;
    std::vector<DrawnMesh> meshes;
};

DrawnMesh drawn(const Shape& shape) {
    return {shape.name(), shape.vertices(), shape.triangles()};
}

/// found: null for a page without layers.
View show(const Shown& shown, const Motion& motion, const Found* found, std::uint32_t triangles) {
    View view;
    view.standing = static_cast<std::uint32_t>(std::count(motion.moves.begin(), motion.moves.end(), false));
    const Json json{{"scene", shown.scene},
                    {"seed", shown.seed},
                    {"dt", shown.dt},
                    {"steps", shown.steps},
                    {"method", to_string(shown.settings.method)},
                    {"direction", to_string(shown.settings.direction)},
                    {"meshSource", shown.mesh_source},
                    {"bodies", bodies_json(shown.bodies, shown.steps, motion.moves)},
                    {"standing", view.standing},
                    {"shapes", shapes_json(shown.meshes, triangles, view.shape_bytes)},
                    {"motion", motion_json(motion, view)},
                    {"layers", found ? layers_json(*found, view) : Json()}};
    view.html = make_page(shown.scene + " - RayContact", dump(json));
    return view;
}

} // namespace

std::uint32_t work_of(const recording::Reader& reader, const ViewOptions& options) {
    return options.layer_every == 0 ? reader.steps() : 2 * reader.steps();
}

View make_view(recording::Reader& reader, const ViewOptions& options) {
    if (reader.steps() == 0) throw InputError("view: the recording has no steps; record at least one");
    const recording::Info& info = reader.info();
    Shown shown{info.scene,     info.mesh_source, info.seed,       info.dt,
                reader.steps(), options.settings, reader.bodies(), {}};
    for (const auto& shape : reader.shapes()) shown.meshes.push_back(drawn(*shape));
    const Motion motion = read_motion(reader, std::max(options.stride, 1u), options.progress);
    if (options.layer_every == 0) return show(shown, motion, nullptr, options.triangles);
    const Found found = find_contacts(reader, options);
    return show(shown, motion, &found, options.triangles);
}

View make_view(const scenes::RunLog& log, const RunView& run, const Settings& settings) {
    constexpr std::uint32_t triangles = 200'000; // a report has more to hold than a view, and names the meshes itself
    Shown shown{log.scene, {}, log.seed, log.dt, run.steps(), settings, {}, {}};
    for (const auto& shape : log.shapes) shown.meshes.push_back(drawn(*shape));
    for (std::size_t b = 0; b < run.first_steps().size(); ++b)
        shown.bodies.push_back({.shape = log.body_shape[b], .first_step = run.first_steps()[b], .id = {}});
    return show(shown, run.motion(log.body_moves), &run.found(), triangles);
}

View make_clash_view(const ClashFile& file, const std::string& name, const ViewOptions& options) {
    View view;
    view.standing = static_cast<std::uint32_t>(file.parts.size());
    std::vector<bool> clashes(file.parts.size(), false);
    for (const ClashMark& mark : file.marks) clashes[mark.a] = clashes[mark.b] = true;
    // What the page draws in float32 is about the middle, for parts far from the origin.
    Vec3 low = file.parts[0].pose.translation, high = low;
    for (const AssemblyPart& part : file.parts) {
        const Vec3& at = part.pose.translation;
        low = {std::min(low.x, at.x), std::min(low.y, at.y), std::min(low.z, at.z)};
        high = {std::max(high.x, at.x), std::max(high.y, at.y), std::max(high.z, at.z)};
    }
    const Vec3 middle{(low.x + high.x) / 2, (low.y + high.y) / 2, (low.z + high.z) / 2};
    const auto from_middle = [&](const Vec3& v) { return Vec3{v.x - middle.x, v.y - middle.y, v.z - middle.z}; };
    std::vector<Pose> poses;
    std::vector<DrawnMesh> meshes;
    std::map<const Mesh*, std::size_t> number;
    Json bodies = Json::array(), names = Json::array(), marks = Json::array();
    for (std::size_t i = 0; i < file.parts.size(); ++i) {
        const AssemblyPart& part = file.parts[i];
        const auto [shape, is_new] = number.try_emplace(part.mesh.get(), meshes.size());
        if (is_new) meshes.push_back({part.mesh->name, part.mesh->vertices, part.mesh->triangles});
        poses.push_back({part.pose.rotation, from_middle(part.pose.translation)});
        bodies.push_back({shape->second, 0, 1, clashes[i] ? 0xcc2a22 : 0x999999});
        names.push_back(part.name);
    }
    for (const ClashMark& mark : file.marks) {
        const Vec3 point = from_middle(mark.point);
        marks.push_back({{"name", mark.name},
                         {"kind", mark.kind},
                         {"a", mark.a},
                         {"b", mark.b},
                         {"depth", mark.depth ? Json(*mark.depth) : Json()},
                         {"at", {mark.point.x, mark.point.y, mark.point.z}},
                         {"point", {point.x, point.y, point.z}}});
    }
    const Motion motion = standing(poses);
    const Json json{{"scene", name},
                    {"dt", 1},
                    {"steps", 1},
                    {"bodies", bodies},
                    {"names", names},
                    {"standing", view.standing},
                    {"shapes", shapes_json(meshes, options.triangles, view.shape_bytes)},
                    {"motion", motion_json(motion, view)},
                    {"layers", nullptr},
                    {"clashes", marks}};
    view.html = make_page(name + " - RayContact", dump(json));
    return view;
}

} // namespace raycontact::view
