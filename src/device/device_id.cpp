// SPDX-License-Identifier: Apache-2.0
#include "device/device_id.h"

#include <raycontact/error.h>

#include "printable.h"

#include <charconv>

namespace raycontact {

namespace {

bool is_number(std::string_view digits, std::uint32_t& number) {
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
    return error == std::errc{} && end == digits.data() + digits.size();
}

// Whether the text is an id.
bool read_into(DeviceId& id, std::string_view text) {
    const std::size_t slash = text.find('/');
    const std::string_view whole = text.substr(0, slash);
    const std::size_t colon = whole.find(':');
    id.kind = whole.substr(0, colon);
    const bool is_cpu = id.kind == "cpu" && colon == std::string_view::npos;
    const bool is_gpu = id.kind == "cuda" || id.kind == "opencl";
    if (!is_cpu && !is_gpu) return false;
    if (is_gpu && (colon == std::string_view::npos || !is_number(whole.substr(colon + 1), id.index))) return false;
    if (slash == std::string_view::npos) return true;
    return id.kind != "cuda" && is_number(text.substr(slash + 1), id.part.emplace());
}

} // namespace

DeviceId DeviceId::read(std::string_view text) {
    DeviceId id;
    if (read_into(id, text)) return id;
    throw InputError("device '" + printable(text)
                     + "': give cpu, cpu/k, cuda:i, opencl:i or opencl:i/k (`raycontact devices` lists them)");
}

std::string DeviceId::whole() const {
    return kind == "cpu" ? kind : kind + ":" + std::to_string(index);
}

std::string DeviceId::text() const {
    return part ? whole() + "/" + std::to_string(*part) : whole();
}

std::string use_one_of(const std::string& prefix, std::size_t count) {
    return "use " + prefix + "0" + (count > 1 ? " to " + prefix + std::to_string(count - 1) : "");
}

} // namespace raycontact
