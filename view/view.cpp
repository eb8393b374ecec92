// SPDX-License-Identifier: Apache-2.0
#include <view/view.h>

#include <view/layers.h>
#include <view/levels.h>
#include <view/motion.h>

#include <raycontact/error.h>
#include <recording/replay.h>
#include <report/colour.h>
#include <report/svg.h>

#include "page_text.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <stdexcept>

namespace raycontact::view {

namespace {

using Json = nlohmann::ordered_json;

// Names come from files: what is no UTF-8 is replaced.
std::string dump(const Json& json) {
    return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

Json shape_json(const Shape& shape, std::uint32_t most, std::uint64_t& bytes) {
    const Levels levels = make_levels(shape, most);
    std::vector<std::uint16_t> vertices;
    for (std::size_t axis = 0; axis < 3; ++axis)
        for (const auto& vertex : levels.vertices) vertices.push_back(vertex[axis]);
    Bytes triangles;
    Json counts = Json::array();
    for (const auto& level : levels.triangles) {
        counts.push_back(level.size());
        for (const std::uint32_t v : level) recording::put(triangles, v);
    }
    Json json{{"name", shape.name()},
              {"triangles", shape.triangles().size()},
              {"low", levels.low},
              {"high", levels.high},
              {"vertexCount", levels.vertices.size()},
              {"levels", counts},
              {"vertices", blob(split_bytes(vertices))},
              {"indices", blob(triangles)}};
    bytes += dump(json).size();
    return json;
}

Json shapes_json(const recording::Reader& reader, std::uint32_t triangles, std::uint64_t& bytes) {
    std::uint64_t all = 0;
    for (const auto& shape : reader.shapes()) all += shape->triangles().size();
    Json json = Json::array();
    for (const auto& shape : reader.shapes()) {
        const std::uint64_t own = shape->triangles().size();
        const std::uint64_t share = all > triangles ? std::max<std::uint64_t>(own * triangles / all, coarsest) : own;
        json.push_back(shape_json(*shape, static_cast<std::uint32_t>(share), bytes));
    }
    return json;
}

/// As the report's pictures show it, 0xrrggbb.
std::uint32_t colour_of(std::size_t body, bool moves) {
    constexpr float light = 1.5f; // a side that the sun meets at some 60 degrees
    std::uint8_t rgb[3];
    report::develop(light * (moves ? report::body_colour(body) : report::resting_colour()), rgb);
    return static_cast<std::uint32_t>(rgb[0] << 16 | rgb[1] << 8 | rgb[2]);
}

/// Where nothing moves at all, nothing is told from the ground.
Json bodies_json(const recording::Reader& reader, const std::vector<bool>& moves) {
    const bool still = std::find(moves.begin(), moves.end(), true) == moves.end();
    Json json = Json::array();
    for (std::size_t b = 0; b < moves.size(); ++b) {
        const recording::Body& body = reader.bodies()[b];
        json.push_back(
            {body.shape, body.first_step, std::min(body.end_step, reader.steps()), colour_of(b, still || moves[b])});
    }
    return json;
}

struct Found {
    std::vector<LayerStep> layers;
    std::vector<std::uint64_t> pairs, contacts; ///< by step
    std::vector<double> depths;                 ///< of the deepest contact of each step, metres
    std::vector<std::string> devices;
};

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
        found.pairs.push_back(scene.stats().pairs);
        found.contacts.push_back(scene.stats().contacts);
        found.depths.push_back(scene.stats().depth_max);
        if (i % options.layer_every == 0) found.layers.push_back(read_layer(scene, i));
        const std::vector<DeviceWork>& work = scene.stats().details.work;
        for (std::size_t k = found.devices.size(); k < work.size(); ++k) found.devices.push_back(work[k].device);
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
         {"decode.js", "camera.js", "shaders.js", "bodies.js", "layers.js", "controls.js", "main.js"})
        page += file(part);
    page += "})().catch(fail);\n</script>\n</body>\n</html>\n";
    return page;
}

} // namespace

std::uint32_t work_of(const recording::Reader& reader, const ViewOptions& options) {
    return options.layer_every == 0 ? reader.steps() : 2 * reader.steps();
}

View make_view(recording::Reader& reader, const ViewOptions& options) {
    if (reader.steps() == 0) throw InputError("view: the recording has no steps; record at least one");
    View view;
    const recording::Info& info = reader.info();
    const Motion motion = read_motion(reader, std::max(options.stride, 1u), options.progress);
    view.standing = static_cast<std::uint32_t>(std::count(motion.moves.begin(), motion.moves.end(), false));
    Json motion_json{{"low", motion.low},
                     {"high", motion.high},
                     {"kept", motion.kept},
                     {"stride", motion.stride},
                     {"numbers", blob(split_bytes(differences(motion)))}};
    view.motion_bytes = dump(motion_json).size();
    Json json{{"scene", info.scene},
              {"seed", info.seed},
              {"dt", info.dt},
              {"steps", reader.steps()},
              {"method", to_string(options.settings.method)},
              {"direction", to_string(options.settings.direction)},
              {"meshSource", info.mesh_source},
              {"bodies", bodies_json(reader, motion.moves)},
              {"standing", view.standing},
              {"shapes", shapes_json(reader, options.triangles, view.shape_bytes)},
              {"motion", motion_json},
              {"layers", nullptr}};
    if (options.layer_every > 0) json["layers"] = layers_json(find_contacts(reader, options), view);
    view.html = make_page(info.scene + " - RayContact", dump(json));
    return view;
}

} // namespace raycontact::view
