// SPDX-License-Identifier: Apache-2.0
#include "mesh/text_scanner.h"

#include "mesh/vector.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <system_error>

namespace raycontact {
namespace {

bool is_line_end(char c) {
    return c == '\n' || c == '\r';
}
bool is_space(char c) {
    return c == ' ' || (c >= '\t' && c <= '\r');
}
bool is_blank(char c) {
    return is_space(c) && !is_line_end(c);
}

/// What Microsoft's printf writes behind `1.` for numbers that are none.
constexpr std::array<std::string_view, 4> microsoft_marks{"#IND", "#QNAN", "#SNAN", "#INF"};

template <class Number>
std::errc parse(const TextScanner& scanner, std::string_view word, const char* what, const char* kind, Number& value) {
    if (word.empty()) scanner.fail(std::string(what) + " is missing; the file may be truncated");
    const std::string_view digits = word.substr(word[0] == '+' && !word.starts_with("+-") ? 1 : 0);
    const auto [last, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (error == std::errc::invalid_argument || last != digits.data() + digits.size())
        scanner.fail(std::string(what) + " " + in_quotes(word) + " is not a " + kind);
    return error;
}

// Of a number that from_chars() found out of range: infinity if it is too large, else 0. Its first digit that is not 0
// stands at a power of ten far from 0.
double beyond_range(std::string_view word) {
    const std::size_t mark = std::min(word.find_first_of("eE"), word.size());
    const std::string_view digits = word.substr(0, mark);
    const std::size_t first = digits.find_first_of("123456789"), point = std::min(digits.find('.'), digits.size());
    if (first == std::string_view::npos) return 0;
    double power = first < point ? static_cast<double>(point - first) : -static_cast<double>(first - point);
    if (mark < word.size()) {
        const std::size_t plus = word.substr(mark + 1).starts_with('+') ? 1 : 0;
        const std::string_view exponent = word.substr(mark + 1 + plus);
        std::int64_t value = 0;
        const auto error = std::from_chars(exponent.data(), exponent.data() + exponent.size(), value).ec;
        constexpr double huge = std::numeric_limits<double>::max();
        power += error == std::errc() ? static_cast<double>(value) : (exponent.starts_with('-') ? -huge : huge);
    }
    return power > 0 ? std::numeric_limits<double>::infinity() : 0;
}

} // namespace

TextScanner::TextScanner(const InputFile& file)
    : file_(file), at_(file.bytes.data()), end_(file.bytes.data() + file.bytes.size()) {
    if (file.bytes.starts_with("\xef\xbb\xbf")) at_ += 3; // a byte order mark
    while (end_ != at_ && text_padding.find(end_[-1]) != std::string_view::npos) --end_;
}

bool TextScanner::joins(const char* backslash) const {
    if (!joins_lines) return false;
    const char* const next = std::find_if_not(backslash + 1, end_, is_blank);
    return next != end_ && is_line_end(*next);
}

// Microsoft's -1.#IND and 1.#QNAN hold a mark that starts none.
bool TextScanner::is_comment(const char* at) const {
    if (*at != comment) return false;
    const std::string_view rest(at, static_cast<std::size_t>(end_ - at));
    return at == file_.bytes.data() || at[-1] != '.'
           || std::ranges::none_of(microsoft_marks, [&](std::string_view mark) { return rest.starts_with(mark); });
}

void TextScanner::skip_blanks() {
    for (;;) {
        while (at_ != end_ && is_blank(*at_)) ++at_;
        if (at_ == end_ || *at_ != '\\' || !joins(at_)) break;
        next_line();
    }
    if (at_ != end_ && *at_ == comment) at_ = std::find_if(at_, end_, is_line_end);
}

std::string_view TextScanner::word_on_line() {
    skip_blanks();
    const char* const first = at_;
    const char* last = first;
    while (last != end_ && !is_space(*last) && !is_comment(last) && (*last != '\\' || !joins(last))) ++last;
    at_ = last;
    return {first, static_cast<std::size_t>(last - first)};
}

bool TextScanner::next_line() {
    check_();
    at_ = std::find_if(at_, end_, is_line_end);
    if (at_ == end_) return false;
    if (*at_ == '\r' && at_ + 1 != end_ && at_[1] == '\n') ++at_;
    ++at_;
    ++line_;
    return at_ != end_;
}

bool TextScanner::at_end() {
    for (skip_blanks(); at_ != end_ && is_line_end(*at_); skip_blanks()) next_line();
    return at_ == end_;
}

std::string_view TextScanner::word() {
    check_();
    at_end();
    return word_on_line();
}

std::string_view TextScanner::rest_of_line() {
    const char* const first = std::find_if_not(at_, end_, is_blank);
    const char* last = at_ = std::find_if(first, end_, is_line_end);
    while (last != first && is_blank(last[-1])) --last;
    return {first, static_cast<std::size_t>(last - first)};
}

double TextScanner::any_number(std::string_view word, const char* what) const {
    const std::string_view bare = word.substr(word.starts_with('-') || word.starts_with('+') ? 1 : 0);
    for (const std::string_view mark : microsoft_marks)
        if (bare.starts_with("1." + std::string(mark)))
            return mark == "#INF" ? std::numeric_limits<double>::infinity() : std::numeric_limits<double>::quiet_NaN();
    double value = 0;
    // Out of range is either too large, so infinite, or so small that it rounds to zero.
    if (parse(*this, word, what, "number", value) == std::errc::result_out_of_range) value = beyond_range(word);
    return value;
}

double TextScanner::number(std::string_view word, const char* what) const {
    const double value = any_number(word, what);
    if (!std::isfinite(value)) fail(not_finite(what, word));
    return value;
}

std::int64_t TextScanner::integer(std::string_view word, const char* what) const {
    std::int64_t value = 0;
    if (parse(*this, word, what, "whole number", value) == std::errc::result_out_of_range)
        fail(std::string(what) + " " + in_quotes(word) + " is out of range");
    return value;
}

Vec3 TextScanner::point_on_line() {
    Vec3 point;
    for (double* const coordinate : {&point.x, &point.y, &point.z}) *coordinate = number(word_on_line(), "coordinate");
    return point;
}

void TextScanner::vertex_on_line(std::vector<Vec3>& vertices, NonfiniteVertices& nonfinite) {
    Vec3 point;
    for (double* const coordinate : {&point.x, &point.y, &point.z}) {
        const std::string_view word = word_on_line();
        *coordinate = any_number(word, "coordinate");
        if (!std::isfinite(*coordinate)) nonfinite.add(vertices.size(), line_, word);
    }
    vertices.push_back(is_finite(point) ? point : Vec3{});
}

std::size_t TextScanner::numbers_on_line(const char* what) {
    std::size_t count = 0;
    for (std::string_view word = word_on_line(); !word.empty(); word = word_on_line()) {
        any_number(word, what);
        ++count;
    }
    return count;
}

} // namespace raycontact
