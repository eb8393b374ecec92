// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <span>
#include <string>
#include <string_view>

namespace raycontact::fuzz {

using Bytes = std::span<const std::uint8_t>;

/// Says what is wrong and ends the program, as a sanitizer does: a fuzzer then keeps the input.
[[noreturn]] void fail(std::string_view what);

/// Whether `read` took its input. It may refuse it by an InputError of one line; any other exception is a finding.
bool taken(const std::function<void()>& read);
/// How often taken() was true, in this process.
std::uint64_t times_taken();

/// The bytes as a text, for files.
inline std::string_view text_of(Bytes bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// Takes numbers off the front of an input; zeros once it has ended.
class Source {
public:
    explicit Source(Bytes bytes) : left_(bytes) {}
    bool empty() const { return left_.empty(); }
    template <class T>
    T get() {
        T value{};
        const std::size_t size = std::min(sizeof(T), left_.size());
        std::memcpy(&value, left_.data(), size);
        left_ = left_.subspan(size);
        return value;
    }
    std::uint32_t below(std::uint32_t count) { return get<std::uint8_t>() % count; }
    Bytes take(std::size_t size) {
        const Bytes taken = left_.first(std::min(size, left_.size()));
        left_ = left_.subspan(taken.size());
        return taken;
    }

private:
    Bytes left_;
};

} // namespace raycontact::fuzz

/// What libFuzzer calls, and replay_main.cpp: once an input.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);
