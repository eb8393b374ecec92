// SPDX-License-Identifier: Apache-2.0
// `collide`: what it prints, on two cubes whose contacts are known by hand.
#include "expect.h"

#include <cmath>

namespace {

using nlohmann::json;

/// Row-major, no rotation.
json translation(double x, double y, double z) {
    return {1, 0, 0, x, 0, 1, 0, y, 0, 0, 1, z, 0, 0, 0, 1};
}

class Collide : public testing::Test {
protected:
    Collide() { folder_.write("cube.obj", cube_obj()); }

    ProgramResult run(const json& pairs, std::vector<std::string> options = {"--json"}) const {
        folder_.write("pairs.json", pairs.dump());
        options.insert(options.begin(), {"collide", "--pairs", "pairs.json"});
        return run_program(options, folder_.path());
    }

    /// By the paper's rule, whose contacts are known by hand.
    ProgramResult run_vertices(const json& pairs, std::vector<std::string> options = {"--json"}) const {
        options.insert(options.end(), {"--features", "vertices"});
        return run(pairs, options);
    }

    /// A cube at the origin and one at (0.8, 0.7, 0.6): one corner each is inside the other.
    static json corner_pair() { return {{"a", "cube.obj"}, {"b", "cube.obj"}, {"pose_b", translation(0.8, 0.7, 0.6)}}; }

    /// In each the second cube reaches a little deeper into the first.
    static json fifty_pairs() {
        json pairs = json::array();
        for (int i = 0; i < 50; ++i) {
            json pair = corner_pair();
            pair["pose_b"] = translation(0.80 - 0.01 * i, 0.7, 0.6);
            pairs.push_back(pair);
        }
        return pairs;
    }

    TemporaryFolder folder_;
};

void expect_vector(const json& vector, double x, double y, double z) {
    ASSERT_EQ(vector.size(), 3u);
    EXPECT_NEAR(vector[0].get<double>(), x, 1e-6);
    EXPECT_NEAR(vector[1].get<double>(), y, 1e-6);
    EXPECT_NEAR(vector[2].get<double>(), z, 1e-6);
}

TEST_F(Collide, NoPairsAreSaidToBeNone) {
    const auto text = run(json::array(), {}), lines = run(json::array());
    EXPECT_EQ(text.status, 0);
    EXPECT_EQ(text.out, "0 pairs\n");
    EXPECT_EQ(lines.status, 0);
    EXPECT_EQ(lines.out, "");
}

TEST_F(Collide, TwoCorners) {
    const auto result = run_vertices(json::array({corner_pair()}));
    ASSERT_EQ(result.status, 0) << result.err;
    EXPECT_NE(result.err.find("cube.obj: coarse for --features vertices"), std::string::npos) << result.err;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1);
    const auto lines = json_lines(result.out);
    ASSERT_EQ(lines.size(), 1u);
    EXPECT_EQ(keys_of(lines[0]), (std::set<std::string>{"pair", "colliding", "intersecting", "distance", "contacts"}));
    EXPECT_EQ(lines[0]["pair"], 0);
    EXPECT_EQ(lines[0]["colliding"], true);
    const json& contacts = lines[0]["contacts"];
    ASSERT_EQ(contacts.size(), 2u);
    for (const json& contact : contacts) {
        EXPECT_EQ(keys_of(contact),
                  (std::set<std::string>{"feature", "vertex_body", "vertex", "triangle", "point", "point_a", "point_b",
                                         "normal", "depth", "ray_length", "weight", "key"}));
        // Either corner is 0.2, 0.3, 0.4 from the faces of the other; the ray runs along the diagonal to the first.
        EXPECT_NEAR(contact["depth"].get<double>(), 0.2, 1e-6);
        EXPECT_NEAR(contact["ray_length"].get<double>(), 0.2 * std::sqrt(3.0), 1e-6);
        expect_vector(contact["normal"], 1, 0, 0);
        EXPECT_EQ(contact["weight"], 1);
    }
    EXPECT_EQ(contacts[0]["vertex_body"], "a");
    EXPECT_EQ(contacts[0]["vertex"], 6);
    expect_vector(contacts[0]["point"], 0.5, 0.5, 0.5);
    EXPECT_TRUE(contacts[0]["triangle"] == 10 || contacts[0]["triangle"] == 11) << contacts[0];
    EXPECT_EQ(contacts[1]["vertex_body"], "b");
    EXPECT_EQ(contacts[1]["vertex"], 0);
    expect_vector(contacts[1]["point"], 0.3, 0.2, 0.1);
    EXPECT_TRUE(contacts[1]["triangle"] == 6 || contacts[1]["triangle"] == 7) << contacts[1];
    EXPECT_NE(contacts[0]["key"], contacts[1]["key"]);
}

