// SPDX-License-Identifier: Apache-2.0
#include <bench/peers/results.h>

#include <fmt/format.h>

#include <algorithm>
#include <sstream>

namespace raycontact::bench {

namespace {

std::string field(const Json& value) {
    if (value.is_null()) return "";
    if (value.is_boolean()) return value.get<bool>() ? "1" : "0";
    if (value.is_number_float()) return fmt::format("{:.9g}", value.get<double>());
    if (!value.is_string()) return value.dump();
    auto text = value.get<std::string>();
    if (text.find_first_of(",\"\n") == std::string::npos) return text;
    std::string quoted = "\"";
    for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
    return quoted + '"';
}

} // namespace

Json machine_json(const Machine& m) {
    return {{"date", m.date},         {"commit", m.commit},     {"cpu", m.cpu},   {"cores", m.cores},
            {"compiler", m.compiler}, {"governor", m.governor}, {"load", m.load}, {"cut_short", m.cut_short}};
}

std::string csv(const Machine& m, const std::string& columns, const Json& rows, const Json& notes) {
    std::vector<std::string> names;
    std::istringstream list(columns);
    for (std::string name; std::getline(list, name, ',');) names.push_back(name);
    std::string begin, text = "date,commit,cpu,cores,compiler,governor,load," + columns + "\n";
    for (const Json& value :
         {Json(m.date), Json(m.commit), Json(m.cpu), Json(m.cores), Json(m.compiler), Json(m.governor), Json(m.load)})
        begin += field(value) + ',';
    for (Json row : rows) {
        if (row.is_object()) {
            const Json wrong = row.value("wrong_rays", Json::object());
            row.update(wrong);
            row["wrong"] = wrong.value("total", Json());
            for (const Json& note : notes)
                if (note["work"] == row["work"])
                    for (const char* name : {"source", "pace_median", "pace_most"}) row[name] = note[name];
        }
        text += begin;
        for (std::size_t k = 0; k < names.size(); ++k)
            text += field(row.is_array() ? row[k] : row[names[k]]) + (k + 1 < names.size() ? ',' : '\n');
    }
    return text;
}

Json note_of(const Work& work) {
    const Pace moved = pace(work);
    return {{"work", work.name},           {"source", work.source},
            {"steps", work.steps.size()},  {"pair_steps", work.pair_steps()},
            {"pace_median", moved.median}, {"pace_most", moved.most}};
}

std::string heading_of(const Json& note) {
    return fmt::format("\n{}: {} steps, {} pair-steps; {}\na pair moves {:.3g} % of its size a step (median; most "
                       "{:.3g} %)\n",
                       note["work"].get<std::string>(), note["steps"].dump(), note["pair_steps"].dump(),
                       note["source"].get<std::string>(), 100 * note["pace_median"].get<double>(),
                       100 * note["pace_most"].get<double>());
}

void add(StepStats& sums, const StepStats& step) {
    sums.pairs += step.pairs;
    sums.details.vertices += step.details.vertices;
    sums.details.rays += step.details.rays;
    sums.details.rays_cast += step.details.rays_cast;
    sums.details.pairs_full += step.details.pairs_full;
    sums.details.pairs_skipped += step.details.pairs_skipped;
    sums.details.walks += step.details.walks;
    sums.details.walks_lost += step.details.walks_lost;
    sums.details.walk_casts += step.details.walk_casts;
    sums.details.predictions += step.details.predictions;
    sums.contacts += step.contacts;
    sums.pair_bytes = std::max(sums.pair_bytes, step.pair_bytes);
}

void put_counts(Json& row, const StepStats& s, const recording::WrongRays& w) {
    row.update(Json{
        {"rays", s.details.rays},
        {"rays_cast", s.details.rays_cast},
        {"walks", s.details.walks},
        {"walks_lost", s.details.walks_lost},
        {"walk_casts", s.details.walk_casts},
        {"predictions", s.details.predictions},
        {"pairs_full", s.details.pairs_full},
        {"pairs_skipped", s.details.pairs_skipped},
        {"pair_bytes", s.pair_bytes},
        {"contacts", s.contacts},
        {"wrong_rays",
         {{"total", w.total()}, {"missed", w.missed}, {"invented", w.invented}, {"other_triangle", w.other_triangle}}},
        {"rays_compared", w.rays_compared},
        {"contacts_compared", w.contacts_compared}});
}

} // namespace raycontact::bench
