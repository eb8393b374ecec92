// SPDX-License-Identifier: Apache-2.0
#include "device/device_list.h"

#include <raycontact/error.h>

#include <algorithm>
#include <charconv>
#include <string>
#include <string_view>

namespace raycontact {

namespace {

// One of the list: "cpu", "cpu/1", "opencl:0", "opencl:0/1", "cuda:0".
struct Name {
    std::string whole; ///< without the part
    bool is_part = false;
    std::uint32_t part = 0;

    std::string text() const { return is_part ? whole + "/" + std::to_string(part) : whole; }
    friend bool operator==(const Name&, const Name&) = default;
};

bool read_number(std::string_view text, std::uint32_t& number) {
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    return error == std::errc{} && end == text.data() + text.size();
}

Name read_name(std::string_view word) {
    const auto malformed = [&] {
        return InputError("devices: \"" + std::string(word)
                          + "\" is not a device: give auto, all, or a list of cpu[/k], opencl:i[/k], cuda:i");
    };
    Name name;
    std::string_view whole = word;
    if (const auto slash = word.find('/'); slash != std::string_view::npos) {
        whole = word.substr(0, slash);
        name.is_part = true;
        if (!read_number(word.substr(slash + 1), name.part)) throw malformed();
    }
    name.whole = whole;
    if (whole == "cpu") return name;
    std::uint32_t index = 0;
    const auto colon = whole.find(':');
    if (colon == std::string_view::npos || !read_number(whole.substr(colon + 1), index)) throw malformed();
    const std::string_view kind = whole.substr(0, colon);
    if (kind != "opencl" && !(kind == "cuda" && !name.is_part)) throw malformed();
    name.whole = std::string(kind) + ":" + std::to_string(index);
    return name;
}

std::vector<std::string> read_list(std::string_view list) {
    std::vector<Name> names;
    std::vector<std::string> ids;
    const auto refuse = [&](const std::string& what) {
        throw InputError("devices: \"" + std::string(list) + "\" names " + what);
    };
    for (std::size_t begin = 0; begin <= list.size();) {
        const std::size_t end = std::min(list.find(',', begin), list.size());
        const Name name = read_name(list.substr(begin, end - begin));
        for (const Name& other : names) {
            if (name == other) refuse("a device twice; name each once");
            if (name.whole == other.whole && name.is_part != other.is_part)
                refuse("a part beside its whole (" + name.whole + "); name one or the other");
        }
        names.push_back(name);
        ids.push_back(name.text());
        begin = end + 1;
    }
    return ids;
}

// Every GPU this version can use, each card once: list_devices() has CUDA's before OpenCL's.
std::vector<std::string> every_gpu() {
    std::vector<std::string> ids, cards;
    for (const DeviceInfo& device : list_devices()) {
        if (!device.usable || device.type != "gpu") continue;
        if (!device.bus.empty() && std::ranges::find(cards, device.bus) != cards.end()) continue;
        cards.push_back(device.bus);
        ids.push_back(device.id);
    }
    return ids;
}

} // namespace

std::vector<std::string> chosen_devices(const Settings& settings) {
    const bool all = settings.devices == "all";
    if (!all && settings.devices != "auto") return read_list(settings.devices);
    // On the CPU `certified` leaves alone most of what a GPU would have to cast in each step.
    if (!all && settings.method == Method::certified) return {"cpu"};
    std::vector<std::string> gpus = every_gpu();
    if (gpus.empty()) return {"cpu"};
    if (!all) gpus.resize(1);
    return gpus;
}

std::vector<OpenDevice> open_devices(const Settings& settings) {
    std::vector<OpenDevice> opened;
    for (const std::string& id : chosen_devices(settings))
        opened.push_back(open_device(id, settings.threads, settings.inexact));
    return opened;
}

} // namespace raycontact
