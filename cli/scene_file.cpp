// SPDX-License-Identifier: Apache-2.0
#include "cli/scene_file.h"

#include "cli/json_file.h"

#include <raycontact/error.h>
#include <scenes/centred_shape.h>
#include <scenes/circle_source.h>
#include <scenes/ground.h>
#include <scenes/meshes_in_words.h>
#include <scenes/models/model.h>
#include <scenes/random.h>

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <utility>

namespace {

using namespace raycontact;
using namespace raycontact::scenes;

constexpr std::uint32_t most_bodies = 1u << 20;

/// A mesh of the file's list as the scene has it.
struct NamedMesh {
    std::uint32_t shape = 0;
    Vec3 centre; ///< of mass, in the mesh's own frame
    double extent = 0;
};

btVector3 bullet_vector(const Vec3& v) {
    return btVector3(btScalar(v.x), btScalar(v.y), btScalar(v.z));
}

btTransform bullet_pose(const Pose& pose) {
    btMatrix3x3 basis;
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 3; ++column)
            basis[row][column] =
                btScalar(pose.rotation[3 * static_cast<std::size_t>(row) + static_cast<std::size_t>(column)]);
    return btTransform(basis, bullet_vector(pose.translation));
}

/// What `make` gives; its errors name the field.
template <class Make>
auto at_fault(const JsonField& field, Make make) {
    try {
        return make();
    } catch (const InputError& error) {
        field.refuse(error.what());
    }
}

class SceneReader {
public:
    SceneReader(const std::filesystem::path& file, const SceneFileOptions& options)
        : file_(file), document_(read_json_file(file, "a scene file", 6)), options_(options) {}

    SceneDescription read() {
        const JsonField root(document_, file_.string());
        root.only({"name", "steps", "seed", "dt", "gravity", "ground", "meshes", "bodies", "sources", "friction",
                   "iterations", "slop", "erp", "linear_damping", "angular_damping", "manifolds", "bounds",
                   "depth_limit"});
        scene_.name = file_.stem().string();
        if (const auto name = root.find("name")) scene_.name = name->text();
        if (const auto steps = root.find("steps")) scene_.steps = steps->count(1, 10'000'000);
        if (const auto seed = root.find("seed")) scene_.seed = seed->whole();
        scene_.steps = options_.steps.value_or(scene_.steps);
        scene_.seed = options_.seed.value_or(scene_.seed);
        scene_.settings = options_.settings;
        if (const auto dt = root.find("dt")) scene_.dt = dt->positive();
        if (const auto gravity = root.find("gravity")) scene_.gravity = gravity->vector();
        if (const auto ground = root.find("ground")) read_ground(*ground);
        read_meshes(root);
        if (const auto bodies = root.find("bodies"))
            for (const JsonField& body : bodies->items()) read_body(body);
        std::stable_sort(scene_.bodies.begin(), scene_.bodies.end(),
                         [](const BodyStart& a, const BodyStart& b) { return a.step < b.step; });
        Random random(scene_.seed);
        if (const auto sources = root.find("sources"))
            for (const JsonField& source : sources->items()) read_source(source, random);
        if (scene_.bodies.size() == (scene_.slab ? 1u : 0u))
            root.refuse("has no bodies; list them under \"bodies\" or \"sources\"");
        read_response(root);
        scene_.region = region();
        return std::move(scene_);
    }

private:
    // Before the bodies, so that they may come at any time: a slab is the first body.
    void read_ground(const JsonField& ground) {
        if (ground.is_text()) {
            const std::string word = ground.text();
            if (word != "plane" && word != "none")
                ground.refuse(quoted(word) + " is not known; give \"plane\", \"none\" or {\"slab\": METRES}");
            scene_.plane = word == "plane";
        } else {
            ground.only({"slab"});
            add_slab(scene_, ground.at("slab").positive() / 2, Region::inf);
        }
    }

    void read_meshes(const JsonField& root) {
        for (const auto& [name, mesh] : root.at("meshes").members()) {
            mesh.only({"file", "model", "triangles", "size", "scale"});
            const auto from_file = mesh.find("file"), model = mesh.find("model"), size = mesh.find("size"),
                       scale = mesh.find("scale");
            if (from_file.has_value() == model.has_value()) mesh.refuse("give either \"file\" or \"model\"");
            if (from_file && mesh.find("triangles")) mesh.refuse("\"triangles\" is for a \"model\"");
            if (size && scale) mesh.refuse("give either \"size\" or \"scale\"");
            const std::optional<double> metres = size ? std::optional(size->positive()) : std::nullopt;
            const double factor = scale ? scale->positive() : 1;
            std::string source;
            CentredShape made;
            if (from_file) {
                const std::string path = from_file->text();
                made = at_fault(*from_file,
                                [&] { return centred_shape(load_mesh(file_.parent_path() / path), metres, factor); });
                source = mesh_in_words(path, *made.shape);
            } else {
                const std::string kind = model->text();
                const auto triangles = mesh.find("triangles");
                const std::uint32_t count = triangles ? triangles->count(1) : 902;
                const Model known = at_fault(*model, [&] { return scene_model(kind, count); });
                made = at_fault(mesh, [&] { return centred_shape(stood_up(known.mesh), metres, factor); });
                source = known.source;
            }
            meshes_[name] = {static_cast<std::uint32_t>(scene_.shapes.size()), made.centre, made.extent};
            scene_.shapes.push_back({made.shape, bullet::Bounds::box, source});
        }
    }

    const NamedMesh& mesh_of(const JsonField& name) const {
        const auto found = meshes_.find(name.text());
        if (found == meshes_.end()) name.refuse(quoted(name.text()) + " is none of \"meshes\"");
        return found->second;
    }