TEST_F(Collide, EdgesSeeWhatNoVertexSees) {
    json inside{{"a", "cube.obj"}, {"b", "cube.obj"}, {"pose_b", translation(0.1, 0, 0.2)}, {"scale_b", 0.1}};
    json stacked{{"a", "cube.obj"}, {"b", "cube.obj"}, {"pose_b", translation(0, 0, 0.99)}};
    // By 45 degrees: no corner lies over the other cube.
    const double turn = std::sqrt(0.5);
    json turned{{"a", "cube.obj"},
                {"b", "cube.obj"},
                {"pose_b", {turn, -turn, 0, 0, turn, turn, 0, 0, 0, 0, 1, 0.99, 0, 0, 0, 1}}};
    json touching{{"a", "cube.obj"}, {"b", "cube.obj"}, {"pose_b", translation(0, 0, 1)}};
    const json pairs = json::array({inside, stacked, turned, touching});
    const auto result = run(pairs);
    EXPECT_EQ(result.err, "");
    const auto lines = json_lines(result.out);
    ASSERT_EQ(lines.size(), 4u);
    ASSERT_EQ(lines[0]["contacts"].size(), 1u);
    EXPECT_EQ(lines[0]["contacts"][0]["feature"], "inside");
    EXPECT_EQ(lines[0]["contacts"][0]["vertex_body"], "b");
    // The crossings have the lower corners of b inside of a, flush as they are.
    EXPECT_EQ(lines[1]["contacts"].size(), 4u);
    for (const json& contact : lines[1]["contacts"]) {
        EXPECT_EQ(contact["feature"], "vertex");
        EXPECT_EQ(contact["vertex_body"], "b");
        EXPECT_NEAR(std::fabs(contact["point"][0].get<double>()), 0.5, 1e-6);
        EXPECT_NEAR(std::fabs(contact["point"][1].get<double>()), 0.5, 1e-6);
        EXPECT_NEAR(contact["depth"].get<double>(), 0.01, 1e-6);
        expect_vector(contact["normal"], 0, 0, 1);
    }
    EXPECT_GE(lines[2]["contacts"].size(), 4u);
    for (const json& contact : lines[2]["contacts"]) {
        EXPECT_EQ(contact["feature"], "edges");
        EXPECT_EQ(contact["key"].get<std::string>().size(), 16u);
        EXPECT_TRUE(contact.contains("edge_a") && contact.contains("edge_b")) << contact;
        for (const char* of_vertices : {"vertex", "vertex_body", "triangle"})
            EXPECT_FALSE(contact.contains(of_vertices)) << contact;
        EXPECT_NEAR(contact["depth"].get<double>(), 0.01, 1e-6);
        expect_vector(contact["normal"], 0, 0, 1);
    }
    EXPECT_EQ(lines[3]["colliding"], false);
    const auto by_vertices = json_lines(run_vertices(pairs).out);
    EXPECT_EQ(by_vertices[1]["colliding"], false);
    EXPECT_EQ(by_vertices[2]["colliding"], false);
}

TEST_F(Collide, SwappedPairTurnsTheNormals) {
    const json swapped{{"a", "cube.obj"}, {"b", "cube.obj"}, {"pose_a", translation(0.8, 0.7, 0.6)}};
    const auto lines = json_lines(run_vertices(json::array({corner_pair(), swapped})).out);
    ASSERT_EQ(lines.size(), 2u);
    EXPECT_EQ(lines[1]["pair"], 1);
    ASSERT_EQ(lines[1]["contacts"].size(), 2u);
    for (std::size_t i = 0; i < 2; ++i) {
        const json& contact = lines[1]["contacts"][i];
        const json& other = lines[0]["contacts"][1 - i]; // the same vertex, now sorted by the other letter
        EXPECT_NE(contact["vertex_body"], other["vertex_body"]);
        for (const char* key : {"vertex", "triangle", "point", "depth", "ray_length", "weight"})
            EXPECT_EQ(contact[key], other[key]) << key;
        for (std::size_t k = 0; k < 3; ++k) {
            EXPECT_EQ(contact["normal"][k].get<double>(), -other["normal"][k].get<double>());
        }
    }
}

