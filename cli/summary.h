// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/scene.h>
#include <scenes/quantile.h>

#include <nlohmann/json.hpp>

#include <cstddef>
#include <iostream>
#include <string>
#include <utility>
#include <vector>

// What `run` and `replay` say alike of their steps.

template <class Row, class Value>
double quantile(const std::vector<Row>& rows, double part, Value value) {
    std::vector<double> all;
    all.reserve(rows.size());
    for (const Row& row : rows) all.push_back(value(row));
    return raycontact::scenes::quantile(std::move(all), part);
}

template <class Row, class Value>
nlohmann::ordered_json median_and_p95(const std::vector<Row>& rows, Value value) {
    return {{"median", quantile(rows, 0.5, value)}, {"p95", quantile(rows, 0.95, value)}};
}

/// What the steps did, added up; of `pairs` and `pair_bytes` the most of a step.
class Work {
public:
    template <class Row>
    explicit Work(const std::vector<Row>& rows) {
        for (const raycontact::StepStats& row : rows) add(row);
    }
    const raycontact::StepStats& sum() const { return sum_; }
    void put(nlohmann::ordered_json& object) const;

private:
    void add(const raycontact::StepStats& step);
    raycontact::StepStats sum_;
};

/// What each device did: a list of {"device", "pairs": {"median", "max"}, "launches", ...} over the steps. A device
/// that was opened later did nothing before.
template <class Row>
nlohmann::ordered_json work_of_devices(const std::vector<Row>& rows) {
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    for (std::size_t d = 0; !rows.empty() && d < rows.back().details.work.size(); ++d) {
        nlohmann::ordered_json entry{{"device", rows.back().details.work[d].device}};
        const auto put = [&](const char* key, auto raycontact::DeviceWork::*value) {
            const auto of = [&](const Row& row) {
                const auto& work = row.details.work;
                return d < work.size() ? static_cast<double>(work[d].*value) : 0.0;
            };
            entry[key] = {{"median", quantile(rows, 0.5, of)}, {"max", quantile(rows, 1, of)}};
        };
        put("pairs", &raycontact::DeviceWork::pairs);
        put("launches", &raycontact::DeviceWork::launches);
        put("reads", &raycontact::DeviceWork::reads);
        put("bytes_up", &raycontact::DeviceWork::bytes_up);
        put("bytes_down", &raycontact::DeviceWork::bytes_down);
        put("busy_ms", &raycontact::DeviceWork::busy_ms);
        put("load", &raycontact::DeviceWork::load);
        put("ms", &raycontact::DeviceWork::ms);
        list.push_back(std::move(entry));
    }
    return list;
}

/// What went wrong in a step though its contacts are complete, on stderr, a line each.
template <class Row>
void print_warnings(const std::vector<Row>& rows) {
    for (std::size_t i = 0; i < rows.size(); ++i)
        for (const std::string& warning : rows[i].warnings)
            std::cerr << "raycontact: warning: step " << i << ": " << warning << '\n';
}

/// The ids of that list.
nlohmann::ordered_json devices_of(const nlohmann::ordered_json& list);

/// A line for each entry of that list, and one that says which device has the pairs and why.
std::string devices_for_a_person(const nlohmann::ordered_json& list, const std::string& choice);

/// The settings that decide how much is looked at; lengths in metres, null where the library chooses.
void put_settings(nlohmann::ordered_json& object, const raycontact::Settings& settings);

/// Lines about the work, and about walks where there were any; `object` has what Work::put put there.
std::string work_for_a_person(const nlohmann::ordered_json& object);

/// Columns of steps.csv that both have, comma before each.
std::string work_columns();
std::string work_cells(const raycontact::StepStats& step);
