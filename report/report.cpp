// SPDX-License-Identifier: Apache-2.0
#include <report/report.h>

#include <report/image.h>
#include <report/page.h>
#include <report/render.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

namespace raycontact::report {
namespace {

constexpr std::uint32_t picture_width = 1600, picture_height = 900, film_width = 640, film_height = 360;
constexpr std::uint32_t picture_cost = 12; // in frames of the film
constexpr int jpeg_quality = 82;           // in the page; the files beside it are PNG

const char* const page_name = "report.html";
const char* const film_name = "pictures/film.webp";

/// The first, the last, and as many as fit evenly between.
std::vector<std::size_t> chosen_frames(std::size_t count, std::size_t most) {
    std::vector<std::size_t> chosen;
    const std::size_t wanted = std::min(count, most);
    for (std::size_t k = 0; k < wanted; ++k) chosen.push_back(wanted > 1 ? k * (count - 1) / (wanted - 1) : count - 1);
    return chosen;
}

/// Those of the film; of a run with a few frames none.
std::vector<std::size_t> film_frames_of(const scenes::RunLog& log, const ReportOptions& options) {
    if (options.pictures == 0 || log.frames.size() < 3) return {};
    return chosen_frames(log.frames.size(), film_frames);
}

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

/// As long as the run where it can be shown so.
std::string film_of(const scenes::RunLog& log, const Renderer& renderer, const ReportOptions& options,
                    std::uint32_t& done) {
    std::vector<Image> images;
    for (const std::size_t k : film_frames_of(log, options)) {
        if (options.stop()) return {};
        images.push_back(renderer.render_for_film(log.frames[k], film_width, film_height));
        options.progress(++done);
    }
    if (images.empty()) return {};
    const double seconds = static_cast<double>(log.rows.size()) * log.dt;
    const double each = 1000 * seconds / static_cast<double>(images.size());
    return encode_webp(images, static_cast<int>(std::clamp(each, 60.0, 420.0)));
}

} // namespace

void claim_report(output::OutFolder& folder) {
    folder.claim(page_name);
    folder.claim(film_name);
    folder.supersede("pictures/step-", ".png");
    folder.supersede("pictures/film", ".webp");
}

std::uint32_t work_of(const scenes::RunLog& log, const ReportOptions& options) {
    const std::size_t pictures = chosen_frames(log.frames.size(), options.pictures).size();
    return static_cast<std::uint32_t>(picture_cost * pictures + film_frames_of(log, options).size());
}

void write_report(output::OutFolder& folder, const scenes::RunLog& log, const ReportOptions& options) {
    Page page;
    describe(log, page);
    page.plots = plots_of(log);
    page.comparison = options.comparison;
    std::optional<Renderer> renderer; // building its scenes takes a while
    if (options.pictures > 0) renderer.emplace(log);
    std::uint32_t done = 0; // of work_of()
    for (const std::size_t k : chosen_frames(log.frames.size(), options.pictures)) {
        if (options.stop()) break;
        const scenes::Frame& frame = log.frames[k];
        const Image image = renderer->render(frame, picture_width, picture_height);
        folder.write(fmt::format("pictures/step-{:03}.png", frame.step), encode_png(image));
        page.stills.push_back({encode_jpeg(image, jpeg_quality),
                               fmt::format("step {}, {:.1f} s", frame.step, (frame.step + 1) * log.dt)});
        options.progress(done += picture_cost);
    }
    if (renderer) page.film = film_of(log, *renderer, options, done);
    if (!page.film.empty()) {
        folder.write(film_name, page.film);
        page.film_caption = fmt::format("The whole run, {:.3g} s", static_cast<double>(log.rows.size()) * log.dt);
    }
    if (!page.stills.empty() || !page.film.empty())
        page.footer = fmt::format("Pictures: Embree, sun and sky{}; colours tell bodies apart and mean nothing else. "
                                  "The camera follows the pile from picture to picture. {}",
                                  log.slab || log.plane ? ", one ground square is 1 m" : "", page.footer);
    if (done < work_of(log, options)) page.footer = "Drawing was ended before all pictures were made. " + page.footer;
    folder.write(page_name, make_page(page));
}

} // namespace raycontact::report