    void read_body(const JsonField& body) {
        body.only({"mesh", "position", "rotation", "pose", "velocity", "spin", "density", "static", "step"});
        const NamedMesh& mesh = mesh_of(body.at("mesh"));
        BodyStart& start = scene_.bodies.emplace_back();
        start.shape = mesh.shape;
        Pose pose;
        if (const auto matrix = body.find("pose")) {
            if (body.find("position") || body.find("rotation"))
                body.refuse("give either \"pose\", or \"position\" and \"rotation\"");
            pose = matrix->rigid();
        } else {
            if (const auto rotation = body.find("rotation")) pose = rotation->turned();
            if (const auto position = body.find("position")) pose.translation = position->vector();
        }
        pose.translation = transform_point(pose, mesh.centre); // the file places the mesh's own origin
        start.pose = bullet_pose(pose);
        if (const auto step = body.find("step")) start.step = step->count(0);
        const auto still = body.find("static");
        if (still && still->truth()) {
            for (const char* key : {"velocity", "spin", "density"})
                if (body.find(key)) body.refuse(fmt::format("a static body has no \"{}\"", key));
            start.density = 0;
            return;
        }
        if (const auto density = body.find("density")) start.density = density->positive();
        if (const auto velocity = body.find("velocity")) start.velocity = bullet_vector(velocity->vector());
        if (const auto spin = body.find("spin")) start.spin = bullet_vector(spin->vector());
        smallest_ = std::min(smallest_, mesh.extent);
    }

    void read_source(const JsonField& field, Random& random) {
        field.only({"meshes", "bodies", "rate", "centre", "radius", "period", "velocity", "density", "step"});
        CircleSource source;
        for (const JsonField& name : field.at("meshes").items()) {
            source.shapes.push_back(mesh_of(name).shape);
            smallest_ = std::min(smallest_, mesh_of(name).extent);
        }
        if (source.shapes.empty()) field.at("meshes").refuse("name at least one mesh");
        source.bodies = field.at("bodies").count(1, most_bodies);
        source.centre = field.at("centre").vector();
        if (const auto rate = field.find("rate")) source.rate = rate->positive();
        if (const auto radius = field.find("radius")) source.radius = radius->not_negative();
        if (const auto period = field.find("period")) source.period = period->positive();
        if (const auto velocity = field.find("velocity")) source.velocity = velocity->vector();
        if (const auto density = field.find("density")) source.density = density->positive();
        if (const auto step = field.find("step")) source.first_step = step->count(0);
        add_source(scene_, source, random);
    }

    // After the bodies: lengths that are not given go by the smallest that moves.
    void read_response(const JsonField& root) {
        Response& r = scene_.response;
        if (smallest_ < Region::inf) {
            r.size = smallest_;
            scene_.depth_limit *= smallest_;
        }
        if (const auto v = root.find("friction")) r.friction = v->not_negative();
        if (const auto v = root.find("iterations")) r.iterations = static_cast<int>(v->count(1, 100'000));
        if (const auto v = root.find("slop")) r.slop = v->not_negative();
        if (const auto v = root.find("erp")) r.erp = v->share();
        if (const auto v = root.find("linear_damping")) r.linear_damping = v->share();
        if (const auto v = root.find("angular_damping")) r.angular_damping = v->share();
        if (const auto v = root.find("depth_limit")) scene_.depth_limit = v->not_negative();
        if (const auto manifolds = root.find("manifolds")) {
            manifolds->only({"patch_cosine", "patch_reach", "keep_steps"});
            if (const auto v = manifolds->find("patch_cosine")) r.manifolds.patch_cosine = btScalar(v->number());
            if (const auto v = manifolds->find("patch_reach")) r.manifolds.patch_reach = btScalar(v->not_negative());
            if (const auto v = manifolds->find("keep_steps"))
                r.manifolds.keep_steps = static_cast<int>(v->count(0, 255));
        }
        if (const auto bounds = root.find("bounds")) {
            const std::string word = bounds->text();
            if (word != "box" && word != "vertices")
                bounds->refuse(quoted(word) + " is not known; give \"box\" or \"vertices\"");
            for (SceneShape& shape : scene_.shapes)
                shape.bounds = word == "box" ? bullet::Bounds::box : bullet::Bounds::vertices;
        }
    }

    // What stands still and all above it. Bodies of a scene without such things cannot be lost.
    Region region() const {
        Region region = Region::empty();
        if (scene_.plane)
            for (const double far : {-Region::inf, Region::inf}) region.include({far, far, 0});
        for (std::size_t k = 0; k < scene_.bodies.size(); ++k) {
            const BodyStart& body = scene_.bodies[k];
            if (body.density > 0) continue;
            for (const Vec3& v : scene_.shapes[body.shape].shape->vertices()) {
                if (scene_.slab == k && v.z < 0) continue; // a slab's top is the ground
                const btVector3 p = body.pose * bullet_vector(v);
                region.include({double(p.x()), double(p.y()), double(p.z())});
            }
        }
        if (region.low.z > region.high.z) return {};
        region.open_above(scene_.gravity);
        return region;
    }

    std::filesystem::path file_;
    nlohmann::json document_;
    const SceneFileOptions& options_;
    SceneDescription scene_;
    std::map<std::string, NamedMesh> meshes_;
    double smallest_ = Region::inf; ///< extent of what moves
};

} // namespace

SceneDescription read_scene_file(const std::filesystem::path& file, const SceneFileOptions& options) {
    return SceneReader(file, options).read();
}
