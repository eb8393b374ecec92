// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/export.h>
#include <raycontact/library_mode.h>

#include <cstdint>
#include <string>
#include <string_view>

namespace raycontact {

/// Which of several devices a pair is on.
enum class Schedule {
    balanced, ///< where it came first, unless devices are loaded unevenly for several steps: then pairs move
    sticky,   ///< where it came first, as long as it is open (paper section 4)
    counted,  ///< as balanced, but what a unit of load costs is set, not measured, so that a run repeats exactly
};

/// Threads of yours in place of a scene's own, as those of a game's job system.
struct TaskSystem {
    /// A piece of work: to be called for each i below `count`, on any thread, once. It does not throw.
    using Job = void (*)(void* data, std::uint32_t i);
    /// Calls job(data, i) for all i, several at once if it can, and returns when all have returned. Called by the
    /// thread that steps the scene, of several devices by one thread each; not from within a job. It must not throw.
    /// A step throws std::logic_error if it returns before all were called. Null: the scene has threads of its own.
    void (*run)(void* user, std::uint32_t count, Job job, void* data) = nullptr;
    void* user = nullptr; ///< for `run`
    friend bool operator==(const TaskSystem&, const TaskSystem&) = default;
};

/// How a scene is run. Nothing here changes a bit of the result, but for `inexact`. Fixed once a Scene is made.
struct Execution {
    /// "auto" (the CPU or the first GPU, whichever was faster when both were tried; Scene::device_choice() tells),
    /// "all" (every GPU, or the CPU where there is none), or ids of list_devices(), separated by commas: the pairs are
    /// shared out among them. "cpu/k", and "ID/k" where the driver divides the device, is its k-th core alone.
    std::string devices = "auto";
    std::uint32_t threads = 0; ///< of the host; 0: one per core; 1: no others than the caller's
    /// Whose threads these are: `threads` says how many run at once. What makes shapes faster beside the steps
    /// (Shape::prepare()) has a thread of its own all the same; call it before if there is to be none.
    TaskSystem tasks{};
    Schedule schedule = Schedule::balanced; ///< of pairs, among several devices; `auto` measures nothing with `counted`
    /// Accept a device that rounds differently: its contacts may differ from those of all other devices.
    bool inexact = false;
    friend bool operator==(const Execution&, const Execution&) = default;
};

/// The word of the command line; throws InputError naming what is known.
RAYCONTACT_API Schedule schedule_from(std::string_view word);
/// The word that schedule_from() takes for it.
RAYCONTACT_API std::string_view to_string(Schedule);

} // namespace raycontact
