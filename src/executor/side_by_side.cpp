// SPDX-License-Identifier: Apache-2.0
#include "executor/side_by_side.h"

#include "executor/float_environment.h"

namespace raycontact {

SideBySide::SideBySide(std::size_t count)
    : begin_(static_cast<std::ptrdiff_t>(count)), end_(static_cast<std::ptrdiff_t>(count)) {
    for (std::size_t i = 1; i < count; ++i) threads_.emplace_back([this, i] { serve(i); });
}

SideBySide::~SideBySide() {
    function_ = nullptr;
    begin_.arrive_and_wait();
}

void SideBySide::run(const std::function<void(std::size_t)>& function) {
    function_ = &function;
    begin_.arrive_and_wait();
    function(0);
    end_.arrive_and_wait();
}

void SideBySide::serve(std::size_t number) {
    const FloatEnvironment environment;
    for (;;) {
        begin_.arrive_and_wait();
        if (!function_) return;
        (*function_)(number);
        end_.arrive_and_wait();
    }
}

} // namespace raycontact
