// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bench/peers/work.h>
#include <raycontact/scene.h>
#include <recording/replay.h>
#include <report/machine.h>

#include <nlohmann/json.hpp>

#include <functional>
#include <string>

// What tables, CSV and JSON of the benchmarks have in common.
namespace raycontact::bench {

using Json = nlohmann::ordered_json;
using report::Machine;

/// What a Progress throws to end a benchmark early: what was measured in whole until then still counts.
struct Stopped {};
/// Told what is being done.
using Progress = std::function<void(const std::string&)>;

Json machine_json(const Machine& machine);
/// The machine's columns, then these. A row has its fields by name, those of its work in a note; or it is an array of
/// them.
std::string csv(const Machine& machine, const std::string& columns, const Json& rows,
                const Json& notes = Json::array());

/// json() of each row.
template <class Rows>
Json json_list(const Rows& rows) {
    Json list = Json::array();
    for (const auto& row : rows) list.push_back(json(row));
    return list;
}

/// What a work was, for the files; and two lines for a person.
Json note_of(const Work& work);
std::string heading_of(const Json& note);

/// Does the work, as far as it gets.
template <class Do>
void until_stopped(Do work) {
    try {
        work();
    } catch (const Stopped&) {
        // What is whole is written.
    }
}

/// Adds the counts of a step; pair_bytes becomes the most of a step.
void add(StepStats& sums, const StepStats& step);
/// What a method of ours did and got wrong.
void put_counts(Json& row, const StepStats& sums, const recording::WrongRays& wrong);

} // namespace raycontact::bench