TEST_F(Collide, ApartIsNotColliding) {
    const auto lines =
        json_lines(run(json::array({{{"a", "cube.obj"}, {"b", "cube.obj"}, {"pose_b", translation(1.2, 0, 0)}}})).out);
    ASSERT_EQ(lines.size(), 1u);
    EXPECT_EQ(lines[0]["colliding"], false);
    EXPECT_TRUE(lines[0]["contacts"].is_array());
    EXPECT_TRUE(lines[0]["contacts"].empty());
}

TEST_F(Collide, ScaleIsOfTheFileNotOfThePose) {
    // Half a cube at (0.6, 0.55, 0.5): spans 0.35 .. 0.85 in x, so its corner is 0.15 deep.
    const json pair{{"a", "cube.obj"}, {"b", "cube.obj"}, {"pose_b", translation(0.6, 0.55, 0.5)}, {"scale_b", 0.5}};
    const auto lines = json_lines(run_vertices(json::array({pair})).out);
    ASSERT_EQ(lines.size(), 1u);
    ASSERT_EQ(lines[0]["contacts"].size(), 2u) << lines[0];
    EXPECT_EQ(lines[0]["contacts"][0]["vertex_body"], "a");
    EXPECT_NEAR(lines[0]["contacts"][0]["depth"].get<double>(), 0.15, 1e-6);
    expect_vector(lines[0]["contacts"][1]["point"], 0.35, 0.3, 0.25);
}

TEST_F(Collide, ManyPairsAreAnsweredInTheirOrder) {
    json pairs = json::array();
    for (int i = 0; i < 5000; ++i) { // more than one batch
        json pair = corner_pair();
        if (i % 3 == 1) pair["pose_b"] = translation(5, 0, 0);
        pairs.push_back(pair);
    }
    const auto lines = json_lines(run(pairs).out);
    ASSERT_EQ(lines.size(), 5000u);
    for (std::size_t i = 0; i < lines.size(); ++i) {
        ASSERT_EQ(lines[i]["pair"], i);
        ASSERT_EQ(lines[i]["colliding"], i % 3 != 1);
        ASSERT_EQ(lines[i]["contacts"], i % 3 != 1 ? lines[0]["contacts"] : json::array());
    }
}

TEST_F(Collide, EveryCasterAndThreadCountGivesTheSameBits) {
    const json pairs = fifty_pairs();
    const auto expected = run(pairs).out;
    EXPECT_FALSE(expected.empty());
    EXPECT_EQ(run(pairs, {"--json", "--caster", "basic"}).out, expected);
    EXPECT_EQ(run(pairs, {"--json", "--caster", "bvh", "--method", "standard"}).out, expected);
    EXPECT_EQ(run(pairs, {"--json", "--threads", "1"}).out, expected);
    EXPECT_EQ(run(pairs, {"--json", "--threads", "3", "--devices", "cpu"}).out, expected);
    EXPECT_EQ(run(pairs, {"--json", "--direction", "reprojected"}).out, expected);
    EXPECT_NE(run(pairs, {"--json", "--direction", "ray"}).out, expected);
}

// A batch is one step, the first: there is nothing yet that a method could have kept.
TEST_F(Collide, EveryMethodAndThresholdGivesTheSameBits) {
    const json pairs = fifty_pairs();
    const auto expected = run(pairs, {"--json", "--method", "standard"}).out;
    EXPECT_FALSE(expected.empty());
    for (const char* method : {"certified", "iterative", "predictive"}) {
        const std::vector<std::string> options{"--json", "--method", method};
        EXPECT_EQ(run(pairs, options).out, expected) << method;
        for (const std::vector<std::string>& more :
             {std::vector<std::string>{"--displacement-threshold", "0.05", "--distance-extension", "0.1"},
              {"--displacement-threshold", "auto", "--confidence", "1", "--max-iterations", "1", "--no-walk-casts"},
              {"--culling-distance", "0", "--walk-casts"}}) {
            auto words = options;
            words.insert(words.end(), more.begin(), more.end());
            EXPECT_EQ(run(pairs, words).out, expected) << method << " " << more[0];
        }
    }
}

