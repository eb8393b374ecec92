// SPDX-License-Identifier: Apache-2.0
#include <report/report.h>

#include <report/page.h>

#include <algorithm>
#include <cmath>

namespace raycontact::report {
namespace {

const char* const page_name = "report.html";

template <class Value>
Line line(const scenes::RunLog& log, const char* name, Value value) {
    Line line{name, {}};
    for (const scenes::StepRow& row : log.rows) line.points.emplace_back(row.step, static_cast<double>(value(row)));
    return line;
}

std::vector<Plot> plots_of(const scenes::RunLog& log) {
    using scenes::StepRow;
    std::vector<Plot> plots{
        {"Pairs",
         "pairs",
         "Pairs of bodies whose boxes overlap, as the broad phase hands them to the narrow phase.",
         {line(log, "pairs", [](const StepRow& r) { return r.pairs; })}},
        {"Rays",
         "rays",
         "Rays of the rule, both ways round: vertices inside the other body's bounds, also those known to be outside "
         "its mesh. By certified only those that it knows no reason to leave alone.",
         {line(log, "rays", [](const StepRow& r) { return r.details.rays; })}},
        {"Contacts",
         "contacts",
         "Rays that met the other mesh from inside before they left their own.",
         {line(log, "contacts", [](const StepRow& r) { return r.contacts; })}},
        {"Time",
         "ms",
         "Wall clock of a whole step (with the response) and of the narrow phase in it, on this machine.",
         {line(log, "step", [](const StepRow& r) { return r.step_ms; }),
          line(log, "narrow phase", [](const StepRow& r) { return r.narrow_ms; })}},
        {"Penetration",
         "mm",
         "Depth of the deepest contact of the step, along the contact's normal.",
         {line(log, "penetration", [](const StepRow& r) { return 1000 * r.penetration_max; })}},
        {"Ray length",
         "m",
         "Lengths of all rays that are contacts, added up.",
         {line(log, "ray length", [](const StepRow& r) { return r.details.ray_length; })}},
        {"Mean ray length",
         "mm",
         "Ray length divided by contacts: how far a vertex in contact typically is from the face it meets.",
         {line(log, "mean ray length",
               [](const StepRow& r) {
                   return r.contacts > 0 ? 1000 * r.details.ray_length / static_cast<double>(r.contacts) : std::nan("");
               })}},
        {"Median speed",
         "m/s",
         "Half of the moving bodies are slower than this at the end of the step.",
         {line(log, "speed", [](const StepRow& r) { return r.median_speed; })}},
    };
    const std::vector<DeviceWork>& opened = log.rows.back().details.work; // some later than others
    const std::size_t devices = opened.size();
    if (devices > 1) {
        Plot load{
            "Load of devices", "pairs at rest", "What each device had to do, counted: pairs, vertices and rays.", {}};
        Plot time{"Time of devices", "ms", "Wall clock of each device's part of a step; they work side by side.", {}};
        for (std::size_t d = 0; d < devices; ++d) {
            const auto add = [&](Plot& plot, double DeviceWork::*value) {
                plot.lines.push_back(line(log, opened[d].device.c_str(), [d, value](const StepRow& r) {
                    return d < r.details.work.size() ? r.details.work[d].*value : 0;
                }));
            };
            add(load, &DeviceWork::load);
            add(time, &DeviceWork::ms);
        }
        plots.push_back(load);
        plots.push_back(time);
    }
    std::erase_if(plots, [](const Plot& plot) { // nothing of the kind happened
        return std::ranges::all_of(plot.lines, [](const Line& line) {
            return std::ranges::all_of(line.points, [](const auto& point) { return !(std::fabs(point.second) > 0); });
        });
    });
    for (Plot& plot : plots) plot.over = over_steps(log.dt);
    return plots;
}

} // namespace

void claim_report(output::OutFolder& folder) {
    folder.claim(page_name);
}

void write_report(output::OutFolder& folder, const scenes::RunLog& log, const std::string& view,
                  const Comparison& comparison) {
    Page page;
    describe(log, page);
    page.view = view;
    page.plots = plots_of(log);
    page.comparison = comparison;
    folder.write(page_name, make_page(page));
}

} // namespace raycontact::report
