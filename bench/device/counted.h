// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bench/device/counted_kernels.h"

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <type_traits>

// The kernel dialect in numbers that count: what replaces `float`, `uint` in structs, and READS().
namespace raycontact::bench::counted {

using uint = std::uint32_t;
using ulong = std::uint64_t;
struct Range {
    uint begin, end;
};

struct Model {
    RayCost cost;
    const char* stack = nullptr; ///< the kernel's frames lie below it

    void operation(std::uint64_t number = 1) { cost.operations += number; }
    void load(const void* from, std::size_t bytes) {
        const auto at = reinterpret_cast<std::uintptr_t>(from), top = reinterpret_cast<std::uintptr_t>(stack);
        constexpr std::uintptr_t deepest = std::uintptr_t{1} << 20;
        if (at < top && top - at < deepest) return; // a variable of the kernel: a register
        cost.loaded += bytes;
        for (std::uintptr_t s = at / sector_bytes; s <= (at + bytes - 1) / sector_bytes; ++s) cost.sectors.push_back(s);
    }
    void lanes(std::string_view function) {
        cost.nodes += function == "hit_children";
        cost.blocks += function == "hit_block";
    }
};
inline Model model;

/// A float32 number. Counts operations, and loads where it lies in a buffer.
class Float {
public:
    Float() = default;
    Float(float value) : value_(value) {} // NOLINT(google-explicit-constructor): stands for a built-in type
    explicit Float(double value) : value_(static_cast<float>(value)) {}
    explicit Float(int value) : value_(static_cast<float>(value)) {}
    Float(const Float& other) : value_(other.read()) {}
    Float& operator=(const Float& other) {
        value_ = other.read();
        return *this;
    }
    explicit operator int() const { return static_cast<int>(read()); }

    float read() const {
        model.load(&value_, sizeof value_);
        return value_;
    }

    friend Float operator-(const Float& a) { return -a.read(); }
    friend Float operator+(const Float& a, const Float& b) { return counted(a.read() + b.read()); }
    friend Float operator-(const Float& a, const Float& b) { return counted(a.read() - b.read()); }
    friend Float operator*(const Float& a, const Float& b) { return counted(a.read() * b.read()); }
    friend Float operator/(const Float& a, const Float& b) { return counted(a.read() / b.read()); }
    Float& operator+=(const Float& other) { return *this = *this + other; }
    friend bool operator<(const Float& a, const Float& b) { return counted(a.read() < b.read()); }
    friend bool operator>(const Float& a, const Float& b) { return counted(a.read() > b.read()); }
    friend bool operator<=(const Float& a, const Float& b) { return counted(a.read() <= b.read()); }
    friend bool operator>=(const Float& a, const Float& b) { return counted(a.read() >= b.read()); }
    friend bool operator==(const Float& a, const Float& b) { return counted(a.read() == b.read()); }

private:
    template <class Result>
    static Result counted(Result result) {
        model.operation();
        return result;
    }
    float value_;
};
static_assert(sizeof(Float) == 4);

/// A whole number in a struct. An aggregate, so that structs are still made from lists of numbers.
struct Word {
    uint value;
    operator uint() const { // NOLINT(google-explicit-constructor): stands for a built-in type
        model.load(&value, sizeof value);
        return value;
    }
    Word& operator=(uint number) {
        value = number;
        return *this;
    }
    Word& operator+=(uint number) { return *this = value + number; }
};
static_assert(sizeof(Word) == 4);

/// A pointer into a buffer. Elements that count their own reading are left to it.
template <class T>
class Reads {
public:
    Reads() = default;
    Reads(const T* first) : first_(first) {} // NOLINT(google-explicit-constructor): stands for a pointer
    const T& operator[](std::size_t i) const {
        if constexpr (std::is_arithmetic_v<T>) model.load(first_ + i, sizeof(T));
        return first_[i];
    }
    const T* operator->() const { return first_; }
    const T& operator*() const { return *first_; }
    explicit operator bool() const { return first_ != nullptr; }
    Reads operator+(uint i) const { return first_ + i; }

private:
    const T* first_;
};

} // namespace raycontact::bench::counted
