// SPDX-License-Identifier: Apache-2.0
// `run FILE.json`: what its fields do, and which errors name them.
#include "expect.h"

#include <algorithm>
#include <tuple>
#include <utility>

namespace {

using nlohmann::json;

class SceneFile : public testing::Test {
protected:
    SceneFile() { folder_.write("cube.obj", cube_obj()); }
    ProgramResult run_words(std::vector<std::string> more) const {
        std::vector<std::string> words{"run", "scene.json", "--json"};
        words.insert(words.end(), more.begin(), more.end());
        return run_program(words, folder_.path());
    }
    json run(const json& scene, const std::vector<std::string>& more = {}) const {
        folder_.write("scene.json", scene.dump());
        const auto result = run_words(more);
        EXPECT_EQ(result.status, 0) << result.err;
        return json::parse(result.out);
    }
    void refused(const json& scene, const std::string& named) const { refused_text(scene.dump(), named); }
    void refused_text(const std::string& text, const std::string& named) const {
        folder_.write("scene.json", text);
        const auto result = run_words({});
        expect_refused(result, "scene.json: ");
        expect_refused(result, named);
    }
    /// One cube, 3 m above the ground.
    static json one_cube() {
        return {{"steps", 120},
                {"ground", {{"slab", 20}}},
                {"meshes", {{"cube", {{"file", "cube.obj"}}}}},
                {"bodies", {{{"mesh", "cube"}, {"position", {0, 0, 3}}}}}};
    }
    static json changed(const char* pointer, const json& value) {
        json scene = one_cube();
        scene[json::json_pointer(pointer)] = value;
        return scene;
    }
    TemporaryFolder folder_;
};

TEST_F(SceneFile, TheExampleRuns) {
    const auto result = run_program({"run", RAYCONTACT_EXAMPLES "/gears-and-stars.json", "--json"}, folder_.path());
    ASSERT_EQ(result.status, 0) << result.err;
    const json log = json::parse(result.out);
    EXPECT_EQ(log["scene"], "gears and stars");
    EXPECT_EQ(log["steps"], 240);
    EXPECT_EQ(log["bodies"], 33); // three, and thirty of the source; the static one is not counted
    EXPECT_GT(log["contacts"].get<int>(), 1000);
    EXPECT_EQ(log["below_ground"], 0);
}

TEST_F(SceneFile, ABodyFallsAndComesToRest) {
    const json log = run(one_cube());
    EXPECT_EQ(log["scene"], "scene"); // the file's name
    EXPECT_EQ(log["bodies"], 1);
    EXPECT_GT(log["contacts"].get<int>(), 0);
    EXPECT_EQ(log["below_ground"], 0);
    EXPECT_EQ(run(one_cube(), {"--threads", "3"})["hash"], log["hash"]);
    EXPECT_EQ(run(one_cube(), {"--steps", "7"})["steps"], 7);
    EXPECT_EQ(run(one_cube(), {"--seed", "9"})["seed"], 9);
    EXPECT_EQ(run(one_cube(), {"--method", "standard"})["hash"], log["hash"]);
}

TEST_F(SceneFile, FieldsDoWhatTheySay) {
    const auto contacts = [&](const json& scene) { return run(scene)["contacts"].get<int>(); };
    EXPECT_EQ(contacts(changed("/gravity", {0, 0, 0})), 0);
    EXPECT_EQ(contacts(changed("/bodies/0/step", 100)), 0); // it comes too late to land
    EXPECT_EQ(contacts(changed("/bodies/0/velocity", {0, 0, 30})), 0);
    EXPECT_EQ(contacts(changed("/dt", 0.001)), 0);
    EXPECT_EQ(contacts(changed("/meshes/cube/scale", 0.01)), 0 + contacts(changed("/meshes/cube/size", 0.01)));
    EXPECT_EQ(run(changed("/ground", "none"))["contacts"], 0);
    EXPECT_EQ(run(changed("/ground", "plane"))["below_ground"], 0);
    EXPECT_EQ(run(changed("/bodies/0/static", true))["bodies"], 0);
    EXPECT_EQ(run(changed("/depth_limit", 0.25))["depth_limit"], 0.25);
    const auto hash = [&](const json& scene) { return run(scene)["hash"]; };
    const json turned = changed("/bodies/0/rotation", {0.8, 0.6, 0, 0});
    json matrix = one_cube();
    matrix["bodies"][0].erase("position");
    matrix["bodies"][0]["pose"] = {1, 0, 0, 0, 0, 0.28, -0.96, 0, 0, 0.96, 0.28, 3, 0, 0, 0, 1};
    EXPECT_EQ(hash(turned), hash(matrix)); // the same rotation twice
    for (const auto& [pointer, value] :
         std::initializer_list<std::pair<const char*, json>>{{"/friction", 0.01},
                                                             {"/iterations", 3},
                                                             {"/slop", 0.02},
                                                             {"/erp", 0.9},
                                                             {"/linear_damping", 0.5},
                                                             {"/bodies/0/spin", {0.5, 0, 0}},
                                                             {"/manifolds", {{"keep_steps", 0}}},
                                                             {"/bodies/0/velocity", {1, 0, 0}}}) {
        json scene = turned;
        scene[json::json_pointer(pointer)] = value;
        EXPECT_NE(hash(scene), hash(turned)) << pointer;
    }
}

// Whatever the ground is, and wherever down is.
TEST_F(SceneFile, LostBodiesAreCounted) {
    json scene = one_cube();
    scene["meshes"]["table"] = {{"file", "cube.obj"}, {"size", 8}};
    scene["bodies"] = json::array();
    for (int i = 0; i < 14; ++i) {
        const int column = i % 5, row = i / 5;
        scene["bodies"].push_back({{"mesh", "cube"}, {"position", {1.5 * column - 3, 1.5 * row - 1.5, 1}}});
    }
    for (int i = 0; i < 10; ++i) // beside the table, whose edge is at x = 4
        scene["bodies"].push_back({{"mesh", "cube"}, {"position", {5 + 1.5 * i, 0, 1}}});
    scene["bodies"].push_back({{"mesh", "table"}, {"static", true}, {"position", {0, 0, -4}}});
    scene["steps"] = 240;
    const auto lost = [&](const char* key) { return run(scene)[key]; };
    scene["ground"] = "none";
    EXPECT_EQ(lost("below_ground"), 10);
    EXPECT_EQ(lost("flown_off"), 10);
    scene["bodies"].erase(24); // nothing to fall from
    EXPECT_TRUE(lost("below_ground").is_null());
    EXPECT_TRUE(lost("flown_off").is_null());
    const auto text = run_program({"run", "scene.json"}, folder_.path()).out;
    EXPECT_NE(text.find("no ground that bodies could fall from"), std::string::npos) << text;
    scene["ground"] = {{"slab", 8}};
    EXPECT_EQ(lost("below_ground"), 10);
    scene["ground"] = "plane";
    EXPECT_EQ(lost("below_ground"), 0);
    scene["gravity"] = {0, 0, 5}; // away from the plane
    EXPECT_EQ(lost("below_ground"), 24);
    scene["gravity"] = {0, 0, 0};
    EXPECT_TRUE(lost("below_ground").is_null());
}

TEST_F(SceneFile, MeshesAreCountedAsTheyAre) {
    json scene = one_cube();
    scene["meshes"]["knot"] = {{"model", "knot"}, {"triangles", 200}};
    scene["bodies"].push_back({{"mesh", "knot"}, {"position", {3, 0, 3}}});
    scene["bodies"].push_back({{"mesh", "cube"}, {"static", true}, {"position", {-3, 0, 3}}});
    EXPECT_EQ(run(scene)["mesh_source"],
              "1 x cube.obj (8 vertices and 12 triangles); 1 x a procedural trefoil knot of 100 vertices and 200 "
              "triangles; standing still: 1 x cube.obj (8 vertices and 12 triangles)");
}

// The file places the mesh's own origin, wherever its centre of mass is.
TEST_F(SceneFile, PosesAreThoseOfTheMeshFile) {
    std::string moved;
    for (const double z : {0.0, 1.0})
        for (const double y : {7.0, 8.0})
            for (const double x : {3.0, 4.0})
                moved += "v " + std::to_string(x) + " " + std::to_string(y) + " " + std::to_string(z) + "\n";
    folder_.write("far.obj", moved + "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n");
    json scene = one_cube();
    scene["gravity"] = {0, 0, 0};
    scene["steps"] = 1;
    scene["meshes"]["far"] = {{"file", "far.obj"}};
    // Half sunk into the slab: the lower four vertices are contacts.
    scene["bodies"] = {{{"mesh", "far"}, {"position", {-3.5, -7.5, -0.5}}}};
    EXPECT_EQ(run(scene)["contacts"], 4);
    scene["bodies"][0]["position"] = {-3.5, -7.5, 0.01};
    EXPECT_EQ(run(scene)["contacts"], 0);
    scene["bodies"][0]["position"] = {6.6, -7.5, -0.5}; // beside the slab, whose edge is at 10
    EXPECT_EQ(run(scene, {"--features", "vertices"})["contacts"], 2);
}

TEST_F(SceneFile, SourcesLetBodiesGoInTurn) {
    json scene = one_cube();
    scene["meshes"]["knot"] = {{"model", "knot"}, {"triangles", 200}};
    scene["sources"] = {{{"meshes", {"cube", "knot"}},
                         {"bodies", 6},
                         {"rate", 5},
                         {"centre", {0, 0, 8}},
                         {"radius", 4},
                         {"period", 2},
                         {"velocity", {0, 0, -1}},
                         {"density", 500},
                         {"step", 12}}};
    const json log = run(scene);
    EXPECT_EQ(log["bodies"], 7);
    EXPECT_EQ(run(scene, {"--steps", "40"})["bodies"], 4);       // of the source those of steps 12, 24 and 36
    EXPECT_NE(run(scene, {"--seed", "5"})["hash"], log["hash"]); // each turned at random
}

TEST_F(SceneFile, ErrorsNameTheField) {
    const std::pair<const char*, json> faults[] = {{"/steps", 0},
                                                   {"/steps", 2.5},
                                                   {"/dt", 0},
                                                   {"/dt", "fast"},
                                                   {"/seed", -1},
                                                   {"/gravity", {0, 0}},
                                                   {"/gravity", {0, 0, "down"}},
                                                   {"/ground", "sea"},
                                                   {"/ground", {{"slab", -1}}},
                                                   {"/friction", -0.1},
                                                   {"/iterations", 0},
                                                   {"/erp", 1.5},
                                                   {"/bounds", "ball"},
                                                   {"/name", ""},
                                                   {"/manifolds", 3},
                                                   {"/meshes", json::object()},
                                                   {"/meshes/cube/file", 7},
                                                   {"/meshes/cube/file", "missing.obj"},
                                                   {"/meshes/cube/size", 0},
                                                   {"/meshes/cube/scale", -2},
                                                   {"/bodies", 3},
                                                   {"/sources", {{{"meshes", {"sphere"}}}}}};
    for (const auto& [pointer, value] : faults) {
        std::string field = std::string(pointer).substr(1);
        std::replace(field.begin(), field.end(), '/', '.');
        refused(changed(pointer, value), field);
    }
    const std::tuple<const char*, json, const char*> in_bodies[] = {
        {"/bodies/0/mesh", "ball", "bodies[0].mesh: \"ball\""},
        {"/bodies/0/position", {1, 2}, "bodies[0].position"},
        {"/bodies/0/rotation", {0, 0, 0, 0}, "bodies[0].rotation"},
        {"/bodies/0/pose", {1, 2, 3}, "bodies[0]"},
        {"/bodies/0/density", 0, "bodies[0].density"},
        {"/bodies/0/static", 1, "bodies[0].static"},
        {"/bodies/0/step", -1, "bodies[0].step"},
        {"/bodies/0/colour", "red", "\"colour\""},
        {"/frictoin", 1, "\"frictoin\""},
        {"/meshes/cube/model", "knot", "meshes.cube"},
        {"/meshes/cube/triangles", 60, "meshes.cube"},
    };
    for (const auto& [pointer, value, named] : in_bodies) refused(changed(pointer, value), named);
    json both = changed("/bodies/0/static", true);
    both["bodies"][0]["velocity"] = {1, 0, 0};
    refused(both, "bodies[0]: a static body has no \"velocity\"");
    json model = one_cube();
    model["meshes"]["cube"] = {{"model", "teapot"}};
    refused(model, "meshes.cube.model");
    model["meshes"]["cube"] = {{"model", "knot"}, {"triangles", 61}};
    refused(model, "meshes.cube");
    json none = one_cube();
    none["bodies"] = json::array();
    refused(none, "bodies");
    none.erase("meshes");
    refused(none, "meshes");
    refused_text("[]", "must be an object");
    refused_text("{\"steps\": 1, \"steps\": 2}", "\"steps\" is given twice");
    refused_text("{\"steps\": ", "is not JSON");
    refused_text("{\"bodies\": [[[[[[[[1]]]]]]]]}", "nested too deeply");
    refused_text("", "is not JSON");
    expect_refused(run_program({"run", "missing.json"}, folder_.path()), "missing.json");
    expect_refused(run_program({"run", "scene.json", "--bodies", "3"}, folder_.path()), "--bodies");
}

} // namespace
