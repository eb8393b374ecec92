// SPDX-License-Identifier: Apache-2.0
// Help, version, exit status and the options that every subcommand shares.
#include "expect.h"

namespace {

class Usage : public testing::Test {
protected:
    Usage() { folder_.write("cube.obj", cube_obj()); }
    ProgramResult run(const std::vector<std::string>& arguments) const {
        return run_program(arguments, folder_.path());
    }
    TemporaryFolder folder_;
};

TEST_F(Usage, HelpEverywhere) {
    const auto whole = run({"--help"});
    EXPECT_EQ(whole.status, 0);
    for (const char* command : {"devices", "samples", "mesh", "collide", "run", "replay"}) {
        EXPECT_NE(whole.out.find(std::string("\n  ") + command + " "), std::string::npos) << command;
        const auto help = run({command, "--help"});
        EXPECT_EQ(help.status, 0) << command;
        EXPECT_NE(help.out.find("--json"), std::string::npos) << command;
        EXPECT_EQ(help.err, "") << command;
    }
    for (const char* command : {"collide", "run", "replay"}) {
        const auto help = run({command, "--help"});
        for (const char* option :
             {"--method", "--caster", "--direction", "--devices", "--threads", "--max-iterations",
              "--displacement-threshold", "--confidence", "--culling-distance", "--distance-extension",
              "--no-walk-casts", "METRES", "metres", "certified", "standard", "iterative", "predictive"}) {
            EXPECT_NE(help.out.find(option), std::string::npos) << command << " " << option;
        }
    }
}

TEST_F(Usage, Version) {
    const auto result = run({"--version"});
    EXPECT_EQ(result.status, 0);
    EXPECT_EQ(result.out, std::string("raycontact ") + RAYCONTACT_VERSION + "\n");
}

TEST_F(Usage, BadUsageIsStatusTwoAndOneLine) {
    for (const char* command : {"subcommand", "devices", "mesh", "collide", "run", "replay", "reproduce"}) {
        expect_refused(run({}), command);
    }
    expect_refused(run({"colide"}), "colide");
    expect_refused(run({"--jsn"}), "--jsn");
    expect_refused(run({"devices", "extra"}), "extra");
    expect_refused(run({"mesh"}), "FILE");
    expect_refused(run({"mesh", "cube.obj", "--method", "standard"}), "--method");
    expect_refused(run({"collide"}), "collide");
    expect_refused(run({"collide", "cube.obj"}), "two mesh files");
    expect_refused(run({"collide", "cube.obj", "cube.obj", "--pairs", "pairs.json"}), "--pairs");
    expect_refused(run({"run"}), "SCENE");
    expect_refused(run({"run", "landslide"}), "landslide");
    expect_refused(run({"replay"}), "RECORDING");
    expect_refused(run({"replay", "missing.glb"}), "missing.glb");
    expect_refused(run({"replay", "cube.obj"}), "cube.obj");
    expect_refused(run({"replay", "cube.obj", "--compare", "quick"}), "--compare");
    expect_refused(run({"collide", "cube.obj", "cube.obj", "--threads", "-1"}), "--threads");
    expect_refused(run({"collide", "cube.obj", "cube.obj", "--threads", "two"}), "--threads");
    expect_refused(run({"collide", "cube.obj", "cube.obj", "--caster"}), "--caster");
    expect_refused(run({"collide", "cube.obj", "cube.obj", "--caster", "bvh", "--caster", "bvh"}), "--caster");
}

TEST_F(Usage, UnknownWordsNameTheOption) {
    for (const char* option : {"--method", "--caster", "--direction", "--devices", "--schedule"}) {
        expect_refused(run({"collide", "cube.obj", "cube.obj", option, "quick"}), option);
    }
    expect_refused(run({"collide", "cube.obj", "cube.obj", "--features", "ed\rges"}), "'ed?ges' is unknown");
    expect_refused(run({"collide", "cube.obj", "cube.obj", "--devices", "gpu\n"}), "'gpu?': give");
}

TEST_F(Usage, UnknownOptionsAreNamedInOrderWithTheNearest) {
    expect_refused(run({"run", "avalanche", "--bodie", "5"}), "not expected: --bodie 5; did you mean --bodies?");
    expect_refused(run({"collide", "cube.obj", "cube.obj", "--methods=standard"}), "did you mean --method?");
    expect_refused(run({"colide", "cube.obj", "cube.obj"}), "did you mean collide?");
    const auto far = run({"collide", "cube.obj", "cube.obj", "--wavelets"});
    EXPECT_EQ(far.err.find("did you mean"), std::string::npos) << far.err;
}

TEST_F(Usage, ThresholdsThatMakeNoSenseNameTheirOption) {
    const std::pair<const char*, const char*> refused[] = {{"--displacement-threshold", "-0.01"},
                                                           {"--displacement-threshold", "nan"},
                                                           {"--displacement-threshold", "1cm"},
                                                           {"--displacement-threshold", ""},
                                                           {"--confidence", "0.99"},
                                                           {"--confidence", "inf"},
                                                           {"--confidence", "auto"},
                                                           {"--culling-distance", "-1"},
                                                           {"--culling-distance", "far"},
                                                           {"--distance-extension", "-1e-9"},
                                                           {"--distance-extension", "1e999"},
                                                           {"--max-iterations", "0"},
                                                           {"--max-iterations", "-1"},
                                                           {"--max-iterations", "2.5"},
                                                           {"--max-iterations", "4097"},
                                                           {"--max-iterations", "4294967295"},
                                                           {"--max-iterations", "99999999999"}};
    for (const auto& [option, value] : refused) {
        expect_refused(run({"collide", "cube.obj", "cube.obj", option, value}), option);
        expect_refused(run({"run", "avalanche", "--steps", "1", option, value}), option);
        expect_refused(run({"replay", "missing.glb", option, value}), option);
    }
    // Each makes sense, the two together do not.
    const auto result =
        run({"collide", "missing.obj", "cube.obj", "--displacement-threshold", "0.02", "--distance-extension", "0.01"});
    expect_refused(result, "--displacement-threshold");
    expect_refused(result, "--distance-extension");
    expect_refused(run({"mesh", "cube.obj", "--confidence", "2"}), "--confidence");
}

TEST_F(Usage, NumbersAreDecimalAndInTheirRange) {
    for (const char* option : {"--seed", "--bodies", "--steps"}) {
        for (const char* value : {"-1", "99999999999999999999", "1e3", "0x10", "2.5", "7 ", " 7", "+7", ""})
            expect_refused(run({"run", "avalanche", std::string(option) + "=" + value}), option);
    }
    for (const char* value : {"-1", "nan", "inf", "0x1p3", "1,5", ""})
        expect_refused(run({"run", "--mesh", "cube.obj", std::string("--size=") + value}), "--size");
    for (const std::vector<std::string>& words : {std::vector<std::string>{"collide", "cube.obj", "cube.obj"},
                                                  {"run", "avalanche"},
                                                  {"replay", "missing.glb"}}) {
        auto all = words;
        all.emplace_back("--threads=-1");
        expect_refused(run(all), "--threads");
    }
    const auto run_log = [&](const char* bodies, const char* seed) {
        const auto result = run({"run", "avalanche", "--bodies", bodies, "--seed", seed, "--steps", "03", "--json"});
        EXPECT_EQ(result.status, 0) << result.err;
        return nlohmann::json::parse(result.out);
    };
    EXPECT_EQ(run_log("010", "18446744073709551615")["bodies"], 10);
    EXPECT_EQ(run_log("10", "18446744073709551615")["seed"], 18446744073709551615u);
    EXPECT_EQ(run({"collide", "cube.obj", "cube.obj", "--max-iterations", "4096"}).status, 0);
}

TEST_F(Usage, EmptyNamesAreRefused) {
    for (const std::vector<std::string>& words : {std::vector<std::string>{"run", "avalanche"},
                                                  {"replay", "missing.glb"},
                                                  {"view", "missing.glb"},
                                                  {"reproduce"}}) {
        auto all = words;
        all.insert(all.end(), {"--out", ""});
        expect_refused(run(all), "--out");
    }
    expect_refused(run({"run", "avalanche", "--record", ""}), "--record");
}

TEST_F(Usage, TooLittleMemoryIsOneLine) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
    GTEST_SKIP() << "a sanitizer needs terabytes of addresses";
#endif
    // Too little to load the program at all is the system's to report; from there on in steps, to where it is enough.
    bool begun = false, enough = false;
    for (int megabytes = 16; !enough && megabytes <= 4096; megabytes += 4) {
        const auto result =
            run_limited("-v " + std::to_string(1024 * megabytes),
                        {"run", "avalanche", "--bodies", "64", "--steps", "2", "--json"}, folder_.path());
        enough = result.status == 0;
        if (enough) continue;
        // A library's own static objects can fail before main(), too.
        if (!begun
            && (result.err.find("error while loading shared libraries") != std::string::npos
                || result.err.starts_with("terminate called after throwing an instance of 'std::bad_alloc'")))
            continue;
        begun = true;
        EXPECT_EQ(result.status, 1) << megabytes << " MB: " << result.err;
        EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << megabytes << " MB: " << result.err;
        EXPECT_TRUE(result.err.starts_with("raycontact: ")) << megabytes << " MB: " << result.err;
    }
    EXPECT_TRUE(begun);
    EXPECT_TRUE(enough);
}

