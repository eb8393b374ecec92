// SPDX-License-Identifier: Apache-2.0
#include "bench/device/roofline.h"

#include "bench/device/counted_kernels.h"
#include "bench/device/replayer.h"
#include "device/forwarding.h"

#include <bench/peers/files.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstring>
#include <memory>
#include <optional>
#include <unordered_set>
#include <utility>

namespace raycontact::bench {

namespace {

struct KindSum {
    std::uint64_t rays = 0, nodes = 0, blocks = 0, faces = 0, operations = 0, loaded = 0, sectors = 0;

    void add(const RayCost& cost) {
        ++rays;
        nodes += cost.nodes;
        blocks += cost.blocks;
        faces += cost.faces;
        operations += cost.operations;
        loaded += cost.loaded;
        sectors += sector_bytes * cost.sectors.size();
    }
};

struct Counts {
    bool on = false;
    KindSum cast, update;
    std::uint64_t unique = 0, written = 0;
    bool agrees = true;
};

std::optional<RayKernel> ray_kernel(KernelId kernel) {
    switch (kernel) {
    case KernelId::cast_rays_bvh:
        return RayKernel::cast_rays_bvh;
    case KernelId::cast_rays_basic:
        return RayKernel::cast_rays_basic;
    case KernelId::follow_rays_bvh:
        return RayKernel::follow_rays_bvh;
    case KernelId::follow_rays_basic:
        return RayKernel::follow_rays_basic;
    default:
        return {};
    }
}

/// Over the CPU's device. Has the rays of each launch cast once more by the counting kernels, into the same buffers.
class RayCounter : public ForwardingDevice {
public:
    /// The counts outlive the device, which a part takes for itself.
    RayCounter(std::unique_ptr<Device> inner, std::shared_ptr<Counts> counts)
        : ForwardingDevice(std::move(inner)), counts_(std::move(counts)) {}

private:
    void launch(KernelId kernel, Count count, std::span<const Argument> arguments) override {
        inner().launch(kernel, count, arguments);
        const auto which = ray_kernel(kernel);
        if (!which || !counts_->on) return;
        const kernels::uint items =
            count.buffer ? static_cast<const kernels::uint*>(count.buffer->host())[count.value] : count.value;
        std::vector<RawArgument> raw;
        std::vector<std::vector<std::byte>> before;
        for (const Argument& argument : arguments) {
            raw.push_back({argument.buffer ? argument.buffer->host() : nullptr, argument.scalar});
            const auto* bytes = static_cast<const std::byte*>(raw.back().memory);
            before.emplace_back(bytes, bytes + (argument.buffer ? argument.buffer->bytes() : 0));
        }
        count_rays(*which, items, raw);
        for (std::size_t i = 0; i < raw.size(); ++i)
            if (!before[i].empty() && std::memcmp(before[i].data(), raw[i].memory, before[i].size()) != 0)
                counts_->agrees = false;
    }

    void count_rays(RayKernel kernel, kernels::uint items, std::span<const RawArgument> raw) {
        const bool follows = kernel == RayKernel::follow_rays_bvh || kernel == RayKernel::follow_rays_basic;
        std::unordered_set<std::uintptr_t> all;
        for (kernels::uint i = 0; i < items; ++i) {
            const RayCost cost = count_ray(kernel, i, items, raw);
            all.insert(cost.sectors.begin(), cost.sectors.end());
            (!follows || was_cast(raw, i) ? counts_->cast : counts_->update).add(cost);
        }
        counts_->unique += sector_bytes * all.size();
        // A hit and three outcomes; what follows has two words more.
        counts_->written += std::uint64_t{items} * (sizeof(kernels::Hit) + (follows ? 5 : 3) * sizeof(kernels::uint));
    }

