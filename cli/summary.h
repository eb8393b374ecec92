// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/scene.h>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

// What `run` and `replay` say alike of their steps.

/// The value that this part of the rows does not exceed; 0 of none.
template <class Row, class Value>
double quantile(const std::vector<Row>& rows, double part, Value value) {
    if (rows.empty()) return 0;
    std::vector<double> all;
    all.reserve(rows.size());
    for (const Row& row : rows) all.push_back(value(row));
    const auto at = all.begin() + static_cast<std::ptrdiff_t>(part * static_cast<double>(all.size() - 1));
    std::nth_element(all.begin(), at, all.end());
    return *at;
}

template <class Row, class Value>
nlohmann::ordered_json median_and_p95(const std::vector<Row>& rows, Value value) {
    return {{"median", quantile(rows, 0.5, value)}, {"p95", quantile(rows, 0.95, value)}};
}

/// What the steps did, added up; `pair_bytes` is the most of a step.
class Work {
public:
    template <class Row>
    explicit Work(const std::vector<Row>& rows) {
        for (const raycontact::StepStats& row : rows) add(row);
    }
    std::uint64_t rays_cast() const { return sum_.rays_cast; }
    void put(nlohmann::ordered_json& object) const;

private:
    void add(const raycontact::StepStats& step);
    raycontact::StepStats sum_;
};

/// The settings that decide how much is looked at; lengths in metres, null where the library chooses.
void put_settings(nlohmann::ordered_json& object, const raycontact::Settings& settings);

/// Lines about the work, and about walks where there were any; `object` has what Work::put put there.
std::string work_for_a_person(const nlohmann::ordered_json& object);

/// Columns of steps.csv that both have, comma before each.
std::string work_columns();
std::string work_cells(const raycontact::StepStats& step);