TEST_F(Usage, DeviceLists) {
    for (const char* list : {"auto", "all", "cpu", "cpu/0"}) {
        EXPECT_EQ(run({"collide", "cube.obj", "cube.obj", "--devices", list}).status, 0) << list;
    }
    for (const char* list : {"", "cpu,", "cpu/", "cpu/x", "cpu/-1", "cpu:0", "opencl", "opencl:", "cuda:0/1", "gpu",
                             "cpu/0/1", "cpu/99999999999"}) {
        expect_refused(run({"collide", "cube.obj", "cube.obj", "--devices", list}), "--devices");
    }
    expect_refused(run({"collide", "cube.obj", "cube.obj", "--devices", "cpu,cpu"}), "twice");
    expect_refused(run({"collide", "cube.obj", "cube.obj", "--devices", "opencl:0,opencl:00"}), "twice");
    expect_refused(run({"collide", "cube.obj", "cube.obj", "--devices", "cpu/0,cpu"}), "beside its whole");
    expect_refused(run({"collide", "cube.obj", "cube.obj", "--devices", "cpu/9999"}), "cpu/9999");
    expect_refused(run({"collide", "cube.obj", "cube.obj", "--devices", "opencl:77"}), "opencl:77");
}

TEST_F(Usage, AFailedRunIsStatusOne) {
    const auto result = run_program({"devices"}, folder_.path(), "/dev/full");
    EXPECT_EQ(result.status, 1);
    EXPECT_NE(result.err.find("standard output"), std::string::npos) << result.err;
}

