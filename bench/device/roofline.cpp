// SPDX-License-Identifier: Apache-2.0
#include "bench/device/roofline.h"

#include "bench/device/counted_kernels.h"
#include "bench/device/replayer.h"
#include "device/forwarding.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <memory>
#include <optional>
#include <unordered_set>
#include <utility>

namespace raycontact::bench {

namespace {

/// Sums over all steps until row_of() has made means of them.
void add(RayKind& sums, const RayCost& cost) {
    sums.a_step += 1;
    sums.nodes += double(cost.nodes);
    sums.blocks += double(cost.blocks);
    sums.faces += double(cost.faces);
    sums.operations += double(cost.operations);
    sums.loaded += double(cost.loaded);
    sums.sectors += double(sector_bytes * cost.sectors.size());
}

struct Counts {
    bool on = false;
    RayKind cast{"cast"}, update{"update"};
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
            add(!follows || was_cast(raw, i) ? counts_->cast : counts_->update, cost);
        }
        counts_->unique += sector_bytes * all.size();
        // A hit and three outcomes; what follows has two words more.
        counts_->written += std::uint64_t{items} * (sizeof(kernels::Hit) + (follows ? 5 : 3) * sizeof(kernels::uint));
    }

    std::shared_ptr<Counts> counts_;
};

RooflineRow row_of(Method method, const Counts& counts, double steps, const Peak& peak) {
    RooflineRow row;
    row.method = method;
    double operations = 0, sectors = 0;
    for (RayKind kind : {counts.cast, counts.update}) {
        if (kind.a_step == 0) continue;
        operations += kind.operations / steps;
        sectors += kind.sectors / steps;
        for (const auto& [name, figure] : ray_figures) kind.*figure /= kind.a_step;
        kind.a_step /= steps;
        row.kinds.push_back(kind);
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

std::vector<RooflineRow> count_roofline(const Work& work, const RooflineOptions& options, const Progress& tell) {
    std::vector<RooflineRow> rows;
    for (const Method method : options.methods) {
        tell("counting " + std::string(to_string(method)));
        const Settings settings = one_thread(method, options.caster);
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

std::string table(const Work& work, const RooflineOptions& options, const std::vector<RooflineRow>& rows) {
    std::string text = fmt::format("{}\nfloors at {:g} GB/s and {:g} TFLOP/s; caster {}\n", work.source,
                                   options.peak.gb_per_s, options.peak.tflops, to_string(options.caster));
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

Json json(const Work& work, const RooflineOptions& options, const std::vector<RooflineRow>& rows) {
    Json out{{"source", work.source},
             {"caster", to_string(options.caster)},
             {"peak_gb_per_s", options.peak.gb_per_s},
             {"peak_tflops", options.peak.tflops},
             {"rows", Json::array()}};
    for (const RooflineRow& row : rows) {
        Json kinds = Json::array();
        for (const RayKind& k : row.kinds) {
            Json& kind = kinds.emplace_back(Json{{"rays", k.name}, {"a_step", k.a_step}});
            for (const auto& [name, figure] : ray_figures) kind[name] = k.*figure;
        }
        out["rows"].push_back({{"method", to_string(row.method)},
                               {"agrees", row.agrees},
                               {"kinds", kinds},
                               {"bytes_once", row.unique},
                               {"bytes_written", row.written},
                               {"floor_us_once", row.floor_unique},
                               {"floor_us_every_ray", row.floor_sectors},
                               {"floor_us_operations", row.floor_operations}});
    }
    return out;
}

} // namespace raycontact::bench
