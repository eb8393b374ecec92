// SPDX-License-Identifier: Apache-2.0
#include "mesh/text_scanner.h"

#include <charconv>
#include <cmath>
#include <cstdlib>
#include <system_error>

namespace raycontact {
namespace {

bool is_blank(char c) {
    return c == ' ' || c == '\t' || c == '\v' || c == '\f';
}
bool is_line_end(char c) {
    return c == '\n' || c == '\r';
}

} // namespace

TextScanner::TextScanner(const InputFile& file, std::size_t start, std::size_t line)
    : file_(file), at_(file.bytes.data() + start), end_(file.bytes.data() + file.bytes.size()), line_(line) {
    if (start == 0 && file.bytes.starts_with("\xef\xbb\xbf")) at_ += 3; // a byte order mark
}

std::string_view TextScanner::word_on_line() {
    while (at_ != end_) {
        if (is_blank(*at_)) {
            ++at_;
        } else if (joiner != 0 && *at_ == joiner && at_ + 1 != end_ && is_line_end(at_[1])) {
            ++at_;
            next_line();
        } else if (comment != 0 && *at_ == comment) {
            while (at_ != end_ && !is_line_end(*at_)) ++at_;
        } else {
            break;
        }
    }
    const char* const first = at_;
    while (at_ != end_ && !is_blank(*at_) && !is_line_end(*at_) && (comment == 0 || *at_ != comment)) {
        if (joiner != 0 && *at_ == joiner && at_ + 1 != end_ && is_line_end(at_[1])) break;
        ++at_;
    }
    return {first, static_cast<std::size_t>(at_ - first)};
}

bool TextScanner::next_line() {
    while (at_ != end_ && !is_line_end(*at_)) ++at_;
    if (at_ == end_) return false;
    if (*at_ == '\r' && at_ + 1 != end_ && at_[1] == '\n') ++at_;
    ++at_;
    ++line_;
    return at_ != end_;
}

std::string_view TextScanner::word() {
    std::string_view found = word_on_line();
    while (found.empty() && next_line()) found = word_on_line();
    return found;
}

bool TextScanner::at_end() {
    const char* const at = at_;
    const std::size_t line = line_;
    const bool end = word().empty();
    at_ = at;
    line_ = line;
    return end;
}

double TextScanner::number(std::string_view word, const char* what) const {
    if (word.empty()) fail(std::string(what) + " is missing; the file may be truncated");
    std::string_view digits = word;
    if (digits.size() > 1 && digits[0] == '+' && digits[1] != '-' && digits[1] != '+') digits.remove_prefix(1);
    double value = 0;
    const auto [last, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (error == std::errc::invalid_argument || last != digits.data() + digits.size()) {
        fail(std::string(what) + " " + in_quotes(word) + " is not a number");
    }
    // Out of range is either too large, refused below, or so small that it rounds to (nearly) zero.
    if (error == std::errc::result_out_of_range) value = std::strtod(std::string(digits).c_str(), nullptr);
    if (!std::isfinite(value)) fail(std::string(what) + " " + in_quotes(word) + " is not finite");
    return value;
}

std::int64_t TextScanner::integer(std::string_view word, const char* what) const {
    if (word.empty()) fail(std::string(what) + " is missing; the file may be truncated");
    std::string_view digits = word;
    if (digits.size() > 1 && digits[0] == '+' && digits[1] != '-' && digits[1] != '+') digits.remove_prefix(1);
    std::int64_t value = 0;
    const auto [last, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (error == std::errc::result_out_of_range) fail(std::string(what) + " " + in_quotes(word) + " is out of range");
    if (error != std::errc() || last != digits.data() + digits.size()) {
        fail(std::string(what) + " " + in_quotes(word) + " is not a whole number");
    }
    return value;
}

Vec3 TextScanner::point_on_line(const char* what) {
    Vec3 point;
    point.x = number(word_on_line(), what);
    point.y = number(word_on_line(), what);
    point.z = number(word_on_line(), what);
    return point;
}

} // namespace raycontact
