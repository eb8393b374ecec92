// SPDX-License-Identifier: Apache-2.0
#include "device/opencl/probe.h"

#include "device/opencl/arguments.h"
#include "executor/float_environment.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <random>
#include <vector>

namespace raycontact::kernels::probe {
#include "device/cpu/instruction_set.h"
#include "device/gpu/probe.h"
#include "device/gpu/probe_double.h"
} // namespace raycontact::kernels::probe

namespace raycontact::opencl {

namespace {

constexpr kernels::uint count = 65536;
constexpr const char* operations[] = {"products", "sums",      "products and sums", "quotients",
                                      "roots",    "denormals", "product residues",  "conversions"};
constexpr std::size_t float_results = std::size(operations), double_results = 3;

// Random signs and mantissas. In three of four sets the operands are of medium size and c is about as large as a * b,
// so that contraction shows. In the fourth, products overflow or underflow.
std::vector<float> float_operands() {
    std::mt19937_64 random(65536);
    std::vector<float> operands;
    const auto number = [&](std::uint64_t exponent) {
        return std::bit_cast<float>(static_cast<kernels::uint>((random() & 0x807fffffU) | exponent << 23));
    };
    for (kernels::uint i = 0; i < count; ++i) {
        const std::uint64_t span = i % 4 == 3 ? 240 : 60;
        const std::uint64_t a = 127 - span / 2 + random() % span, b = 127 - span / 2 + random() % span;
        const std::uint64_t c = std::clamp<std::uint64_t>(a + b + random() % 5, 130, 383) - 129;
        for (const std::uint64_t exponent : {a, b, c, std::uint64_t{0}}) operands.push_back(number(exponent));
    }
    return operands;
}

std::vector<double> double_operands() {
    std::mt19937_64 random(65536);
    std::vector<double> operands;
    const auto number = [&](std::uint64_t exponent) {
        return std::bit_cast<double>((random() & 0x800fffffffffffffU) | exponent << 52);
    };
    for (kernels::uint i = 0; i < count; ++i) {
        const std::uint64_t a = 1023 - 30 + random() % 60, b = 1023 - 30 + random() % 60;
        for (const std::uint64_t exponent : {a, b, a + b - 1025 + random() % 5}) operands.push_back(number(exponent));
    }
    return operands;
}

// One launch: operands go up, results come down.
class Run {
public:
    Run(Launcher& launcher, cl_context context) : launcher_(launcher), context_(context) {}

    template <typename T>
    cl_mem send(const std::vector<T>& values) {
        cl_int status = CL_SUCCESS;
        Memory& memory = memories_.emplace_back(
            clCreateBuffer(context_, CL_MEM_READ_WRITE, values.size() * sizeof(T), nullptr, &status));
        check(status, "clCreateBuffer");
        check(clEnqueueWriteBuffer(launcher_.queue(), memory.get(), CL_TRUE, 0, values.size() * sizeof(T),
                                   values.data(), 0, nullptr, nullptr),
              "clEnqueueWriteBuffer");
        return memory.get();
    }
    template <typename T>
    std::vector<T> fetch(cl_mem memory, std::size_t size) {
        std::vector<T> values(size);
        check(clEnqueueReadBuffer(launcher_.queue(), memory, CL_TRUE, 0, size * sizeof(T), values.data(), 0, nullptr,
                                  nullptr),
              "clEnqueueReadBuffer");
        return values;
    }

private:
    Launcher& launcher_;
    cl_context context_;
    std::vector<Memory> memories_;
};

template <typename T>
bool same_bits(const std::vector<T>& a, const std::vector<T>& b) {
    return std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0;
}

} // namespace

Probed probe(Launcher& launcher, const Program& program, const Source& source, cl_context context) {
    const FloatEnvironment environment;
    Probed probed;
    Run run(launcher, context);
    {
        const std::vector<float> operands = float_operands();
        std::vector<float> expected(float_results * count);
        kernels::probe::probe_float({0, count}, count, operands.data(), expected.data());
        const Kernel kernel = program.entry("probe_float");
        const cl_mem results = run.send(std::vector<float>(expected.size()));
        set_arguments(kernel.get(), count, run.send(operands), results);
        launcher.over_items(kernel.get(), "probe_float", count);
        const std::vector<float> found = run.fetch<float>(results, expected.size());
        for (std::size_t k = 0; k < float_results && probed.differs.empty(); ++k) {
            kernels::uint differ = 0;
            for (std::size_t i = k * count; i < (k + 1) * count; ++i)
                differ += std::bit_cast<kernels::uint>(found[i]) != std::bit_cast<kernels::uint>(expected[i]);
            if (differ > 0)
                probed.differs = std::to_string(differ) + " of " + std::to_string(count) + " " + operations[k];
        }
    }
    if (source.has_double) {
        const std::vector<double> operands = double_operands();
        std::vector<double> expected(double_results * count);
        std::vector<float> expected_rounded(count);
        kernels::probe::probe_double({0, count}, count, operands.data(), expected_rounded.data(), expected.data());
        const Kernel kernel = program.entry("probe_double");
        const cl_mem rounded = run.send(std::vector<float>(count));
        const cl_mem results = run.send(std::vector<double>(expected.size()));
        set_arguments(kernel.get(), count, run.send(operands), rounded, results);
        launcher.over_items(kernel.get(), "probe_double", count);
        probed.exact_double = same_bits(run.fetch<float>(rounded, count), expected_rounded)
                              && same_bits(run.fetch<double>(results, expected.size()), expected);
    }
    launcher.add_up();
    return probed;
}

} // namespace raycontact::opencl
