// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <output/out_file.h>
#include <scenes/simulation.h>

#include <memory>
#include <optional>
#include <string>

/// Records a simulation as it runs; does nothing where no file was asked for. A file that cannot be written later on
/// does not end the run: error() says so.
class RunRecorder {
public:
    /// Without a file nothing is recorded.
    RunRecorder(std::optional<raycontact::output::OutFile> file, const raycontact::scenes::Simulation& scene);
    ~RunRecorder(); ///< without finish(): leaves the steps so far in the file's .part
    RunRecorder(const RunRecorder&) = delete;
    RunRecorder& operator=(const RunRecorder&) = delete;

    void step();                                        ///< after each step of the scene
    void finish(bool cut_short);                        ///< says on standard error what was written and what it cost
    const std::string& error() const { return error_; } ///< empty: none so far

private:
    struct State;
    void give_up(const std::string& why);
    std::unique_ptr<State> state_;
    std::string error_;
};
