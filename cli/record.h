// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <output/out_file.h>
#include <raycontact/recorder.h>
#include <scenes/simulation.h>

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
    void give_up(const std::string& why);
    std::optional<raycontact::output::OutFile> file_;
    std::optional<raycontact::Recorder> recorder_; ///< as long as there is something to write
    std::string error_;
};
