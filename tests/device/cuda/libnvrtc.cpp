// SPDX-License-Identifier: Apache-2.0
// A compiler that compiles nothing: its cubins and PTX texts are the kernels' own text, with what the test driver
// checks on their first lines.
#include "device/cuda/fakes.h"

#include <algorithm>
#include <cstring>
#include <memory>

using namespace raycontact::cuda_test;

namespace {

struct Program {
    std::string text, image;
};

FakeNvrtc& fake() {
    static FakeNvrtc state;
    state.reset = [] {
        state = {};
        fake(); // sets this again
    };
    return state;
}

constexpr int error = 6;
constexpr int known[] = {50, 75, 80, 90, 120};

} // namespace

#define ENTER                                                                                                          \
    if (fake().enter(__func__)) return error

extern "C" {

FakeNvrtc* raycontact_fake_nvrtc() {
    return &fake();
}

const char* nvrtcGetErrorString(int status) {
    return status == 0 ? "NVRTC_SUCCESS" : "NVRTC_ERROR_FAKE";
}
int nvrtcVersion(int* major, int* minor) {
    ENTER;
    *major = fake().major;
    *minor = 0;
    return 0;
}
int nvrtcGetNumSupportedArchs(int* count) {
    ENTER;
    *count = static_cast<int>(std::size(known));
    return 0;
}
int nvrtcGetSupportedArchs(int* architectures) {
    ENTER;
    std::copy(std::begin(known), std::end(known), architectures);
    return 0;
}
int nvrtcCreateProgram(Program** program, const char* text, const char*, int, const char* const*, const char* const*) {
    ENTER;
    *program = new Program{text, ""};
    return 0;
}
int nvrtcDestroyProgram(Program** program) {
    delete *program;
    *program = nullptr;
    ENTER;
    return 0;
}
int nvrtcCompileProgram(Program* program, int count, const char* const* options) {
    ENTER;
    fake().options.assign(options, options + count);
    const std::string major = std::to_string(fake().major);
    for (const std::string& option : fake().options) {
        const std::string binary = "--gpu-architecture=sm_", virtual_ = "--gpu-architecture=compute_";
        if (option.starts_with(binary))
            program->image = "cubin " + option.substr(binary.size()) + " " + major + "\n" + program->text;
        if (option.starts_with(virtual_))
            program->image = "// PTX\n.version " + std::to_string(fake().major - 4) + ".3\n.target sm_"
                             + option.substr(virtual_.size()) + "\n" + program->text;
    }
    return program->text.find("nonsense") == std::string::npos ? 0 : error;
}
int nvrtcGetProgramLogSize(Program* program, std::size_t* size) {
    ENTER;
    *size = program->text.find("nonsense") == std::string::npos ? 1 : std::strlen("nonsense?") + 1;
    return 0;
}
int nvrtcGetProgramLog(Program* program, char* log) {
    ENTER;
    std::strcpy(log, program->text.find("nonsense") == std::string::npos ? "" : "nonsense?");
    return 0;
}
int nvrtcGetPTXSize(Program* program, std::size_t* size) {
    ENTER;
    *size = program->image.size() + 1;
    return 0;
}
int nvrtcGetPTX(Program* program, char* ptx) {
    ENTER;
    std::strcpy(ptx, program->image.c_str());
    return 0;
}
int nvrtcGetCUBINSize(Program* program, std::size_t* size) {
    ENTER;
    *size = program->image.size();
    return 0;
}
int nvrtcGetCUBIN(Program* program, char* cubin) {
    ENTER;
    std::copy(program->image.begin(), program->image.end(), cubin);
    return 0;
}

} // extern "C"
