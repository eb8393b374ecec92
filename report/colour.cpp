// SPDX-License-Identifier: Apache-2.0
#include <report/colour.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace raycontact::report {
namespace {

float decode(std::uint32_t byte) {
    const float v = static_cast<float>(byte & 255u) / 255;
    return v <= 0.04045f ? v / 12.92f : std::pow((v + 0.055f) / 1.055f, 2.4f);
}

std::uint8_t encode(float v) {
    const float s = v <= 0.0031308f ? 12.92f * v : 1.055f * std::pow(v, 1 / 2.4f) - 0.055f;
    return static_cast<std::uint8_t>(std::clamp(255 * s + 0.5f, 0.0f, 255.0f));
}

/// Narkowicz's fit of the ACES film curve.
float film(float x) {
    return std::clamp(x * (2.51f * x + 0.03f) / (x * (2.43f * x + 0.59f) + 0.14f), 0.0f, 1.0f);
}

} // namespace

Float3 linear(std::uint32_t srgb) {
    return {decode(srgb >> 16), decode(srgb >> 8), decode(srgb)};
}

Float3 body_colour(std::size_t body) {
    static const std::array<Float3, 12> palette{linear(0xe8684a), linear(0xf2a541), linear(0xf6d365), linear(0x8cb369),
                                                linear(0x3d9b8f), linear(0x62b6cb), linear(0x3e78b2), linear(0x5b5f97),
                                                linear(0xa06cb4), linear(0xe27396), linear(0xf4e9d8), linear(0xc8553d)};
    // A multiplicative hash: neighbours in the grid get unlike colours, and a little lighter or darker.
    const std::uint32_t mixed = (static_cast<std::uint32_t>(body) + 1) * 2654435769u;
    const float shade = 0.86f + 0.26f * static_cast<float>(mixed >> 8 & 0xffu) / 255;
    return shade * palette[(mixed >> 16) % palette.size()];
}

Float3 resting_colour() {
    return {0.5f, 0.5f, 0.5f};
}

Float3 sky(Float3 direction) {
    const Float3 horizon{0.93f, 0.95f, 1.0f}, zenith{0.55f, 0.72f, 1.05f}, below{0.62f, 0.58f, 0.54f};
    if (direction.z < 0) return below;
    return mix(horizon, zenith, std::sqrt(direction.z));
}

void develop(Float3 light, std::uint8_t* rgb) {
    constexpr float exposure = 0.74f;
    rgb[0] = encode(film(exposure * light.x));
    rgb[1] = encode(film(exposure * light.y));
    rgb[2] = encode(film(exposure * light.z));
}

} // namespace raycontact::report