TEST_F(Collide, FewerContactsSayHowManyAreLeftOut) {
    const json pairs = json::array({corner_pair(), corner_pair()});
    const auto all = run(pairs), one = run(pairs, {"--json", "--max-contacts-per-pair", "1"});
    ASSERT_EQ(one.status, 0) << one.err;
    std::size_t count = 0;
    for (const json& line : json_lines(all.out)) count += line.at("contacts").size();
    for (const json& line : json_lines(one.out)) EXPECT_EQ(line.at("contacts").size(), 1u);
    const std::string said =
        "collide: " + std::to_string(count - 2) + " of " + std::to_string(count) + " contacts are left out";
    EXPECT_NE(one.err.find(said), std::string::npos) << one.err;
    EXPECT_EQ(run(pairs, {"--max-contacts", "no"}).status, 2);
}

TEST_F(Collide, DirectionRayIsTheRayItself) {
    const auto lines = json_lines(run_vertices(json::array({corner_pair()}), {"--json", "--direction", "ray"}).out);
    ASSERT_EQ(lines.size(), 1u);
    ASSERT_EQ(lines[0]["contacts"].size(), 2u);
    for (const json& contact : lines[0]["contacts"]) {
        EXPECT_EQ(contact["depth"], contact["ray_length"]);
        const double third = std::sqrt(1.0 / 3);
        expect_vector(contact["normal"], third, third, third);
    }
}

TEST_F(Collide, DirectionWeightedIsTheRayAndTheAreaOfItsVertex) {
    // Either corner is one of five triangles of half a square metre, and a third of each is its own.
    const double share = 5 * 0.5 / 3;
    json scaled = corner_pair();
    scaled["pose_b"] = translation(0.6, 0.55, 0.5);
    scaled["scale_b"] = 0.5;
    const json pairs = json::array({corner_pair(), scaled});
    const auto lines = json_lines(run_vertices(pairs, {"--json", "--direction", "weighted"}).out);
    auto rays = json_lines(run_vertices(pairs, {"--json", "--direction", "ray"}).out);
    ASSERT_EQ(lines.size(), 2u);
    for (std::size_t i = 0; i < 2; ++i) {
        ASSERT_EQ(lines[i]["contacts"].size(), 2u);
        for (std::size_t k = 0; k < 2; ++k) {
            const json& contact = lines[i]["contacts"][k];
            const double scale = i == 1 && contact["vertex_body"] == "b" ? 0.5 : 1;
            EXPECT_NEAR(contact["weight"].get<double>(), scale * scale * share, 1e-7);
            json& ray = rays[i]["contacts"][k];
            EXPECT_EQ(ray["weight"], 1);
            ray["weight"] = contact["weight"];
        }
        EXPECT_EQ(lines[i], rays[i]) << "all but the weight";
    }
    const auto table = run_vertices(pairs, {"--direction", "weighted"}).out;
    EXPECT_NE(table.find("weight (m^2)"), std::string::npos) << table;
    EXPECT_NE(table.find("  0.8333333\n"), std::string::npos) << table;
    EXPECT_EQ(run_vertices(pairs, {}).out.find("weight"), std::string::npos);
}

TEST_F(Collide, TenKilometresAwayIsTheSame) {
    const json far{{"a", "cube.obj"},
                   {"b", "cube.obj"},
                   {"pose_a", translation(10000, -10000, 10000)},
                   {"pose_b", translation(10000.8, -9999.3, 10000.6)}};
    const auto lines = json_lines(run_vertices(json::array({corner_pair(), far})).out);
    ASSERT_EQ(lines.size(), 2u);
    ASSERT_EQ(lines[1]["contacts"].size(), 2u);
    for (std::size_t i = 0; i < 2; ++i) {
        const json &near_contact = lines[0]["contacts"][i], &far_contact = lines[1]["contacts"][i];
        EXPECT_EQ(near_contact["key"], far_contact["key"]);
        EXPECT_NEAR(near_contact["depth"].get<double>(), far_contact["depth"].get<double>(), 1e-6);
        EXPECT_NEAR(near_contact["point"][0].get<double>() + 10000, far_contact["point"][0].get<double>(), 1e-6);
    }
}

