// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

namespace raycontact::report {

/// A point, direction or linear colour of a picture: float32 is plenty, the picture's origin lies among the bodies.
struct Float3 {
    float x = 0, y = 0, z = 0;
};

inline Float3 operator+(Float3 a, Float3 b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
}
inline Float3 operator-(Float3 a, Float3 b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
inline Float3 operator*(Float3 a, Float3 b) {
    return {a.x * b.x, a.y * b.y, a.z * b.z};
}
inline Float3 operator*(float s, Float3 a) {
    return {s * a.x, s * a.y, s * a.z};
}
inline Float3& operator+=(Float3& a, Float3 b) {
    return a = a + b;
}
inline float dot(Float3 a, Float3 b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
inline Float3 cross(Float3 a, Float3 b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline float length(Float3 a) {
    return std::sqrt(dot(a, a));
}
inline Float3 unit(Float3 a) {
    const float l = length(a);
    return l > 0 ? (1 / l) * a : a;
}
inline Float3 mix(Float3 a, Float3 b, float t) {
    return (1 - t) * a + t * b;
}

} // namespace raycontact::report
