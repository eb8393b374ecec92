// SPDX-License-Identifier: Apache-2.0
#include "bench/device/measure.h"

#include <fmt/format.h>

namespace raycontact::bench {

Json json(const KernelRow& k) {
    return {{"kernel", k.name}, {"launches", k.launches}, {"items", k.items}, {"us", k.us}, {"share", k.share}};
}

Json json(const DeviceResult& r) {
    Json row{
        {"device", r.device}, {"method", to_string(r.method)}, {"caster", to_string(r.caster)}, {"steps", r.steps}};
    for (const auto& [name, figure] : device_figures) row[name] = r.*figure;
    row.update(Json{{"hash", r.hash},
                    {"cpu_hash", r.cpu_hash},
                    {"agrees", r.agrees()},
                    {"fault", r.fault},
                    {"kernels", json_list(r.kernels)}});
    return row;
}

std::string table(const Work& work, const DeviceOptions& options, const DeviceResults& results) {
    std::string text = fmt::format("{}; {} times\n", work.source, options.copies);
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

Json json(const Work& work, const DeviceOptions& options, const DeviceResults& results) {
    Json out{{"source", work.source},
             {"first", options.first},
             {"copies", options.copies},
             {"devices", Json::array()},
             {"results", json_list(results.results)}};
    for (const auto& [info, b] : results.devices)
        out["devices"].push_back({{"device", info.id},
                                  {"name", info.name},
                                  {"driver", info.driver},
                                  {"write_gb_per_s", b.write},
                                  {"read_gb_per_s", b.read},
                                  {"copy_gb_per_s", b.copy},
                                  {"launch_us", b.launch_us},
                                  {"launch_and_wait_us", b.wait_us}});
    return out;
}

Json csv_rows(const Work& work, const DeviceOptions& options, const DeviceResults& results) {
    Json rows = Json::array();
    for (const auto& [info, b] : results.devices) {
        const Json device{{"device", info.id},        {"device_name", info.name},
                          {"driver", info.driver},    {"first", options.first},
                          {"copies", options.copies}, {"bodies", work.body_shape.size() * options.copies}};
        const auto add = [&rows](Json row, const Json& more) {
            row.update(more);
            rows.push_back(row);
        };
        add(device, {{"what", "write"}, {"gb_per_s", b.write}});
        add(device, {{"what", "read"}, {"gb_per_s", b.read}});
        add(device, {{"what", "copy"}, {"gb_per_s", b.copy}});
        add(device, {{"what", "launch"}, {"us", b.launch_us}});
        add(device, {{"what", "launch-and-wait"}, {"us", b.wait_us}});
        for (const DeviceResult& r : results.results) {
            if (r.device != info.id) continue;
            Json step = device;
            step.update(json(r));
            add(step, {{"what", "step"}, {"us", r.step_us}});
            Json way = device;
            way.update({{"method", step["method"]}, {"caster", step["caster"]}, {"steps", r.steps}});
            for (Json kernel : step["kernels"]) {
                kernel["what"] = kernel["kernel"];
                add(way, kernel);
            }
        }
    }
    return rows;
}

} // namespace raycontact::bench