    std::shared_ptr<Counts> counts_;
};

RayKind kind_of(const char* name, const KindSum& sum, double steps) {
    const double rays = static_cast<double>(std::max<std::uint64_t>(sum.rays, 1));
    const auto mean = [&](std::uint64_t all) { return static_cast<double>(all) / rays; };
    return {name,
            static_cast<double>(sum.rays) / steps,
            mean(sum.nodes),
            mean(sum.blocks),
            mean(sum.faces),
            mean(sum.operations),
            mean(sum.loaded),
            mean(sum.sectors)};
}

RooflineRow row_of(Method method, const Counts& counts, double steps, const Peak& peak) {
    RooflineRow row;
    row.method = method;
    double operations = 0, sectors = 0;
    for (const auto& [name, sum] :
         {std::pair<const char*, const KindSum&>{"cast", counts.cast}, {"update", counts.update}}) {
        if (sum.rays == 0) continue;
        row.kinds.push_back(kind_of(name, sum, steps));
        operations += static_cast<double>(sum.operations) / steps;
        sectors += static_cast<double>(sum.sectors) / steps;
    }
    row.unique = static_cast<double>(counts.unique) / steps;
    row.written = static_cast<double>(counts.written) / steps;
    row.floor_sectors = (sectors + row.written) / peak.gb_per_s * 1e-3;
    row.floor_unique = (row.unique + row.written) / peak.gb_per_s * 1e-3;
    row.floor_operations = operations / peak.tflops * 1e-6;
    row.agrees = counts.agrees;
    return row;
}

} // namespace

std::vector<RooflineRow> count_roofline(const Work& work, const RooflineOptions& options,
                                        const std::function<void(const std::string&)>& tell) {
    std::vector<RooflineRow> rows;
    for (const Method method : options.methods) {
        tell("counting " + std::string(to_string(method)));
        Settings settings;
        settings.features = Features::vertices;
        settings.method = method;
        settings.paper.caster = options.caster;
        settings.execution.threads = 1;
        const auto counts = std::make_shared<Counts>();
        OpenDevice opened = open_device("cpu", 1);
        opened.device = std::make_unique<RayCounter>(std::move(opened.device), counts);
        Replayer replayer(work, 1, settings, std::move(opened));
        replayer.rest(settings);
        for (std::size_t k = 0; k < work.steps.size(); ++k) {
            replayer.step(k);
            counts->on = true; // not in the first step, in which every pair is new
        }
        rows.push_back(row_of(method, *counts, static_cast<double>(work.steps.size() - 1), options.peak));
    }
    return rows;
}

std::string table(const Machine& machine, const Work& work, const RooflineOptions& options,
                  const std::vector<RooflineRow>& rows) {
    std::string text = heading(machine) + work.source + "\n";
    text += fmt::format("floors at {:g} GB/s and {:g} TFLOP/s; caster {}\n", options.peak.gb_per_s, options.peak.tflops,
                        to_string(options.caster));
    for (const RooflineRow& row : rows) {
        text +=
            fmt::format("\n{}{}\n", to_string(row.method), row.agrees ? "" : ": THE COUNTING KERNELS GAVE OTHER BITS");
        text += fmt::format("  {:<8}{:>10}{:>8}{:>8}{:>8}{:>12}{:>14}{:>14}{:>10}\n", "rays", "a step", "nodes",
                            "blocks", "faces", "operations", "bytes loaded", "in sectors", "op/byte");
        for (const RayKind& k : row.kinds)
            text += fmt::format("  {:<8}{:>10.1f}{:>8.2f}{:>8.2f}{:>8.2f}{:>12.1f}{:>14.1f}{:>14.1f}{:>10.2f}\n",
                                k.name, k.a_step, k.nodes, k.blocks, k.faces, k.operations, k.loaded, k.sectors,
                                k.operations / std::max(k.sectors, 1.0));
        text +=
            fmt::format("  a step: {:.0f} bytes if each is read once, {:.0f} written; floor {:.3f} us so, {:.3f} us if "
                        "every ray reads its own, {:.3f} us for the operations\n",
                        row.unique, row.written, row.floor_unique, row.floor_sectors, row.floor_operations);
    }
    return text;
}

std::string json(const Machine& machine, const Work& work, const RooflineOptions& options,
                 const std::vector<RooflineRow>& rows) {
    using Json = nlohmann::ordered_json;
    Json out{{"machine", machine_json(machine)},    {"source", work.source},
             {"caster", to_string(options.caster)}, {"peak_gb_per_s", options.peak.gb_per_s},
             {"peak_tflops", options.peak.tflops},  {"rows", Json::array()}};
    for (const RooflineRow& row : rows) {
        Json kinds = Json::array();
        for (const RayKind& k : row.kinds)
            kinds.push_back({{"rays", k.name},
                             {"a_step", k.a_step},
                             {"nodes", k.nodes},
                             {"blocks", k.blocks},
                             {"faces", k.faces},
                             {"operations", k.operations},
                             {"bytes_loaded", k.loaded},
                             {"bytes_in_sectors", k.sectors}});
        out["rows"].push_back({{"method", to_string(row.method)},
                               {"agrees", row.agrees},
                               {"kinds", kinds},
                               {"bytes_once", row.unique},
                               {"bytes_written", row.written},
                               {"floor_us_once", row.floor_unique},
                               {"floor_us_every_ray", row.floor_sectors},
                               {"floor_us_operations", row.floor_operations}});
    }
    return out.dump() + "\n";
}

} // namespace raycontact::bench
