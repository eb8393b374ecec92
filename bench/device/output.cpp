// SPDX-License-Identifier: Apache-2.0
#include "bench/device/output.h"

#include <bench/peers/files.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>

namespace raycontact::bench {

namespace {

using Json = nlohmann::ordered_json;

const DeviceInfo& info_of(const DeviceResults& results, const std::string& id) {
    return std::ranges::find(results.devices, id, [](const MeasuredDevice& d) { return d.info.id; })->info;
}

std::string scale_of(const Work& work, const DeviceOptions& options) {
    return fmt::format("{},{},{}", options.first, options.copies, work.body_shape.size() * options.copies);
}

constexpr const char* columns =
    ",device,device_name,driver,first,copies,bodies,method,caster,steps,what,pairs,rays_cast,walks,contacts,launches,"
    "items,us,share,narrow_us,busy_us,reads,bytes_up,bytes_down,gb_per_s,hash,agrees,fault\n";

std::string csv(const Machine& machine, const Work& work, const DeviceOptions& options, const DeviceResults& results) {
    std::string text = machine_columns + std::string(columns);
    const auto begin = [&](const DeviceInfo& info) {
        return fmt::format("{},{},{},{},{}", machine_fields(machine), info.id, quoted(info.name), quoted(info.driver),
                           scale_of(work, options));
    };
    for (const auto& [info, bandwidth] : results.devices) {
        for (const auto& [name, value] : {std::pair{"write", bandwidth.write}, std::pair{"read", bandwidth.read},
                                          std::pair{"copy", bandwidth.copy}})
            text += fmt::format("{},,,,{},,,,,,,,,,,,,,{:.3f},,,\n", begin(info), name, value);
        for (const auto& [name, value] :
             {std::pair{"launch", bandwidth.launch_us}, std::pair{"launch-and-wait", bandwidth.wait_us}})
            text += fmt::format("{},,,,{},,,,,,,{:.3f},,,,,,,,,,\n", begin(info), name, value);
    }
    for (const DeviceResult& r : results.results) {
        const std::string way = fmt::format("{},{},{},{}", begin(info_of(results, r.device)), to_string(r.method),
                                            to_string(r.caster), r.steps);
        text += fmt::format("{},step,{},{},{},{},{},,{:.3f},,{:.3f},{:.3f},{},{},{},,{},{},{}\n", way, r.pairs,
                            r.rays_cast, r.walks, r.contacts, r.launches, r.step_us, r.narrow_us, r.busy_us, r.reads,
                            r.bytes_up, r.bytes_down, r.hash, r.agrees() ? 1 : 0, quoted(r.fault));
        for (const KernelRow& k : r.kernels)
            text += fmt::format("{},{},,,,,{:.3f},{:.1f},{:.3f},{:.4f},,,,,,,,,\n", way, k.name, k.launches, k.items,
                                k.us, k.share);
    }
    return text;
}

} // namespace

std::string table(const Machine& machine, const Work& work, const DeviceOptions& options,
                  const DeviceResults& results) {
    std::string text = heading(machine);
    text += fmt::format("{}; {} times\n", work.source, options.copies);
    for (const auto& [info, b] : results.devices) {
        text += fmt::format("\n{}: {} ({})\n", info.id, info.name, info.driver);
        text +=
            fmt::format("  GB/s: write {:.2f}, read {:.2f}, copy {:.2f} (read and written); empty launch {:.2f} us, "
                        "with its wait {:.2f} us\n",
                        b.write, b.read, b.copy, b.launch_us, b.wait_us);
        for (const DeviceResult& r : results.results) {
            if (r.device != info.id) continue;
            text += fmt::format("  {} {}, {} steps: {} pairs, {} rays cast, {} walks, {} contacts; {}\n",
                                to_string(r.method), to_string(r.caster), r.steps, r.pairs, r.rays_cast, r.walks,
                                r.contacts,
                                !r.fault.empty() ? "FAILED: " + r.fault
                                : r.agrees()     ? "hash " + r.hash + ", as the CPU's"
                                                 : "HASH " + r.hash + ", THE CPU'S IS " + r.cpu_hash);
            text += fmt::format("    step {:.1f} us, narrow phase {:.1f}, busy {:.1f}; {} launches, {} reads, {} bytes "
                                "up, {} down\n",
                                r.step_us, r.narrow_us, r.busy_us, r.launches, r.reads, r.bytes_up, r.bytes_down);
            for (const KernelRow& k : r.kernels)
                text += fmt::format("      {:<18}{:>6.2f} a step{:>13.1f} items{:>12.2f} us{:>7.1f} %\n", k.name,
                                    k.launches, k.items, k.us, 100 * k.share);
        }
    }
    return text;
}

std::string json(const Machine& machine, const Work& work, const DeviceOptions& options, const DeviceResults& results) {
    Json out{{"machine", machine_json(machine)}, {"source", work.source},    {"first", options.first},
             {"copies", options.copies},         {"devices", Json::array()}, {"results", Json::array()}};
    for (const auto& [info, b] : results.devices)
        out["devices"].push_back({{"device", info.id},
                                  {"name", info.name},
                                  {"driver", info.driver},
                                  {"write_gb_per_s", b.write},
                                  {"read_gb_per_s", b.read},
                                  {"copy_gb_per_s", b.copy},
                                  {"launch_us", b.launch_us},
                                  {"launch_and_wait_us", b.wait_us}});
    for (const DeviceResult& r : results.results) {
        Json kernels = Json::array();
        for (const KernelRow& k : r.kernels)
            kernels.push_back(
                {{"kernel", k.name}, {"launches", k.launches}, {"items", k.items}, {"us", k.us}, {"share", k.share}});
        out["results"].push_back({{"device", r.device},
                                  {"method", to_string(r.method)},
                                  {"caster", to_string(r.caster)},
                                  {"steps", r.steps},
                                  {"pairs", r.pairs},
                                  {"rays_cast", r.rays_cast},
                                  {"walks", r.walks},
                                  {"contacts", r.contacts},
                                  {"step_us", r.step_us},
                                  {"narrow_us", r.narrow_us},
                                  {"busy_us", r.busy_us},
                                  {"launches", r.launches},
                                  {"reads", r.reads},
                                  {"bytes_up", r.bytes_up},
                                  {"bytes_down", r.bytes_down},
                                  {"hash", r.hash},
                                  {"cpu_hash", r.cpu_hash},
                                  {"agrees", r.agrees()},
                                  {"fault", r.fault},
                                  {"kernels", kernels}});
    }
    // Drivers choose their own names: what is not UTF-8 in them must not end the program.
    return out.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
}

void write_results(output::OutFolder& folder, const Machine& machine, const Work& work, const DeviceOptions& options,
                   const DeviceResults& results) {
    folder.write(result_name(machine, "device", ".csv"), csv(machine, work, options, results));
}

} // namespace raycontact::bench
