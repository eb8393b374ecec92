// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <report/plot.h>
#include <reproduce/cache.h>
#include <reproduce/number.h>

#include <functional>
#include <string>
#include <vector>

namespace raycontact::reproduce {

/// Told of work as it is done: what share of its part.
using Tick = std::function<void(double)>;

/// A piece of work whose result is kept.
struct Part {
    std::string name; ///< of the file in the cache
    Json key;         ///< all settings that decide the result
    double cost = 1;  ///< rough milliseconds; only the progress bar goes by it
    std::function<Json(const Tick&)> make;
};

struct Table {
    std::string title;
    std::vector<std::string> head;
    std::vector<std::vector<std::string>> rows; ///< as long as head
};

/// A page with a 3D view, zlib-compressed, in base64 (view::blob).
struct PackedView {
    std::string name; ///< a word, unique on the page
    std::string html;
};

/// What a reader gets to see of an experiment.
struct Outcome {
    std::vector<Number> numbers;
    std::vector<report::Plot> plots;
    std::vector<Table> tables;
    std::vector<PackedView> views;
    std::vector<std::string> paragraphs; ///< what was done, what differs and why
};

/// One figure, table or claim of the paper.
struct Experiment {
    std::string name; ///< word of the command line, as fig9
    std::string title;
    std::vector<Part> parts;
    /// From the results of all parts, in their order.
    std::function<Outcome(const std::vector<Json>&)> show;
};

} // namespace raycontact::reproduce
