// SPDX-License-Identifier: Apache-2.0
// The kernels' text as CUDA C++: it compiles for old and new GPUs, and its PTX rounds every operation as the CPU does.
#include "device/ptx.h"

#include "device/cuda/image.h"
#include "device/cuda/nvrtc.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <map>
#include <sstream>

using namespace raycontact;
using cuda::Nvrtc;
using namespace raycontact::device_test;

namespace {

const std::vector<std::string> exact_options = cuda::exact_source().options;

std::string text() {
    return cuda::exact_source().text;
}

const Nvrtc& nvrtc() {
    static const Nvrtc loaded(1000); // any
    return loaded;
}

std::string compile(const std::string& text, const std::vector<std::string>& options) {
    const Nvrtc::Compiled compiled = nvrtc().compile(text, options);
    EXPECT_EQ(compiled.log, "") << "a warning";
    return compiled.image;
}

std::vector<std::string> with(std::vector<std::string> options, const std::vector<std::string>& more) {
    options.insert(options.end(), more.begin(), more.end());
    return options;
}

// With every intended fused multiply-add (product_error) turned into a call: whatever fma is left was not intended.
PtxReport without_intended_fma(const std::vector<std::string>& options, std::string* ptx = nullptr) {
    const std::string marked = "extern \"C\" __device__ float marked_fma(float, float, float);\n"
                               "#define __fmaf_rn marked_fma\n"
                               + text();
    const std::string made = compile(marked, with(options, {"--relocatable-device-code=true"}));
    if (ptx) *ptx = made;
    return read_ptx(made);
}

std::string joined(const std::vector<std::string>& lines) {
    std::string text;
    for (const std::string& line : lines) text += line + "\n";
    return text;
}

std::vector<std::string> target(const std::string& architecture) {
    return {"--gpu-architecture=compute_" + architecture};
}

class Architecture : public testing::TestWithParam<const char*> {};

TEST_P(Architecture, has_every_kernel_and_rounds_every_operation) {
    const std::string ptx = compile(text(), with(exact_options, target(GetParam())));
    EXPECT_NE(ptx.find(std::string(".target sm_") + GetParam()), std::string::npos);
    const PtxReport report = read_ptx(ptx);
    std::vector<std::string> expected = {
#define RAYCONTACT_KERNEL(name) #name,
#define RAYCONTACT_CPU_KERNEL(name)
#include "kernels/kernels.def"
#undef RAYCONTACT_KERNEL
#undef RAYCONTACT_CPU_KERNEL
        "scan_at_once", "scan_blocks", "scan_sums", "scan_firsts", "probe_float", "probe_double"};
    std::vector<std::string> entries = report.entries;
    std::sort(expected.begin(), expected.end());
    std::sort(entries.begin(), entries.end());
    EXPECT_EQ(entries, expected);
    EXPECT_EQ(joined(report.inexact), "");
    EXPECT_GT(report.rounded, 500u);
    EXPECT_GT(report.rounded_double, 20u); // place_pairs: no fused one among them
    EXPECT_GT(report.fused, 0u);           // product_error
}

TEST_P(Architecture, fuses_only_in_product_error) {
    std::string ptx;
    const PtxReport report = without_intended_fma(with(exact_options, target(GetParam())), &ptx);
    EXPECT_NE(ptx.find("call"), std::string::npos);
    EXPECT_EQ(report.fused, 0u);
    EXPECT_EQ(joined(report.inexact), "");
}

// The number in front of `what` in a line, 0 where there is none.
std::size_t number_before(const std::string& line, const std::string& what) {
    const auto end = line.find(what);
    if (end == std::string::npos) return 0;
    return std::stoul(line.substr(line.find_last_not_of("0123456789", end - 1) + 1));
}

// Bytes of local memory that each kernel takes, the functions it calls included, as the assembler of a cubin says.
std::map<std::string, std::size_t> local_bytes(const std::string& architecture) {
    const std::string log =
        nvrtc()
            .compile(text(), with(exact_options, {"--gpu-architecture=sm_" + architecture, "--ptxas-options=-v"}))
            .log;
    std::map<std::string, std::size_t> bytes;
    std::string kernel;
    const std::string entry = "Compiling entry function '";
    std::istringstream lines(log);
    for (std::string line; std::getline(lines, line);) {
        if (const auto at = line.find(entry); at != std::string::npos) {
            const auto name = at + entry.size();
            bytes[kernel = line.substr(name, line.find('\'', name) - name)] = 0;
        }
        for (const char* what : {" bytes stack frame", " bytes cumulative stack size"})
            bytes[kernel] = std::max(bytes[kernel], number_before(line, what));
    }
    return bytes;
}

// A GPU keeps in slow memory what has an address.
TEST_P(Architecture, kernels_take_little_local_memory) {
    const auto bytes = local_bytes(GetParam());
#define RAYCONTACT_KERNEL(name)                                                                                        \
    EXPECT_EQ(bytes.count(#name), 1u) << #name;                                                                        \
    EXPECT_LE(bytes.at(#name), 192u) << #name;
#define RAYCONTACT_CPU_KERNEL(name)
#include "kernels/kernels.def"
#undef RAYCONTACT_KERNEL
#undef RAYCONTACT_CPU_KERNEL
    EXPECT_GT(bytes.at("follow_rays_basic"), 0u); // the log was understood
}

// What a driver is given; no GPU is needed to make it.
TEST(nvrtc, images_suit_the_driver) {
    setenv("RAYCONTACT_CACHE", "/dev/null/none", 1); // compiled here and now
    const std::string own = cuda::image_for(nvrtc(), cuda::exact_source(), 90, nvrtc().major());
    EXPECT_TRUE(own.starts_with("\177ELF"));
    const std::string older = cuda::image_for(nvrtc(), cuda::exact_source(), 90, nvrtc().major() - 1);
    EXPECT_NE(older.find("\n.version " + std::to_string(nvrtc().major() - 5) + ".0\n"), std::string::npos);
    EXPECT_NE(older.find("\n.target sm_" + std::to_string(nvrtc().architectures().front())), std::string::npos);
    const std::string newer = cuda::image_for(nvrtc(), cuda::exact_source(), 9990, nvrtc().major());
    EXPECT_NE(newer.find("\n.target sm_" + std::to_string(nvrtc().architectures().back())), std::string::npos);
    for (const std::string& ptx : {older, newer}) {
        EXPECT_TRUE(read_ptx(ptx).inexact.empty());
        EXPECT_GT(read_ptx(ptx).rounded, 500u);
    }
}

// What the checks are worth: other rules for floats are noticed.
TEST(nvrtc, contraction_is_noticed) {
    const std::vector<std::string> contracted = {"--fmad=true", "--prec-div=true", "--prec-sqrt=true", "--ftz=false",
                                                 "--std=c++17"};
    const PtxReport report = without_intended_fma(with(contracted, target("90")));
    EXPECT_GT(report.fused, 0u);
    EXPECT_FALSE(report.inexact.empty()); // what ptxas would be free to contract
}

TEST(nvrtc, fast_division_and_flushing_are_noticed) {
    for (const char* wrong : {"--prec-div=false", "--ftz=true"}) {
        std::vector<std::string> options = target("90");
        for (const std::string& option : exact_options)
            if (!option.starts_with(std::string(wrong).substr(0, 6))) options.push_back(option);
        options.emplace_back(wrong);
        EXPECT_FALSE(without_intended_fma(options).inexact.empty()) << wrong;
    }
}

// Turing, the oldest that today's compiler knows; Hopper; Blackwell.
INSTANTIATE_TEST_SUITE_P(nvrtc, Architecture, testing::Values("75", "90", "120"));

TEST(ptx, sees_what_does_not_round_as_ours) {
    const auto report = [](const char* line) { return read_ptx(line); };
    for (const char* wrong :
         {"\tadd.f32 \t%f1, %f2, %f3;", "\tmul.ftz.f32 %f1, %f2, %f3;", "@%p1 mad.rn.f32 %f1, %f2, %f3, %f4;",
          "\tdiv.full.f32 %f1, %f2, %f3;", "\tsqrt.approx.f32 %f1, %f2;", "\tfma.rn.f64 %fd1, %fd2, %fd3, %fd4;",
          "\tdiv.rn.f64 %fd1, %fd2, %fd3;", "\tadd.rz.f32 %f1, %f2, %f3;", "\tsin.approx.f32 %f1, %f2;",
          "\tsetp.lt.ftz.f32 %p1, %f1, %f2;"})
        EXPECT_EQ(report(wrong).inexact.size(), 1u) << wrong;
    for (const char* right : {"\tadd.rn.f32 %f1, %f2, %f3;", "@!%p2 sub.rn.f32 %f1, %f2, %f3;"}) {
        EXPECT_EQ(report(right).inexact.size(), 0u) << right;
        EXPECT_EQ(report(right).rounded, 1u) << right;
    }
    EXPECT_EQ(report("\tfma.rn.f32 %f1, %f2, %f3, %f4;").fused, 1u);
    EXPECT_EQ(report(".visible .entry cast(").entries, std::vector<std::string>{"cast"});
}

} // namespace