TEST_F(Collide, PathsAreRelativeToThePairsFile) {
    std::filesystem::create_directory(folder_.path() / "sub");
    folder_.write("sub/inner.obj", cube_obj());
    folder_.write("sub/pairs.json", json::array({{{"a", "inner.obj"}, {"b", "../cube.obj"}}}).dump());
    const auto result = run_program({"collide", "--pairs", "sub/pairs.json", "--json"}, folder_.path());
    EXPECT_EQ(result.status, 0) << result.err;
    EXPECT_EQ(json_lines(result.out).size(), 1u);
}

TEST_F(Collide, TwoFilesAndTheTable) {
    // A tetrahedron with its right-angled corner in the cube, 0.2 below the top; the cube's corner is as far inside it.
    folder_.write("moved.obj", "v 0.1 0.2 0.3\nv 4.1 0.2 0.3\nv 0.1 4.2 0.3\nv 0.1 0.2 4.3\n"
                               "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
    const auto lines = json_lines(
        run_program({"collide", "cube.obj", "moved.obj", "--features", "vertices", "--json"}, folder_.path()).out);
    ASSERT_EQ(lines.size(), 1u);
    EXPECT_EQ(lines[0]["pair"], 0);
    ASSERT_EQ(lines[0]["contacts"].size(), 2u) << lines[0];
    EXPECT_EQ(lines[0]["contacts"][0]["vertex_body"], "a");
    EXPECT_EQ(lines[0]["contacts"][0]["vertex"], 6);
    EXPECT_EQ(lines[0]["contacts"][1]["vertex_body"], "b");
    EXPECT_EQ(lines[0]["contacts"][1]["vertex"], 0);
    EXPECT_NEAR(lines[0]["contacts"][1]["depth"].get<double>(), 0.2, 1e-6);
    const auto table = run_program({"collide", "cube.obj", "moved.obj", "--features", "vertices"}, folder_.path());
    EXPECT_EQ(table.status, 0);
    EXPECT_NE(table.out.find("2 contacts, deepest 0.2"), std::string::npos) << table.out;
    EXPECT_NE(table.out.find("\n  a     vertex        6 "), std::string::npos) << table.out;
    const auto edges = run_program({"collide", "cube.obj", "moved.obj"}, folder_.path());
    EXPECT_NE(edges.out.find("\n  a     edges "), std::string::npos) << edges.out;
    EXPECT_NE(run_vertices(json::array({corner_pair()}), {}).out.find("2 contacts, deepest 0.19999999 m"),
              std::string::npos);
}

TEST_F(Collide, SeparationsPartMeshesOrAreTheirDistance) {
    json apart = corner_pair();
    apart["pose_b"] = translation(3, 0, 0);
    const auto lines = json_lines(run(json::array({corner_pair(), apart}), {"--json", "--separation"}).out);
    ASSERT_EQ(lines.size(), 2u);
    const json &parted = lines[0]["separation"], &far = lines[1]["separation"];
    EXPECT_EQ(keys_of(parted), (std::set<std::string>{"distance", "normal", "point_a", "point_b"}));
    EXPECT_NEAR(parted["distance"].get<double>(), -0.2, 1e-4);
    expect_vector(parted["normal"], 1, 0, 0);
    EXPECT_EQ(far["distance"], lines[1]["distance"]);
    expect_vector(far["normal"], 1, 0, 0);
    EXPECT_FALSE(json_lines(run(json::array({apart})).out)[0].contains("separation"));
    const std::string text = run(json::array({corner_pair(), apart}), {"--separation"}).out;
    EXPECT_NE(text.find("; parted by 0.2"), std::string::npos) << text;
    EXPECT_NE(text.find(": apart by 2 m\n"), std::string::npos) << text;
}

TEST_F(Collide, NoPairsIsNoOutput) {
    const auto result = run(json::array());
    EXPECT_EQ(result.status, 0) << result.err;
    EXPECT_EQ(result.out, "");
}

class CollideByHand : public testing::Test {
protected:
    CollideByHand() { folder_.write("cube.obj", cube_obj()); }
    ProgramResult run(std::vector<std::string> options) const {
        options.insert(options.begin(), {"collide", "cube.obj", "cube.obj"});
        return run_program(options, folder_.path());
    }
    TemporaryFolder folder_;
};

TEST_F(CollideByHand, SaysWhatItIs) {
    const auto crossing = run({"--at", "0.9,0.2,0.1"});
    EXPECT_NE(crossing.out.find("pair 0: cube.obj and cube.obj: intersecting, "), std::string::npos) << crossing.out;
    EXPECT_NE(crossing.out.find(" contacts, deepest 0.10000003 m\n"), std::string::npos) << crossing.out;
    EXPECT_EQ(run({"--at", "1.1,0,0"}).out, "pair 0: cube.obj and cube.obj: apart by 0.10000000000000009 m\n");
    EXPECT_NE(run({"--at=-1,0,0"}).out.find("intersecting, 0 contacts"), std::string::npos) << "they touch";
    EXPECT_EQ(run({"--at", "-1.1,0,0"}).out, "pair 0: cube.obj and cube.obj: apart by 0.10000000000000009 m\n");
}

TEST_F(CollideByHand, TurnsAboutXThenYThenZ) {
    // A cube turned by 45 degrees about z or y reaches to 0.707 along x, about x to 0.5.
    const auto at = [&](const char* turn) { return run({"--at", "1.15,0,0", "--turn", turn}).out; };
    EXPECT_NE(at("0,0,45").find("intersecting, "), std::string::npos);
    EXPECT_NE(at("0,45,0").find("intersecting, "), std::string::npos);
    EXPECT_NE(at("45,0,0").find("apart"), std::string::npos);
    // First about x, and then about z or y: the long diagonal that lay along z now lies along x, or where it was.
    EXPECT_NE(at("45,90,0").find("intersecting, "), std::string::npos);
    EXPECT_NE(at("45,0,180").find("apart"), std::string::npos);
    EXPECT_NE(at("90,0,45").find("intersecting, "), std::string::npos);
    const auto quarter = json_lines(run({"--at", "1,0,0", "--turn", "90,180,-270", "--json"}).out);
    ASSERT_EQ(quarter.size(), 1u);
    EXPECT_EQ(quarter[0]["intersecting"], true) << "quarter turns are exact: the faces still touch";
    EXPECT_EQ(quarter[0]["colliding"], false);
}

TEST_F(CollideByHand, WitnessPoints) {
    const auto lines = json_lines(run({"--at", "0.9,0.2,0.1", "--json"}).out);
    ASSERT_EQ(lines.size(), 1u);
    EXPECT_EQ(lines[0]["intersecting"], true);
    for (const json& contact : lines[0]["contacts"])
        for (std::size_t k = 0; k < 3; ++k)
            EXPECT_NEAR(contact["point_a"][k].get<double>() - contact["point_b"][k].get<double>(),
                        contact["depth"].get<double>() * contact["normal"][k].get<double>(), 1e-6);
}

TEST_F(CollideByHand, RefusesHalfAPose) {
    expect_refused(run({"--at", "1,2"}), "--at");
    expect_refused(run({"--turn", "1,2,x"}), "--turn");
    expect_refused(run({"--at", "1,2,inf"}), "not a finite number");
}

TEST_F(Collide, TablePrintsNumbersInFull) {
    // As on a map: the sixth digit is a metre or ten.
    const json pair{{"a", "cube.obj"},
                    {"b", "cube.obj"},
                    {"pose_a", translation(500000.125, 5400000.25, 0)},
                    {"pose_b", translation(500000.875, 5400000.75, 0.5)}};
    const auto table = run_vertices(json::array({pair}), {});
    EXPECT_EQ(table.status, 0) << table.err;
    EXPECT_NE(table.out.find("  500000.625  5400000.75"), std::string::npos) << table.out;
    json apart = pair;
    apart["pose_b"] = translation(500100.125 + 1.0 / 1024, 5400000.25, 0);
    EXPECT_NE(run(json::array({apart}), {}).out.find("apart by 99.0009765625 m\n"), std::string::npos);
}

} // namespace
