// SPDX-License-Identifier: Apache-2.0
#include "device/scan.h"

#include <raycontact/error.h>

#include <limits>

namespace raycontact {

namespace {

constexpr std::size_t words = sizeof(kernels::Totals) / sizeof(kernels::uint);

} // namespace

Count::Count(std::size_t number) {
    if (number >= std::numeric_limits<kernels::uint>::max())
        throw InputError("more than 2^32 items in one step; give it fewer pairs");
    value = most = static_cast<kernels::uint>(number);
}

void Columns::resize(Device& device, kernels::uint columns, std::size_t items) {
    columns_ = columns;
    stride_ = Count(items).value;
    values_.resize(device, columns * items);
    firsts_.resize(device, items);
}

void Columns::scan(Device& device, const Count& count, const Array<kernels::Totals>& totals, std::size_t at,
                   std::size_t room, std::size_t before) const {
    device.queue().scan({count, columns_, stride_, values_.buffer(), firsts_.buffer(), totals.buffer(),
                         static_cast<kernels::uint>(at), Count(room).value, Count(before).value});
}

Count items_of(const Array<kernels::Totals>& totals, std::size_t at, std::size_t most) {
    return {totals.buffer(), at * words, most};
}

Count results_of(const Array<kernels::Totals>& totals, std::size_t at, std::size_t most) {
    return {totals.buffer(), at * words + 1, most};
}

void check_sums(std::span<const kernels::Totals> totals) {
    for (const kernels::Totals& own : totals)
        for (const kernels::uint sum : own.sums)
            if (sum == NONE) throw InputError("more than 2^32 items in one step; give it fewer pairs");
}

} // namespace raycontact
