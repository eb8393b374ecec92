// SPDX-License-Identifier: Apache-2.0
#include "device/device_list.h"

#include "device/device_id.h"

#include <raycontact/error.h>

#include <algorithm>
#include <string>
#include <string_view>

namespace raycontact {

namespace {

std::vector<std::string> read_list(std::string_view list) {
    std::vector<DeviceId> given;
    std::vector<std::string> ids;
    const auto refuse = [&](const std::string& what) {
        throw InputError("devices: \"" + std::string(list) + "\" names " + what);
    };
    for (std::size_t begin = 0; begin <= list.size();) {
        const std::size_t end = std::min(list.find(',', begin), list.size());
        const DeviceId id = DeviceId::read(list.substr(begin, end - begin));
        for (const DeviceId& other : given) {
            if (id == other) refuse("a device twice; name each once");
            if (id.whole() == other.whole() && id.part.has_value() != other.part.has_value())
                refuse("a part beside its whole (" + id.whole() + "); name one or the other");
        }
        given.push_back(id);
        ids.push_back(id.text());
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
