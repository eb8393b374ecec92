// SPDX-License-Identifier: Apache-2.0
#include "device/gpu/run_probe.h"

#include "device/array.h"
#include "executor/float_environment.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <random>
#include <vector>

namespace raycontact::kernels::probe {
#include "device/cpu/instruction_set.h"
#include "device/gpu/probe.h"
#include "device/gpu/probe_double.h"
} // namespace raycontact::kernels::probe

namespace raycontact::gpu {

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

/// An array on the device, and its copy here.
template <typename T>
struct Sent {
    Sent(Device& device, std::vector<T> given) : values(std::move(given)) { array.write(device, values); }
    Argument argument() const { return {array.buffer()}; }
    const std::vector<T>& fetch(Device& device) {
        array.read(device, values);
        return values;
    }
    std::vector<T> values;
    Array<T> array;
};

template <typename T>
bool same_bits(const std::vector<T>& a, const std::vector<T>& b) {
    return std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0;
}

} // namespace

void Probed::judge(DeviceInfo& info) const {
    if (!info.exact || differs.empty()) return;
    info.exact = info.usable = false;
    info.why_not = differs + " that it computed are not the host's; its contacts would differ";
}

Probed run_probe(Device& device, bool has_double, const LaunchProbe& launch) {
    const FloatEnvironment environment;
    Probed probed;
    {
        Sent<float> operands(device, float_operands()), results(device, std::vector<float>(float_results * count));
        std::vector<float> expected(results.values.size());
        kernels::probe::probe_float({0, count}, count, operands.values.data(), expected.data());
        launch("probe_float", count, std::array{operands.argument(), results.argument()});
        const std::vector<float>& found = results.fetch(device);
        for (std::size_t k = 0; k < float_results && probed.differs.empty(); ++k) {
            kernels::uint differ = 0;
            for (std::size_t i = k * count; i < (k + 1) * count; ++i)
                differ += std::bit_cast<kernels::uint>(found[i]) != std::bit_cast<kernels::uint>(expected[i]);
            if (differ > 0)
                probed.differs = std::to_string(differ) + " of " + std::to_string(count) + " " + operations[k];
        }
    }
    if (has_double) {
        Sent<double> operands(device, double_operands()), results(device, std::vector<double>(double_results * count));
        Sent<float> rounded(device, std::vector<float>(count));
        std::vector<double> expected(results.values.size());
        std::vector<float> expected_rounded(count);
        kernels::probe::probe_double({0, count}, count, operands.values.data(), expected_rounded.data(),
                                     expected.data());
        launch("probe_double", count, std::array{operands.argument(), rounded.argument(), results.argument()});
        probed.exact_double =
            same_bits(rounded.fetch(device), expected_rounded) && same_bits(results.fetch(device), expected);
    }
    return probed;
}

} // namespace raycontact::gpu