TEST_F(Usage, DevicesHaveTheirKeys) {
    const auto result = run({"devices", "--json"});
    ASSERT_EQ(result.status, 0) << result.err;
    const auto devices = nlohmann::json::parse(result.out);
    ASSERT_TRUE(devices.is_array());
    ASSERT_GE(devices.size(), 1u);
    const std::set<std::string> keys{"id",    "kind",  "type",         "bus",    "name",   "driver",
                                     "cores", "exact", "memory_bytes", "usable", "why_not"};
    bool cpu = false;
    for (const auto& device : devices) {
        EXPECT_EQ(keys_of(device), keys);
        EXPECT_EQ(device["usable"].get<bool>(), device["why_not"].get<std::string>().empty());
        if (device["id"] == "cpu") {
            cpu = true;
            EXPECT_EQ(device["kind"], "cpu");
            EXPECT_EQ(device["type"], "cpu");
            EXPECT_TRUE(device["usable"].get<bool>());
            EXPECT_TRUE(device["exact"].get<bool>());
            EXPECT_GE(device["cores"].get<int>(), 1);
            EXPECT_GT(device["memory_bytes"].get<double>(), 1e6);
        }
    }
    EXPECT_TRUE(cpu);
    EXPECT_NE(run({"devices"}).out.find("cpu"), std::string::npos);
    EXPECT_NE(run({"devices"}).out.find("--devices auto "), std::string::npos);
}

TEST_F(Usage, MeshHasItsKeys) {
    const auto result = run({"mesh", "cube.obj", "--json"});
    ASSERT_EQ(result.status, 0) << result.err;
    const auto report = nlohmann::json::parse(result.out);
    for (const char* key : {"vertices", "triangles", "closed", "manifold", "oriented", "self_intersecting",
                            "components", "volume", "area", "box", "repairs"}) {
        EXPECT_TRUE(report.contains(key)) << key;
    }
    EXPECT_EQ(report["vertices"], 8);
    EXPECT_EQ(report["triangles"], 12);
    EXPECT_TRUE(report["closed"].get<bool>());
    EXPECT_DOUBLE_EQ(report["volume"].get<double>(), 1);
    EXPECT_DOUBLE_EQ(report["area"].get<double>(), 6);
    EXPECT_TRUE(report["repairs"].empty());
    const auto text = run({"mesh", "cube.obj"});
    EXPECT_EQ(text.status, 0);
    EXPECT_NE(text.out.find("12"), std::string::npos);
}

TEST_F(Usage, MeshRepairsUnlessToldNotTo) {
    std::string flipped = cube_obj();
    flipped.replace(flipped.find("f 1 4 3 2"), 9, "f 1 2 3 4");
    folder_.write("flipped.obj", flipped);
    const auto repaired = nlohmann::json::parse(run({"mesh", "flipped.obj", "--json"}).out);
    EXPECT_TRUE(repaired["oriented"].get<bool>());
    EXPECT_FALSE(repaired["repairs"].empty());
    const auto as_is = nlohmann::json::parse(run({"mesh", "flipped.obj", "--as-is", "--json"}).out);
    EXPECT_FALSE(as_is["oriented"].get<bool>());
    EXPECT_TRUE(as_is["repairs"].empty());
}

TEST_F(Usage, BadMeshFilesNameTheFile) {
    folder_.write("short.obj", "v 0 0 0\nf 1 2 3\n");
    folder_.write("empty.obj", "");
    folder_.write("what.xyz", "1 2 3\n");
    std::filesystem::create_directory(folder_.path() / "folder.obj");
    for (const char* file : {"short.obj", "empty.obj", "what.xyz", "folder.obj", "missing.obj"}) {
        expect_refused(run({"mesh", file}), file);
        expect_refused(run({"collide", "cube.obj", file, "--json"}), file);
        expect_refused(run({"collide", file, "cube.obj"}), file);
    }
    expect_refused(run({"mesh", "two\nlines.obj"}), "lines.obj");
}

} // namespace
